//! How smoothly joints move.

use gaitway_character::anim::{Clip, Pose, SampleCursor, Skeleton, model_from_joint};
use glam::{Affine3A, Quat, Vec3A};

use crate::budget::measured_steps;
use crate::map::Pair;
use crate::pose::with_ancestors;

const FRAMES_PER_SEC: f32 = 60.0;

/// Fields are `None` if the clip is too short.
#[derive(Debug, Clone, Copy, Default)]
pub struct Smoothness {
    /// The largest angle by which a joint turns in model space within 1/60 s: one that snaps.
    pub largest_turn_degrees: Option<f64>,
    /// Mean length of the third derivative of the joints' positions in model space.
    pub jerk_mean: Option<f64>,
}

/// Plays a clip at 60 frames per second and measures the target joints of `pairs`.
pub fn smoothness(skeleton: &Skeleton, pairs: &[Pair], clip: &Clip) -> Smoothness {
    let (mut pose, mut cursor) = (Pose::default(), SampleCursor::default());
    let joints = with_ancestors(skeleton, pairs.iter().map(|pair| pair.target));
    let mut world = Vec::new();
    let [mut before, mut now] = [(); 2].map(|()| vec![Quat::IDENTITY; skeleton.len()]);
    // Of each pair, in the last four frames, from the oldest.
    let mut positions = vec![[Vec3A::ZERO; 4]; pairs.len()];
    // Unit quaternions are apart by twice the sine of a quarter of the angle.
    let mut largest_chord: Option<f32> = None;
    let (mut jerk_sum, mut jerk_count) = (0.0, 0_usize);
    for frame in 0..=measured_steps(clip.duration_secs() * FRAMES_PER_SEC + 1e-3, skeleton.len()) {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, frame as f32 / FRAMES_PER_SEC, &mut cursor, &mut pose);
        std::mem::swap(&mut before, &mut now);
        for &joint in &joints {
            let parent = skeleton.parent(joint).map_or(Quat::IDENTITY, |parent| now[parent.get()]);
            now[joint.get()] = (parent * pose.local(joint).rotation).normalize();
        }
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
        for (pair, positions) in pairs.iter().zip(&mut positions) {
            positions.rotate_left(1);
            positions[3] = world[pair.target.get()].translation;
        }
        if frame > 0 {
            let turns = pairs.iter().map(|pair| {
                let [from, to]: [Quat; 2] = [before[pair.target.get()], now[pair.target.get()]];
                (to - from).length().min((to + from).length())
            });
            largest_chord = turns.fold(largest_chord, |max, turn| Some(max.unwrap_or(0.0).max(turn)));
        }
        if frame > 2 {
            let differences = positions.iter().map(|[a, b, c, d]| f64::from((d - a + 3.0 * (b - c)).length()));
            jerk_sum += differences.sum::<f64>();
            jerk_count += positions.len();
        }
    }
    Smoothness {
        largest_turn_degrees: largest_chord.map(|chord| 4.0 * f64::from(0.5 * chord).min(1.0).asin().to_degrees()),
        jerk_mean: (jerk_count > 0).then(|| jerk_sum / jerk_count as f64 * f64::from(FRAMES_PER_SEC).powi(3)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys};

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
        smoothness(&skeleton, &[pair], &clip.build()).largest_turn_degrees
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

    /// A position that is cubic in time has a constant third derivative, here of 6 m/s³.
    #[test]
    fn jerk_is_the_third_derivative_of_positions() {
        let joint = |name: &str, parent| Joint { name: name.to_owned(), parent, ..Joint::default() };
        let skeleton = Skeleton::new(vec![joint("hips", None)]).unwrap();
        let hips = skeleton.joints().next().unwrap();
        let jerk = |frames: usize| {
            let times: Vec<f32> = (0..=frames).map(|frame| frame as f32 / FRAMES_PER_SEC).collect();
            let keys = times.iter().map(|&time| glam::Vec3::new(time.powi(3), 0.0, 2.0 * time)).collect();
            let mut clip = ClipBuilder::new("cubic", &skeleton);
            clip.channel(hips, Interpolation::Linear, &times, Keys::Translation(keys)).unwrap();
            let pair = Pair { target: hips, source: hips, correction: Quat::IDENTITY };
            smoothness(&skeleton, &[pair], &clip.build()).jerk_mean
        };
        let measured = jerk(60).unwrap();
        assert!((measured - 6.0).abs() < 0.1, "{measured}");
        assert_eq!(jerk(2), None);
    }
}
