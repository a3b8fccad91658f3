//! The Camera tab: camera, light, background, up axis, images and videos.

use egui::{RichText, Ui};
use gaitway_scene::editor::short_name;
use gaitway_scene::state::{
    Background, CameraChoice, Command, EnvironmentChoice, KeyLight, LightSetup, OrbitCamera, ToneMap, UpAxis,
    ViewerState, frame_all, front_yaw_radians, resolve_camera,
};

use crate::ui::controls::{self, SliderSettings, capitals};
use crate::ui::{Output, RecordingFormat, Saved, Shown, UiAction, UiState, VideoSettings, style, text};

/// Settings of saved images and videos.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureSettings {
    /// Width and height in pixels.
    size: [u32; 2],
    transparent: bool,
    /// Of recordings.
    frames_per_sec: u32,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self { size: [1920, 1080], transparent: false, frames_per_sec: 30 }
    }
}

impl PictureSettings {
    /// An image with these settings.
    pub fn image(&self) -> Saved {
        Saved::Picture { size: self.size, transparent: self.transparent }
    }

    /// Returns the label, the tooltip and the action of the buttons that record with these settings.
    pub fn recordings(&self) -> [(&'static str, &'static str, UiAction); 3] {
        let Self { size, transparent, frames_per_sec } = *self;
        [
            (RecordingFormat::Video, text::RECORD, "Renders the played range once, frame by frame, as MP4 or WebM."),
            (RecordingFormat::Gif, text::RECORD_GIF, text::ABOUT_GIF),
            (
                RecordingFormat::Images,
                text::RECORD_IMAGES,
                "Renders the played range once, frame by frame, as PNGs in a .zip.",
            ),
        ]
        .map(|(format, label, tooltip)| {
            let settings = VideoSettings { size, frames_per_sec, transparent, format };
            (label, tooltip, UiAction::Record(settings))
        })
    }
}

/// Supported by nearly every device. WebGL2 guarantees only 2048, so the app may save a smaller image.
const MAX_PICTURE_SIZE: u32 = 4096;

pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let aspect = local.viewport.aspect;
    camera(ui, shown, aspect, out);
    controls::section(ui, capitals!(text::BACKGROUND));
    background(ui, shown.state.display.background, out);
    light(ui, shown, out);
    controls::section(ui, capitals!(text::UP_AXIS));
    let axes = [
        (UpAxis::X, "X"),
        (UpAxis::Y, "Y"),
        (UpAxis::Z, text::UP_Z),
        (UpAxis::MinusX, "−X"),
        (UpAxis::MinusY, "−Y"),
        (UpAxis::MinusZ, "−Z"),
    ];
    if let Some(up) = controls::segmented(ui, text::UP_AXIS, Some(shown.state.character.edits.up), &axes) {
        out.commands.push(Command::SetUp(up));
    }
    ui.add_space(2.0);
    controls::hint(ui, "Y in glTF. Change it if the model lies on its back.");
    scenes(ui, shown, out);
    if std::mem::take(&mut local.seeks_picture_settings) {
        ui.scroll_to_cursor(Some(egui::Align::TOP));
    }
    picture(ui, shown, &mut local.picture_settings, out);
}

/// Saving images and recording videos.
fn picture(ui: &mut Ui, shown: &Shown<'_>, settings: &mut PictureSettings, out: &mut Output) {
    controls::section(ui, "IMAGE AND VIDEO");
    let sizes = [([1280, 720], "720p"), ([1920, 1080], "1080p"), ([3840, 2160], "4K"), ([1080, 1080], text::SQUARE)];
    if let Some(size) = controls::segmented(ui, text::PICTURE_SIZE, Some(settings.size), &sizes) {
        settings.size = size;
    }
    ui.horizontal(|ui| {
        for (edge, name) in [(0, "Width in pixels"), (1, "Height in pixels")] {
            controls::number(ui, [90.0, 26.0], &mut settings.size[edge], |field| {
                field.range(16..=MAX_PICTURE_SIZE).suffix(" px")
            })
            .accessible_name(name);
        }
    });
    if controls::switch(ui, text::TRANSPARENT_BACKGROUND, settings.transparent) {
        settings.transparent = !settings.transparent;
    }
    let wide = |ui: &mut Ui, enabled: bool, text: &str| {
        let button = egui::Button::new(text).min_size(egui::vec2(ui.available_width(), 32.0));
        ui.add_enabled(enabled, button)
    };
    if wide(ui, true, text::SAVE_IMAGE).clicked() {
        out.actions.push(UiAction::Save(settings.image()));
    }
    ui.add_space(4.0);
    let rates = [24, 30, 60].map(|rate| (rate, text::frames_per_sec(rate)));
    let choices = rates.each_ref().map(|(rate, label)| (*rate, label.as_str()));
    if let Some(rate) = controls::segmented_about(ui, text::FRAME_RATE, Some(settings.frames_per_sec), &choices) {
        settings.frames_per_sec = rate;
    }
    for (label, tooltip, action) in settings.recordings() {
        if wide(ui, shown.is_animated(), label).on_hover_text(tooltip).clicked() {
            out.actions.push(action);
        }
    }
}

