//! `gaitway render`: renders the same image as the page, or the frames of one loop, without a window.

use gaitway_render::{Renderer, RendererOptions, headless_device, read_pixels};
use gaitway_scene::editor::{Contents, Editor};
use gaitway_scene::frame::{Frame, current_orbit, evaluate};
use gaitway_scene::library::Library;
use gaitway_scene::state::{
    Background, CameraChoice, Command, EnvironmentChoice, LoopFrames, NameKind, OrbitCamera, UnknownName, ViewerState,
    active_variant, from_object, source_on_stage,
};
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use serde_json::json;

use super::failure::{Failure, Outcome};
use super::moment::apply_moment;
use super::motion::{Overrides, apply_link, open_editor};
use super::output::{check_output, is_standard_output, print_error, write_output};
use super::quiet::Quiet;
use super::sequence::{Format, Sequence};
use super::{RenderArguments, open};
use crate::files::{Disk, Role, encode_png};

/// File extensions for the image.
const EXTENSIONS: &[&str] = &["png"];

/// The message for pixels that didn't arrive.
pub(super) const NOT_READ: &str = "couldn't read the image back from the graphics device";

pub(super) fn run(arguments: &RenderArguments, disk: &Disk) -> Outcome {
    let editor = open_requested_view(arguments, disk)?;
    match arguments.frames {
        Some(frames_per_sec) => render_frames(arguments, frames_per_sec, &editor, disk),
        None => render_picture(arguments, &editor, disk),
    }
}

fn render_picture(arguments: &RenderArguments, editor: &Editor, disk: &Disk) -> Outcome {
    check_output(&arguments.out, EXTENSIONS, disk)?;
    let [width, height] = arguments.size;
    let pixels = Studio::new(editor, arguments.size)?.draw(editor.library(), editor.state())?;
    let png = encode_png(width, height, &pixels).ok_or_else(|| Failure::new(NOT_READ))?;
    write_output(&arguments.out, &png, EXTENSIONS, disk)
}

/// Renders the editor's view for previews of links, as a JPEG.
pub(super) fn picture(editor: &Editor, size: [u32; 2]) -> Outcome<Vec<u8>> {
    let pixels = Studio::new(editor, size)?.draw(editor.library(), editor.state())?;
    jpeg(size, &pixels).ok_or_else(|| Failure::new(NOT_READ))
}

/// Encodes RGBA rows from the top, in front of the studio's grey, since a JPEG has no alpha.
fn jpeg([width, height]: [u32; 2], pixels: &[u8]) -> Option<Vec<u8>> {
    const STUDIO: [u8; 3] = [0xa3, 0xa6, 0xab];
    const QUALITY: u8 = 80;
    let over = |color: u8, behind: u8, alpha: u8| {
        let (color, behind, alpha) = (u32::from(color), u32::from(behind), u32::from(alpha));
        ((color * alpha + behind * (255 - alpha) + 127) / 255) as u8
    };
    let opaque = pixels.chunks_exact(4).flat_map(|pixel| [0, 1, 2].map(|at| over(pixel[at], STUDIO[at], pixel[3])));
    let mut file = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut file, QUALITY);
    encoder.encode(&opaque.collect::<Vec<_>>(), width, height, ExtendedColorType::Rgb8).ok()?;
    Some(file)
}

/// Renders one loop of the clip, as the page records it.
fn render_frames(arguments: &RenderArguments, frames_per_sec: u32, editor: &Editor, disk: &Disk) -> Outcome {
    let (library, state, size) = (editor.library(), editor.state(), arguments.size);
    if is_standard_output(&arguments.out) {
        return Err(Failure::expected("a folder, or a file ending in .mp4, .webm or .gif", "-").at("--out"));
    }
    let frames = LoopFrames::new(library, state, aspect(size), frames_per_sec)
        .ok_or_else(|| Failure::new("nothing moves").with_hint("choose a clip with --clip").at("--frames"))?;
    if frames.count() > LoopFrames::MAX_COUNT {
        let expected = format!("at most {} frames", LoopFrames::MAX_COUNT);
        let failure = Failure::expected(expected, frames.count().to_string()).at("--frames");
        return Err(failure.with_hint("choose a part of the clip with --view range=START,END"));
    }
    let is_transparent = state.display.background == Background::Transparent;
    let format = Format { size, frames_per_sec, frame_count: frames.count(), is_transparent };
    let mut sequence = Sequence::create(&arguments.out, format, disk)?;
    let frames = if is_transparent && sequence.has_hard_edges() { frames.without_ground() } else { frames };
    let mut studio = Studio::new(editor, size)?;
    for index in 0..frames.count() {
        sequence.add(&studio.draw(library, &frames.state(library, index))?, disk)?;
    }
    sequence.finish(disk)?;
    print_error(&format!("{} frames written", frames.count()));
    Ok(())
}

