//! Every pair of real characters and motions, retargeted by the proposed map. `UPDATE_PAIRS=1` rewrites
//! the published table, docs/retargeting-pairs.tsv.

use std::collections::BTreeMap;
use std::path::Path;

use gaitway_character::asset::Slot;
use gaitway_retarget::FitWarning;
use glam::{Mat4, Vec4};

use crate::data_folder::data_folder;
use crate::people::{
    COLUMNS, Loaded, Outcome, borrow, crossed_share, each_pair, largest_excess_turn, load_people, measured, planted,
    proposed,
};

#[test]
fn every_real_pair_keeps_orientations_and_directions() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    if std::env::var_os("UPDATE_PAIRS").is_some() {
        update(&people);
        return;
    }
    let recorded = recorded();
    let mut pairs = 0;
    let mut problems = Vec::new();
    for (model, motion) in each_pair(&people) {
        pairs += 1;
        let name = (model.name, motion.name);
        let outcome = match borrow(model, motion, false) {
            Ok(outcome) => outcome,
            Err(error) => {
                problems.push(format!("{name:?}: {error}"));
                continue;
            }
        };
        let figures = &outcome.figures;
        let at_least = |value: Option<f64>, min: f64| value.is_some_and(|value| value >= min);
        let below = |value: Option<f64>, max: f64| value.is_some_and(|value| value < max);
        if !(at_least(figures.coverage, 0.85)
            && below(figures.orientation_error_degrees_mean, 0.5)
            && below(figures.limb_direction_error_degrees_mean, 4.0))
        {
            problems.push(format!("{name:?}: {figures:?}"));
        }
        problems.extend(FitWarning::of(figures).iter().map(|warning| format!("{name:?}: {warning}")));
        match recorded.get(&name) {
            Some(cells) => problems.extend(changes(&outcome, cells).map(|change| format!("{name:?}: {change}"))),
            None => problems.push(format!("{name:?} is not in docs/retargeting-pairs.tsv")),
        }
    }
    assert_eq!(problems, Vec::<String>::new());
    assert!(pairs > 500, "{pairs}");
    assert_eq!(recorded.len(), pairs, "docs/retargeting-pairs.tsv has other pairs");
}

/// How far soles may be off the ground while they are planted, as shares of the distance from hips to foot: in any pair, and on
/// average.
const MAX_HOVER: f64 = 0.06;
const MAX_MEAN_HOVER: f64 = 0.002;

/// How deep a planted sole may go into the ground at any time, as a share of the same distance: in any pair (a leg that would have
/// to turn too far or too fast lets its foot sink) and on average.
const MAX_DEPTH: f64 = 0.19;
const MAX_MEAN_DEPTH: f64 = 0.012;

/// How far limbs may point apart from their source's while feet are planted, in degrees: on average, and in any pair at any time.
/// The body moves along with its feet, so that legs need not bend.
const MAX_MEAN_DIRECTION_ERROR: f64 = 1.7;
const MAX_DIRECTION_ERROR: f64 = 31.0;

