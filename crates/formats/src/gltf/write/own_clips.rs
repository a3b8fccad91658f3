//! The clips that a file already has: some get other names, some are left out with their keys.
//!
//! Everything else keeps its index, since extensions that Gaitway doesn't know may refer to it. So accessors and views that
//! are left out only disappear from the ends of their lists; elsewhere an empty one takes their place.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use gaitway_character::sort::sort_by_key;
use gltf::json::Root;
use gltf::json::animation::Animation;
use gltf::json::mesh::Primitive;
use serde_json::{Value, json};

use crate::gltf::object::{Array, Object, raw};

/// What becomes of a model's own clips in a written file, by their indices. Others stay as they are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OwnClips {
    /// Names that replace those of the file.
    pub names: BTreeMap<usize, String>,
    /// Clips that are not written.
    pub left_out: BTreeSet<usize>,
}

impl OwnClips {
    /// Whether all stay as they are.
    pub fn are_unchanged(&self) -> bool {
        self.names.is_empty() && self.left_out.is_empty()
    }
}

/// Alignment of what follows data that is cut out.
const ALIGNMENT: usize = 4;

/// Renames animations, and leaves others out. `binary` is the data of the first and only buffer if keys can be cut out of it.
pub fn edit(json: &mut Object, root: &Root, own: &OwnClips, binary: Option<&mut Vec<u8>>) {
    if own.are_unchanged() {
        return;
    }
    let mut animations = Array::new();
    for (index, mut animation) in json.read::<Array>("animations").unwrap_or_default().into_iter().enumerate() {
        if let (Some(name), Ok(mut named)) = (own.names.get(&index), serde_json::from_str::<Object>(animation.get())) {
            named.set("name", name);
            animation = raw(&named);
        }
        if !own.left_out.contains(&index) {
            animations.push(animation);
        }
    }
    set_or_remove(json, "animations", &animations);
    if let Some(binary) = binary.filter(|_| !own.left_out.is_empty() && json.count("buffers") == 1) {
        cut(json, root, &own.left_out, binary);
    }
}

/// Sets a list, or removes it if it is empty, since glTF doesn't allow empty lists.
fn set_or_remove(json: &mut Object, key: &str, list: &Array) {
    if list.is_empty() { json.remove(key) } else { json.set(key, list) }
}

/// Removes the accessors and views that only the animations `left_out` use, and their bytes.
fn cut(json: &mut Object, root: &Root, left_out: &BTreeSet<usize>, binary: &mut Vec<u8>) {
    let mut views: Vec<Object> = json.read("bufferViews").unwrap_or_default();
    // An extension may refer to any bytes.
    if views.iter().any(|view| view.read::<Object>("extensions").is_some()) {
        return;
    }
    let named = named_by_extensions(json);
    let mut unused = unused_accessors(root, left_out);
    unused.retain(|accessor| !named.contains(accessor));
    let mut accessors: Array = json.read("accessors").unwrap_or_default();
    let (mut used_views, mut unused_views) = (BTreeSet::new(), BTreeSet::new());
    used_views.extend(root.images.iter().filter_map(|image| Some(image.buffer_view?.value())));
    for (index, accessor) in root.accessors.iter().enumerate() {
        let sparse = accessor.sparse.iter();
        let of_sparse =
            sparse.flat_map(|sparse| [sparse.indices.buffer_view.value(), sparse.values.buffer_view.value()]);
        let of_accessor = accessor.buffer_view.map(|view| view.value()).into_iter().chain(of_sparse);
        if unused.contains(&index) { unused_views.extend(of_accessor) } else { used_views.extend(of_accessor) }
    }
    unused_views.retain(|view| *view < views.len() && !used_views.contains(view) && !named.contains(view));
    for &index in &unused {
        accessors[index] = raw(&json!({ "componentType": 5126, "count": 1, "type": "SCALAR" }));
    }
    accessors.truncate(accessors.len() - trailing(accessors.len(), &unused));
    set_or_remove(json, "accessors", &accessors);

    let range = |view: &Object| -> Range<usize> {
        let start = view.read("byteOffset").unwrap_or(0);
        start..view.read::<usize>("byteLength").unwrap_or(0).saturating_add(start)
    };
    let kept: Vec<Range<usize>> = views
        .iter()
        .enumerate()
        .filter(|(index, _)| !unused_views.contains(index))
        .map(|(_, view)| range(view))
        .collect();
    let cuts = cuts(unused_views.iter().map(|&index| range(&views[index])), &kept, binary.len());
    for (index, view) in views.iter_mut().enumerate() {
        let start = range(view).start;
        if unused_views.contains(&index) {
            view.set("byteOffset", &0);
            view.set("byteLength", &1);
            view.remove("byteStride");
        } else if start > 0 {
            let before: usize = cuts.iter().filter(|cut| cut.end <= start).map(ExactSizeIterator::len).sum();
            view.set("byteOffset", &(start - before));
        }
    }
    views.truncate(views.len() - trailing(views.len(), &unused_views));
    set_or_remove(json, "bufferViews", &views.iter().map(raw).collect());
    for cut in cuts.into_iter().rev() {
        binary.drain(cut);
    }
    if views.is_empty() {
        binary.clear();
        json.remove("buffers");
    }
}

