//! Knees on the ground, on figures that kneel down, whose thighs are another share of their legs.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys};
use gaitway_character::asset::Slot;
use gaitway_retarget::{Contacts, Feet, Figures, ResolvedMap, Retargeted, Retargeting};
use glam::{DVec3, Quat, Vec3};

use crate::contacts::{keys_of, with_boxes};
use crate::feet::walker;
use crate::figure::{Figure, Rig};
use crate::laws::{body, map};

/// How far parts of the body are turned forwards about +X, in degrees in model space: others go along with their parents.
type Turns<'a> = &'a [(Slot, f32)];

/// Thighs upright, shins and the backs of the feet on the ground.
const UPRIGHT: Turns = &[
    (Slot::LeftUpperLeg, 0.0),
    (Slot::RightUpperLeg, 0.0),
    (Slot::LeftLowerLeg, 90.0),
    (Slot::RightLowerLeg, 90.0),
    (Slot::LeftFoot, 126.4),
    (Slot::RightFoot, 126.4),
];

/// The same with the right foot in front.
const ONE_KNEE: Turns = &[
    (Slot::LeftUpperLeg, 0.0),
    (Slot::RightUpperLeg, -86.6),
    (Slot::LeftLowerLeg, 90.0),
    (Slot::RightLowerLeg, 0.0),
    (Slot::LeftFoot, 126.4),
    (Slot::RightFoot, 0.0),
];

/// The trunk bent down as well, until the hanging arms reach the ground.
const ON_ALL_FOURS: Turns = &[
    (Slot::Spine, 80.0),
    (Slot::LeftUpperLeg, 0.0),
    (Slot::RightUpperLeg, 0.0),
    (Slot::LeftLowerLeg, 90.0),
    (Slot::RightLowerLeg, 90.0),
    (Slot::LeftFoot, 126.4),
    (Slot::RightFoot, 126.4),
];

/// Seconds in which the figure stands, kneels and stands again: most of the time it stands, which is where its ground is.
const TIMES: [f32; 6] = [0.0, 4.0, 4.6, 5.6, 6.2, 10.2];

/// Of the hips at rest, and while it kneels.
const HIPS: [f32; 2] = [1.0, 0.567];

/// Of the toes at rest.
const GROUND: f64 = 0.02;

/// From the toes to the head.
const HEIGHT: f64 = 1.58;

