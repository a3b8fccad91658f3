//! Reading and writing the values of link keys: each as short as possible while reading back exactly.

use std::collections::BTreeMap;
use std::fmt::Display;

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{ClipRef, Contacts, Feet, JointMapFile, PathOrigin, RootOptions, RootPart, Unmapped};
use gaitway_session::{is_light_file, with_current_member};
use glam::Vec3;
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use serde_json::Value;

use super::{Read, Written};
use crate::library::LookTarget;
use crate::state::{
    Background, CameraChoice, Channel, ClipChoice, Embed, Fade, Hidden, Inspect, MotionMap, OrbitCamera, Show, UpAxis,
    VertexChoice,
};
use crate::state::{EnvironmentChoice, KeyLight, LightSetup, ToneMap, ViewerState, map_code};

const FEET: [(&str, Feet); 2] = [("off", Feet::Off), ("plant", Feet::Plant)];

const CONTACTS: [(&str, Contacts); 2] = [("off", Contacts::Off), ("keep", Contacts::Keep)];

const ROOT_PARTS: [(&str, RootPart); 3] =
    [("keep", RootPart::Keep), ("in-place", RootPart::InPlace), ("freeze", RootPart::Freeze)];

pub(super) const LOOP_MODES: [(&str, LoopMode); 3] =
    [("once", LoopMode::Once), ("loop", LoopMode::Loop), ("ping-pong", LoopMode::PingPong)];

pub(super) const SKINNING_MODES: [(&str, SkinningMode); 3] = [
    ("linear", SkinningMode::Linear),
    ("rigid", SkinningMode::Rigid),
    ("dual-quaternion", SkinningMode::DualQuaternion),
];

pub(super) const TONE_MAPS: [(&str, ToneMap); 4] =
    [("neutral", ToneMap::Neutral), ("aces", ToneMap::Aces), ("agx", ToneMap::Agx), ("none", ToneMap::None)];

pub(super) const CHANNELS: [(&str, Channel); Channel::ALL.len()] = [
    ("shaded", Channel::Shaded),
    ("base-color", Channel::BaseColor),
    ("normal", Channel::Normal),
    ("tangent", Channel::Tangent),
    ("roughness", Channel::Roughness),
    ("metallic", Channel::Metallic),
    ("occlusion", Channel::Occlusion),
    ("emissive", Channel::Emissive),
    ("uv", Channel::Uv),
    ("vertex-color", Channel::VertexColor),
    ("influences", Channel::Influences),
    ("wireframe", Channel::Wireframe),
];

pub(super) const UP_AXES: [(&str, UpAxis); 6] = [
    ("x", UpAxis::X),
    ("y", UpAxis::Y),
    ("z", UpAxis::Z),
    ("-x", UpAxis::MinusX),
    ("-y", UpAxis::MinusY),
    ("-z", UpAxis::MinusZ),
];

/// `embed` was a flag at first: its first two values are still written as one.
pub(super) fn read_embed(text: &str) -> Option<Embed> {
    match text {
        "transport" => Some(Embed::Transport),
        "viewport" => Some(Embed::Viewport),
        _ => flag(text).map(|is_on| if is_on { Embed::Page } else { Embed::Off }),
    }
}

pub(super) fn write_embed(embed: &Embed) -> Written {
    match embed {
        Embed::Off | Embed::Page => Written::Flag(embed.is_on()),
        Embed::Transport => Written::Text("transport".to_owned()),
        Embed::Viewport => Written::Text("viewport".to_owned()),
    }
}

fn word_of<T: PartialEq>(words: &[(&str, T)], value: &T) -> String {
    words.iter().find(|(_, other)| other == value).map_or(String::new(), |(word, _)| (*word).to_owned())
}

pub(super) fn from_word<T: Copy>(words: &[(&str, T)], text: &str) -> Option<T> {
    words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value)
}

/// Escaped in joint names: the separators between them, and the escape character.
const IN_NAMES: &AsciiSet = &CONTROLS.add(b'%').add(b',').add(b':');

