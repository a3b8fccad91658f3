//! Every pair of real characters and motions, retargeted by the proposed map.

use std::collections::BTreeMap;

use crate::data_folder::data_folder;
use crate::pairs_of_people::{COLUMNS, Outcome, borrow, each_pair, load_people};

#[test]
fn every_real_pair_keeps_orientations_and_directions() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
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
        let figures = outcome.figures;
        let at_least = |value: Option<f64>, min: f64| value.is_some_and(|value| value >= min);
        let below = |value: Option<f64>, max: f64| value.is_some_and(|value| value < max);
        if !(at_least(figures.coverage, 0.9)
            && below(figures.orientation_error_degrees_mean, 0.5)
            && below(figures.limb_direction_error_degrees_mean, 4.0))
        {
            problems.push(format!("{name:?}: {figures:?}"));
        }
        match recorded.get(&name) {
            Some(cells) => problems.extend(changes(&outcome, cells).map(|change| format!("{name:?}: {change}"))),
            None => problems.push(format!("{name:?} is not in docs/retargeting-pairs.tsv")),
        }
    }
    assert_eq!(problems, Vec::<String>::new());
    assert!(pairs > 500, "{pairs}");
    assert_eq!(recorded.len(), pairs, "docs/retargeting-pairs.tsv has other pairs");
}

/// The cells of each pair in the published table.
fn recorded() -> BTreeMap<(&'static str, &'static str), Vec<&'static str>> {
    let mut lines = include_str!("../../docs/retargeting-pairs.tsv").lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    assert_eq!(header, [&["model", "motion"], &COLUMNS.map(|(name, _)| name)[..]].concat());
    let row = |line: &'static str| {
        let mut cells = line.split('\t');
        ((cells.next().unwrap_or_default(), cells.next().unwrap_or_default()), cells.collect())
    };
    lines.map(row).collect()
}

/// Where the published figures are no longer true. The planted slide is left out: measuring it would double the time.
fn changes<'a>(outcome: &'a Outcome, cells: &'a [&str]) -> impl Iterator<Item = String> + 'a {
    let columns = COLUMNS.into_iter().zip(outcome.values()).zip(cells);
    columns.filter(|(((name, _), _), _)| *name != "foot_slide_planted_m_per_s").filter_map(
        |(((name, digits), value), cell)| {
            // The last digit may be rounded the other way on another machine.
            let tolerance = 1.01 * 10.0_f64.powi(-(digits as i32));
            let is_same = match (value, cell.parse::<f64>().ok()) {
                (Some(value), Some(published)) => (value - published).abs() < tolerance,
                (value, published) => value.is_none() && published.is_none(),
            };
            (!is_same).then(|| format!("{name} is {value:?}, docs/retargeting-pairs.tsv has {cell:?}"))
        },
    )
}
