//! How fast joints turn, which reveals those that snap.

use glam::Quat;

use crate::anim::{Clip, Pose, SampleCursor, Skeleton};
use crate::retarget::map::Pair;
use crate::retarget::pose::with_ancestors;

const FRAMES_PER_SEC: f32 = 60.0;

/// Returns the largest angle by which a target joint of `pairs` turns in model space within 1/60 s, in degrees. `None` for a
/// clip shorter than that.
pub fn largest_turn_degrees(skeleton: &Skeleton, pairs: &[Pair], clip: &Clip) -> Option<f64> {
    let (mut pose, mut cursor) = (Pose::default(), SampleCursor::default());
    let joints = with_ancestors(skeleton, pairs.iter().map(|pair| pair.target));
    let [mut before, mut now] = [(); 2].map(|()| vec![Quat::IDENTITY; skeleton.len()]);
    // Unit quaternions are apart by twice the sine of a quarter of the angle.
    let mut largest: Option<f32> = None;
    for frame in 0..=(clip.duration_secs() * FRAMES_PER_SEC + 1e-3) as u32 {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, frame as f32 / FRAMES_PER_SEC, &mut cursor, &mut pose);
        std::mem::swap(&mut before, &mut now);
        for &joint in &joints {
            let parent = skeleton.parent(joint).map_or(Quat::IDENTITY, |parent| now[parent.get()]);
            now[joint.get()] = (parent * pose.local(joint).rotation).normalize();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys};

    /// Two joints; the first turns by `degrees` within a frame, half a second in.
    fn largest_turn(degrees: f32, mapped: usize, duration_secs: f32) -> Option<f64> {
        let joint = |name: &str, parent| Joint { name: name.to_owned(), parent, ..Joint::default() };
        let skeleton = Skeleton::new(vec![joint("shoulder", None), joint("hand", Some(0))]).unwrap();
        let joints: Vec<JointIndex> = skeleton.joints().collect();
        let mut clip = ClipBuilder::new("snap", &skeleton);
        let share = duration_secs.min(1.0);
        let times = [0.0, 0.5, 0.5 + 1.0 / 60.0, 1.0].map(|time| time * share);
        let keys = [0.0, 3.0, 3.0 + degrees, degrees].map(|degrees| Quat::from_rotation_y(degrees.to_radians()));
        clip.channel(joints[0], Interpolation::Linear, &times, Keys::Rotation(keys.to_vec())).unwrap();
        let pair = Pair { target: joints[mapped], source: joints[0], correction: Quat::IDENTITY };
        largest_turn_degrees(&skeleton, &[pair], &clip.build())
    }

    #[test]
    fn a_snap_is_the_largest_turn() {
        for degrees in [0.0, 40.0, 170.0] {
            let largest = largest_turn(degrees, 0, 1.0).unwrap();
            let expected = f64::from(degrees).max(0.1);
            assert!((largest - expected).abs() < 0.05, "{degrees}: {largest}");
        }
    }

    #[test]
    fn joints_turn_with_their_parents() {
        let largest = largest_turn(40.0, 1, 1.0).unwrap();
        assert!((largest - 40.0).abs() < 0.05, "{largest}");
    }

    #[test]
    fn less_than_a_frame_has_no_turn() {
        assert_eq!(largest_turn(40.0, 0, 0.01), None);
    }
}
