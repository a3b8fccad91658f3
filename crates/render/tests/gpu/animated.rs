//! Animated materials and visibility change the picture, and leave nothing behind.

use gaitway_render::{Renderer, RendererOptions, read_pixels};
use gaitway_scene::frame::{Frame, View, evaluate};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::state::{Background, CharacterView, ClipChoice, Playhead, ViewerState};
use glam::Vec3;
use glam::camera::rh::proj::directx::orthographic;
use glam::camera::rh::view::look_at_mat4;
use serde_json::json;

use crate::build_gltf::Build;
use crate::device::{Gpu, gpu};
use crate::scene::{Picture, SIZE, near};

const BASE_COLOR: &str = "/materials/0/pbrMetallicRoughness/baseColorFactor";
const BLUE: [u8; 4] = [0, 0, 255, 255];

/// A blue unlit triangle that covers the lower left of the picture.
fn triangle() -> Build {
    let mut build = Build::triangle();
    build.json["nodes"] = json!([{ "mesh": 0, "translation": [-1, -1, 0], "scale": [3, 3, 1] }]);
    build.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let surface = json!({ "baseColorFactor": [0, 0, 1, 1] });
    build.json["materials"] = json!([{ "pbrMetallicRoughness": surface, "extensions": { "KHR_materials_unlit": {} } }]);
    build
}

struct Stage {
    gpu: Gpu,
    library: Library,
    renderer: Renderer,
    frame: Frame,
}

impl Stage {
    /// `None` without a GPU.
    fn new(build: Build) -> Option<Self> {
        let gpu = gpu()?;
        let mut library = Library::default();
        library.add(Model::new("built.glb".to_owned(), build.load().expect("readable"), Vec::new()));
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, RendererOptions { samples: 1 });
        renderer.upload(&gpu.device, &gpu.queue, library.active().expect("a model")).expect("small enough");
        Some(Self { gpu, library, renderer, frame: Frame::default() })
    }

    /// Draws the first clip at this time, or the rest pose.
    fn draw(&mut self, time_secs: Option<f64>) -> Picture {
        let clip = if time_secs.is_some() { ClipChoice::First } else { ClipChoice::RestPose };
        let playhead = Playhead { clip, time_secs: time_secs.unwrap_or(0.0), ..Playhead::default() };
        let mut state =
            ViewerState { character: CharacterView { playhead, ..CharacterView::default() }, ..ViewerState::default() };
        state.display.background = Background::Transparent;
        (state.display.show.grid, state.display.show.shadow) = (false, false);
        let Self { gpu: Gpu { device, queue }, library, renderer, frame } = self;
        evaluate(library, &state, 1.0, frame);
        let eye = Vec3::new(0.0, 0.0, 5.0);
        let view_from_world = look_at_mat4(eye, Vec3::ZERO, Vec3::Y);
        let projection_from_view = orthographic(-1.0, 1.0, -1.0, 1.0, 1.0, 9.0);
        frame.view = View { view_from_world, projection_from_view, eye };
        renderer.draw(device, queue, frame, [SIZE, SIZE]);
        Picture(pollster::block_on(read_pixels(device, queue, renderer.output())))
    }
}

#[test]
fn an_animated_base_colour_is_drawn_and_the_files_own_comes_back() {
    let mut build = triangle();
    let colors = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0];
    build.point(BASE_COLOR, "STEP", "VEC4", &[0.0, 1.0], &colors);
    let Some(mut stage) = Stage::new(build) else { return };
    for (time_secs, color) in [(None, BLUE), (Some(0.5), [255, 0, 0, 255]), (Some(1.0), [0, 255, 0, 255]), (None, BLUE)]
    {
        near(stage.draw(time_secs).at(-0.5, -0.5), color, 1);
    }
}

#[test]
fn a_hidden_node_is_not_drawn() {
    let visibility = "/nodes/0/extensions/KHR_node_visibility/visible";
    let mut build = triangle();
    build.point(visibility, "STEP", "SCALAR", &[0.0, 1.0], &[1.0, 0.0]);
    let Some(mut stage) = Stage::new(build) else { return };
    let shown = stage.draw(Some(0.5));
    near(shown.at(-0.5, -0.5), BLUE, 1);
    assert_eq!(stage.draw(Some(1.0)).covered(), 0, "not even its skeleton");
    assert_eq!(stage.draw(None).0, shown.0);
    let mut hidden = triangle();
    hidden.json["nodes"][0]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
    let Some(mut stage) = Stage::new(hidden) else { return };
    assert_ne!(stage.draw(None).at(-0.5, -0.5), BLUE);
}

/// A blended surface that fades casts no shadow once it is more than half transparent.
#[test]
fn the_shadow_of_a_fading_surface_ends_with_it() {
    let mut build = triangle();
    build.json["materials"][0]["alphaMode"] = json!("BLEND");
    build.point(BASE_COLOR, "STEP", "VEC4", &[0.0, 1.0], &[0.0, 0.0, 1.0, 0.6, 0.0, 0.0, 1.0, 0.4]);
    let Some(mut stage) = Stage::new(build) else { return };
    let mut calls = |time_secs| {
        stage.draw(Some(time_secs));
        let Stage { gpu: Gpu { device, queue }, renderer, frame, .. } = &mut stage;
        frame.look.shadow = true;
        renderer.draw(device, queue, frame, [SIZE, SIZE]);
        renderer.stats().draw_calls
    };
    assert_eq!(calls(0.0), calls(1.0) + 1);
}