fn camera(ui: &mut Ui, shown: &Shown<'_>, aspect: f32, out: &mut Output) {
    let state = shown.state;
    controls::section(ui, "CAMERA");
    let sides = [(0.0, 0.0, text::FRONT), (180.0, 0.0, "Back"), (90.0, 0.0, text::SIDE), (0.0, 89.9, text::TOP)];
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let width = (ui.available_width() - 4.0 * 6.0) / 5.0;
        for (yaw_degrees, pitch_degrees, label) in sides {
            if controls::sized(ui, [width, 30.0], egui::Button::new(label)).clicked() {
                out.commands.push(look_from(shown, aspect, yaw_degrees, pitch_degrees));
            }
        }
        let about_fit = controls::with_key(ui, text::FRAME_ALL_KEY);
        if controls::sized(ui, [width, 30.0], egui::Button::new("Fit")).on_hover_text(about_fit).clicked() {
            out.commands.push(Command::FrameAll);
        }
    });
    let cameras = shown.library.active().map_or(&[][..], |model| &model.asset.cameras);
    if !cameras.is_empty() {
        ui.add_space(2.0);
        let free = !matches!(state.camera, CameraChoice::File(_));
        if controls::list_row(ui, "Free camera", "", free).clicked() && !free {
            out.commands.push(Command::SetCamera(CameraChoice::Auto));
        }
        for (index, camera) in cameras.iter().enumerate() {
            let name = if camera.name.is_empty() { format!("Camera {index}") } else { camera.name.clone() };
            let chosen = state.camera == CameraChoice::File(index);
            if controls::list_row(ui, &name, "from the file", chosen).clicked() {
                out.commands.push(Command::SetCamera(CameraChoice::File(index)));
            }
        }
    }
    let settings =
        SliderSettings { range: (10.0, 100.0), default: 35.0, decimals: 0, suffix: "°", logarithmic: false };
    if let Some(degrees) = controls::slider(ui, "Field of view", f64::from(state.camera_options.fov_degrees), settings)
    {
        out.commands.push(Command::SetFov(degrees as f32));
    }
    if controls::switch(ui, text::FOLLOW, state.camera_options.follow) {
        out.commands.push(Command::SetFollow(!state.camera_options.follow));
    }
    let settings =
        SliderSettings { range: (-90.0, 90.0), default: 0.0, decimals: 0, suffix: "°/s", logarithmic: false };
    if let Some(speed) = controls::slider(ui, "Turntable", f64::from(state.camera_options.turntable), settings) {
        out.commands.push(Command::SetTurntable(speed as f32));
    }
}

/// An orbit camera that frames everything from a fixed direction.
fn look_from(shown: &Shown<'_>, aspect: f32, yaw_degrees: f32, pitch_degrees: f32) -> Command {
    let camera = CameraChoice::Orbit(OrbitCamera {
        yaw_radians: front_yaw_radians(shown.library, shown.state) + yaw_degrees.to_radians(),
        pitch_radians: pitch_degrees.to_radians(),
        ..resolve_camera(shown.library, shown.state, aspect)
    });
    let state = ViewerState { camera, ..shown.state.clone() };
    Command::SetCamera(CameraChoice::Orbit(frame_all(shown.library, &state, aspect)))
}

fn light(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let state = shown.state;
    controls::section(ui, "LIGHT");
    environment(ui, shown, out);
    let settings =
        SliderSettings { range: (-5.0, 5.0), default: 0.0, decimals: 1, suffix: " stops", logarithmic: false };
    if let Some(stops) = controls::slider(ui, text::EXPOSURE, f64::from(state.display.exposure), settings) {
        out.commands.push(Command::SetExposure(stops as f32));
    }
    let tone_maps = [
        (ToneMap::Neutral, text::TONE_NEUTRAL),
        (ToneMap::Aces, text::TONE_ACES),
        (ToneMap::Agx, text::TONE_AGX),
        (ToneMap::None, text::NO_TONE_MAP),
    ];
    ui.label(RichText::new(text::TONE_MAP).color(style::palette(ui).weak_text));
    if let Some(tone_map) = controls::segmented_about(ui, text::TONE_MAP, Some(state.display.tone_map), &tone_maps) {
        out.commands.push(Command::SetToneMap(tone_map));
    }
    let settings =
        SliderSettings { range: (-180.0, 180.0), default: 0.0, decimals: 0, suffix: "°", logarithmic: false };
    if let Some(degrees) =
        controls::slider(ui, "Light rotation", f64::from(state.display.environment_degrees), settings)
    {
        out.commands.push(Command::SetEnvironment(degrees as f32));
    }
    key_light(ui, state.lighting.key, out);
}

