//! The walker's clips: a walk with heel strike, roll-off and toe-off whose feet do not slide on the (moving) ground, a
//! breathing idle, and a wave. Legs use inverse kinematics; everything else is set as angles.

use std::f32::consts::{PI, TAU};

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, JointIndex, Keys, Skeleton};
use glam::{Quat, Vec3};

use super::{EYES_NODE, WalkerError, joint, position};

const FRAMES_PER_SEC: usize = 30;

/// Hips position and the local rotations of all joints.
struct Stance {
    hips: Vec3,
    rotations: [Quat; joint::COUNT],
    eyes_closed: f32,
}

/// A foot: ankle position, in metres from the point on the ground between the feet, and pitch, positive with the toes
/// down.
struct Foot {
    ankle: Vec3,
    pitch: f32,
}

pub fn all(skeleton: &Skeleton) -> Result<Vec<Clip>, WalkerError> {
    Ok(vec![
        record("Walk", skeleton, 32, walk)?,
        record("Idle", skeleton, 120, idle)?,
        record("Wave", skeleton, 84, wave)?,
    ])
}

/// Bakes a function of the clip's phase, 0 to 1, into a clip with a key at every frame. Phases 0 and 1 give the same
/// stance.
fn record(
    name: &str,
    skeleton: &Skeleton,
    frames: usize,
    stance_at: impl Fn(f32) -> Stance,
) -> Result<Clip, WalkerError> {
    let times_secs: Vec<f32> = (0..=frames).map(|frame| frame as f32 / FRAMES_PER_SEC as f32).collect();
    // The last key repeats the first exactly, so that the loop has no seam.
    let stances: Vec<Stance> = (0..=frames).map(|frame| stance_at((frame % frames) as f32 / frames as f32)).collect();
    let mut clip = ClipBuilder::new(name, skeleton);
    let joint_of_source = |source: usize| skeleton.joint_of_source(source).unwrap_or(JointIndex(0));
    let hips = stances.iter().map(|stance| stance.hips).collect();
    clip.channel(joint_of_source(joint::HIPS), Interpolation::Linear, &times_secs, Keys::Translation(hips))?;
    for source in joint::HIPS..joint::COUNT {
        let rotations: Vec<Quat> = stances.iter().map(|stance| stance.rotations[source]).collect();
        if rotations.iter().any(|rotation| rotation.dot(Quat::IDENTITY).abs() < 1.0 - 1e-7) {
            clip.channel(joint_of_source(source), Interpolation::Linear, &times_secs, Keys::Rotation(rotations))?;
        }
    }
    let values = stances.iter().map(|stance| stance.eyes_closed).collect();
    let eyes = Keys::MorphWeights { values, targets: 1 };
    clip.channel(joint_of_source(EYES_NODE), Interpolation::Linear, &times_secs, eyes)?;
    Ok(clip.build())
}

impl Stance {
    /// Upright, arms hanging.
    fn standing() -> Self {
        let mut stance =
            Self { hips: position(joint::HIPS), rotations: [Quat::IDENTITY; joint::COUNT], eyes_closed: 0.0 };
        stance.arm(1.0, 0.0, 0.16, 0.2);
        stance.arm(-1.0, 0.0, 0.16, 0.2);
        stance
    }

    /// `swing` forward, `spread` away from the body, `bend` of the elbow, in radians. Side 1 is left, −1 right.
    fn arm(&mut self, side: f32, swing: f32, spread: f32, bend: f32) {
        let [shoulder, upper, lower, hand] = if side > 0.0 { joint::LEFT_ARM } else { joint::RIGHT_ARM };
        self.rotations[shoulder] = Quat::from_rotation_z(-side * 0.06);
        self.rotations[upper] =
            Quat::from_rotation_x(-swing) * Quat::from_rotation_z(side * (spread + 0.06 - 0.5 * PI));
        self.rotations[lower] = Quat::from_rotation_y(-side * bend);
        self.rotations[hand] = Quat::from_rotation_y(-side * 0.1);
    }

