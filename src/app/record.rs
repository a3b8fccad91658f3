//! A video of one round of the clip: the panels go, the clip plays from its start, what the canvas shows is recorded.

use super::App;
use crate::state::{Command, active_clip, play_range};

pub(super) struct Recording {
    /// egui's time at which the first frame was shown; none until the panels are gone.
    start_secs: Option<f64>,
    length_secs: f64,
    /// Put back afterwards.
    was_playing: bool,
    time_secs: f64,
}

impl App {
    /// Begins with the next frame.
    pub(super) fn record(&mut self) {
        let Some(model) = self.library.active() else { return };
        let Some(clip) = active_clip(model, &self.state) else { return };
        let range = play_range(model, clip, &self.state);
        if let Err(error) = self.host.start_recording() {
            self.tell(vec![error]);
            return;
        }
        self.recording = Some(Recording {
            start_secs: None,
            length_secs: range.length_secs() / self.state.speed,
            was_playing: self.state.playing,
            time_secs: self.state.time_secs,
        });
        self.panels.recording = Some(0.0);
        self.apply(Command::Seek(range.start_secs));
        self.apply(Command::SetPlaying(true));
    }

    pub(super) fn go_on_recording(&mut self, context: &egui::Context) {
        let Some(recording) = &mut self.recording else { return };
        let now_secs = context.input(|input| input.time);
        let start_secs = *recording.start_secs.get_or_insert(now_secs);
        let share = (now_secs - start_secs) / recording.length_secs.max(1e-3);
        self.panels.recording = Some(share.clamp(0.0, 1.0) as f32);
        if share >= 1.0 {
            self.stop_recording(true);
        }
        context.request_repaint();
    }

    /// `whole`: the round is over; else what there is of it is thrown away.
    pub(super) fn stop_recording(&mut self, whole: bool) {
        let Some(recording) = self.recording.take() else { return };
        self.panels.recording = None;
        let name = self.video_name();
        self.host.stop_recording(whole.then_some(name.as_str()));
        self.apply(Command::Seek(recording.time_secs));
        self.apply(Command::SetPlaying(recording.was_playing));
        if !whole {
            self.toast("The recording was ended.".to_owned());
        }
    }
}