/// Light from all around: generated set-ups, and the images that were opened.
fn environment(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let setups = [
        (LightSetup::Studio, text::STUDIO),
        (LightSetup::Soft, text::SOFT_LIGHT),
        (LightSetup::Hard, text::HARD_LIGHT),
        (LightSetup::Outdoor, text::OUTDOOR_LIGHT),
        (LightSetup::White, text::WHITE_LIGHT),
    ];
    let environment = &shown.state.lighting.environment;
    let chosen = if let EnvironmentChoice::Setup(setup) = environment { Some(*setup) } else { None };
    if let Some(setup) = controls::segmented_about(ui, text::LIGHT, chosen, &setups) {
        out.commands.push(Command::SetLight(EnvironmentChoice::Setup(setup)));
    }
    for image in shown.library.environments() {
        let choice = EnvironmentChoice::File(image.origin.clone());
        if controls::list_row(ui, &short_name(&image.origin), "", *environment == choice).clicked() {
            out.commands.push(Command::SetLight(choice));
        }
    }
    ui.add_space(2.0);
    controls::hint(ui, "Drop an .hdr image to light the scene with it.");
}

fn key_light(ui: &mut Ui, key: Option<KeyLight>, out: &mut Output) {
    if controls::switch(ui, text::OWN_KEY_LIGHT, key.is_some()) {
        out.commands.push(Command::SetKeyLight(if key.is_some() { None } else { Some(KeyLight::STUDIO) }));
    }
    let Some(key) = key else { return };
    let settings = |range, default: f32, decimals, suffix| SliderSettings {
        range,
        default: f64::from(default),
        decimals,
        suffix,
        logarithmic: false,
    };
    let strength = settings((0.0, 3.0), KeyLight::STUDIO.strength, 2, "");
    let mut changed = None;
    if let Some(strength) = controls::slider(ui, text::KEY_STRENGTH, f64::from(key.strength), strength) {
        changed = Some(KeyLight { strength: strength as f32, ..key });
    }
    let yaw = settings((-180.0, 180.0), KeyLight::STUDIO.yaw_degrees, 0, "°");
    if let Some(yaw) = controls::slider(ui, text::KEY_AZIMUTH, f64::from(key.yaw_degrees), yaw) {
        changed = Some(KeyLight { yaw_degrees: yaw as f32, ..key });
    }
    let pitch = settings((-90.0, 90.0), KeyLight::STUDIO.pitch_degrees, 0, "°");
    if let Some(pitch) = controls::slider(ui, text::KEY_ELEVATION, f64::from(key.pitch_degrees), pitch) {
        changed = Some(KeyLight { pitch_degrees: pitch as f32, ..key });
    }
    out.commands.extend(changed.map(|key| Command::SetKeyLight(Some(key))));
}

fn background(ui: &mut Ui, now: Background, out: &mut Output) {
    let mut color = if let Background::Color(color) = now { color } else { [236, 238, 242] };
    let is_color = matches!(now, Background::Color(_));
    let kinds = [
        (Background::Studio, text::STUDIO),
        (Background::Color(color), text::COLOR),
        (Background::Environment, text::ENVIRONMENT),
        (Background::Blurred, text::BLURRED),
        (Background::Transparent, text::NO_BACKGROUND),
    ];
    if let Some(kind) = controls::segmented(ui, text::BACKGROUND, Some(now), &kinds) {
        out.commands.push(Command::SetBackground(kind));
    }
    if is_color && ui.color_edit_button_srgb(&mut color).accessible_name("Background colour").changed() {
        out.commands.push(Command::SetBackground(Background::Color(color)));
    }
}

fn scenes(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let Some(model) = shown.library.active().filter(|model| model.asset.scenes.len() > 1) else { return };
    controls::section(ui, "SCENE");
    let now = model.scene(shown.state.character.sources.scene);
    for (index, scene) in model.asset.scenes.iter().enumerate() {
        let name = if scene.name.is_empty() { format!("Scene {index}") } else { scene.name.clone() };
        let default = if model.asset.default_scene == Some(index) { "default" } else { "" };
        if controls::list_row(ui, &name, default, now == Some(index)).clicked() {
            out.commands.push(Command::SetScene(Some(index)));
        }
    }
}