    /// Bends the legs to reach the feet (two-bone inverse kinematics). Set the hips first.
    fn legs(&mut self, feet: [Foot; 2]) {
        for (foot, joints) in feet.into_iter().zip([joint::LEFT_LEG, joint::RIGHT_LEG]) {
            let [upper, lower, ankle, toes] = joints;
            let hips = self.rotations[joint::HIPS];
            let hip_joint = self.hips + hips * (position(upper) - position(joint::HIPS));
            let (thigh, shin) =
                ((position(upper) - position(lower)).length(), (position(lower) - position(ankle)).length());
            let reach = foot.ankle - hip_joint;
            let distance = reach.length().min(0.9995 * (thigh + shin));
            let angle = |opposite: f32, a: f32, b: f32| {
                ((a * a + b * b - opposite * opposite) / (2.0 * a * b)).clamp(-1.0, 1.0).acos()
            };
            let knee = PI - angle(distance, thigh, shin);
            let aim = Quat::from_rotation_arc(Vec3::NEG_Y, reach.normalize_or(Vec3::NEG_Y));
            let world_from_thigh = aim * Quat::from_rotation_x(-angle(shin, thigh, distance));
            let world_from_shin = world_from_thigh * Quat::from_rotation_x(knee);
            self.rotations[upper] = hips.inverse() * world_from_thigh;
            self.rotations[lower] = Quat::from_rotation_x(knee);
            self.rotations[ankle] = world_from_shin.inverse() * Quat::from_rotation_x(foot.pitch);
            // Toes stay flat on the ground while the heel is lifted.
            self.rotations[toes] = Quat::from_rotation_x(-foot.pitch.max(0.0));
        }
    }
}

/// Fraction of the gait cycle in which a foot is on the ground.
const CONTACT: f32 = 0.62;
/// Ground travel under a foot in that time, metres.
const TRAVEL: f32 = 0.56;

/// Foot pitch over the cycle from heel strike to heel strike: (phase, radians, toes down positive).
const ROLL: [(f32, f32); 9] = [
    (0.0, -0.3),
    (0.09, 0.0),
    (0.36, 0.0),
    (0.5, 0.22),
    (0.62, 0.72),
    (0.72, 0.62),
    (0.84, 0.02),
    (0.94, -0.28),
    (1.0, -0.3),
];

/// A foot of the walk, at a phase of its own cycle, which starts at heel strike.
fn walking_foot(side: f32, phase: f32) -> Foot {
    let pitch = keyed(&ROLL, phase);
    let (forward, lift) = if phase < CONTACT {
        (TRAVEL * (0.5 - phase / CONTACT), 0.0)
    } else {
        let swing = (phase - CONTACT) / (1.0 - CONTACT);
        // Hermite: lifts off and lands at the ground's speed.
        let speed = -TRAVEL / CONTACT * (1.0 - CONTACT);
        let (s2, s3) = (swing * swing, swing * swing * swing);
        let forward = -0.5 * TRAVEL * (2.0 * s3 - 3.0 * s2 + 1.0)
            + speed * (s3 - 2.0 * s2 + swing)
            + 0.5 * TRAVEL * (3.0 * s2 - 2.0 * s3)
            + speed * (s3 - s2);
        (forward, 0.035 * (PI * swing).sin().powi(2))
    };
    rolled(side, forward, lift, pitch)
}

/// A foot pitched about its pivot: the heel with the toes up, the toe joint with the toes down.
fn rolled(side: f32, forward: f32, lift: f32, pitch: f32) -> Foot {
    let [ankle, toes] = [joint::LEFT_LEG[2], joint::LEFT_LEG[3]].map(position);
    let flat = Vec3::new(0.075 * side, ankle.y + lift, forward);
    let pivot = if pitch > 0.0 { toes - ankle } else { Vec3::new(0.0, -ankle.y, -0.07) };
    Foot { ankle: flat + pivot - Quat::from_rotation_x(pitch) * pivot, pitch }
}

/// Interpolates between keys with smoothstep.
fn keyed(keys: &[(f32, f32)], at: f32) -> f32 {
    keys.windows(2).find(|pair| at <= pair[1].0).map_or(keys[keys.len() - 1].1, |pair| {
        let share = ((at - pair[0].0) / (pair[1].0 - pair[0].0)).clamp(0.0, 1.0);
        pair[0].1 + (pair[1].1 - pair[0].1) * share * share * (3.0 - 2.0 * share)
    })
}

/// A walk in place. The left heel strikes at phase 0, the right one half a cycle later.
fn walk(phase: f32) -> Stance {
    let mut stance = Stance::standing();
    let (sin, cos) = (TAU * phase).sin_cos();
    // Highest with a leg upright under the body, lowest in double support; shifted over the supporting leg.
    let bob = -(2.0 * TAU * (phase - 0.04)).cos();
    stance.hips += Vec3::new(0.018 * (TAU * (phase - 0.05)).sin(), -0.052 + 0.013 * bob, 0.0);
    let turn = 0.13 * cos;
    stance.rotations[joint::HIPS] =
        Quat::from_rotation_y(-turn) * Quat::from_rotation_z(0.05 * sin) * Quat::from_rotation_x(0.04);
    stance.rotations[joint::SPINE] = Quat::from_rotation_y(0.9 * turn) * Quat::from_rotation_z(-0.04 * sin);
    stance.rotations[joint::CHEST] =
        Quat::from_rotation_y(0.9 * turn) * Quat::from_rotation_z(-0.02 * sin) * Quat::from_rotation_x(0.02);
    stance.rotations[joint::NECK] = Quat::from_rotation_y(-0.4 * turn) * Quat::from_rotation_x(-0.03);
    stance.rotations[joint::HEAD] = Quat::from_rotation_y(-0.4 * turn) * Quat::from_rotation_x(-0.02 + 0.015 * bob);
    for side in [1.0, -1.0] {
        // Arms swing with the opposite leg.
        let swing = -side * (TAU * (phase - 0.02)).cos();
        stance.arm(side, 0.05 + 0.42 * swing, 0.15, 0.32 + 0.2 * swing.max(-0.5));
    }
    stance.legs([walking_foot(1.0, phase), walking_foot(-1.0, (phase + 0.5) % 1.0)]);
    stance.eyes_closed = blink(phase, 0.7, 0.13);
    stance
}