/// Planting holds feet, but never at the price of a leg that snaps.
#[test]
fn every_planted_leg_turns_like_its_source_and_stands_on_the_ground() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let recorded = recorded();
    let mut problems = Vec::new();
    let (mut hovers, mut depths, mut crossed) = (Vec::new(), Vec::new(), Vec::new());
    let mut direction_errors = Vec::new();
    for (model, motion) in each_pair(&people) {
        let name = (model.name, motion.name);
        let map = planted(proposed(model, motion).unwrap());
        let (figures, made) = measured(model, motion, &map).unwrap();
        let clips = [&made.clip, &motion.asset.clips[motion.clip.unwrap()]];
        let excess = largest_excess_turn([&model.asset, &motion.asset], clips, &map, &model.slots);
        if excess > 5.0 {
            problems.push(format!("{name:?}: a leg turns {excess}° a frame further than its source"));
        }
        let published = [
            ("foot_slide_planted_m_per_s", figures.foot_slide_metres_per_sec),
            ("foot_hover_planted_m", figures.foot_hover_metres_mean),
            ("sole_penetration_planted_max_m", figures.sole_penetration_metres_max),
        ];
        for (column, value) in published {
            let at = COLUMNS.iter().position(|(name, _)| *name == column).unwrap();
            problems
                .extend(change(COLUMNS[at], value, recorded[&name][at]).map(|change| format!("{name:?}: {change}")));
        }
        direction_errors.extend(figures.limb_direction_error_degrees_mean);
        if figures.limb_direction_error_degrees_max.is_some_and(|error| error > MAX_DIRECTION_ERROR) {
            problems.push(format!("{name:?}: planting bends a limb: {figures:?}"));
        }
        let height = hips_height(model);
        if let Some(hover) = figures.foot_hover_metres_mean.map(|hover| hover.abs() / height) {
            hovers.push(hover);
            if hover > MAX_HOVER {
                problems.push(format!("{name:?}: soles are {hover} of the hips' height off the ground"));
            }
        }
        if let Some(depth) = figures.sole_penetration_metres_max.map(|depth| depth / height) {
            depths.push(depth);
            if depth > MAX_DEPTH {
                problems.push(format!("{name:?}: a sole is {depth} of the hips' height in the ground"));
            }
        }
        let clips = [made.unplanted.as_ref().unwrap(), &made.clip];
        let shares = clips.map(|clip| crossed_share(&model.asset.skeleton, clip, &model.slots));
        let source = crossed_share(&motion.asset.skeleton, &motion.asset.clips[motion.clip.unwrap()], &motion.slots);
        if let ([Some(unplanted), Some(planted)], Some(source)) = (shares, source) {
            crossed.push([source, unplanted, planted]);
        }
    }
    assert_eq!(problems, Vec::<String>::new());
    assert!(hovers.len() > 500, "{}", hovers.len());
    let hover = mean(&hovers);
    assert!(hover < MAX_MEAN_HOVER, "{hover} of the hips' height on average");
    let depth = mean(&depths);
    assert!(depth < MAX_MEAN_DEPTH, "{depth} of the hips' height on average");
    let error = mean(&direction_errors);
    assert!(error < MAX_MEAN_DIRECTION_ERROR, "{error}° on average");
    // Hips of other proportions make legs cross; planted feet do so no more often than the sources'.
    let [source, unplanted, planted] =
        [0, 1, 2].map(|side| mean(&crossed.iter().map(|shares| shares[side]).collect::<Vec<f64>>()));
    assert!(planted <= source && planted < unplanted, "{source}, unplanted {unplanted}, planted {planted}");
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Distance from the hips to a foot at rest. Models come in metres and in centimetres.
fn hips_height(model: &Loaded) -> f64 {
    let skeleton = &model.asset.skeleton;
    let mut model_from_joint: Vec<Mat4> = Vec::new();
    for (local, parent) in skeleton.rest().locals().zip(skeleton.parents()) {
        let parent = parent.map_or(Mat4::IDENTITY, |parent| model_from_joint[parent.get()]);
        let local = Mat4::from_scale_rotation_translation(local.scale, local.rotation, local.translation);
        model_from_joint.push(parent * local);
    }
    let [hips, foot] = [Slot::Hips, Slot::LeftFoot]
        .map(|slot| model.slots.joint(slot).map_or(Vec4::ZERO, |joint| model_from_joint[joint.get()].w_axis));
    f64::from((hips - foot).length())
}

/// Writes the table that [`recorded`] reads, which takes minutes in a release build.
fn update(people: &[Loaded]) {
    let mut table = format!("model\tmotion\t{}\n", COLUMNS.map(|(name, _)| name).join("\t"));
    for (model, motion) in each_pair(people) {
        let outcome = borrow(model, motion, true).unwrap_or_else(|e| panic!("{} ← {}: {e}", model.name, motion.name));
        table += &format!("{}\t{}\t{}\n", model.name, motion.name, outcome.cells().join("\t"));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/retargeting-pairs.tsv");
    std::fs::write(path, table).expect("the table can be written");
}

/// The cells of each pair in the published table.
fn recorded() -> BTreeMap<(&'static str, &'static str), Vec<&'static str>> {
    let mut lines = include_str!("../../../../docs/retargeting-pairs.tsv").lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    assert_eq!(header, [&["model", "motion"], &COLUMNS.map(|(name, _)| name)[..]].concat());
    let row = |line: &'static str| {
        let mut cells = line.split('\t');
        ((cells.next().unwrap_or_default(), cells.next().unwrap_or_default()), cells.collect())
    };
    lines.map(row).collect()
}

/// Published figures that are out of date. Those of planted feet have their own test.
fn changes<'a>(outcome: &'a Outcome, cells: &'a [&str]) -> impl Iterator<Item = String> + 'a {
    let columns = COLUMNS.into_iter().zip(outcome.values()).zip(cells);
    let unplanted = columns.filter(|(((name, _), _), _)| !name.contains("_planted_"));
    unplanted.filter_map(|((column, value), cell)| change(column, value, cell))
}

fn change((name, digits): (&str, usize), value: Option<f64>, cell: &str) -> Option<String> {
    // The last digit may be rounded the other way on another machine.
    let tolerance = 1.01 * 10.0_f64.powi(-(digits as i32));
    let is_same = match (value, cell.parse::<f64>().ok()) {
        (Some(value), Some(published)) => (value - published).abs() < tolerance,
        (value, published) => value.is_none() && published.is_none(),
    };
    (!is_same).then(|| format!("{name} is {value:?}, docs/retargeting-pairs.tsv has {cell:?}"))
}
