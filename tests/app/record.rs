//! Recording a video: frames depend only on their number, and the view doesn't change.

use gaitway::app::{Message, Video};
use gaitway::ui::{Tab, text};
use gaitway_scene::state::Command;

use crate::desk::{Desk, desk};

/// Starts recording the run of the mannequin at the given size.
fn record(desk: &mut Desk, size: &str) -> Video {
    desk.press(Tab::Camera.label());
    desk.scroll_and_press(size);
    desk.scroll_and_press(text::RECORD);
    desk.video.take().expect("a recording was started")
}

#[test]
fn a_frame_is_the_same_whenever_it_is_drawn_and_the_view_stays() {
    let Some(mut desk) = desk("sample:mannequin") else { return };
    desk.open(&["sample:mannequin_run".into()]);
    desk.command(Command::SetPlaying(true));
    desk.command(Command::Seek(0.3));
    let video = record(&mut desk, "720p");
    let before = desk.state().clone();
    assert_eq!((video.size, video.frames_per_sec, video.transparent), ([1280, 720], 30, false));
    let model = desk.library().active().expect("a model");
    let clip = gaitway_scene::state::active_clip(model, &before).expect("a clip").clip();
    assert_eq!(video.frame_count, (clip.duration_secs() * 30.0).round() as u32);
    assert!(desk.shows(text::RECORDING));

    let first = desk.video_frame(0).expect("drawn");
    assert_eq!(first.len(), 4 * 1280 * 720);
    assert!(first.chunks_exact(4).all(|pixel| pixel[3] == 255), "the studio is opaque");
    let fifth = desk.video_frame(5).expect("drawn");
    assert!(first != fifth, "it moves");
    assert!(desk.video_frame(0).expect("drawn") == first, "whatever was drawn before");
    assert_eq!(desk.state(), &before, "time stands still");

    desk.send(Message::Recorded(Ok(Some("run.mp4".to_owned()))));
    assert!(desk.shows("Saved run.mp4."));
    assert!(!desk.shows(text::RECORDING));
    assert!(desk.video_frame(0).is_err());
    assert!(desk.state().playback.playing);
    assert_ne!(desk.state().character.playhead, before.character.playhead, "playback goes on");
}

#[test]
fn a_recording_that_fails_or_is_cancelled_says_so() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    record(&mut desk, "720p");
    desk.send(Message::Recorded(Err("the encoder stopped".to_owned())));
    assert_eq!(desk.problem().as_deref(), Some("Couldn't record the video: the encoder stopped"));
    assert!(!desk.shows("Saved"));
    desk.scroll_and_press(text::RECORD_IMAGES);
    desk.send(Message::Recorded(Err("the disk is full".to_owned())));
    assert!(desk.problem().expect("an error").ends_with("Couldn't record the images: the disk is full"));
    desk.scroll_and_press(text::RECORD_GIF);
    desk.send(Message::Recorded(Err("there is no memory left".to_owned())));
    assert!(desk.problem().expect("an error").ends_with("Couldn't record the GIF: there is no memory left"));
    record(&mut desk, "720p");
    desk.send(Message::Recorded(Ok(None)));
    assert!(desk.shows("Recording cancelled."));
}

#[test]
fn another_model_ends_the_recording() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    record(&mut desk, "720p");
    desk.video_frame(0).expect("drawn");
    desk.open(&["sample:creature".into()]);
    assert_eq!(desk.video_frame(1), Err("another model was opened meanwhile".to_owned()));
}