pub(super) fn write_word<T: PartialEq>(words: &[(&str, T)], value: &T) -> Written {
    Written::Text(word_of(words, value))
}

/// Reads an optional field whose text is never empty.
pub(super) fn read_some<T>(read: fn(&str) -> Option<T>) -> impl Fn(&str) -> Option<Option<T>> {
    move |text| read(text).map(Some)
}

/// Reads an optional field; empty text unsets it.
pub(super) fn read_unless_empty<T>(read: fn(&str) -> Option<T>) -> impl Fn(&str) -> Option<Option<T>> {
    move |text| if text.is_empty() { Some(None) } else { read(text).map(Some) }
}

pub(super) fn write_some<T>(text: fn(&T) -> String) -> impl Fn(&Option<T>) -> Written {
    move |value| value.as_ref().map_or(Written::Unset, |value| Written::Text(text(value)))
}

pub(super) fn write_flag(flag: &bool) -> Written {
    Written::Flag(*flag)
}

pub(super) fn write_number<T: Display + Copy + Into<Value>>(number: &T) -> Written {
    Written::Number(number.to_string(), (*number).into())
}

pub(super) fn read_index(text: &str) -> Option<Option<usize>> {
    if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) }
}

pub(super) fn write_index(index: &Option<usize>) -> Written {
    index.as_ref().map_or(Written::Unset, write_number)
}

pub(super) fn read_text(text: &str) -> Option<String> {
    Some(text.to_owned())
}

pub(super) fn read_clip(text: &str) -> Option<ClipChoice> {
    Some(if text.is_empty() { ClipChoice::RestPose } else { ClipChoice::called(text) })
}

pub(super) fn write_clip(clip: &ClipChoice) -> Written {
    match clip {
        ClipChoice::First | ClipChoice::FirstOfMotions => Written::Unset,
        ClipChoice::RestPose => Written::Text(String::new()),
        ClipChoice::Clip(clip) => Written::Text(clip.to_string()),
    }
}

pub(super) fn read_feet(text: &str) -> Option<Feet> {
    from_word(&FEET, text)
}

pub(super) fn feet_text(feet: &Feet) -> String {
    word_of(&FEET, feet)
}

pub(super) fn read_contacts(text: &str) -> Option<Contacts> {
    from_word(&CONTACTS, text)
}

pub(super) fn contacts_text(contacts: &Contacts) -> String {
    word_of(&CONTACTS, contacts)
}

pub(super) fn flag_text(flag: bool) -> &'static str {
    if flag { "1" } else { "0" }
}

pub(super) fn flag(text: &str) -> Option<bool> {
    match text {
        "1" | "true" => Some(true),
        "0" | "false" => Some(false),
        _ => None,
    }
}

fn joined<T: Display>(parts: impl Iterator<Item = T>) -> String {
    parts.map(|part| part.to_string()).collect::<Vec<_>>().join(",")
}

/// Reads a decimal number; rejects infinities and NaN.
pub(super) fn finite<T: std::str::FromStr + Copy + Into<f64>>(text: &str) -> Option<T> {
    text.trim().parse::<T>().ok().filter(|&value| Into::<f64>::into(value).is_finite())
}

pub(super) fn read_source(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| with_current_member(text))
}

pub(super) fn map_text(map: &MotionMap) -> String {
    match map {
        MotionMap::Numbers(map) => map_code::encode(map),
        MotionMap::Names(text) | MotionMap::File(text) => text.clone(),
    }
}

/// Reads the compact form, JSON, or a URL.
pub(super) fn read_map(text: &str) -> Option<MotionMap> {
    if text.starts_with('{') {
        JointMapFile::from_json(text).is_ok().then(|| MotionMap::Names(text.to_owned()))
    } else if map_code::is_code(text) {
        map_code::decode(text).map(MotionMap::Numbers)
    } else {
        (!text.is_empty()).then(|| MotionMap::File(text.to_owned()))
    }
}

