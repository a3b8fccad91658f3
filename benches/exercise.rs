//! CPU cost of a step while a joint of a skinning-exercise model is rotated with a slider: pose, matrices, palette and
//! the rest of the frame. Also the cost of CPU skinning, which the GPU does instead.

mod support;

use std::hint::black_box;

use gaitway_character::mesh::{DeformedVertices, SkinningMode, deform};
use gaitway_formats::load;
use gaitway_scene::frame::{Frame, evaluate, pose_document};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::state::{Command, Display, Inspect, Show, ViewerState, apply};
use support::data_folder::data_folder;
use support::{files_of, measure};

fn main() {
    let Some(folder) = data_folder() else { return };
    let Some(files) = files_of(&folder.join("mit6837/Model1.obj")) else { return };
    let asset = load(&files).unwrap_or_else(|problem| panic!("{problem}"));
    println!("{:44} {:>10} {:>10}", "13,336 vertices, 18 joints, up to 13 weights", "µs", "(fastest)");
    let mut library = Library::default();
    library.add(Model::new("Model1.obj".to_owned(), asset, Vec::new()));
    let print = |name: &str, nanos: support::Nanos| {
        println!("{name:44} {:>10.1} {:>10.1}", nanos.median / 1e3, nanos.fastest / 1e3);
    };
    for (name, split) in [("slider step", false), ("slider step, three modes side by side", true)] {
        let show = Show { skeleton: true, ..Show::default() };
        let display = Display { show, ..Display::default() };
        let inspect = Inspect { split, ..Inspect::default() };
        let mut state = ViewerState { display, inspect, ..ViewerState::default() };
        let (mut frame, mut angle) = (Frame::default(), 0.0_f32);
        let nanos = measure(|| {
            angle = (angle + 1.0) % 90.0;
            apply(&mut state, &library, Command::SetPose { joint: 5, degrees: Some([angle, 0.0, 0.0]) });
            evaluate(black_box(&library), &state, 1.5, &mut frame);
        });
        print(name, nanos);
    }
    let mut frame = Frame::default();
    evaluate(&library, &ViewerState::default(), 1.5, &mut frame);
    let geometry = library.active().map(|model| &model.asset.meshes[0].primitives[0]);
    let (Some(geometry), Some(character)) = (geometry, frame.characters.first()) else { return };
    let mut out = DeformedVertices::default();
    let work = || deform(black_box(geometry), &[], &character.palette, SkinningMode::Linear, &mut out);
    print("all vertices on the CPU", measure(work));
    print("the pose document", measure(|| drop(black_box(pose_document(&library, &ViewerState::default())))));
}
