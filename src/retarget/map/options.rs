//! Options of a joint map that name no joint: the file form and the resolved map share them.

use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestChoices {
    pub model: RestChoice,
    pub motion: RestChoice,
}

/// Which pose counts as a skeleton's rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RestChoice {
    #[default]
    Auto,
    /// The nodes' own transforms.
    Node,
    /// The bind pose, for joints that a skin covers.
    Bind,
    /// The first key of the clip.
    FirstFrame,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RootOptions {
    pub horizontal: RootPart,
    pub vertical: RootPart,
    pub yaw: RootPart,
    /// Moves the travel that is kept to the model's root joint.
    pub extract: bool,
}

/// What happens to one component of the root motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RootPart {
    #[default]
    Keep,
    /// Removes the travel (the line from the first to the last key); the sway stays.
    InPlace,
    /// Holds the first key's value.
    Freeze,
}

/// Whether translations or scales of joints other than the hips are carried over.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// Keeps them if the two skeletons are the same.
    #[default]
    Auto,
    Keep,
    Drop,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feet {
    #[default]
    Off,
    /// Keeps feet in place while they touch the ground.
    Plant,
}
