//! Retargets every motion of the test data to every character and prints the quality figures, one pair per line:
//!
//! `cargo run --release --no-default-features --example pairs > docs/retargeting-pairs.tsv`
//!
//! Reads the files in `$GAITWAY_DATA`, or in `../shared/data`.

#[path = "../tests/support/data_folder.rs"]
mod data_folder;
#[path = "../tests/support/pairs.rs"]
mod pairs;

use pairs::{COLUMNS, borrow, each_pair, load_people};

fn main() {
    let Some(folder) = data_folder::data_folder() else { return };
    let people = load_people(&folder);
    println!("model\tmotion\t{}", COLUMNS.map(|(name, _)| name).join("\t"));
    for (model, motion) in each_pair(&people) {
        match borrow(model, motion, true) {
            Ok(outcome) => println!("{}\t{}\t{}", model.name, motion.name, outcome.cells().join("\t")),
            Err(error) => eprintln!("{} ← {}: {error}", model.name, motion.name),
        }
    }
}
