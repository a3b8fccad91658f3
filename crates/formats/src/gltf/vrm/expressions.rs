//! `expressions` of VRM 1.0, `blendShapeMaster` of 0.x, and the names of animated expressions in a .vrma.

use std::collections::{BTreeMap, HashMap};

use gaitway_character::anim::{JointIndex, MaterialProperty, PropertyTarget, TextureSlot, ToonColor};
use gaitway_character::avatar::{Expression, MaterialBind, MorphBind, Override};
use glam::Vec4;
use serde_json::Value;

use super::{Reader, index, mtoon, number, text};

/// Further expressions are skipped.
const MAX_EXPRESSIONS: usize = 256;
/// Further binds of one kind in an expression are skipped.
const MAX_BINDS: usize = 1024;

/// MToon's own colours, as VRM 1.0 and 0.x call them.
const TOON_COLORS: [(&str, ToonColor); 7] = [
    ("shadeColor", ToonColor::ShadeColor),
    ("_ShadeColor", ToonColor::ShadeColor),
    ("matcapColor", ToonColor::MatcapColor),
    ("rimColor", ToonColor::RimColor),
    ("_RimColor", ToonColor::RimColor),
    ("outlineColor", ToonColor::OutlineColor),
    ("_OutlineColor", ToonColor::OutlineColor),
];

/// Preset names of VRM 0.x and their equivalents in 1.0.
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

/// Calls `add` for each entry of `expressions` with its place, name, whether it is a preset, and its definition.
fn for_each_expression(
    reader: &mut Reader,
    extension: &str,
    value: &Value,
    add: &mut dyn FnMut(&mut Reader, &str, &str, bool, &Value),
) {
    let mut count = 0;
    for (kind, is_preset) in [("preset", true), ("custom", false)] {
        let entries = value["expressions"][kind].as_object().into_iter().flatten();
        for (name, value) in entries.filter(|(_, value)| !value.is_null()) {
            let place = format!("extensions.{extension}.expressions.{kind}.{name}");
            count += 1;
            if count > MAX_EXPRESSIONS {
                reader
                    .ignore(place, format!("expected at most {MAX_EXPRESSIONS} expressions; the others are left out"));
                return;
            }
            if Expression::PRESETS.contains(&name.as_str()) == is_preset && !name.is_empty() {
                add(reader, &place, name, is_preset, value);
            } else {
                reader.ignore(place, format!("“{name}” can't be the name of a {kind} expression; it is left out"));
            }
        }
    }
}

pub fn read_1(reader: &mut Reader, vrm: &Value, out: &mut Vec<Expression>) {
    for_each_expression(reader, "VRMC_vrm", vrm, &mut |reader, place, name, is_preset, value| {
        let mut expression = Expression::new(name, name, is_preset);
        expression.is_binary = value["isBinary"] == true;
        expression.overrides = ["overrideBlink", "overrideLookAt", "overrideMouth"].map(|key| match text(value, key) {
            "block" => Override::Block,
            "blend" => Override::Blend,
            _ => Override::None,
        });
        let mut binds = |key: &str| {
            let place = format!("{place}.{key}");
            (reader.list(&place, &value[key], MAX_BINDS), place)
        };
        let (morphs, morphs_place) = binds("morphTargetBinds");
        let (colors, _) = binds("materialColorBinds");
        let (transforms, _) = binds("textureTransformBinds");
        for (at, bind) in morphs.iter().enumerate() {
            let place = format!("{morphs_place}[{at}]");
            if let Some(joint) = reader.joint_at(&place, &bind["node"]) {
                add_morph(reader, &place, &[joint], &bind["index"], number(bind, "weight", 1.0), &mut expression);
            }
        }
        for bind in colors {
            if let Some(material) = index(&bind["material"]) {
                add_color(reader, material, text(bind, "type"), &bind["targetValue"], &mut expression);
            }
        }
        for bind in transforms {
            if let Some(material) = index(&bind["material"]) {
                let offset = pair(&bind["offset"], 0, [0.0, 0.0]);
                add_texture_transform(reader, material, pair(&bind["scale"], 0, [1.0, 1.0]), offset, &mut expression);
            }
        }
        out.push(expression);
    });
}

pub fn read_0(reader: &mut Reader, vrm: &Value, out: &mut Vec<Expression>) {
    let mut joints_of_mesh: BTreeMap<usize, Vec<JointIndex>> = BTreeMap::new();
    for instance in reader.context.instances {
        joints_of_mesh.entry(instance.mesh).or_default().push(instance.joint);
    }
    let mut materials_by_name: HashMap<&str, Vec<usize>> = HashMap::new();
    let materials = reader.context.materials;
    for (at, material) in materials.iter().enumerate().filter(|(_, material)| !material.name.is_empty()) {
        materials_by_name.entry(&material.name).or_default().push(at);
    }
    let place = "extensions.VRM.blendShapeMaster.blendShapeGroups";
    let groups = reader.list(place, &vrm["blendShapeMaster"]["blendShapeGroups"], MAX_EXPRESSIONS);
    for (at, value) in groups.iter().enumerate() {
        let place = format!("{place}[{at}]");
        let (title, preset) = (text(value, "name"), text(value, "presetName").to_lowercase());
        let preset = PRESETS_0.iter().find(|(name, _)| *name == preset).map(|&(_, name)| name);
        let name = preset.unwrap_or(title);
        if name.is_empty() || out.iter().any(|other| other.name == name) {
            let problem = format!("expected a unique name, found “{name}”; it is left out");
            reader.ignore(place, problem);
            continue;
        }
        let title = if title.is_empty() { name } else { title };
        let mut expression = Expression::new(name, title, preset.is_some());
        expression.is_binary = value["isBinary"] == true;
        let binds_place = format!("{place}.binds");
        for (at, bind) in reader.list(&binds_place, &value["binds"], MAX_BINDS).iter().enumerate() {
            let joints =
                index(&bind["mesh"]).and_then(|mesh| joints_of_mesh.get(&mesh)).map_or(&[][..], |joints| joints);
            let weight = number(bind, "weight", 100.0) / 100.0;
            add_morph(reader, &format!("{binds_place}[{at}]"), joints, &bind["index"], weight, &mut expression);
        }
        for bind in reader.list(&format!("{place}.materialValues"), &value["materialValues"], MAX_BINDS) {
            add_material_value(reader, &materials_by_name, bind, &mut expression);
        }
        out.push(expression);
    }
}

