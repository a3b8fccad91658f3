//! Tests of `anim` and `mesh`. One module per capability.

mod allocation;
mod bounds;
mod build;
mod clip;
mod layer;
mod lobes;
mod morph;
mod playback;
mod pose;
mod properties;
mod skeleton;
#[path = "../../../../tests/support/skeletons.rs"]
mod skeletons;
mod skin;
mod skinning;

#[path = "../../../../tests/support/allocations.rs"]
mod allocations;
#[path = "../../../../tests/support/random.rs"]
mod random;
#[path = "../../../../tests/support/random_vectors.rs"]
mod random_vectors;
#[path = "../../../../tests/support/skinning_cases.rs"]
mod skinning_cases;
