//! Lets every real character borrow every real motion and prints the figures as a table: `docs/retargeting.md` holds its
//! output. Reads the files of `$GAITWAY_DATA`, or of `../shared/data`.

#[path = "../tests/support/data_folder.rs"]
mod data_folder;
#[path = "../tests/support/pairs.rs"]
mod pairs;

use pairs::{borrow, load_people};

fn main() {
    let Some(folder) = data_folder::data_folder() else { return };
    let people = load_people(&folder);
    println!(
        "| model | motion | joints | coverage | hips scale | orientation error, ° (max) | limb direction error, ° (max) | foot slide, m/s (source) | planted | below ground, m |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for model in people.iter().filter(|model| model.person.has_mesh) {
        for motion in people.iter().filter(|motion| motion.clip.is_some()) {
            if std::ptr::eq(model, motion) {
                continue;
            }
            match borrow(model, motion, true) {
                Ok(outcome) => {
                    let figure = |value: Option<f64>, digits: usize| {
                        value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
                    };
                    let figures = outcome.figures;
                    println!(
                        "| {} | {} | {} | {} | {} | {} ({}) | {} ({}) | {} ({}) | {} | {} |",
                        model.name,
                        motion.name,
                        outcome.mapped,
                        figure(figures.coverage, 2),
                        figure(outcome.hips_scale, 3),
                        figure(figures.orientation_error_degrees_mean, 3),
                        figure(figures.orientation_error_degrees_max, 2),
                        figure(figures.limb_direction_error_degrees_mean, 2),
                        figure(figures.limb_direction_error_degrees_max, 1),
                        figure(figures.foot_slide_metres_per_sec, 3),
                        figure(figures.foot_slide_source_metres_per_sec, 3),
                        figure(outcome.planted.and_then(|planted| planted.foot_slide_metres_per_sec), 3),
                        figure(figures.ground_penetration_metres_max, 3),
                    );
                }
                Err(error) => println!("| {} | {} | {error} | | | | | | | |", model.name, motion.name),
            }
        }
    }
}