/// Reads the expressions that a .vrma animates. Returns the node of each and its index in `out`.
pub fn read_animated(reader: &mut Reader, vrma: &Value, out: &mut Vec<Expression>) -> Vec<(JointIndex, usize)> {
    let mut nodes = Vec::new();
    for_each_expression(reader, "VRMC_vrm_animation", vrma, &mut |reader, place, name, is_preset, value| {
        if let Some(joint) = reader.joint_at(place, &value["node"]) {
            nodes.push((joint, out.len()));
            out.push(Expression::new(name, name, is_preset));
        }
    });
    nodes
}

fn add_morph(
    reader: &mut Reader,
    place: &str,
    joints: &[JointIndex],
    target: &Value,
    weight: f32,
    expression: &mut Expression,
) {
    let before = expression.morphs.len();
    for &joint in joints.iter().take(MAX_BINDS) {
        let range = reader.context.skeleton.morph_range(joint);
        let target = index(target).filter(|&target| target < range.len());
        if let Some(target) = target.filter(|_| expression.morphs.len() < MAX_BINDS) {
            expression.morphs.push(MorphBind { index: range.start + target, weight });
        }
    }
    if expression.morphs.len() == before {
        reader.ignore(place.to_owned(), format!("there is no morph target {target} of this mesh; it is left out"));
    }
}

fn add_material_bind(
    expression: &mut Expression,
    material: usize,
    property: MaterialProperty,
    rest: Vec4,
    value: Vec4,
) {
    let target = PropertyTarget::Material(material, property);
    // Several values of one property would add up.
    if expression.materials.len() < MAX_BINDS && expression.materials.iter().all(|bind| bind.target != target) {
        expression.materials.push(MaterialBind { target, rest, delta: value - rest });
    }
}

fn add_color(reader: &Reader, at: usize, kind: &str, target: &Value, expression: &mut Expression) {
    let Some(material) = reader.context.materials.get(at) else { return };
    let component = |index: usize| target.get(index).and_then(Value::as_f64).map_or(1.0, |number| number as f32);
    let target = Vec4::from_array([0, 1, 2, 3].map(component));
    if !target.is_finite() {
        return;
    }
    let is_gamma = kind.starts_with('_') && kind != "_EmissionColor" && material.toon.is_some();
    let target = if is_gamma { mtoon::linear(target) } else { target };
    match kind {
        "color" | "_Color" => {
            add_material_bind(expression, at, MaterialProperty::BaseColor, material.base_color, target)
        }
        "emissionColor" | "_EmissionColor" => {
            let rest = material.emissive.extend(0.0);
            add_material_bind(expression, at, MaterialProperty::Emissive, rest, target.truncate().extend(0.0));
        }
        _ => {
            let color = TOON_COLORS.iter().find(|(name, _)| *name == kind).map(|&(_, color)| color);
            if let (Some(mut toon), Some(color)) = (material.toon.as_deref().copied(), color) {
                let rest = toon.color_mut(color).extend(0.0);
                add_material_bind(expression, at, MaterialProperty::Toon(color), rest, target.truncate().extend(0.0));
            }
        }
    }
}

fn add_texture_transform(reader: &Reader, at: usize, scale: [f32; 2], offset: [f32; 2], expression: &mut Expression) {
    let Some(material) = reader.context.materials.get(at) else { return };
    // MToon's matcap isn't looked up by texture coordinates (VRMC_vrm, TextureTransformBind).
    for slot in TextureSlot::ALL.into_iter().filter(|&slot| slot != TextureSlot::Matcap) {
        let Some(texture) = material.texture(slot) else { continue };
        let uvs = texture.uv_transform;
        let vec4 = |[x, y]: [f32; 2]| Vec4::new(x, y, 0.0, 0.0);
        add_material_bind(expression, at, MaterialProperty::UvOffset(slot), vec4(uvs.offset.to_array()), vec4(offset));
        add_material_bind(expression, at, MaterialProperty::UvScale(slot), vec4(uvs.scale.to_array()), vec4(scale));
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

/// VRM 0.x identifies materials by name, and its V coordinates start at the bottom.
fn add_material_value(
    reader: &Reader,
    materials_by_name: &HashMap<&str, Vec<usize>>,
    bind: &Value,
    expression: &mut Expression,
) {
    let (name, property, value) = (text(bind, "materialName"), text(bind, "propertyName"), &bind["targetValue"]);
    let left = MAX_BINDS.saturating_sub(expression.materials.len());
    for &at in materials_by_name.get(name).into_iter().flatten().take(left) {
        if property == "_MainTex_ST" {
            let (scale, [x, y]) = (pair(value, 0, [1.0, 1.0]), pair(value, 2, [0.0, 0.0]));
            add_texture_transform(reader, at, scale, [x, 1.0 - y - scale[1]], expression);
        } else {
            add_color(reader, at, property, value, expression);
        }
    }
}
