//! `expressions` of VRM 1.0, `blendShapeMaster` of 0.x, and the names of animated expressions in a .vrma.

use glam::Vec4;
use serde_json::Value;

use super::{Read, Reader, index, list, number, text};
use crate::anim::{JointIndex, MaterialProperty, PropertyTarget, TextureSlot};
use crate::avatar::{Expression, MaterialBind, MorphBind, Override};

/// Further expressions, and further parts of one, are left out.
const MAX_EXPRESSIONS: usize = 1024;
const MAX_BINDS: usize = 4096;

const TEXTURES: [TextureSlot; 5] = [
    TextureSlot::BaseColor,
    TextureSlot::MetallicRoughness,
    TextureSlot::Normal,
    TextureSlot::Occlusion,
    TextureSlot::Emissive,
];

/// VRM 0.x's preset names and those of 1.0.
const PRESETS_0: [(&str, &str); 18] = [
    ("neutral", "neutral"),
    ("a", "aa"),
    ("i", "ih"),
    ("u", "ou"),
    ("e", "ee"),
    ("o", "oh"),
    ("blink", "blink"),
    ("joy", "happy"),
    ("angry", "angry"),
    ("sorrow", "sad"),
    ("fun", "relaxed"),
    ("lookup", "lookUp"),
    ("lookdown", "lookDown"),
    ("lookleft", "lookLeft"),
    ("lookright", "lookRight"),
    ("blink_l", "blinkLeft"),
    ("blink_r", "blinkRight"),
    ("surprised", "surprised"),
];

/// Calls `add` with place, name, whether it is a preset, and definition of each entry of `expressions`.
fn each(
    reader: &mut Reader,
    extension: &str,
    value: &Value,
    mut add: impl FnMut(&mut Reader, &str, &str, bool, &Value),
) {
    for (kind, is_preset) in [("preset", true), ("custom", false)] {
        for (name, value) in value["expressions"][kind].as_object().into_iter().flatten() {
            let place = format!("extensions.{extension}.expressions.{kind}.{name}");
            if Expression::PRESETS.contains(&name.as_str()) == is_preset && !name.is_empty() {
                add(reader, &place, name, is_preset, value);
            } else if !value.is_null() {
                reader.ignore(place, format!("“{name}” can't be the name of a {kind} expression; it is left out"));
            }
        }
    }
}

pub fn read_1(reader: &mut Reader, vrm: &Value, out: &mut Vec<Expression>) {
    each(reader, "VRMC_vrm", vrm, |reader, place, name, is_preset, value| {
        if out.len() >= MAX_EXPRESSIONS || value.is_null() {
            return;
        }
        let mut expression = Expression::new(name, name, is_preset);
        expression.is_binary = value["isBinary"] == true;
        expression.overrides = ["overrideBlink", "overrideLookAt", "overrideMouth"].map(|key| match text(value, key) {
            "block" => Override::Block,
            "blend" => Override::Blend,
            _ => Override::None,
        });
        for (at, bind) in list(&value["morphTargetBinds"]).iter().take(MAX_BINDS).enumerate() {
            let place = format!("{place}.morphTargetBinds[{at}]");
            if let Some(joint) = reader.joint_at(&place, &bind["node"]) {
                morph(reader, &place, &[joint], &bind["index"], number(bind, "weight", 1.0), &mut expression);
            }
        }
        for bind in list(&value["materialColorBinds"]).iter().take(MAX_BINDS) {
            if let Some(material) = index(&bind["material"]) {
                color(reader, material, text(bind, "type"), &bind["targetValue"], &mut expression);
            }
        }
        for bind in list(&value["textureTransformBinds"]).iter().take(MAX_BINDS) {
            if let Some(material) = index(&bind["material"]) {
                let offset = pair(&bind["offset"], 0, [0.0, 0.0]);
                texture_transform(reader, material, pair(&bind["scale"], 0, [1.0, 1.0]), offset, &mut expression);
            }
        }
        out.push(expression);
    });
}

pub fn read_0(reader: &mut Reader, vrm: &Value, out: &mut Vec<Expression>) {
    for (at, value) in list(&vrm["blendShapeMaster"]["blendShapeGroups"]).iter().take(MAX_EXPRESSIONS).enumerate() {
        let place = format!("extensions.VRM.blendShapeMaster.blendShapeGroups[{at}]");
        let (title, preset) = (text(value, "name"), text(value, "presetName").to_lowercase());
        let preset = PRESETS_0.iter().find(|(name, _)| *name == preset).map(|&(_, name)| name);
        let name = preset.unwrap_or(title);
        if name.is_empty() || out.iter().any(|other| other.name == name) {
            let problem = format!("expected an expression with a name of its own, found “{name}”; it is left out");
            reader.ignore(place, problem);
            continue;
        }
        let title = if title.is_empty() { name } else { title };
        let mut expression = Expression::new(name, title, preset.is_some());
        expression.is_binary = value["isBinary"] == true;
        for (at, bind) in list(&value["binds"]).iter().take(MAX_BINDS).enumerate() {
            let mesh = index(&bind["mesh"]);
            let draws = reader.parts.instances.iter().filter(|instance| Some(instance.mesh) == mesh);
            let joints: Vec<JointIndex> = draws.map(|instance| instance.joint).collect();
            let weight = number(bind, "weight", 100.0) / 100.0;
            morph(reader, &format!("{place}.binds[{at}]"), &joints, &bind["index"], weight, &mut expression);
        }
        for bind in list(&value["materialValues"]).iter().take(MAX_BINDS) {
            material_value(reader, bind, &mut expression);
        }
        out.push(expression);
    }
}

