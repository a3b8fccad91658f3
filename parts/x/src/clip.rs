//! Animation sets as clips.

use gaitway_glb::{Animation, Glb, Warnings};
use glam::{DAffine3, DQuat, DVec3};

use crate::document::{Document, short, text};
use crate::frame::Nodes;
use crate::transform::{Parts, matrix, mirrored, parts, rotation};

/// DirectX's unit of time, where the file states none.
const DEFAULT_TICKS_PER_SEC: u32 = 4800;
/// Frames per second where the file counts frames without saying so, as assumed by assimp and other viewers.
const FRAMES_PER_SEC: u32 = 25;
/// Minimum plausible key spacing at [`DEFAULT_TICKS_PER_SEC`]: 240 keys per second.
const MIN_TICKS_BETWEEN_KEYS: f64 = 20.0;
/// Minimum plausible clip length: 0.1 s.
const MIN_TICKS_OF_CLIPS: f64 = 480.0;

const PATHS: [&str; 3] = ["translation", "rotation", "scale"];
const ROTATION: usize = 1;
const SCALE: usize = 2;

/// Keys of a property: ticks and values.
#[derive(Default)]
struct Track {
    ticks: Vec<f64>,
    values: Vec<f32>,
}

/// An `AnimationKey`, read.
struct Keys {
    /// For each of [`PATHS`].
    tracks: [Option<Track>; 3],
    are_matrices: bool,
    is_sheared: bool,
}

/// Writes all animation sets, and marks the nodes that they move.
pub fn write(document: &Document, nodes: &mut Nodes, glb: &mut Glb, warnings: &mut Warnings) -> Result<(), String> {
    let ticks_per_sec = ticks_per_sec(document, warnings)?;
    if nodes.are_targets {
        warnings.add("The file has animation alone: its joints have the names of frames, but no hierarchy.".to_owned());
    }
    let mut clips = Clips { written: vec![[0; 3]; nodes.entries.len()], ticks_per_sec, nodes, glb, warnings };
    for (set, object) in document.all("AnimationSet") {
        let mut clip = Animation::default();
        for (animation, _) in document.children(set, "Animation") {
            let Some(node) = target(document, animation, clips.nodes, clips.warnings) else { continue };
            for (key, _) in document.children(animation, "AnimationKey") {
                clips.add(document, set, key, node, &mut clip)?;
            }
        }
        clip.write(&text(object.name), clips.glb);
    }
    Ok(())
}

struct Clips<'a, 'b> {
    ticks_per_sec: f64,
    /// Of each node's properties, the animation set that has written it last.
    written: Vec<[usize; 3]>,
    nodes: &'a mut Nodes<'b>,
    glb: &'a mut Glb,
    warnings: &'a mut Warnings,
}

impl Clips<'_, '_> {
    /// Adds the keys of an object to the clip.
    fn add(
        &mut self,
        document: &Document,
        set: usize,
        key: usize,
        node: usize,
        clip: &mut Animation,
    ) -> Result<(), String> {
        let keys = read_keys(document, key)?;
        if keys.is_sheared {
            self.warnings.add(format!("{}: its matrices are sheared, which keys can't be.", document.label(key)));
        }
        let rest = parts(&self.nodes.entries[node].matrix).scale.to_array().map(|factor| factor as f32);
        // A matrix has a scale even if nothing is scaled.
        let is_rest = |track: &Track| track.values.as_chunks::<3>().0.iter().all(|scale| *scale == rest);
        for (path, track) in keys.tracks.into_iter().enumerate() {
            let Some(track) = track.filter(|track| !track.ticks.is_empty()) else { continue };
            if path == SCALE && keys.are_matrices && is_rest(&track) {
                continue;
            }
            let before = std::mem::replace(&mut self.written[node][path], set);
            if before == set {
                let label = document.label(key);
                self.warnings.add(format!("{label} left out: its frame is animated already."));
                continue;
            }
            let entry = &mut self.nodes.entries[node];
            entry.is_animated = true;
            // Only the keys tell the rest of a frame that the file doesn't have.
            if self.nodes.are_targets && before == 0 {
                set_part(&mut entry.matrix, path, &track.values);
            }
            let (times, values) = track.in_seconds(self.ticks_per_sec);
            clip.add(self.glb, (node, PATHS[path]), "LINEAR", &times, &values)?;
        }
        Ok(())
    }
}

/// Sets one of the [`PATHS`] of a transform to the first of some values.
fn set_part(matrix: &mut DAffine3, path: usize, values: &[f32]) {
    let Parts { mut translation, mut rotation, mut scale, .. } = parts(matrix);
    match *values {
        [x, y, z, w, ..] if path == ROTATION => rotation = DQuat::from_array([x, y, z, w].map(f64::from)),
        [x, y, z, ..] if path == SCALE => scale = DVec3::from_array([x, y, z].map(f64::from)),
        [x, y, z, ..] => translation = DVec3::from_array([x, y, z].map(f64::from)),
        _ => {}
    }
    *matrix = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
}

/// Returns the node that an animation moves.
fn target(document: &Document, animation: usize, nodes: &Nodes, warnings: &mut Warnings) -> Option<usize> {
    let children = document.objects[animation].children.iter().map(|&child| &document.objects[child]);
    let name = children.filter(|child| child.is_reference()).map(|child| child.name).next();
    let Some(name) = name else {
        warnings.add(format!("{} left out: it doesn't say what it moves.", document.label(animation)));
        return None;
    };
    let node = nodes.named(name);
    if node.is_none() {
        warnings.add(format!("Animation of \"{}\" left out: no frame has that name.", short(name)));
    }
    node
}

