//! Works around a bug of ufbx 0.23.1: where a node inherits the scales of several ancestors component by component, it takes a
//! scale that the file leaves out, because it is 1, for 0.

use ufbx::{Anim, MirrorAxis, Node, Transform, Vec3};

const LCL_SCALING: &str = "Lcl Scaling";
const LCL_TRANSLATION: &str = "Lcl Translation";
/// `UFBX_TRANSFORM_FLAG_IGNORE_COMPONENTWISE_SCALE`.
const IGNORE_COMPONENTWISE_SCALE: u32 = 0x2;

const ONE: Vec3 = Vec3 { x: 1.0, y: 1.0, z: 1.0 };

/// Evaluates a node's transform like `ufbx::evaluate_transform_flags`.
pub fn transform(anim: &Anim, node: &Node, time: f64, flags: u32) -> Transform {
    let Some(parent) = node.parent.as_deref().filter(|parent| helpers(parent).any(|helper| !has_scale(helper))) else {
        return ufbx::evaluate_transform_flags(anim, node, time, flags);
    };
    let factor = helpers(parent).fold(ONE, |factor, helper| product(factor, scale(anim, helper, time)));
    let mut transform = ufbx::evaluate_transform_flags(anim, node, time, flags | IGNORE_COMPONENTWISE_SCALE);
    if node.is_scale_helper {
        transform.scale = product(transform.scale, factor);
    } else if let Some(helper) = &parent.scale_helper {
        // The scale multiplies the node's own translation only, not what its pivots add.
        let own = ufbx::evaluate_prop(anim, &node.element, LCL_TRANSLATION, time).value_vec4;
        let own = product(Vec3 { x: own.x, y: own.y, z: own.z }, scale(anim, helper, time));
        let unit = node.adjust_translation_scale;
        let mirror = if node.adjust_mirror_axis == MirrorAxis::X { -1.0 } else { 1.0 };
        transform.translation.x += mirror * unit * own.x * (factor.x - 1.0);
        transform.translation.y += unit * own.y * (factor.y - 1.0);
        transform.translation.z += unit * own.z * (factor.z - 1.0);
    }
    transform
}

/// Iterates over the helper nodes that hold the scales which a node inherits.
fn helpers(node: &Node) -> impl Iterator<Item = &Node> {
    let ancestors =
        std::iter::successors(node.inherit_scale_node.as_deref(), |node| node.inherit_scale_node.as_deref());
    ancestors.map_while(|ancestor| ancestor.scale_helper.as_deref())
}

fn has_scale(helper: &Node) -> bool {
    ufbx::find_prop(&helper.element.props, LCL_SCALING).is_some()
}

/// Returns the scale that a helper node holds.
fn scale(anim: &Anim, helper: &Node, time: f64) -> Vec3 {
    if !has_scale(helper) {
        return ONE;
    }
    let scale = ufbx::evaluate_prop(anim, &helper.element, LCL_SCALING, time).value_vec4;
    Vec3 { x: scale.x, y: scale.y, z: scale.z }
}

fn product(a: Vec3, b: Vec3) -> Vec3 {
    Vec3 { x: a.x * b.x, y: a.y * b.y, z: a.z * b.z }
}
