//! Retargeting without a GPU: laws checked on figures made in code, and real pairs of files.

#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
mod people;
#[path = "../../../../tests/support/random.rs"]
mod random;
#[path = "../../../../tests/support/random_vectors.rs"]
mod random_vectors;
#[path = "../../../../tests/support/real.rs"]
mod real;
#[path = "../../../../tests/support/skeletons.rs"]
mod skeletons;

mod carriers;
mod chains;
mod change;
mod changed_people;
mod contact_table;
mod contacts;
mod coursework;
mod endless;
mod facings;
mod faults;
mod feet;
mod figure;
mod hold;
mod knees;
mod laws;
mod layers;
mod pairs;
mod pins;
mod reflections;
mod rests;
mod soles;
mod stack;
mod surface;
mod travel;
mod up;
mod verdicts;
mod whole_rests;
mod written;