/// Returns the file's unit of time. Some exporters count frames and don't say so: their keys would be implausibly
/// close.
fn ticks_per_sec(document: &Document, warnings: &mut Warnings) -> Result<f64, String> {
    for (index, _) in document.all("AnimTicksPerSecond") {
        let ticks = document.numbers(index).index(u32::MAX as usize, "ticks per second")?;
        if ticks > 0 {
            return Ok(ticks as f64);
        }
    }
    let (mut end, mut closest) = (0.0, f64::INFINITY);
    for (key, _) in document.all("AnimationKey") {
        for track in read_keys(document, key)?.tracks.iter().flatten() {
            let last = track.ticks.last().copied().unwrap_or(0.0);
            end = f64::max(end, last);
            if track.ticks.len() > 1 {
                closest = closest.min((last - track.ticks[0]) / (track.ticks.len() - 1) as f64);
            }
        }
    }
    if end == 0.0 || (end >= MIN_TICKS_OF_CLIPS && closest >= MIN_TICKS_BETWEEN_KEYS) {
        return Ok(f64::from(DEFAULT_TICKS_PER_SEC));
    }
    warnings.add(format!(
        "The file doesn't state the speed of its clips; at DirectX's {DEFAULT_TICKS_PER_SEC} ticks per second they would be far \
         too fast. {FRAMES_PER_SEC} were assumed: set the playback speed if that is wrong."
    ));
    Ok(f64::from(FRAMES_PER_SEC))
}

fn read_keys(document: &Document, key: usize) -> Result<Keys, String> {
    let mut numbers = document.numbers(key);
    let kind = numbers.index(4, "the kind of its keys")?;
    let width = [4, 3, 3, 16, 16][kind];
    let count = numbers.count(2 + width, "keys")?;
    let mut keys: Vec<(f64, &[f64])> = Vec::with_capacity(count);
    let mut ascend = true;
    for _ in 0..count {
        let [ticks] = numbers.array("a time")?;
        let values = numbers.index(width, "the number of values")?;
        if values != width {
            return Err(numbers.damaged(&format!("{width} values for each key"), &values.to_string()));
        }
        let ticks = ticks.max(0.0);
        ascend &= keys.last().is_none_or(|&(before, _)| before < ticks);
        keys.push((ticks, numbers.take(width, "a key")?));
    }
    if !ascend {
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Of keys at the same time, the last one wins.
        keys.reverse();
        keys.dedup_by(|a, b| a.0 == b.0);
        keys.reverse();
    }
    Ok(if width == 16 { from_matrices(&keys) } else { from_values(kind, &keys) })
}

fn from_values(kind: usize, keys: &[(f64, &[f64])]) -> Keys {
    let path = [ROTATION, SCALE, 0][kind];
    let mut track = Track::default();
    let mut before = DQuat::IDENTITY;
    for &(ticks, values) in keys {
        match *values {
            [w, x, y, z] => track.push_rotation(ticks, rotation([w, x, y, z]), &mut before),
            [x, y, z] if path == SCALE => track.push(ticks, &[x, y, z]),
            [x, y, z] => track.push(ticks, &mirrored([x, y, z]).to_array()),
            _ => {}
        }
    }
    let mut tracks = [None, None, None];
    tracks[path] = Some(track.simplified(if path == ROTATION { 4 } else { 3 }));
    Keys { tracks, are_matrices: false, is_sheared: false }
}

fn from_matrices(keys: &[(f64, &[f64])]) -> Keys {
    let mut tracks = [Track::default(), Track::default(), Track::default()];
    let [translations, rotations, scales] = &mut tracks;
    let mut before = DQuat::IDENTITY;
    let mut is_sheared = false;
    for &(ticks, values) in keys {
        let mut numbers = [0.0; 16];
        numbers.copy_from_slice(values);
        let parts = parts(&matrix(numbers));
        is_sheared |= parts.is_sheared;
        translations.push(ticks, &parts.translation.to_array());
        rotations.push_rotation(ticks, parts.rotation, &mut before);
        scales.push(ticks, &parts.scale.to_array());
    }
    let [translations, rotations, scales] = tracks;
    let tracks = [translations.simplified(3), rotations.simplified(4), scales.simplified(3)].map(Some);
    Keys { tracks, are_matrices: true, is_sheared }
}

impl Track {
    fn push(&mut self, ticks: f64, values: &[f64]) {
        self.ticks.push(ticks);
        self.values.extend(values.iter().map(|&value| value as f32));
    }

    /// Adds a rotation with the sign that is nearer to the one before.
    fn push_rotation(&mut self, ticks: f64, rotation: DQuat, before: &mut DQuat) {
        let rotation = if rotation.dot(*before) < 0.0 { -rotation } else { rotation };
        *before = rotation;
        self.push(ticks, &rotation.to_array());
    }

    /// Returns the times and values of keys. Of those that are too close for 32 bits, the first is kept.
    fn in_seconds(&self, ticks_per_sec: f64) -> (Vec<f32>, Vec<f32>) {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        let width = self.values.len() / self.ticks.len();
        for (ticks, value) in self.ticks.iter().zip(self.values.chunks_exact(width)) {
            let time = (ticks / ticks_per_sec) as f32;
            if times.last() != Some(&time) {
                times.push(time);
                values.extend_from_slice(value);
            }
        }
        (times, values)
    }

    /// Reduces constant values to the first and the last key, which keeps the clip's end.
    fn simplified(mut self, width: usize) -> Track {
        let (first, rest) = self.values.split_at(width.min(self.values.len()));
        if self.ticks.len() > 2 && rest.chunks_exact(width).all(|value| value == first) {
            self.ticks = vec![self.ticks[0], self.ticks[self.ticks.len() - 1]];
            self.values.truncate(2 * width);
        }
        self
    }
}
