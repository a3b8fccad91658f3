//! `gaitway render`: the same picture as the page, without a window.

use anyhow::{Context, bail};

use super::borrow::{load_library, state_of_link};
use super::{RenderArguments, open, set_moment};
use crate::frame::{Frame, evaluate};
use crate::library::Library;
use crate::render::{Renderer, RendererOptions, headless_device, read_pixels};
use crate::state::{
    CameraChoice, ClipChoice, Command, OrbitCamera, ViewerState, apply, resolve_camera, source_on_stage,
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

/// The link's view with the options on top.
fn view(arguments: &RenderArguments, library: &mut Library) -> anyhow::Result<ViewerState> {
    let mut state = ViewerState { clip: ClipChoice::RestPose, ..ViewerState::default() };
    if let Some(link) = &arguments.view {
        state = state_of_link(library, link, &arguments.borrowing)?;
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
