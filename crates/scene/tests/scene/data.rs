//! Models for the tests: the walker, small generated ones, and real files if they are available.

use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, Keys, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance};
use gaitway_character::mesh::{Geometry, Mesh};
use gaitway_scene::library::{Library, Model, TakeSampler};
use gaitway_scene::samples;
use gaitway_scene::state::{ViewerState, active_take, moment};
use glam::Vec3;

use crate::data_folder::data_folder;
use crate::opened;

pub fn library_of(model: Model) -> Library {
    let mut library = Library::default();
    library.add(model);
    library
}

pub fn walker() -> Library {
    library_of(samples::load("walker").expect("the walker is built in"))
}

/// A box of the given half size on one node, with a clip "Move" of these translation keys.
pub fn moving_box(half: f32, times_secs: &[f32], places: &[Vec3]) -> Library {
    let joint = Joint { name: "Box".to_owned(), rest: Transform::IDENTITY, ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint]).expect("one joint");
    let joint = skeleton.joint_of_source(0).expect("one joint");
    let mut clip = ClipBuilder::new("Move", &skeleton);
    clip.channel(joint, Interpolation::Linear, times_secs, Keys::Translation(places.to_vec())).expect("fine keys");
    let clips = vec![clip.build()];
    let positions: Vec<Vec3> =
        gaitway_character::mesh::Bounds { min: Vec3::splat(-half), max: Vec3::splat(half) }.corners().into();
    let geometry = Geometry { file_vertices: 8, positions, indices: (0..6).collect(), ..Geometry::default() };
    let parts = AssetParts {
        format: "test",
        clips,
        meshes: vec![Mesh { primitives: vec![geometry], ..Mesh::default() }],
        instances: vec![MeshInstance::new(joint, 0, None)],
        skeleton,
        ..AssetParts::default()
    };
    let asset = Asset::new(parts).expect("indices in range");
    library_of(Model::new("box".to_owned(), asset, Vec::new()))
}

/// Samples the pose of a view, without a camera.
pub fn sampled(model: &Model, state: &ViewerState) -> TakeSampler {
    let mut sampler = TakeSampler::default();
    sampler.sample(&active_take(model, state), moment(model, state), None);
    sampler
}

/// A real file.
pub fn open(path: &str) -> Option<Library> {
    let path = data_folder()?.join(path);
    Some(library_of(opened::model(path.to_str().expect("a plain path"))))
}
