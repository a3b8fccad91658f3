//! The panels over a model, driven by label; commands are recorded and applied, as in the frame loop.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{self, Output, Shown, UiAction, UiState};
use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton};
use gaitway_character::asset::{Asset, AssetParts, Warning};
use gaitway_scene::editor::Editor;
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{Library, Model, Motion};
use gaitway_scene::samples;
use gaitway_scene::state::{Command, Playback, ViewerState};

pub struct Bench {
    pub editor: Editor,
    pub frame: Frame,
    pub panels: UiState,
    pub commands: Vec<Command>,
    pub actions: Vec<UiAction>,
    pub viewport: egui::Rect,
}

pub const WIDE: [f32; 2] = [1280.0, 720.0];
pub const NARROW: [f32; 2] = [390.0, 844.0];

/// The sample at rest in its first moment, paused so that nothing moves by itself.
pub fn sample_bench(size: [f32; 2]) -> Harness<'static, Bench> {
    bench(size, samples::load("walker").expect("the sample is there"))
}

/// The sample with the sample's own clips to borrow, as if they came from other files.
pub fn motion_bench(size: [f32; 2], motions: &[&str]) -> Harness<'static, Bench> {
    let mut library = Library::default();
    library.add(samples::load("walker").expect("the sample is there"));
    let asset = library.active().expect("just set").asset.clone();
    library.set_motions(motions.iter().map(|name| Motion::new((*name).to_owned(), asset.clone())).collect());
    bench_of(size, library)
}

pub fn bench(size: [f32; 2], model: Model) -> Harness<'static, Bench> {
    let mut library = Library::default();
    library.add(model);
    bench_of(size, library)
}

impl Bench {
    pub fn state(&self) -> &ViewerState {
        self.editor.state()
    }

    pub fn library(&self) -> &Library {
        self.editor.library()
    }

    /// Changes the state directly, without a control.
    pub fn change(&mut self, change: impl FnOnce(&mut ViewerState)) {
        let mut state = self.state().clone();
        change(&mut state);
        self.editor.apply(Command::Replace(Box::new(state)));
    }
}

pub fn bench_of(size: [f32; 2], library: Library) -> Harness<'static, Bench> {
    let playback = Playback { playing: false, ..Playback::default() };
    let bench = Bench {
        editor: Editor::new(library, ViewerState { playback, ..ViewerState::default() }),
        frame: Frame::default(),
        panels: UiState::default(),
        commands: Vec::new(),
        actions: Vec::new(),
        viewport: egui::Rect::NOTHING,
    };
    let mut harness = Harness::builder()
        .with_size(size)
        .with_step_dt(1.0 / 60.0)
        .with_max_steps(60)
        .with_context_setup(ui::install)
        .build_ui_state(
            |ui, bench: &mut Bench| {
                // The harness leaves a margin around what it shows; the window has none.
                let whole = ui.ctx().content_rect();
                let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(whole));
                ui.set_clip_rect(whole);
                let ui = &mut ui;
                let Bench { editor, frame, panels, commands, actions, viewport } = bench;
                evaluate(editor.library(), editor.state(), panels.viewport.aspect, frame);
                panels.host.can_undo = editor.can_undo();
                panels.host.can_redo = editor.can_redo();
                panels.host.can_undo_retargeting = editor.can_undo_retargeting();
                panels.host.can_redo_retargeting = editor.can_redo_retargeting();
                let mut output = Output::default();
                let shown = Shown { library: editor.library(), state: editor.state(), frame: &*frame };
                *viewport = ui::panels(ui, shown, panels, &mut output);
                ui::viewport(ui, *viewport, shown, panels, &mut output);
                ui::labels(ui, *viewport, shown, panels);
                ui::overlays(ui, *viewport, shown, panels, &mut output);
                editor.set_aspect(panels.viewport.aspect);
                if !output.commands.is_empty() || !output.actions.is_empty() {
                    ui.ctx().request_repaint();
                }
                ui::begin_gestures(ui, editor);
                for command in output.commands {
                    commands.push(command.clone());
                    editor.apply(command);
                }
                for action in &output.actions {
                    match action {
                        UiAction::Undo => editor.undo(),
                        UiAction::Redo => editor.redo(),
                        _ => continue,
                    };
                }
                actions.extend(output.actions);
                ui::end_gestures(ui, editor);
            },
            bench,
        );
    harness.run();
    harness
}

/// One joint and as many clips as asked for, each of its own length, and a few warnings.
pub fn model_with_clips(count: usize) -> Model {
    model_with_clips_named((0..count).map(|index| format!("Move {index}")))
}

/// The same with these names.
pub fn model_with_clips_named(names: impl Iterator<Item = String>) -> Model {
    let joint = Joint { name: "Only".to_owned(), ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint]).expect("one joint");
    let mut clips = Vec::new();
    for (index, name) in names.enumerate() {
        let mut clip = ClipBuilder::new(name, &skeleton);
        let keys = Keys::Translation(vec![glam::Vec3::ZERO, glam::Vec3::X]);
        let end_secs = 1.0 + index as f32;
        clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, end_secs], keys).expect("two keys");
        clips.push(clip.build());
    }
    let extensions_used = vec!["KHR_texture_transform".to_owned()];
    let parts = AssetParts { format: "glb", skeleton, clips, extensions_used, ..AssetParts::default() };
    let mut asset = Asset::new(parts).expect("indices in range");
    for node in ["A", "B"] {
        asset.warnings.push(Warning::MatrixNotDecomposable { node: node.to_owned() });
    }
    Model::new("folder/many.glb".to_owned(), asset, Vec::new())
}

/// The painted texts, each with whether it is truncated, and where.
pub fn painted(harness: &Harness<'_, Bench>) -> Vec<(String, bool, egui::Rect)> {
    fn collect(shape: &egui::Shape, texts: &mut Vec<(String, bool, egui::Rect)>) {
        match shape {
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, texts)),
            egui::Shape::Text(text) => {
                let rect = text.galley.rect.translate(text.pos.to_vec2());
                texts.push((text.galley.text().to_owned(), text.galley.elided, rect));
            }
            _ => {}
        }
    }
    let mut texts = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut texts));
    texts
}

/// Presses the control with this label and returns the resulting commands.
pub fn press(harness: &mut Harness<'_, Bench>, label: &str) -> Vec<Command> {
    harness.state_mut().commands.clear();
    harness.get_by_label(label).click();
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

pub fn press_key(harness: &mut Harness<'_, Bench>, key: egui::Key) -> Vec<Command> {
    harness.state_mut().commands.clear();
    harness.key_press(key);
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

/// Presses the pointer at one place, moves it to another and releases it.
pub fn drag(
    harness: &mut Harness<'_, Bench>,
    from: egui::Pos2,
    to: egui::Pos2,
    button: egui::PointerButton,
) -> Vec<Command> {
    harness.state_mut().commands.clear();
    let event = |pressed, pos| egui::Event::PointerButton { pos, button, pressed, modifiers: egui::Modifiers::NONE };
    harness.event(egui::Event::PointerMoved(from));
    harness.run();
    harness.event(event(true, from));
    harness.run();
    harness.event(egui::Event::PointerMoved(to));
    harness.run();
    harness.event(event(false, to));
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}