/// Writes `rest`, `clip:CLIP` or `first-key:CLIP`; a clip name that looks like an index is quoted.
pub(super) fn unmapped_text(unmapped: &Unmapped) -> String {
    let Unmapped::Clip { clip, frozen } = unmapped else { return "rest".to_owned() };
    let clip = match clip {
        ClipRef::Index(index) => index.to_string(),
        ClipRef::Name(name) if name.parse::<usize>().is_ok() || name.starts_with('"') => format!("\"{name}\""),
        ClipRef::Name(name) => name.clone(),
    };
    format!("{}:{clip}", if *frozen { "first-key" } else { "clip" })
}

pub(super) fn read_unmapped(text: &str) -> Option<Unmapped> {
    if text == "rest" {
        return Some(Unmapped::Rest);
    }
    let (word, clip) = text.split_once(':')?;
    let frozen = match word {
        "clip" => false,
        "first-key" => true,
        _ => return None,
    };
    let quoted = clip.strip_prefix('"').and_then(|clip| clip.strip_suffix('"'));
    let clip = match (quoted, clip.parse()) {
        (Some(name), _) => ClipRef::Name(name.to_owned()),
        (None, Ok(index)) => ClipRef::Index(index),
        (None, Err(_)) => ClipRef::Name(clip.to_owned()),
    };
    Some(Unmapped::Clip { clip, frozen })
}

/// Writes `horizontal:PART,vertical:PART,yaw:PART,extract,origin:feet`, leaving out defaults; `keep` if nothing is left.
pub(super) fn root_text(root: &RootOptions) -> String {
    let parts = [("horizontal", root.horizontal), ("vertical", root.vertical), ("yaw", root.yaw)];
    let parts = parts.into_iter().filter(|(_, part)| *part != RootPart::Keep);
    let words = parts.map(|(name, part)| format!("{name}:{}", word_of(&ROOT_PARTS, &part)));
    let extract = root.extract.then_some("extract");
    let origin = (root.origin == PathOrigin::Feet).then_some("origin:feet");
    let text = joined(words.chain(extract.into_iter().chain(origin).map(str::to_owned)));
    if text.is_empty() { "keep".to_owned() } else { text }
}

/// Reads what [`root_text`] writes. A lone `in-place` or `freeze` applies to horizontal motion.
pub(super) fn read_root(text: &str) -> Option<RootOptions> {
    let mut root = RootOptions::default();
    for word in text.split(',').map(str::trim) {
        let (name, part) = word.split_once(':').unwrap_or(("horizontal", word));
        match word {
            "extract" => root.extract = true,
            "origin:rest" => root.origin = PathOrigin::Rest,
            "origin:feet" => root.origin = PathOrigin::Feet,
            _ => *part_named(&mut root, name)? = from_word(&ROOT_PARTS, part)?,
        }
    }
    Some(root)
}

fn part_named<'a>(root: &'a mut RootOptions, name: &str) -> Option<&'a mut RootPart> {
    match name {
        "horizontal" => Some(&mut root.horizontal),
        "vertical" => Some(&mut root.vertical),
        "yaw" => Some(&mut root.yaw),
        _ => None,
    }
}

pub(super) fn range_text(range: &TimeRange) -> String {
    format!("{},{}", range.start_secs, range.end_secs)
}

pub(super) fn read_range(text: &str) -> Option<TimeRange> {
    let (start, end) = text.split_once(',')?;
    let (start_secs, end_secs) = (finite(start)?, finite(end)?);
    (start_secs <= end_secs).then_some(TimeRange { start_secs, end_secs })
}

/// Writes the elapsed time, the clip's time and the clip's name, which is empty for the rest pose.
pub(super) fn fade_text(fade: &Fade) -> String {
    let clip = match &fade.clip {
        ClipChoice::Clip(clip) => clip.to_string(),
        ClipChoice::First | ClipChoice::FirstOfMotions | ClipChoice::RestPose => String::new(),
    };
    format!("{},{},{clip}", fade.elapsed_secs, fade.time_secs)
}

pub(super) fn read_fade(text: &str) -> Option<Fade> {
    let mut parts = text.splitn(3, ',');
    let (elapsed_secs, time_secs) = (finite(parts.next()?)?, finite(parts.next()?)?);
    let clip = match parts.next()? {
        "" => ClipChoice::RestPose,
        name => ClipChoice::called(name),
    };
    Some(Fade { clip, time_secs, elapsed_secs })
}

