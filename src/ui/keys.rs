//! The keys: one table that is both listened to and shown.

use egui::{Context, Key, Modifiers};

use super::transport::range_here;
use super::{Output, Shown, UiAction, UiState, motion};
use crate::anim::LoopMode;
use crate::state::{CameraChoice, Command, Show, choice_of_clip};

/// One line of the help.
pub struct KeyHelp {
    pub keys: &'static str,
    pub does: &'static str,
    pressed: &'static [Key],
    act: fn(&Shown<'_>, &mut UiState, usize, &mut Output),
}

const ORBIT_STEP_RADIANS: f32 = 0.12;
const ZOOM_STEP: f32 = 0.9;

/// All keys. `act` gets the position of the pressed key among `pressed`.
pub const KEY_TABLE: &[KeyHelp] = &[
    KeyHelp {
        keys: "Space",
        does: "Play or pause",
        pressed: &[Key::Space],
        act: |_, _, _, out| out.commands.push(Command::TogglePlaying),
    },
    KeyHelp {
        keys: "Comma, period",
        does: "One frame back, one frame on",
        pressed: &[Key::Comma, Key::Period],
        act: |_, _, which, out| out.commands.push(Command::StepFrames(if which == 0 { -1 } else { 1 })),
    },
    KeyHelp {
        keys: "Up  Down",
        does: "Nearer, farther",
        pressed: &[Key::ArrowUp, Key::ArrowDown],
        act: |_, _, which, out| {
            let factor = if which == 0 { ZOOM_STEP } else { 1.0 / ZOOM_STEP };
            out.commands.push(Command::Zoom { factor, right: 0.0, up: 0.0 });
        },
    },
    KeyHelp {
        keys: "Left  Right",
        does: "Around",
        pressed: &[Key::ArrowLeft, Key::ArrowRight],
        act: |_, _, which, out| {
            let yaw_radians = if which == 0 { -ORBIT_STEP_RADIANS } else { ORBIT_STEP_RADIANS };
            out.commands.push(Command::Orbit { yaw_radians, pitch_radians: 0.0 });
        },
    },
    KeyHelp {
        keys: "1 – 9",
        does: "Choose a clip",
        pressed: &[Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9],
        act: |shown, _, which, out| {
            if let Some(model) = shown.library.active().filter(|model| which < model.clip_count()) {
                out.commands.push(Command::SetClip(choice_of_clip(model, which)));
            }
        },
    },
    KeyHelp {
        keys: "F",
        does: "Fit everything into the picture",
        pressed: &[Key::F],
        act: |_, _, _, out| out.commands.push(Command::FrameAll),
    },
    KeyHelp {
        keys: "Home",
        does: "The camera as it was at first",
        pressed: &[Key::Home],
        act: |_, _, _, out| out.commands.push(Command::SetCamera(CameraChoice::Auto)),
    },
    KeyHelp {
        keys: "C",
        does: "The camera goes along with the character, or stays",
        pressed: &[Key::C],
        act: |shown, _, _, out| out.commands.push(Command::SetFollow(!shown.state.camera_options.follow)),
    },
    KeyHelp {
        keys: "I  O",
        does: "In point, out point here",
        pressed: &[Key::I, Key::O],
        act: |shown, _, which, out| out.commands.extend(range_here(shown, which == 0)),
    },
    KeyHelp {
        keys: "L",
        does: "Next loop mode",
        pressed: &[Key::L],
        act: |shown, _, _, out| {
            out.commands.push(Command::SetLoopMode(match shown.state.playback.loop_mode {
                LoopMode::Once => LoopMode::Loop,
                LoopMode::Loop => LoopMode::PingPong,
                LoopMode::PingPong => LoopMode::Once,
            }));
        },
    },
    KeyHelp {
        keys: "S  W  G",
        does: "Skeleton, wireframe, grid",
        pressed: &[Key::S, Key::W, Key::G],
        act: |shown, _, which, out| {
            let mut show: Show = shown.state.display.show;
            match which {
                0 => show.skeleton = !show.skeleton,
                1 => show.wireframe = !show.wireframe,
                _ => show.grid = !show.grid,
            }
            out.commands.push(Command::SetShow(show));
        },
    },
    KeyHelp { keys: "Ctrl O", does: "Open files", pressed: &[], act: |_, _, _, _| {} },
    KeyHelp {
        keys: "Ctrl Z, Ctrl Y",
        does: "Undo, redo a setting or what was opened",
        pressed: &[],
        act: |_, _, _, _| {},
    },
    KeyHelp {
        keys: "?",
        does: "This list",
        pressed: &[Key::Questionmark, Key::F1],
        act: |_, local, _, _| local.help_open = !local.help_open,
    },
    KeyHelp {
        keys: "Esc",
        does: "Close what is open, choose no joint",
        pressed: &[Key::Escape],
        act: |shown, local, _, out| {
            if local.help_open {
                local.help_open = false;
            } else if motion::stop_clicking(local) {
                // That was all.
            } else if local.sheet.is_some() {
                local.sheet = None;
            } else if local.error.is_some() {
                local.error = None;
                local.motion_refused = false;
            } else if shown.state.selection.joint.is_some() {
                out.commands.push(Command::SelectJoint(None));
            }
        },
    },
];

/// Listens, unless someone is typing or a control has the keyboard; to shortcuts also when a mere button has it.
pub(super) fn listen(context: &Context, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    if local.path_prompt.is_some() || local.motion.is_picking() {
        return;
    }
    if !context.text_edit_focused() {
        shortcuts(context, out);
    }
    if context.egui_wants_keyboard_input() {
        return;
    }
    // The help is modal: only the keys that close it count.
    let modal = local.help_open;
    for line in KEY_TABLE {
        if modal && !line.pressed.iter().any(|key| matches!(key, Key::Escape | Key::Questionmark)) {
            continue;
        }
        for (which, &key) in line.pressed.iter().enumerate() {
            let presses = context.input(|input| {
                let plain = !input.modifiers.intersects_command_or_alt();
                if plain { input.num_presses(key) } else { 0 }
            });
            for _ in 0..presses {
                (line.act)(shown, local, which, out);
            }
        }
    }
}

/// On a slow machine a key is pressed several times within a frame: each counts.
fn shortcuts(context: &Context, out: &mut Output) {
    // The longer one first: the shorter would swallow it.
    let shortcuts = [
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::Z, UiAction::Redo),
        (Modifiers::COMMAND, Key::Y, UiAction::Redo),
        (Modifiers::COMMAND, Key::Z, UiAction::Undo),
        (Modifiers::COMMAND, Key::O, UiAction::OpenFiles),
    ];
    for (modifiers, key, action) in shortcuts {
        let presses = context.input_mut(|input| input.count_and_consume_key(modifiers, key));
        out.actions.extend(std::iter::repeat_n(action, presses));
    }
}

trait CommandOrAlt {
    fn intersects_command_or_alt(self) -> bool;
}

impl CommandOrAlt for Modifiers {
    fn intersects_command_or_alt(self) -> bool {
        self.ctrl || self.command || self.mac_cmd || self.alt
    }
}
