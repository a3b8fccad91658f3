//! Keyboard shortcuts: one table for both handling and help.

use egui::{Context, Key, Modifiers};
use gaitway_character::anim::LoopMode;
use gaitway_scene::state::{CameraChoice, ClipChoice, Command, Show};

use super::transport::range_here;
use super::{Output, Sheet, Shown, UiAction, UiState, motion, text, typing};

/// A shortcut and its line in the help.
pub struct KeyHelp {
    /// The keys, as the help writes them.
    pub keys: &'static str,
    /// What they do, as the help says it.
    pub does: &'static str,
    pressed: &'static [Key],
    act: fn(&Shown<'_>, &mut UiState, Press, &mut Output),
}

/// The press of a key.
#[derive(Clone, Copy)]
struct Press {
    /// Its index in [`KeyHelp::pressed`].
    which: usize,
    has_shift: bool,
}

const ORBIT_STEP_RADIANS: f32 = 0.12;
const ZOOM_STEP: f32 = 0.9;

/// All shortcuts.
pub const KEY_TABLE: &[KeyHelp] = &[
    KeyHelp {
        keys: "Space",
        does: "Play or pause",
        pressed: &[Key::Space],
        act: |_, _, _, out| out.commands.push(Command::TogglePlaying),
    },
    KeyHelp {
        keys: text::STEP_KEYS,
        does: text::STEP_FRAMES,
        pressed: &[Key::Comma, Key::Period],
        act: |_, _, Press { which, .. }, out| out.commands.push(Command::StepFrames(if which == 0 { -1 } else { 1 })),
    },
    KeyHelp {
        keys: "Up, Down",
        does: "Zoom in, zoom out",
        pressed: &[Key::ArrowUp, Key::ArrowDown],
        act: |_, _, Press { which, .. }, out| {
            let factor = if which == 0 { ZOOM_STEP } else { 1.0 / ZOOM_STEP };
            out.commands.push(Command::Zoom { factor, right: 0.0, up: 0.0 });
        },
    },
    KeyHelp {
        keys: "Left, Right",
        does: "Orbit",
        pressed: &[Key::ArrowLeft, Key::ArrowRight],
        act: |_, _, Press { which, .. }, out| {
            let yaw_radians = if which == 0 { -ORBIT_STEP_RADIANS } else { ORBIT_STEP_RADIANS };
            out.commands.push(Command::Orbit { yaw_radians, pitch_radians: 0.0 });
        },
    },
    KeyHelp {
        keys: "1 to 9",
        does: "Play a clip",
        pressed: &[Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9],
        act: |shown, _, Press { which, .. }, out| {
            if let Some(clip) = shown.library.active().and_then(|model| model.clips().iter().nth(which)) {
                out.commands.push(Command::SetClip(ClipChoice::Clip(clip.id().clone())));
            }
        },
    },
    KeyHelp {
        keys: "F",
        does: text::FRAME_ALL,
        pressed: &[Key::F],
        act: |_, _, _, out| out.commands.push(Command::FrameAll),
    },
    KeyHelp {
        keys: "Home",
        does: "Reset camera",
        pressed: &[Key::Home],
        act: |_, _, _, out| out.commands.push(Command::SetCamera(CameraChoice::Auto)),
    },
    KeyHelp {
        keys: "C",
        does: "Toggle camera follow",
        pressed: &[Key::C],
        act: |shown, _, _, out| out.commands.push(Command::SetFollow(!shown.state.camera_options.follow)),
    },
    KeyHelp {
        keys: "I, O",
        does: "Set in point, set out point",
        pressed: &[Key::I, Key::O],
        act: |shown, _, Press { which, .. }, out| out.commands.extend(range_here(shown, which == 0)),
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
        keys: "S, W, G",
        does: "Toggle skeleton, wireframe, grid",
        pressed: &[Key::S, Key::W, Key::G],
        act: |shown, _, Press { which, .. }, out| {
            let mut show: Show = shown.state.display.show;
            match which {
                0 => show.skeleton = !show.skeleton,
                1 => show.wireframe = !show.wireframe,
                _ => show.grid = !show.grid,
            }
            out.commands.push(Command::SetShow(show));
        },
    },
    KeyHelp {
        keys: "V, Shift V",
        does: text::CYCLE_CHANNELS,
        pressed: &[Key::V],
        act: |shown, _, press, out| {
            let channel = shown.state.channel().cycled(if press.has_shift { -1 } else { 1 });
            out.commands.push(Command::SetChannel(channel));
        },
    },
    KeyHelp {
        keys: "T, N",
        does: "Show or hide the clips, the inspector",
        pressed: &[Key::T, Key::N],
        act: |_, local, Press { which, .. }, _| {
            local.layout.toggle(if which == 0 { Sheet::Clips } else { Sheet::Inspector })
        },
    },
    KeyHelp { keys: "Ctrl O", does: "Open files", pressed: &[], act: |_, _, _, _| {} },
    KeyHelp { keys: "Ctrl Z, Ctrl Y", does: text::UNDO_HELP, pressed: &[], act: |_, _, _, _| {} },
    KeyHelp {
        keys: "?",
        does: "Show this list",
        pressed: &[Key::Questionmark, Key::F1],
        act: |_, local, _, _| local.help.toggle_by_key(),
    },
    KeyHelp {
        keys: "Esc",
        does: "Close or cancel; deselect the joint",
        pressed: &[Key::Escape],
        act: |shown, local, _, out| {
            if local.help.is_open {
                local.help.is_open = false;
            } else if motion::stop_clicking(local) {
                // Esc only ended picking.
            } else if local.layout.sheet.is_some() {
                local.layout.sheet = None;
            } else if local.messages.error.is_some() {
                local.messages.clear_error();
            } else if local.messages.about_view.take().is_some() {
                // Esc only dismissed the notice.
            } else if shown.state.selection.joint.is_some() {
                out.commands.push(Command::SelectJoint(None));
            }
        },
    },
];

/// Keys that controls have a use for.
const KEYS_OF_CONTROLS: [Key; 7] =
    [Key::Space, Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight, Key::Home, Key::Escape];

/// Handles shortcuts unless the user is typing into a field. While a control has the keyboard, its keys are the control's.
pub(super) fn listen(context: &Context, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    // An open menu has the arrow keys and Esc, also in the frame in which Esc closes it.
    let has_popup = egui::Popup::is_any_open(context);
    let had_popup = std::mem::replace(&mut local.had_popup, has_popup);
    let blocks_keys = local.host.recording.is_some() || local.motion.is_picking();
    if blocks_keys || typing::is_typing(context) {
        return;
    }
    shortcuts(context, out);
    // While the modal help is open, only the keys that close it work. The help has the focus.
    let modal = local.help.is_open;
    let has_control = context.egui_wants_keyboard_input() && !local.viewport.has_focus && !modal;
    if had_popup || has_popup {
        return;
    }
    for line in KEY_TABLE {
        let toggles_help = line.pressed.contains(&Key::Questionmark);
        if modal && !toggles_help && !line.pressed.contains(&Key::Escape) {
            continue;
        }
        for (which, &key) in line.pressed.iter().enumerate() {
            if has_control && KEYS_OF_CONTROLS.contains(&key) {
                continue;
            }
            let pressed =
                |input: &egui::InputState| input.events.iter().filter_map(|event| plain_press(event, key)).collect();
            let presses: Vec<bool> = context.input(pressed);
            for has_shift in presses {
                (line.act)(shown, local, Press { which, has_shift }, out);
            }
        }
    }
}

/// If the event presses this key without Ctrl, Alt or Cmd, returns whether Shift was held then: on a slow machine, Shift may have been
/// released by the end of the frame.
fn plain_press(event: &egui::Event, wanted: Key) -> Option<bool> {
    match *event {
        egui::Event::Key { key, pressed: true, modifiers, .. } if key == wanted => {
            (!modifiers.intersects_command_or_alt()).then_some(modifiers.shift)
        }
        _ => None,
    }
}

/// Handles shortcuts with modifiers in the order in which they are pressed: on a slow machine one frame can have several.
fn shortcuts(context: &Context, out: &mut Output) {
    // Ctrl+Shift+Z first: matching Ctrl+Z ignores Shift.
    let shortcuts = [
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::Z, UiAction::Redo),
        (Modifiers::COMMAND, Key::Y, UiAction::Redo),
        (Modifiers::COMMAND, Key::Z, UiAction::Undo),
        (Modifiers::COMMAND, Key::O, UiAction::OpenFiles),
    ];
    context.input_mut(|input| {
        input.events.retain(|event| {
            let &egui::Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
            let meant = shortcuts.iter().find(|(wanted, of, _)| *of == key && modifiers.matches_logically(*wanted));
            out.actions.extend(meant.map(|(.., action)| action.clone()));
            meant.is_none()
        });
    });
}

trait CommandOrAlt {
    fn intersects_command_or_alt(self) -> bool;
}

impl CommandOrAlt for Modifiers {
    fn intersects_command_or_alt(self) -> bool {
        self.ctrl || self.command || self.mac_cmd || self.alt
    }
}