/// Reads comma-separated entries; `None` if any of them is invalid.
fn each<K: Ord, V>(text: &str, read: impl Fn(&str) -> Option<(K, V)>) -> Option<BTreeMap<K, V>> {
    let mut entries = BTreeMap::new();
    for part in text.split(',').filter(|part| !part.is_empty()) {
        let (key, value) = read(part)?;
        entries.insert(key, value);
    }
    Some(entries)
}

pub(super) fn write_morph(morph: &BTreeMap<usize, f32>) -> Written {
    Written::Text(joined(morph.iter().map(|(index, weight)| format!("{index}:{weight}"))))
}

pub(super) fn read_morph(text: &str) -> Option<BTreeMap<usize, f32>> {
    let pair = |pair: &str| {
        let (index, weight) = pair.split_once(':')?;
        Some((index.trim().parse().ok()?, finite(weight)?))
    };
    each(text, pair)
}

pub(super) fn write_expressions(expressions: &BTreeMap<String, f32>) -> Written {
    let pair = |(name, weight): (&String, &f32)| format!("{}:{weight}", escaped_name(name));
    Written::Text(joined(expressions.iter().map(pair)))
}

/// Names are escaped like joint names.
pub(super) fn read_expressions(text: &str) -> Option<BTreeMap<String, f32>> {
    let pair = |pair: &str| {
        let (name, weight) = pair.split_once(':')?;
        Some((unescaped_name(name)?, finite(weight)?))
    };
    each(text, pair)
}

pub(super) fn write_look(target: &LookTarget) -> Written {
    match target {
        LookTarget::Off => Written::Unset,
        LookTarget::Camera => Written::Text("camera".to_owned()),
        LookTarget::Point(point) => Written::Text(joined(point.to_array().iter())),
    }
}

pub(super) fn read_look(text: &str) -> Option<LookTarget> {
    match text {
        "off" | "" => Some(LookTarget::Off),
        "camera" => Some(LookTarget::Camera),
        _ => {
            let mut numbers = text.split(',').map(finite::<f32>);
            let point = Vec3::new(numbers.next()??, numbers.next()??, numbers.next()??);
            numbers.next().is_none().then_some(LookTarget::Point(point))
        }
    }
}

pub(super) fn write_pose(pose: &BTreeMap<usize, [f32; 3]>) -> Written {
    Written::Text(joined(pose.iter().map(|(joint, [x, y, z])| format!("{joint}:{x}:{y}:{z}"))))
}

pub(super) fn read_pose(text: &str) -> Option<BTreeMap<usize, [f32; 3]>> {
    let rotation = |part: &str| {
        let (joint, angles) = part.split_once(':')?;
        let mut angles = angles.split(':').map(finite::<f32>);
        let degrees = [angles.next()??, angles.next()??, angles.next()??];
        angles.next().is_none().then_some((joint.trim().parse().ok()?, degrees))
    };
    each(text, rotation)
}

pub(super) fn write_names(names: &BTreeMap<usize, String>) -> Written {
    let name = |(joint, name): (&usize, &String)| format!("{joint}:{}", escaped_name(name));
    Written::Text(joined(names.iter().map(name)))
}

/// Escapes a name among the separators of a value.
pub(super) fn escaped_name(name: &str) -> String {
    utf8_percent_encode(name, IN_NAMES).to_string()
}

/// Reads what [`escaped_name`] writes.
pub(super) fn unescaped_name(text: &str) -> Option<String> {
    Some(percent_decode_str(text).decode_utf8().ok()?.into_owned())
}

/// Names are escaped a second time because of the separators between them.
pub(super) fn read_names(text: &str) -> Option<BTreeMap<usize, String>> {
    let named = |part: &str| {
        let (joint, name) = part.split_once(':')?;
        let name = unescaped_name(name)?;
        let is_line = !name.trim().is_empty() && !name.contains(char::is_control);
        is_line.then_some((joint.trim().parse().ok()?, name))
    };
    each(text, named)
}

