//! How fast joints turn, which reveals those that snap.

use glam::Quat;

use crate::anim::{Clip, Pose, SampleCursor, Skeleton};
use crate::retarget::map::Pair;

const FRAMES_PER_SEC: f32 = 60.0;

/// Returns the largest angle by which a target joint of `pairs` turns in model space within 1/60 s, in degrees. `None` for a
/// clip shorter than that.
pub fn largest_turn_degrees(skeleton: &Skeleton, pairs: &[Pair], clip: &Clip) -> Option<f64> {
    let (mut pose, mut cursor) = (Pose::default(), SampleCursor::default());
    let [mut before, mut now] = [(); 2].map(|()| Vec::with_capacity(skeleton.len()));
    // Unit quaternions are apart by twice the sine of a quarter of the angle.
    let mut largest: Option<f32> = None;
    for frame in 0..=(clip.duration_secs() * FRAMES_PER_SEC + 1e-3) as u32 {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, frame as f32 / FRAMES_PER_SEC, &mut cursor, &mut pose);
        std::mem::swap(&mut before, &mut now);
        now.clear();
        for (local, parent) in pose.locals().zip(skeleton.parents()) {
            let parent = parent.map_or(Quat::IDENTITY, |parent| now[parent.get()]);
            now.push((parent * local.rotation).normalize());
        }
        if frame > 0 {
            let turns = pairs.iter().map(|pair| {
                let [from, to]: [Quat; 2] = [before[pair.target.get()], now[pair.target.get()]];
                (to - from).length().min((to + from).length())
            });
            largest = turns.fold(largest, |max, turn| Some(max.unwrap_or(0.0).max(turn)));
        }
    }
    largest.map(|chord| 4.0 * f64::from(0.5 * chord).min(1.0).asin().to_degrees())
}