fn aspect([width, height]: [u32; 2]) -> f32 {
    width as f32 / height as f32
}

/// Draws views without a window.
struct Studio {
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Renderer,
    frame: Frame,
    size: [u32; 2],
}

impl Studio {
    /// Opens a device and uploads what the editor holds.
    fn new(editor: &Editor, size: [u32; 2]) -> Outcome<Self> {
        let quiet = Quiet::start();
        let device = headless_device();
        drop(quiet);
        // On failure, try again without silencing the driver, whose output may explain why.
        let (device, queue, adapter) = device.or_else(|_| headless_device())?;
        print_error(&format!("rendering with {} ({})", adapter.name, adapter.backend));
        let mut renderer = Renderer::new(&device, &queue, RendererOptions::for_adapter(&adapter));
        let library = editor.library();
        let source = source_on_stage(library, editor.state()).map(|source| source.model);
        for model in library.models().iter().chain(source) {
            renderer.upload(&device, &queue, model)?;
        }
        Ok(Self { device, queue, renderer, frame: Frame::default(), size })
    }

    /// Returns RGBA rows from the top, with straight alpha. Fails if the device was lost.
    fn draw(&mut self, library: &Library, state: &ViewerState) -> Outcome<Vec<u8>> {
        evaluate(library, state, aspect(self.size), &mut self.frame);
        self.renderer.draw_refined(&self.device, &self.queue, &self.frame, self.size);
        let pixels = pollster::block_on(read_pixels(&self.device, &self.queue, self.renderer.output()));
        if pixels.is_empty() { Err(Failure::new(NOT_READ)) } else { Ok(pixels) }
    }
}

fn show_variant(editor: &mut Editor, name: &str) -> Outcome {
    editor.apply(Command::SetVariant(Some(name.to_owned())));
    let Some(model) = editor.library().active() else { return Ok(()) };
    // The command ignores unknown names, which may leave the link's in the state.
    if active_variant(model, editor.state()).is_some_and(|index| model.asset.variants[index] == name) {
        return Ok(());
    }
    let (name, names) = (name.to_owned(), model.asset.variants.clone());
    Err(Failure::from(UnknownName { kind: NameKind::Variant, name, names }).in_file(&model.source))
}

/// Lights the scene with what the link's key `light` would name, or with a file.
fn light_with(editor: &mut Editor, name: &str, disk: &Disk) -> Outcome {
    let (state, errors) = from_object(editor.state(), editor.library(), &json!({ "light": name }));
    if let Some(error) = errors.first() {
        return Err(Failure::new(error.to_string()).at("--environment"));
    }
    let EnvironmentChoice::File(path) = state.lighting.environment else {
        editor.apply(Command::SetLight(state.lighting.environment));
        return Ok(());
    };
    let Contents { environment: Some(environment), .. } = disk.read_paths(&[path.clone().into()], Role::Any)? else {
        return Err(Failure::expected("an .hdr image", "something else").in_file(path));
    };
    let contents = Contents { environment: Some(environment), ..Contents::default() };
    editor.open(contents, None, &mut |_| Ok(()))?;
    Ok(())
}

/// Opens the link's view, overridden by the other options.
fn open_requested_view(arguments: &RenderArguments, disk: &Disk) -> Outcome<Editor> {
    let mut editor = open_editor(open(&arguments.input.files, disk)?, &arguments.motion, disk)?;
    let aspect = aspect(arguments.size);
    editor.set_aspect(aspect);
    if let Some(link) = &arguments.view {
        let overrides = Overrides { variant: arguments.variant.is_some(), ..arguments.moment.overrides() };
        apply_link(&mut editor, link, &arguments.motion, overrides, disk)?;
    }
    if let Some(name) = &arguments.variant {
        show_variant(&mut editor, name)?;
    }
    if let Some(name) = &arguments.environment {
        light_with(&mut editor, name, disk)?;
    }
    apply_moment(&mut editor, &arguments.moment, arguments.motion.motion.is_some())?;
    if let Some([yaw_degrees, pitch_degrees, distance]) = arguments.camera {
        let orbit = OrbitCamera {
            yaw_radians: yaw_degrees.to_radians(),
            pitch_radians: pitch_degrees.to_radians(),
            distance,
            target: current_orbit(editor.library(), editor.state(), aspect).target,
        };
        editor.apply(Command::SetCamera(CameraChoice::Orbit(orbit)));
    }
    Ok(editor)
}
