//! Recording a video of one loop of the clip: hides the panels, plays from the start, and records the canvas.

use super::App;
use crate::state::{Command, active_clip, play_range};

pub(super) struct Recording {
    /// egui's time at the start; `None` while the panels are still on the canvas.
    start_secs: Option<f64>,
    /// Number of frames laid out without panels.
    bare_frames: u32,
    length_secs: f64,
    /// Restored afterwards.
    was_playing: bool,
    time_secs: f64,
}

impl App {
    /// Hides the panels; recording starts once only the viewport is on the canvas.
    pub(super) fn prepare_recording(&mut self) {
        let Some(model) = self.editor.library().active() else { return };
        let Some(clip) = active_clip(model, self.editor.state()) else { return };
        let range = play_range(model, clip, self.editor.state());
        self.recording = Some(Recording {
            start_secs: None,
            bare_frames: 0,
            length_secs: range.length_secs() / self.editor.state().playback.speed,
            was_playing: self.editor.state().playback.playing,
            time_secs: self.editor.state().playhead.time_secs,
        });
        self.panels.host.is_recording = true;
        self.apply(Command::SetPlaying(false));
        self.apply(Command::Seek(range.start_secs));
    }

    pub(super) fn update_recording(&mut self, context: &egui::Context) {
        let Some(recording) = &mut self.recording else { return };
        context.request_repaint();
        let now_secs = context.input(|input| input.time);
        let Some(start_secs) = recording.start_secs else {
            // The first one counted is the frame in which the button was pressed.
            recording.bare_frames += 1;
            if recording.bare_frames > 2 {
                recording.start_secs = Some(now_secs);
                match self.host.start_recording() {
                    Ok(()) => self.apply(Command::SetPlaying(true)),
                    Err(error) => {
                        self.end_recording();
                        self.add_error(&error);
                    }
                }
            }
            return;
        };
        if now_secs - start_secs >= recording.length_secs {
            self.stop_recording(true);
        }
    }

    /// Stops recording; discards the video unless the loop is complete.
    pub(super) fn stop_recording(&mut self, is_complete: bool) {
        let name = self.video_name();
        self.host.stop_recording(is_complete.then_some(name.as_str()));
        self.end_recording();
        self.toast(if is_complete { format!("Saved {name}.") } else { "Recording cancelled.".to_owned() });
    }

    /// Restores the panels and the playback.
    fn end_recording(&mut self) {
        let Some(recording) = self.recording.take() else { return };
        self.panels.host.is_recording = false;
        self.apply(Command::Seek(recording.time_secs));
        self.apply(Command::SetPlaying(recording.was_playing));
    }
}
