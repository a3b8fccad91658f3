//! `gaitway render`: the same picture as the page, without a window.

use std::path::Path;

use anyhow::{Context, bail};

use super::borrow::{load_library, open_map, open_motion};
use super::{RenderArguments, open, set_moment, state_of_view};
use crate::frame::{Frame, evaluate};
use crate::library::Library;
use crate::render::{Renderer, RendererOptions, headless_device, read_pixels};
use crate::state::{
    CameraChoice, ClipChoice, Command, MotionMap, OrbitCamera, ViewerState, apply, maps_in_force, resolve_camera,
    settled_maps, source_on_stage,
};

pub(super) fn run(arguments: &RenderArguments) -> anyhow::Result<()> {
    let mut library = load_library(open(&arguments.input.files)?, &arguments.borrowing)?;
    let state = view(arguments, &mut library)?;
    let [width, height] = arguments.size;
    let mut frame = Frame::default();
    evaluate(&library, &state, width as f32 / height as f32, &mut frame);

    let (device, queue, adapter) = headless_device()?;
    eprintln!("drawing with {} ({})", adapter.name, adapter.backend);
    let mut renderer = Renderer::new(&device, &queue, RendererOptions { samples: 4 });
    let source = source_on_stage(&library, &state).map(|source| source.model);
    for model in library.models().iter().chain(source) {
        renderer.upload(&device, &queue, model)?;
    }
    renderer.draw(&device, &queue, &frame, arguments.size);
    let pixels = pollster::block_on(read_pixels(&device, &queue, renderer.output()));
    let Some(image) = image::RgbaImage::from_raw(width, height, pixels).filter(|image| image.width() > 0) else {
        bail!("the picture could not be read back from the graphics device");
    };
    let out = &arguments.out;
    image.save_with_format(out, image::ImageFormat::Png).with_context(|| format!("{}", out.display()))
}

/// Reads the motions and maps that a link names, as far as they are files here; the command line's own win.
fn borrow_as_linked(arguments: &RenderArguments, library: &mut Library, state: &mut ViewerState) {
    if arguments.borrowing.motion.is_none() && !state.motion.is_empty() {
        let read = |source: &String| match open_motion(Path::new(source.strip_prefix("file:").unwrap_or(source))) {
            Ok(motion) => Some(motion),
            Err(error) => {
                eprintln!("warning: {error:#}; name the motion's file with --motion");
                None
            }
        };
        let motions = state.motion.iter().filter_map(read).collect();
        library.set_motions(motions);
    }
    if arguments.borrowing.map.is_some() {
        return;
    }
    for map in &mut state.map {
        if let MotionMap::File(file) = map {
            match open_map(Path::new(file.as_str())) {
                Ok(read) => *map = MotionMap::Names(read),
                Err(error) => eprintln!("warning: {error:#}; name the map's file with --map"),
            }
        }
    }
    for problem in settled_maps(library, state).1 {
        eprintln!("warning: {problem}");
    }
    apply(state, library, Command::SettleMaps);
    library.borrow_each(maps_in_force(library, state));
    for error in library.borrow_errors() {
        eprintln!("warning: {error}");
    }
}

/// The link's view with the options on top.
fn view(arguments: &RenderArguments, library: &mut Library) -> anyhow::Result<ViewerState> {
    let mut state = ViewerState { clip: ClipChoice::RestPose, ..ViewerState::default() };
    if let Some(link) = &arguments.view {
        state = state_of_view(library, link);
        borrow_as_linked(arguments, library, &mut state);
    }
    set_moment(library, &arguments.moment, arguments.borrowing.motion.is_some(), &mut state)?;
    if let Some([yaw_degrees, pitch_degrees, distance]) = arguments.camera {
        let [width, height] = arguments.size;
        let target = resolve_camera(library, &state, width as f32 / height as f32).target;
        let orbit = OrbitCamera {
            yaw_radians: yaw_degrees.to_radians(),
            pitch_radians: pitch_degrees.to_radians(),
            distance,
            target,
        };
        apply(&mut state, library, Command::SetCamera(CameraChoice::Orbit(orbit)));
    }
    Ok(state)
}
