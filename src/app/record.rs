//! Recording one loop of the clip as a video, a GIF or images. The host asks for one frame after the other and encodes it, so the
//! result is the same however long a frame takes. What is on screen stays as it is.

use gaitway_render::read_pixels;
use gaitway_scene::editor::AWAITS_IMAGES;
use gaitway_scene::state::{Background, LoopFrames};

use super::recording::Recording;
use super::viewport::fitted;
use super::{App, Video};
use crate::ui::{RecordingFormat, RecordingProgress, VideoSettings, text};

/// Of a GIF's longer edge, in pixels. GIFs hardly compress: four seconds at this size take about 6 MB.
const MAX_GIF_SIZE: u32 = 640;
/// Frames per second. At 60, the next rate that can be chosen, frames would be shorter than the two hundredths of a second below which
/// browsers slow GIFs down.
const MAX_GIF_RATE: u32 = 30;

impl App {
    pub(super) fn start_recording(&mut self, settings: VideoSettings) {
        let VideoSettings { format, .. } = settings;
        let (size, frames_per_sec) = match format {
            RecordingFormat::Gif => (fitted(settings.size, MAX_GIF_SIZE), settings.frames_per_sec.min(MAX_GIF_RATE)),
            RecordingFormat::Video | RecordingFormat::Images => (settings.size, settings.frames_per_sec),
        };
        let size = self.viewport.picture_size(size);
        let size = match format {
            // Most codecs take only even sizes.
            RecordingFormat::Video => size.map(|edge| (edge & !1).max(2)),
            RecordingFormat::Gif | RecordingFormat::Images => size,
        };
        let (library, state) = (self.editor.library(), self.editor.state());
        let Some(model) = library.active() else { return };
        if model.awaits_images() {
            return self.fail_to_record(format, AWAITS_IMAGES);
        }
        let aspect = size[0] as f32 / size[1] as f32;
        let Some(frames) = LoopFrames::new(library, state, aspect, frames_per_sec) else { return };
        if frames.count() > LoopFrames::MAX_COUNT {
            return self.fail_to_record(format, text::TOO_MANY_FRAMES);
        }
        let transparent = settings.transparent || state.display.background == Background::Transparent;
        let frames = if transparent && format == RecordingFormat::Gif { frames.without_ground() } else { frames };
        let (frame_count, model) = (frames.count(), model.id);
        let name = self.editor.file_stem();
        let video = Video { name, size, frames_per_sec, frame_count, transparent, format };
        match self.host.record(video, &self.inbox) {
            Ok(()) => {
                let remark = (size != settings.size).then(|| format!("It is {} × {} pixels.", size[0], size[1]));
                self.recording = Some(Recording { frames, model, size, transparent, format, remark });
                self.panels.host.recording = Some(RecordingProgress { frames_done: 0, frame_count });
            }
            Err(error) => self.add_error(&error),
        }
    }

    /// Draws a frame of the video that is being recorded and returns its pixels: RGBA rows from the top, with straight alpha.
    ///
    /// # Errors
    /// If no video is being recorded, the model was replaced, or the graphics device was lost.
    pub fn video_frame(&mut self, index: u32) -> Result<impl Future<Output = Result<Vec<u8>, String>> + use<>, String> {
        let library = self.editor.library();
        let recording = self.recording.as_ref().ok_or("no video is being recorded")?;
        if library.active().map(|model| model.id) != Some(recording.model) {
            return Err("another model was opened meanwhile".to_owned());
        }
        let state = recording.frames.state(library, index);
        let (size, transparent) = (recording.size, recording.transparent);
        let (device, queue, texture) = self.viewport.draw_off_screen(library, &state, size, transparent);
        if let Some(progress) = &mut self.panels.host.recording {
            progress.frames_done = index;
        }
        self.context.request_repaint();
        Ok(async move {
            let pixels = read_pixels(&device, &queue, &texture).await;
            if pixels.is_empty() { Err("the graphics device was lost".to_owned()) } else { Ok(pixels) }
        })
    }

    /// Ends the recording: the video was saved under a name, cancelled, or failed.
    pub(super) fn end_recording(&mut self, saved_name: Result<Option<String>, String>) {
        self.panels.host.recording = None;
        let Some(recording) = self.recording.take() else { return };
        match saved_name {
            Ok(Some(name)) => self.toast(text::saved(&name, recording.remark.as_deref())),
            Ok(None) => self.toast("Recording cancelled.".to_owned()),
            Err(error) => self.fail_to_record(recording.format, &error),
        }
    }

    fn fail_to_record(&mut self, format: RecordingFormat, error: &str) {
        let what = match format {
            RecordingFormat::Video => "video",
            RecordingFormat::Gif => "GIF",
            RecordingFormat::Images => "images",
        };
        self.add_error(&format!("Couldn't record the {what}: {error}"));
    }
}
