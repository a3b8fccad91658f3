//! Where the hips face over time, and the rotation laws without the turning that the root options remove.

use std::f64::consts::TAU;

use glam::DQuat;

use super::averaged::{averaged, steps};
use super::root_motion::RootPolicy;
use super::rotation::RotationLaw;
use super::yaw::Yaw;
use super::{Hips, Transfer};
use crate::keys::limits::MAX_TURN;
use crate::keys::resample::{Curve, Resampled, resample, union};
use crate::map::{Pair, RootPart};
use crate::math::yaw_of;
use crate::pose::ancestry;

/// Less turning than this from first to last key is sway and stays with the hips when travel moves to the root joint.
const MIN_EXTRACTED_DEGREES: f64 = 5.0;

/// Hips that turn away from a constant speed by more than this aren't only swaying.
const MAX_SWAY_DEGREES: f64 = 45.0;

/// Returns the law of each pair, with the turning removed that the root options ask for, and the turning that goes to the
/// root joint instead.
pub fn rotation_laws<'a>(transfer: &Transfer<'a>) -> (Vec<RotationLaw<'a>>, Option<Yaw>) {
    let law = |pair: &Pair| RotationLaw::new(transfer, pair.target, transfer.turn(pair));
    let mut laws: Vec<RotationLaw> = transfer.map.pairs.iter().map(law).collect();
    let Some(hips) = transfer.hips else { return (laws, None) };
    let policy = RootPolicy::new(transfer, hips);
    let root_turn = remove_turning(transfer, hips, &policy, &mut laws);
    (laws, root_turn)
}

/// Sets the yaw that the law of the topmost mapped joint takes out. Returns the yaw that goes to the root joint, if any.
fn remove_turning(transfer: &Transfer, hips: &Hips, policy: &RootPolicy, laws: &mut [RotationLaw]) -> Option<Yaw> {
    let root_options = &transfer.map.root;
    if root_options.yaw == RootPart::Keep && policy.extraction_joint.is_none() {
        return None;
    }
    let top = hips.top_pair(transfer.map, transfer.target_skeleton);
    let heading = heading(transfer, hips, top, laws)?;
    let root_turn = match root_options.yaw {
        RootPart::Keep => Some(root_turning(&heading)?),
        RootPart::InPlace | RootPart::Freeze => None,
    };
    let (Yaw { times, radians: headings }, line) = (&heading, turning_line(&heading));
    laws[top].yaw = Some(match (&root_turn, root_options.yaw) {
        (Some(turn), _) => Yaw { times: turn.times.clone(), radians: turn.radians.iter().map(|turn| -turn).collect() },
        (None, RootPart::Freeze) => {
            Yaw { times: times.clone(), radians: headings.iter().map(|heading| headings[0] - heading).collect() }
        }
        (None, _) => Yaw { times: times.clone(), radians: times.iter().map(|&time| -line(time)).collect() },
    });
    root_turn
}

/// The turning from the first to the last key at a constant speed, from where it starts.
fn turning_line(heading: &Yaw) -> impl Fn(f32) -> f64 + use<> {
    let Yaw { times, radians } = heading;
    let (first_secs, last) = (times[0], times.len() - 1);
    let secs = f64::from(times[last] - first_secs);
    let slope = if secs > 0.0 { (radians[last] - radians[0]) / secs } else { 0.0 };
    move |time| slope * f64::from(time - first_secs)
}

/// The turning of a root joint: at a constant speed, or as the hips turn, without their sway, if they stray from that. None if it
/// is too little.
fn root_turning(heading: &Yaw) -> Option<Yaw> {
    let Yaw { times, radians } = heading;
    let (line, last_secs) = (turning_line(heading), times[times.len() - 1]);
    let sway = |(&time, turned): (&f32, &f64)| (turned - radians[0] - line(time)).abs();
    if times.iter().zip(radians).map(sway).fold(0.0, f64::max).to_degrees() > MAX_SWAY_DEGREES {
        let times = steps(times[0], last_secs);
        let turned: Vec<f64> = times.iter().map(|&time| heading.at(time) - radians[0]).collect();
        return Some(Yaw { radians: averaged(&turned), times });
    }
    let is_enough = line(last_secs).to_degrees().abs() > MIN_EXTRACTED_DEGREES;
    is_enough.then(|| Yaw { radians: times.iter().map(|&time| line(time)).collect(), times: times.clone() })
}

/// Yaw of the target's hips away from their aligned rest, before any of it is removed. None without keys.
fn heading(transfer: &Transfer, hips: &Hips, top: usize, laws: &[RotationLaw]) -> Option<Yaw> {
    let Transfer { map, target_skeleton, alignment, .. } = *transfer;
    let joint = map.pairs[hips.pair].target;
    let rest = alignment.target.rotation(joint);
    let value = |time: f32| {
        let model_from_hips = ancestry(target_skeleton, joint).fold(DQuat::IDENTITY, |below, ancestor| {
            let pair = map.pair_index(ancestor);
            let local = pair.map_or(alignment.target.locals[ancestor.get()].rotation, |pair| laws[pair].at(time));
            local * below
        });
        yaw_of(alignment.target.world_from_model * model_from_hips * rest.conjugate())
    };
    let (top_times, top_jumps) = laws[top].times();
    let (hips_times, hips_jumps) = laws[hips.pair].times();
    let (times, jumps) = (union([&top_times[..], &hips_times]), union([&top_jumps[..], &hips_jumps]));
    if times.is_empty() {
        return None;
    }
    let curve = Curve {
        value,
        error: |from: &f64, to: &f64, factor: f64, at: &f64| wrapped(from + factor * wrapped(to - from) - at).abs(),
        tolerance: MAX_TURN,
    };
    let Resampled { times, values: mut radians } = resample(&times, &jumps, curve);
    // Unwrap, so that several turns count as several.
    for at in 1..radians.len() {
        radians[at] = radians[at - 1] + wrapped(radians[at] - radians[at - 1]);
    }
    Some(Yaw { times, radians })
}

/// The equivalent angle from −π to π.
fn wrapped(radians: f64) -> f64 {
    radians - (radians / TAU).round() * TAU
}
