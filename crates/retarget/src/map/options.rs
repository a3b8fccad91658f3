//! Options of a joint map that name no joint: the file form and the resolved map share them.

use serde::{Deserialize, Serialize};

/// Which poses count as the rests that motion is measured from, rotations and translations alike.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestChoices {
    /// The model's.
    pub model: RestChoice,
    /// The motion's.
    pub motion: RestChoice,
    /// Which way is up in the motion.
    #[serde(skip_serializing_if = "UpChoice::is_auto")]
    pub up: UpChoice,
}

/// Which axis is up in a motion's data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpChoice {
    /// The one that the motion's rest stands along; another one if the clip stands along that, with its feet on the ground.
    #[default]
    Auto,
    /// Y, as in glTF.
    Y,
    /// Z, as in AMASS and Blender.
    Z,
}

impl UpChoice {
    /// All choices in display order.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Y, Self::Z];

    /// Whether maps may leave the option out.
    pub fn is_auto(&self) -> bool {
        *self == Self::Auto
    }
}

/// Which pose counts as a skeleton's rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RestChoice {
    /// The bind pose where a skin covers a joint, the node's transform elsewhere and for a declared humanoid. For a motion of the
    /// model's own rig, the model's rest; for one whose own rest is not upright and symmetric, the pose of its clip that comes
    /// closest.
    #[default]
    Auto,
    /// The nodes' own transforms.
    Node,
    /// The bind pose, for joints that a skin covers.
    Bind,
    /// The first key of the clip.
    FirstFrame,
}

impl RestChoice {
    /// All choices in display order.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Node, Self::Bind, Self::FirstFrame];
}

/// What happens to the travel and turning of the hips.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RootOptions {
    /// Position of the hips on the ground plane.
    pub horizontal: RootPart,
    /// Height of the hips.
    pub vertical: RootPart,
    /// Heading: rotation of the hips about the vertical.
    pub yaw: RootPart,
    /// Moves the horizontal travel and the turning that are kept from the hips to their parent. No effect if they have
    /// no parent or it has a source.
    pub extract: bool,
    /// Where the path of the hips lies on the ground plane.
    pub origin: PathOrigin,
}

/// How the path of the hips is placed on the ground plane, before [`RootPart`] applies.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathOrigin {
    /// The hips of the source at rest correspond to those of the target at rest.
    #[default]
    Rest,
    /// The midpoint of the target's feet, as they stand at rest, is where the source's is, scaled about the origin. The same as
    /// `Rest` unless both skeletons have two feet below upper legs.
    Feet,
}

/// What happens to one component of the root motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RootPart {
    /// Leaves it unchanged.
    #[default]
    Keep,
    /// Removes the travel (the line from the first to the last key); the sway stays.
    InPlace,
    /// Holds the first key's value.
    Freeze,
}

/// Whether translations (of joints other than the hips) or scales (of all mapped joints) are carried over.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// Keeps them if the two skeletons are the same.
    #[default]
    Auto,
    /// Carries them over, converted to the target's rest and size.
    Keep,
    /// Leaves them out.
    Drop,
}

/// What happens to contacts of hands with the body and of hands and knees with the ground after retargeting.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contacts {
    /// Leaves them where the retargeted rotations put them.
    #[default]
    Off,
    /// Keeps hands where the source's touch its body or rest on the ground, knees where they rest there, and arms out of both.
    Keep,
}

impl Contacts {
    /// Whether maps may leave the option out.
    pub fn is_off(&self) -> bool {
        *self == Self::Off
    }
}

/// What happens to joints that bend or turn as one and don't follow the motion's one to one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Chains {
    /// Joints without a source rest; the next mapped joint takes their turn.
    #[default]
    Off,
    /// Spines, necks and fingers of different numbers of joints share the bend by length, twist joints take their share of a limb's
    /// turn about its axis, and helpers beside the body follow hands and feet.
    Share,
}

impl Chains {
    /// Whether maps may leave the option out.
    pub fn is_off(&self) -> bool {
        *self == Self::Off
    }
}

/// What happens to the feet after retargeting.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feet {
    /// Leaves them where the retargeted rotations put them.
    #[default]
    Off,
    /// Keeps feet in place while they touch the ground.
    Plant,
}