fn kneeling(turns: Turns) -> Figure {
    let mut figure = with_boxes(&Rig::default(), 0.1);
    let mut clip = ClipBuilder::new("kneel", &figure.asset.skeleton);
    let arms = [(Slot::LeftUpperArm, -80.0_f32), (Slot::RightUpperArm, 80.0)];
    let bend = |slot: Slot| turns.iter().find(|turn| turn.0 == slot).map(|turn| turn.1);
    let mut rotate = |slot: Slot, standing: Quat, down: Quat| {
        let keys = vec![standing, standing, down, down, standing, standing];
        clip.channel(figure.joint(slot), Interpolation::Linear, &TIMES, Keys::Rotation(keys)).unwrap();
    };
    for &(slot, degrees) in turns {
        let above = match slot {
            Slot::LeftLowerLeg => bend(Slot::LeftUpperLeg),
            Slot::RightLowerLeg => bend(Slot::RightUpperLeg),
            Slot::LeftFoot => bend(Slot::LeftLowerLeg),
            Slot::RightFoot => bend(Slot::RightLowerLeg),
            _ => None,
        };
        let local = Quat::from_rotation_x((degrees - above.unwrap_or(0.0)).to_radians());
        rotate(slot, Quat::IDENTITY, local);
    }
    let spine = Quat::from_rotation_x(bend(Slot::Spine).unwrap_or(0.0).to_radians());
    for (slot, degrees) in arms {
        let hang = Quat::from_rotation_z(degrees.to_radians());
        rotate(slot, hang, spine.inverse() * hang);
    }
    let path = [0, 0, 1, 1, 0, 0].map(|at| Vec3::Y * HIPS[at]).to_vec();
    clip.channel(figure.joint(Slot::Hips), Interpolation::Linear, &TIMES, Keys::Translation(path)).unwrap();
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

fn with_thighs(thigh_length: f64) -> Figure {
    with_boxes(&Rig { thigh_length, ..Rig::default() }, 0.1)
}

fn retarget(model: &Figure, motion: &Figure, feet: Feet, contacts: Contacts) -> (Retargeted, Figures) {
    let map = ResolvedMap { contacts, feet, ..map(model, motion) };
    let pair = Retargeting::new(body(model), body(motion), 0, &map).unwrap();
    let done = pair.bake().unwrap();
    let figures = pair.figures(&done);
    (done, figures)
}

fn off_and_keep(model: &Figure, motion: &Figure, feet: Feet) -> [(Retargeted, Figures); 2] {
    [Contacts::Off, Contacts::Keep].map(|contacts| retarget(model, motion, feet, contacts))
}

fn place(figure: &Figure, clip: &Clip, slot: Slot, time: f32) -> DVec3 {
    figure.world(clip, time)[figure.joint(slot).get()].1
}

/// How much higher a joint is than the source's, as a share of the height.
fn miss(model: &Figure, clip: &Clip, motion: &Figure, slot: Slot, time: f32) -> f64 {
    (place(model, clip, slot, time) - place(motion, &motion.asset.clips[0], slot, time)).y / HEIGHT
}

#[test]
fn knees_rest_on_the_ground_whatever_the_proportions() {
    let motion = kneeling(UPRIGHT);
    for (thighs, feet) in [(1.15, Feet::Off), (0.87, Feet::Off), (1.15, Feet::Plant), (0.87, Feet::Plant)] {
        let model = with_thighs(thighs);
        let [(off, before), (keep, after)] = off_and_keep(&model, &motion, feet);
        for slot in [Slot::LeftLowerLeg, Slot::RightLowerLeg] {
            for time in [4.8, 5.1, 5.5] {
                let misses = [&off.clip, &keep.clip].map(|clip| miss(&model, clip, &motion, slot, time));
                assert!(misses[1].abs() < misses[0].abs().min(0.01), "{thighs} {feet:?}: {misses:?} at {time} s");
                // Planted feet raise or lower the body already.
                assert!(feet == Feet::Plant || misses[0].abs() > 0.025, "{thighs}: {misses:?} at {time} s");
            }
        }
        let errors = [before, after].map(|figures| figures.contact_error_metres_mean.unwrap());
        assert!(errors[1] < (0.5 * errors[0]).min(0.01), "{thighs} {feet:?}: {errors:?}");
        let toes = place(&model, &keep.clip, Slot::LeftToes, 5.1).y - GROUND;
        assert!(toes.abs() < 0.01 * HEIGHT, "{thighs} {feet:?}: {toes}");
        // It stands as before, and nothing but hips and legs is turned or moved.
        for time in [0.0, 3.8, 6.4, 10.0] {
            let [before, after] = [&off.clip, &keep.clip].map(|clip| place(&model, clip, Slot::Head, time));
            assert!(before.distance(after) < 1e-4, "{thighs} {feet:?}: at {time} s");
        }
        for slot in [Slot::Spine, Slot::Head, Slot::LeftShoulder, Slot::LeftUpperArm, Slot::LeftHand] {
            let joint = model.joint(slot);
            assert!(keys_of(&off.clip, joint) == keys_of(&keep.clip, joint), "{slot:?}");
        }
        let hips = |clip: &Clip, at: i32| place(&model, clip, Slot::Hips, at as f32 / 60.0);
        let moves: Vec<DVec3> = (0..=612).map(|at| hips(&keep.clip, at) - hips(&off.clip, at)).collect();
        let step = moves.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
        assert!(step < 0.01, "{thighs} {feet:?}: {step} m per frame");
    }
}

#[test]
fn a_foot_stays_in_place_beside_a_knee_on_the_ground() {
    let motion = kneeling(ONE_KNEE);
    for (thighs, feet) in [(1.1, Feet::Off), (0.9, Feet::Off), (1.1, Feet::Plant), (0.9, Feet::Plant)] {
        let model = with_thighs(thighs);
        let [(off, _), (keep, _)] = off_and_keep(&model, &motion, feet);
        let misses = [&off.clip, &keep.clip].map(|clip| miss(&model, clip, &motion, Slot::LeftLowerLeg, 5.1));
        assert!(misses[1].abs() < misses[0].abs().min(0.01), "{thighs} {feet:?}: {misses:?}");
        assert!(feet == Feet::Plant || misses[0].abs() > 0.02, "{thighs}: {misses:?}");
        for time in [3.0, 4.3, 4.8, 5.1, 5.5, 5.9, 7.0] {
            for slot in [Slot::RightFoot, Slot::RightToes] {
                let [before, after] = [&off.clip, &keep.clip].map(|clip| place(&model, clip, slot, time));
                assert!(before.distance(after) < 0.002 * HEIGHT, "{thighs} {feet:?}: {before} {after} at {time} s");
            }
        }
    }
}

#[test]
fn hands_stay_on_the_ground_as_hips_move_for_the_knees() {
    let motion = kneeling(ON_ALL_FOURS);
    let model = with_thighs(0.87);
    let [(off, before), (keep, after)] = off_and_keep(&model, &motion, Feet::Off);
    let misses = |slot: Slot| [&off.clip, &keep.clip].map(|clip| miss(&model, clip, &motion, slot, 5.1));
    let (knee, hand) = (misses(Slot::LeftLowerLeg), misses(Slot::LeftHand));
    assert!(knee[0] > 0.025 && knee[1].abs() < 0.01 && hand[1].abs() < 0.01, "{knee:?} {hand:?}");
    let errors = [before, after].map(|figures| figures.contact_error_metres_mean.unwrap());
    assert!(errors[1] < 0.3 * errors[0], "{errors:?}");
}

#[test]
fn nothing_changes_on_a_body_like_the_source_or_without_knees_on_the_ground() {
    for (motion, model, feet) in [
        (kneeling(UPRIGHT), with_thighs(1.0), Feet::Off),
        (kneeling(ONE_KNEE), with_boxes(&Rig { size: 2.5, ..Rig::default() }, 0.1), Feet::Off),
        (walker(0.0), with_thighs(1.15), Feet::Off),
        (walker(0.0), with_thighs(1.15), Feet::Plant),
    ] {
        let [(off, _), (keep, figures)] = off_and_keep(&model, &motion, feet);
        for joint in model.asset.skeleton.joints() {
            assert!(keys_of(&off.clip, joint) == keys_of(&keep.clip, joint), "{feet:?}: {joint:?} {figures:?}");
        }
    }
}