/// Writes nodes, then materials as `m` and their index. `m` alone is the default material.
pub(super) fn write_hidden(hidden: &Hidden) -> Written {
    let nodes = hidden.nodes.iter().map(ToString::to_string);
    let materials = hidden.materials.iter().map(|material| match material {
        Some(index) => format!("m{index}"),
        None => "m".to_owned(),
    });
    Written::Text(joined(nodes.chain(materials)))
}

pub(super) fn read_hidden(text: &str) -> Option<Hidden> {
    let mut hidden = Hidden::default();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        match part.strip_prefix('m') {
            Some("") => _ = hidden.materials.insert(None),
            Some(index) => _ = hidden.materials.insert(Some(index.parse().ok()?)),
            None => _ = hidden.nodes.insert(part.parse().ok()?),
        }
    }
    Some(hidden)
}

pub(super) fn vertex_text(choice: &VertexChoice) -> String {
    format!("{}:{}:{}", choice.instance, choice.primitive, choice.vertex)
}

pub(super) fn read_vertex(text: &str) -> Option<VertexChoice> {
    let mut numbers = text.split(':').map(|part| part.trim().parse().ok());
    let choice = VertexChoice { instance: numbers.next()??, primitive: numbers.next()??, vertex: numbers.next()?? };
    numbers.next().is_none().then_some(choice)
}

/// Returns the words of `show`, each with its flag and the flag's value if the word is present. The mesh and its shadow are on
/// by default, so their words hide them.
fn show_flags<'a>(show: &'a mut Show, inspect: &'a mut Inspect) -> [(&'static str, &'a mut bool, bool); 15] {
    [
        ("no-mesh", &mut show.mesh, false),
        ("skeleton", &mut show.skeleton, true),
        ("weights", &mut inspect.weights, true),
        ("bounds", &mut show.bounds, true),
        ("wireframe", &mut show.wireframe, true),
        ("grid", &mut show.grid, true),
        ("no-shadow", &mut show.shadow, false),
        ("split", &mut inspect.split, true),
        ("rests", &mut inspect.rests, true),
        ("source", &mut show.source, true),
        ("over", &mut show.over, true),
        ("error", &mut show.error, true),
        ("boxes", &mut show.boxes, true),
        ("controls", &mut show.controls, true),
        ("smooth", &mut show.smooth, true),
    ]
}

pub(super) fn write_show(state: &ViewerState) -> Written {
    let (mut show, mut inspect) = (state.display.show, state.inspect);
    let flags = show_flags(&mut show, &mut inspect).into_iter();
    let words = flags.filter(|(_, flag, when)| **flag == *when).map(|(word, ..)| word.to_owned());
    Written::Text(joined(words.chain(state.page.unknown.get("show").cloned().unwrap_or_default())))
}

pub(super) fn read_show(state: &mut ViewerState, text: &str) -> Read {
    let mut unknown = Vec::new();
    state.page.unknown.remove("show");
    let mut flags = show_flags(&mut state.display.show, &mut state.inspect);
    flags.iter_mut().for_each(|(_, flag, when)| **flag = !*when);
    for word in text.split(',').map(str::trim).filter(|word| !word.is_empty()) {
        match flags.iter_mut().find(|(other, ..)| *other == word) {
            Some((_, flag, when)) => **flag = *when,
            None => unknown.push(word.to_owned()),
        }
    }
    if unknown.is_empty() { Read::Done } else { Read::UnknownShow(unknown) }
}

pub(super) fn reset_show(state: &mut ViewerState) {
    state.page.unknown.remove("show");
    (state.display.show, state.inspect) = (Show::default(), Inspect::default());
}

pub(super) fn write_camera(camera: &CameraChoice) -> Written {
    Written::Text(match camera {
        CameraChoice::Auto => "auto".to_owned(),
        CameraChoice::File(index) => format!("gltf:{index}"),
        CameraChoice::Orbit(OrbitCamera { yaw_radians, pitch_radians, distance, target }) => {
            let (yaw, pitch) = (degrees_text(*yaw_radians), degrees_text(*pitch_radians));
            format!("{yaw},{pitch},{distance},{},{},{}", target.x, target.y, target.z)
        }
    })
}

