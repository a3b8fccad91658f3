//! Tests of `anim` and `mesh`, and of the layers: no files, GPU or user interface. One module per capability.

mod allocation;
mod bounds;
mod build;
mod clip;
mod layer;
mod layering;
mod lobes;
mod morph;
mod playback;
mod pose;
mod properties;
mod skeleton;
#[path = "../support/skeletons.rs"]
mod skeletons;
mod skin;
mod skinning;

#[path = "../support/allocations.rs"]
mod allocations;
#[path = "../support/random.rs"]
mod random;
#[path = "../support/random_vectors.rs"]
mod random_vectors;
#[path = "../support/skinning_cases.rs"]
mod skinning_cases;