/// The expressions that a .vrma animates: their names and nodes.
pub fn read_animated(reader: &mut Reader, vrma: &Value, read: &mut Read) {
    each(reader, "VRMC_vrm_animation", vrma, |reader, place, name, is_preset, value| {
        if let Some(joint) = reader.joint_at(place, &value["node"])
            && read.avatar.expressions.len() < MAX_EXPRESSIONS
        {
            read.animated.expressions.push((joint, read.avatar.expressions.len()));
            read.avatar.expressions.push(Expression::new(name, name, is_preset));
        }
    });
}

fn morph(
    reader: &mut Reader,
    place: &str,
    joints: &[JointIndex],
    target: &Value,
    weight: f32,
    expression: &mut Expression,
) {
    let before = expression.morphs.len();
    for &joint in joints {
        let range = reader.parts.skeleton.morph_range(joint);
        let target = index(target).filter(|&target| target < range.len());
        if let Some(target) = target.filter(|_| expression.morphs.len() < MAX_BINDS) {
            expression.morphs.push(MorphBind { index: range.start + target, weight });
        }
    }
    if expression.morphs.len() == before {
        reader.ignore(place.to_owned(), format!("there is no morph target {target} of this mesh; it is left out"));
    }
}

fn add(expression: &mut Expression, material: usize, property: MaterialProperty, rest: Vec4, target: Vec4) {
    let target_property = PropertyTarget::Material(material, property);
    // Several values of one property would add up.
    if expression.materials.len() < MAX_BINDS && expression.materials.iter().all(|bind| bind.target != target_property)
    {
        expression.materials.push(MaterialBind { target: target_property, rest, delta: target - rest });
    }
}

/// Colours of MToon have no effect, since its materials are shown as what they fall back to.
fn color(reader: &Reader, at: usize, kind: &str, target: &Value, expression: &mut Expression) {
    let Some(material) = reader.parts.materials.get(at) else { return };
    let component = |index: usize| target.get(index).and_then(Value::as_f64).map_or(1.0, |number| number as f32);
    let target = Vec4::from_array([0, 1, 2, 3].map(component));
    if !target.is_finite() {
        return;
    }
    match kind {
        "color" | "_Color" => add(expression, at, MaterialProperty::BaseColor, material.base_color, target),
        "emissionColor" | "_EmissionColor" => {
            let rest = material.emissive.extend(0.0);
            add(expression, at, MaterialProperty::Emissive, rest, target.truncate().extend(0.0));
        }
        _ => {}
    }
}

fn texture_transform(reader: &Reader, at: usize, scale: [f32; 2], offset: [f32; 2], expression: &mut Expression) {
    let Some(material) = reader.parts.materials.get(at) else { return };
    for slot in TEXTURES {
        let Some(texture) = material.texture(slot) else { continue };
        let uvs = texture.uv_transform;
        let wide = |[x, y]: [f32; 2]| Vec4::new(x, y, 0.0, 0.0);
        add(expression, at, MaterialProperty::UvOffset(slot), wide(uvs.offset.to_array()), wide(offset));
        add(expression, at, MaterialProperty::UvScale(slot), wide(uvs.scale.to_array()), wide(scale));
    }
}

/// Two components of an array, from `start`.
fn pair(value: &Value, start: usize, default: [f32; 2]) -> [f32; 2] {
    let component = |at: usize| {
        let number = value.get(start + at).and_then(Value::as_f64).map(|number| number as f32);
        number.filter(|number| number.is_finite()).unwrap_or(default[at])
    };
    [component(0), component(1)]
}

/// VRM 0.x names materials, and has texture coordinates that start at the bottom.
fn material_value(reader: &Reader, bind: &Value, expression: &mut Expression) {
    let (name, property, value) = (text(bind, "materialName"), text(bind, "propertyName"), &bind["targetValue"]);
    for (at, _) in reader.parts.materials.iter().enumerate().filter(|(_, material)| material.name == name) {
        if property == "_MainTex_ST" {
            let (scale, [x, y]) = (pair(value, 0, [1.0, 1.0]), pair(value, 2, [0.0, 0.0]));
            texture_transform(reader, at, scale, [x, 1.0 - y - scale[1]], expression);
        } else {
            color(reader, at, property, value, expression);
        }
    }
}