/// Writes the shortest decimal that reads back as the same angle.
fn degrees_text(radians: f32) -> String {
    let degrees = f64::from(radians).to_degrees();
    let reads_back = |text: &String| text.parse::<f64>().is_ok_and(|degrees| degrees.to_radians() as f32 == radians);
    (0..12).map(|digits| format!("{degrees:.digits$}")).find(reads_back).unwrap_or_else(|| degrees.to_string())
}

pub(super) fn read_camera(text: &str) -> Option<CameraChoice> {
    if text == "auto" {
        return Some(CameraChoice::Auto);
    }
    if let Some(index) = text.strip_prefix("gltf:") {
        return index.parse().ok().map(CameraChoice::File);
    }
    let parts: Vec<&str> = text.split(',').collect();
    let &[yaw, pitch, distance, x, y, z] = parts.as_slice() else { return None };
    let radians = |text: &str| {
        let radians = finite::<f64>(text)?.to_radians() as f32;
        radians.is_finite().then_some(radians)
    };
    let distance = finite::<f32>(distance).filter(|&distance| distance > 0.0)?;
    let target = Vec3::new(finite(x)?, finite(y)?, finite(z)?);
    Some(CameraChoice::Orbit(OrbitCamera {
        yaw_radians: radians(yaw)?,
        pitch_radians: radians(pitch)?,
        distance,
        target,
    }))
}

pub(super) const LIGHT_SETUPS: [(&str, LightSetup); 5] = [
    ("studio", LightSetup::Studio),
    ("white", LightSetup::White),
    ("soft", LightSetup::Soft),
    ("hard", LightSetup::Hard),
    ("outdoor", LightSetup::Outdoor),
];

pub(super) fn write_light(environment: &EnvironmentChoice) -> Written {
    match environment {
        EnvironmentChoice::Setup(setup) => write_word(&LIGHT_SETUPS, setup),
        EnvironmentChoice::File(name) => Written::Text(name.clone()),
    }
}

/// A file has an extension or is a URL or a path; anything else is a misspelt set-up.
pub(super) fn read_light(text: &str) -> Option<EnvironmentChoice> {
    match from_word(&LIGHT_SETUPS, text) {
        Some(setup) => Some(EnvironmentChoice::Setup(setup)),
        None => is_light_file(text).then(|| EnvironmentChoice::File(text.to_owned())),
    }
}

pub(super) fn key_light_text(key: &KeyLight) -> String {
    format!("{},{},{}", key.strength, key.yaw_degrees, key.pitch_degrees)
}

pub(super) fn read_key_light(text: &str) -> Option<KeyLight> {
    let parts: Vec<&str> = text.split(',').collect();
    let &[strength, yaw, pitch] = parts.as_slice() else { return None };
    Some(KeyLight { strength: finite(strength)?, yaw_degrees: finite(yaw)?, pitch_degrees: finite(pitch)? })
}

pub(super) fn write_background(background: &Background) -> Written {
    Written::Text(match background {
        Background::Studio => "studio".to_owned(),
        Background::Transparent => "transparent".to_owned(),
        Background::Environment => "environment".to_owned(),
        Background::Blurred => "blurred".to_owned(),
        Background::Color([red, green, blue]) => format!("{red:02x}{green:02x}{blue:02x}"),
    })
}

pub(super) fn read_background(text: &str) -> Option<Background> {
    match text {
        "studio" => Some(Background::Studio),
        "transparent" => Some(Background::Transparent),
        "environment" => Some(Background::Environment),
        "blurred" => Some(Background::Blurred),
        _ => {
            let hex = text.strip_prefix('#').unwrap_or(text);
            let ok = hex.len() == 6 && hex.bytes().all(|byte| byte.is_ascii_hexdigit());
            let number = u32::from_str_radix(hex, 16).ok().filter(|_| ok)?;
            let [_, red, green, blue] = number.to_be_bytes();
            Some(Background::Color([red, green, blue]))
        }
    }
}
