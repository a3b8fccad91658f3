//! A pose of the skinning exercise's models, in both implementations.

// Each test program uses a part of it.
#![allow(dead_code)]

use gaitway_scene::state::{ViewerState, from_link};
use glam::{DQuat, DVec3, EulerRot};
use serde_json::Value;

use crate::coursework::Exercise;
use crate::data_folder::data_folder;

pub const BENT: &str = "v=1&clip=&pose=0:10:-20:5,2:0:0:15,5:-60:0:10,6:70:0:0,12:0:30:-20,13:0:0:45,16:-30:20:0";

pub fn bent() -> ViewerState {
    from_link(BENT).0
}

/// The same rotations for the reference implementation of the exercise.
pub fn rotations(state: &ViewerState) -> Vec<DQuat> {
    let of = |joint: usize| {
        let [x, y, z] = state
            .character
            .edits
            .pose
            .get(&joint)
            .copied()
            .unwrap_or_default()
            .map(|angle| f64::from(angle).to_radians());
        DQuat::from_euler(EulerRot::XYZ, x, y, z)
    };
    (0..18).map(of).collect()
}

pub fn exercise(name: &str) -> Option<Exercise> {
    let folder = data_folder()?.join("mit6837");
    let text = |kind: &str| std::fs::read_to_string(folder.join(format!("{name}.{kind}"))).expect("a real file");
    Some(Exercise::read(&text("obj"), &text("skel"), &text("attach")))
}

pub fn positions(document: &Value) -> Vec<DVec3> {
    let meshes = document["meshes"].as_array().expect("meshes");
    assert_eq!(meshes.len(), 1, "an .obj is one mesh");
    let numbers: Vec<f64> =
        meshes[0]["positions"].as_array().expect("positions").iter().filter_map(Value::as_f64).collect();
    numbers.as_chunks::<3>().0.iter().map(|&at| DVec3::from_array(at)).collect()
}

pub fn furthest(a: &[DVec3], b: &[DVec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}
