//! Tests of the core: no files of a person, no GPU, no user interface. Each module checks one capability.

mod allocation;
mod bounds;
mod build;
mod clip;
mod layering;
mod morph;
mod playback;
mod pose;
mod skeleton;
mod skin;
mod skinning;

#[path = "../support/skinning_cases.rs"]
mod skinning_cases;