/// Returns the accessors that only the animations `left_out` use.
fn unused_accessors(root: &Root, left_out: &BTreeSet<usize>) -> BTreeSet<usize> {
    let of_animation = |animation: &Animation| -> Vec<usize> {
        animation.samplers.iter().flat_map(|sampler| [sampler.input.value(), sampler.output.value()]).collect()
    };
    let of_primitive = |primitive: &Primitive| -> Vec<usize> {
        let targets = primitive.targets.iter().flatten();
        let of_targets = targets.flat_map(|target| [target.positions, target.normals, target.tangents]).flatten();
        let others = primitive.attributes.values().copied().chain(primitive.indices);
        others.chain(of_targets).map(|accessor| accessor.value()).collect()
    };
    let (left_out, kept): (Vec<_>, Vec<_>) =
        root.animations.iter().enumerate().partition(|(index, _)| left_out.contains(index));
    let mut unused: BTreeSet<usize> = left_out.into_iter().flat_map(|(_, animation)| of_animation(animation)).collect();
    let of_skins = root.skins.iter().filter_map(|skin| Some(skin.inverse_bind_matrices?.value()));
    let of_meshes = root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(of_primitive);
    for used in kept.into_iter().flat_map(|(_, animation)| of_animation(animation)).chain(of_skins).chain(of_meshes) {
        unused.remove(&used);
    }
    unused.retain(|&accessor| accessor < root.accessors.len());
    unused
}

/// Extensions whose numbers are no accessors or views.
const WITHOUT_DATA: [&str; 5] = ["KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_node_", "VRM"];

/// Returns all whole numbers in extensions and extras: any may be the index of an accessor or a view, as in
/// `EXT_mesh_gpu_instancing`.
fn named_by_extensions(json: &Object) -> BTreeSet<usize> {
    let mut named = BTreeSet::new();
    json.members().for_each(|(key, value)| collect(key, &value, false, &mut named));
    named
}

fn collect(key: &str, value: &Value, is_inside: bool, named: &mut BTreeSet<usize>) {
    let is_inside = is_inside || matches!(key, "extensions" | "extras");
    match value {
        Value::Number(number) if is_inside => {
            named.extend(number.as_u64().and_then(|index| usize::try_from(index).ok()))
        }
        Value::Array(values) => values.iter().for_each(|value| collect("", value, is_inside, named)),
        Value::Object(members) => {
            let has_data = |key: &str| !is_inside || !WITHOUT_DATA.iter().any(|prefix| key.starts_with(prefix));
            members
                .iter()
                .filter(|(key, _)| has_data(key))
                .for_each(|(key, value)| collect(key, value, is_inside, named));
        }
        _ => {}
    }
}

/// Returns how many indices at the end of a list of `count` items are in the set.
fn trailing(count: usize, set: &BTreeSet<usize>) -> usize {
    (0..count).rev().take_while(|index| set.contains(index)).count()
}

/// Returns the parts of the `unused` ranges that can be cut out of a buffer without moving the `kept` ones off their alignment, in
/// ascending order and without overlaps.
fn cuts(unused: impl Iterator<Item = Range<usize>>, kept: &[Range<usize>], length: usize) -> Vec<Range<usize>> {
    let aligned = |range: Range<usize>| range.start.next_multiple_of(ALIGNMENT)..range.end / ALIGNMENT * ALIGNMENT;
    let is_free = |range: &Range<usize>| {
        range.end <= length && !kept.iter().any(|kept| kept.start < range.end && range.start < kept.end)
    };
    let mut ranges: Vec<Range<usize>> =
        unused.map(aligned).filter(|range| range.start < range.end).filter(is_free).collect();
    sort_by_key(&mut ranges, |range| range.start);
    let mut cuts: Vec<Range<usize>> = Vec::new();
    for range in ranges {
        match cuts.last_mut().filter(|last| range.start <= last.end) {
            Some(last) => last.end = last.end.max(range.end),
            None => cuts.push(range),
        }
    }
    cuts
}
