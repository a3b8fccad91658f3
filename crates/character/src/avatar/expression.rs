//! Facial expressions: weights of morph targets, colours and texture transforms under one name (`VRMC_vrm-1.0`,
//! expressions.md; `blendShapeMaster` of VRM 0.x).

use glam::Vec4;

use crate::anim::{Pose, PropertyTarget, PropertyValues};

/// A named expression, with a weight from 0 to 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Expression {
    /// A preset's name in VRM 1.0, otherwise the file's name. Unique within the avatar.
    pub name: String,
    /// The file's name, which differs from `name` for presets of VRM 0.x.
    pub title: String,
    /// Whether VRM defines the name.
    pub is_preset: bool,
    /// The group that other expressions can override.
    pub group: Option<ExpressionGroup>,
    /// Weights above 0.5 count as 1, all others as 0.
    pub is_binary: bool,
    /// How it overrides the expressions of each [`ExpressionGroup`], in declaration order.
    pub overrides: [Override; 3],
    /// Morph targets and their weights.
    pub morphs: Vec<MorphBind>,
    /// Colours and texture transforms.
    pub materials: Vec<MaterialBind>,
}

/// Expressions that applications drive automatically and that others may have to suppress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExpressionGroup {
    /// `blink`, `blinkLeft`, `blinkRight`.
    Blink,
    /// `lookUp`, `lookDown`, `lookLeft`, `lookRight`.
    LookAt,
    /// `aa`, `ih`, `ou`, `ee`, `oh`.
    Mouth,
}

/// How an expression overrides those of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Override {
    /// Not at all.
    #[default]
    None,
    /// Turns them off while its own weight is above 0.
    Block,
    /// Fades them out by its own weight.
    Blend,
}

/// A morph target in an expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MorphBind {
    /// Index into [`Pose::morph_weights`].
    pub index: usize,
    /// Added at an expression weight of 1.
    pub weight: f32,
}

/// A property of a material in an expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialBind {
    /// Always a [`PropertyTarget::Material`].
    pub target: PropertyTarget,
    /// The material's own value.
    pub rest: Vec4,
    /// Added at an expression weight of 1.
    pub delta: Vec4,
}

impl Expression {
    /// VRM 1.0's preset names.
    pub const PRESETS: [&'static str; 18] = [
        "happy",
        "angry",
        "sad",
        "relaxed",
        "surprised",
        "aa",
        "ih",
        "ou",
        "ee",
        "oh",
        "blink",
        "blinkLeft",
        "blinkRight",
        "lookUp",
        "lookDown",
        "lookLeft",
        "lookRight",
        "neutral",
    ];

    /// Returns an expression without effect. A preset's name determines the group.
    pub fn new(name: &str, title: &str, is_preset: bool) -> Self {
        let group = match name {
            _ if !is_preset => None,
            "blink" | "blinkLeft" | "blinkRight" => Some(ExpressionGroup::Blink),
            "lookUp" | "lookDown" | "lookLeft" | "lookRight" => Some(ExpressionGroup::LookAt),
            "aa" | "ih" | "ou" | "ee" | "oh" => Some(ExpressionGroup::Mouth),
            _ => None,
        };
        Self { name: name.to_owned(), title: title.to_owned(), is_preset, group, ..Self::default() }
    }

    /// Whether it can change anything.
    pub fn has_effect(&self) -> bool {
        !self.morphs.is_empty() || !self.materials.is_empty() || self.overrides != [Override::None; 3]
    }
}

/// Replaces requested weights with the ones to display: rounds those of binary expressions, then applies overrides. A
/// partly overridden binary expression is off.
pub fn resolve_weights(expressions: &[Expression], weights: &mut [f32]) {
    let mut factors = [1.0_f32; 3];
    for (expression, weight) in expressions.iter().zip(weights.iter_mut()) {
        *weight = match expression.is_binary {
            true => f32::from(*weight > 0.5),
            false => weight.clamp(0.0, 1.0),
        };
        // An expression can't override its own group (VRMC_vrm, “Override”).
        let own = expression.group.map(|group| group as usize);
        let others = factors.iter_mut().zip(expression.overrides).enumerate().filter(|(group, _)| Some(*group) != own);
        for (_, (factor, mode)) in others {
            *factor -= match mode {
                Override::None => 0.0,
                Override::Block => f32::from(*weight > 0.0),
                Override::Blend => *weight,
            };
        }
    }
    for (expression, weight) in expressions.iter().zip(weights.iter_mut()) {
        let Some(group) = expression.group else { continue };
        *weight *= factors[group as usize].max(0.0);
        if expression.is_binary && *weight < 1.0 {
            *weight = 0.0;
        }
    }
}

/// Adds expressions to a pose and to animated properties. `weights` come from [`resolve_weights`].
pub fn apply_expressions(
    expressions: &[Expression],
    weights: &[f32],
    pose: &mut Pose,
    properties: &mut PropertyValues,
) {
    for (expression, &weight) in expressions.iter().zip(weights).filter(|&(_, &weight)| weight != 0.0) {
        for bind in &expression.morphs {
            if let Some(sum) = pose.morph_weights.get_mut(bind.index) {
                *sum += bind.weight * weight;
            }
        }
        for bind in &expression.materials {
            properties.add(bind.target, bind.rest, bind.delta * weight);
        }
    }
}