fn idle(phase: f32) -> Stance {
    let mut stance = Stance::standing();
    stand(&mut stance, phase);
    let look = keyed(
        &[(0.0, 0.0), (0.3, 0.0), (0.4, 0.42), (0.52, 0.42), (0.66, -0.3), (0.78, -0.3), (0.9, 0.0), (1.0, 0.0)],
        phase,
    );
    stance.rotations[joint::NECK] = Quat::from_rotation_y(0.4 * look);
    stance.rotations[joint::HEAD] =
        Quat::from_rotation_y(0.6 * look) * Quat::from_rotation_x(0.02 * (2.0 * TAU * phase).sin());
    stance.eyes_closed = blink(phase, 0.33, 0.04) + blink(phase, 0.62, 0.04) + blink(phase, 0.68, 0.04);
    stance
}

/// Two breaths while the weight shifts from leg to leg, feet planted.
fn stand(stance: &mut Stance, phase: f32) {
    let (sway, breath) = ((TAU * phase).sin(), (2.0 * TAU * phase).sin());
    stance.hips += Vec3::new(0.022 * sway, -0.022 + 0.004 * breath, 0.0);
    stance.rotations[joint::HIPS] = Quat::from_rotation_z(-0.025 * sway) * Quat::from_rotation_y(0.03 * sway);
    stance.rotations[joint::SPINE] = Quat::from_rotation_z(0.02 * sway) * Quat::from_rotation_x(0.012 * breath);
    stance.rotations[joint::CHEST] = Quat::from_rotation_z(0.015 * sway) * Quat::from_rotation_x(-0.025 * breath);
    for side in [1.0, -1.0] {
        stance.arm(side, 0.06 + 0.02 * sway * side, 0.17 + 0.015 * breath, 0.26 + 0.02 * breath);
    }
    stance.legs([rolled(1.35, 0.015, 0.0, 0.0), rolled(-1.35, -0.015, 0.0, 0.0)]);
}

fn wave(phase: f32) -> Stance {
    let mut stance = Stance::standing();
    stand(&mut stance, phase);
    let raised = keyed(&[(0.0, 0.0), (0.06, 0.0), (0.24, 1.0), (0.8, 1.0), (0.98, 0.0), (1.0, 0.0)], phase);
    let beat = raised * (TAU * 4.0 * (phase - 0.24) / 0.56).sin() * f32::from(u8::from((0.24..=0.8).contains(&phase)));
    let [shoulder, upper, lower, hand] = joint::RIGHT_ARM;
    let hanging = [shoulder, upper, lower, hand].map(|joint| stance.rotations[joint]);
    // The right arm points along −X: a negative rotation about Z raises it, then the forearm is rotated upright.
    let lifted = [
        Quat::from_rotation_z(-0.2),
        Quat::from_rotation_z(-0.12) * Quat::from_rotation_y(0.25),
        Quat::from_rotation_z(-1.25 + 0.3 * beat) * Quat::from_rotation_x(0.2),
        Quat::from_rotation_z(0.18 * beat),
    ];
    for (index, joint) in [shoulder, upper, lower, hand].into_iter().enumerate() {
        stance.rotations[joint] = hanging[index].slerp(lifted[index], raised);
    }
    stance.rotations[joint::CHEST] *= Quat::from_rotation_z(0.07 * raised + 0.012 * beat);
    stance.rotations[joint::HEAD] = Quat::from_rotation_z(-0.12 * raised) * Quat::from_rotation_y(-0.1 * raised);
    stance.eyes_closed =
        0.35 * keyed(&[(0.0, 0.0), (0.28, 0.0), (0.36, 1.0), (0.7, 1.0), (0.78, 0.0), (1.0, 0.0)], phase);
    stance
}

/// Closed at phase `at`; the whole blink takes `length`.
fn blink(phase: f32, at: f32, length: f32) -> f32 {
    (1.0 - (phase - at).abs() / (0.5 * length)).clamp(0.0, 1.0)
}
