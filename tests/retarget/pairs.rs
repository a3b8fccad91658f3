//! Every pair of real characters and motions, retargeted by the proposed map.

use crate::data_folder::data_folder;
use crate::pairs_of_people::{borrow, load_people};

#[test]
fn every_real_pair_keeps_orientations_and_directions() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let mut pairs = 0;
    let mut problems = Vec::new();
    for model in people.iter().filter(|model| model.person.has_mesh) {
        for motion in people.iter().filter(|motion| motion.clip.is_some() && !std::ptr::eq(model, *motion)) {
            pairs += 1;
            let outcome = match borrow(model, motion, false) {
                Ok(outcome) => outcome,
                Err(error) => {
                    problems.push(format!("{} ← {}: {error}", model.name, motion.name));
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
                problems.push(format!("{} ← {}: {figures:?}", model.name, motion.name));
            }
        }
    }
    assert_eq!(problems, Vec::<String>::new());
    assert!(pairs > 500, "{pairs}");
}
