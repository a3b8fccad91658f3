//! `gaitway render`: renders the same image as the page, without a window.

use serde_json::json;

use super::failure::{Failure, Outcome};
use super::motion::{Overrides, apply_link, open_editor};
use super::output::{check_output, print_error, write_output};
use super::quiet::Quiet;
use super::{RenderArguments, apply_moment, open};
use crate::editor::{Contents, Editor};
use crate::files::{Disk, Role, encode_png};
use crate::frame::{Frame, current_orbit, evaluate};
use crate::render::{Renderer, RendererOptions, headless_device, read_pixels};
use crate::state::{
    CameraChoice, Command, EnvironmentChoice, NameKind, OrbitCamera, UnknownName, active_variant, from_object,
    source_on_stage,
};

/// File extensions for the image.
const EXTENSIONS: &[&str] = &["png"];

pub(super) fn run(arguments: &RenderArguments, disk: &Disk) -> Outcome {
    let editor = open_requested_view(arguments, disk)?;
    check_output(&arguments.out, EXTENSIONS, disk)?;
    let (library, state) = (editor.library(), editor.state());
    let [width, height] = arguments.size;
    let mut frame = Frame::default();
    evaluate(library, state, width as f32 / height as f32, &mut frame);

    let quiet = Quiet::start();
    let device = headless_device();
    drop(quiet);
    // On failure, try again without silencing the driver, whose output may explain why.
    let (device, queue, adapter) = device.or_else(|_| headless_device())?;
    print_error(&format!("rendering with {} ({})", adapter.name, adapter.backend));
    let mut renderer = Renderer::new(&device, &queue, RendererOptions { samples: 4 });
    let source = source_on_stage(library, state).map(|source| source.model);
    for model in library.models().iter().chain(source) {
        renderer.upload(&device, &queue, model)?;
    }
    renderer.draw(&device, &queue, &frame, arguments.size);
    let pixels = pollster::block_on(read_pixels(&device, &queue, renderer.output()));
    let Some(png) = encode_png(width, height, &pixels) else {
        return Err(Failure::new("couldn't read the image back from the graphics device"));
    };
    write_output(&arguments.out, &png, EXTENSIONS, disk)
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
    let (state, errors) = from_object(editor.state(), &json!({ "light": name }));
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
    let [width, height] = arguments.size;
    let aspect = width as f32 / height as f32;
    editor.set_aspect(aspect);
    if let Some(link) = &arguments.view {
        let moment = &arguments.moment;
        let layers = !moment.layers.layers.is_empty();
        let overrides = Overrides { clip: moment.clip.is_some(), layers, variant: arguments.variant.is_some() };
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
