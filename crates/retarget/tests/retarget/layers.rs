//! Baking a clip and the layers below it into one clip.

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, JointIndex, Keys, Pose, SampleCursor, Skeleton, Transform,
};
use gaitway_character::asset::Asset;
use gaitway_retarget::{Baking, LayerClip, bake_layers};
use glam::{Quat, Vec3};

use crate::skeletons::{asset, joint};

fn pose_at(clip: &Clip, skeleton: &Skeleton, time_secs: f32) -> Pose {
    let mut pose = skeleton.rest().clone();
    clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    pose
}

fn model() -> Asset {
    asset(vec![joint("hips", None, Transform::IDENTITY), joint("tail", Some(0), Transform::IDENTITY)])
}

/// A joint goes so many metres along X.
fn moving(model: &Asset, name: &str, joint: JointIndex, secs: f32, metres: f32) -> Clip {
    let mut clip = ClipBuilder::new(name, &model.skeleton);
    let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::X * metres]);
    clip.channel(joint, Interpolation::Linear, &[0.0, secs], keys).expect("a good channel");
    clip.build()
}

#[test]
fn a_stretched_spline_has_the_same_curve() {
    let (model, tail) = (model(), JointIndex(1));
    let mut layer = ClipBuilder::new("Idle", &model.skeleton);
    // In-tangent, value, out-tangent; tangents are per second.
    let vectors = [Vec3::ZERO, Vec3::X, Vec3::Y * 8.0, Vec3::X * 5.0, Vec3::Z, Vec3::ZERO];
    let turns = [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::IDENTITY, Quat::from_xyzw(3.0, 0.0, 0.0, 0.0)];
    let turns = [turns, [Quat::from_xyzw(0.0, 2.0, 0.0, 0.0), Quat::from_rotation_z(1.0), turns[0]]].concat();
    for keys in [Keys::Translation(vectors.to_vec()), Keys::Scale(vectors.to_vec()), Keys::Rotation(turns)] {
        layer.channel(tail, Interpolation::CubicSpline, &[0.0, 1.0], keys).expect("a good channel");
    }
    let layer = LayerClip { clip: layer.build(), duration_secs: 1.0, frozen: false };
    let clip = moving(&model, "Walk", JointIndex(0), 2.125, 1.0);
    // Two loops of the layer, each a sixteenth longer than it.
    let baked = bake_layers(&model, &clip, std::slice::from_ref(&layer), &Baking { loops: 1, seamless: true });
    assert_eq!(baked.duration_secs(), 2.125);
    for eighth in 0..8 {
        let share = (eighth as f32 + 0.5) / 8.0;
        let expected = pose_at(&layer.clip, &model.skeleton, share).local(tail);
        for round in [0.0, 1.0] {
            let found = pose_at(&baked, &model.skeleton, (share + round) * 1.0625).local(tail);
            assert!(found.translation.abs_diff_eq(expected.translation, 1e-5), "{share}: {found:?} {expected:?}");
            assert!(found.scale.abs_diff_eq(expected.scale, 1e-5), "{share}: {found:?} {expected:?}");
            assert!(found.rotation.abs_diff_eq(expected.rotation, 1e-5), "{share}: {found:?} {expected:?}");
        }
    }
}

/// A layer that fits no number of loops ends with the clip, and the clip is no longer than it was.
#[test]
fn a_layer_that_does_not_fit_is_cut_off() {
    let (model, tail) = (model(), JointIndex(1));
    let layer = LayerClip { clip: moving(&model, "Idle", tail, 2.0, 2.0), duration_secs: 2.0, frozen: false };
    let clip = moving(&model, "Walk", JointIndex(0), 0.75, 1.0);
    for (loops, tail_at_end) in [(1, 0.75), (3, 0.25)] {
        let baked = bake_layers(&model, &clip, std::slice::from_ref(&layer), &Baking { loops, seamless: false });
        let end = 0.75 * loops as f32;
        assert_eq!(baked.duration_secs(), end);
        let found = pose_at(&baked, &model.skeleton, end).local(tail).translation;
        assert!(found.abs_diff_eq(Vec3::X * tail_at_end, 1e-5), "{found} at the end of {loops} loops");
    }
}
