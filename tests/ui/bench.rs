//! The panels over a model, driven by label; commands are noted and applied, as the frame loop does.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton};
use gaitway::asset::{Asset, Warning};
use gaitway::frame::{Frame, evaluate};
use gaitway::library::{Library, Model, Motion};
use gaitway::samples;
use gaitway::state::{Command, History, ViewerState, apply, maps_in_force};
use gaitway::ui::{self, Output, Shown, UiAction, UiState};

pub struct Bench {
    pub library: Library,
    pub state: ViewerState,
    pub history: History,
    pub frame: Frame,
    pub panels: UiState,
    pub commands: Vec<Command>,
    pub actions: Vec<UiAction>,
    pub picture: egui::Rect,
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
    library.set(samples::load("walker").expect("the sample is there"));
    let asset = library.active().expect("just set").asset.clone();
    library.set_motions(motions.iter().map(|name| Motion::new((*name).to_owned(), asset.clone())).collect());
    bench_of(size, library)
}

pub fn bench(size: [f32; 2], model: Model) -> Harness<'static, Bench> {
    let mut library = Library::default();
    library.set(model);
    bench_of(size, library)
}

fn settle(bench: &mut Bench) {
    apply(&mut bench.state, &bench.library, Command::SettleMaps);
    bench.library.borrow_each(maps_in_force(&bench.library, &bench.state));
}

pub fn bench_of(size: [f32; 2], library: Library) -> Harness<'static, Bench> {
    let state = ViewerState { playing: false, ..ViewerState::default() };
    let mut bench = Bench {
        library,
        state,
        history: History::default(),
        frame: Frame::default(),
        panels: UiState::default(),
        commands: Vec::new(),
        actions: Vec::new(),
        picture: egui::Rect::NOTHING,
    };
    settle(&mut bench);
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
                evaluate(&bench.library, &bench.state, bench.panels.aspect, &mut bench.frame);
                (bench.panels.can_undo, bench.panels.can_redo) = (bench.history.can_undo(), bench.history.can_redo());
                let mut output = Output::default();
                let shown = Shown { library: &bench.library, state: &bench.state, frame: &bench.frame };
                bench.picture = ui::panels(ui, shown, &mut bench.panels, &mut output);
                ui::picture(ui, bench.picture, shown, &mut bench.panels, &mut output);
                ui::labels(ui, bench.picture, shown, &mut bench.panels);
                ui::overlays(ui, bench.picture, shown, &mut bench.panels, &mut output);
                for command in output.commands {
                    bench.commands.push(command.clone());
                    bench.history.apply(&mut bench.state, &bench.library, command);
                    settle(bench);
                    ui.ctx().request_repaint();
                }
                for action in &output.actions {
                    match action {
                        UiAction::Undo => bench.history.undo(&mut bench.state, &mut bench.library),
                        UiAction::Redo => bench.history.redo(&mut bench.state, &mut bench.library),
                        _ => continue,
                    };
                    settle(bench);
                    ui.ctx().request_repaint();
                }
                bench.actions.extend(output.actions);
                if ui.input(|input| !input.pointer.any_down() && input.keys_down.is_empty()) {
                    bench.history.end_gesture();
                }
            },
            bench,
        );
    harness.run();
    harness
}

/// One joint and as many clips as asked for, each of its own length, and a few warnings.
pub fn model_with_clips(count: usize) -> Model {
    let joint = Joint { name: "Only".to_owned(), ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint]).expect("one joint");
    let mut asset = Asset { format: "glb", ..Asset::default() };
    for index in 0..count {
        let mut clip = ClipBuilder::new(format!("Move {index}"), &skeleton);
        let keys = Keys::Translation(vec![glam::Vec3::ZERO, glam::Vec3::X]);
        let end_secs = 1.0 + index as f32;
        clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, end_secs], keys).expect("two keys");
        asset.clips.push(clip.build());
    }
    asset.skeleton = skeleton;
    asset.extensions_used = vec!["KHR_texture_transform".to_owned()];
    for node in ["A", "B"] {
        asset.warnings.push(Warning::MatrixNotDecomposable { node: node.to_owned() });
    }
    Model::new("folder/many.glb".to_owned(), asset, Vec::new())
}

/// Presses what has this label and gives back the commands that came of it.
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

/// Presses the pointer at one place, moves it to another and lets go.
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
