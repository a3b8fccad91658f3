//! Writes a glTF model as one GLB, with clips added after its own, which may get other names or be left out.

use std::borrow::Cow;

use base64::Engine;
use gaitway_character::anim::{Clip, JointIndex, Skeleton};
use gaitway_character::asset::Warnings;
use gltf::json::Root;
use imagesize::ImageType;
use serde_json::json;
use serde_json::value::RawValue;

use super::clip::{self, Counts};
use super::own_clips::{self, OwnClips};
use super::{WriteError, glb};
use crate::gltf::accessor::Bytes;
use crate::gltf::document::{Document, as_text, json_error, size};
use crate::gltf::images::{AVIF, KTX2, is_avif};
use crate::gltf::object::{Array, Object, raw};
use crate::gltf::{container, data, resolve_buffers};
use crate::{FileSet, extension, named};

/// The extension that textures need to use KTX2.
const BASISU: &str = "KHR_texture_basisu";

/// Writes the file `file` of the set as a self-contained GLB, with `clips` (of `skeleton`, which was loaded from the
/// same file) added after its `own`. Its first buffer is the beginning of the new one unless keys are left out; indices,
/// numbers and everything unknown are preserved. Only nodes whose matrix an added clip animates get translation, rotation and
/// scale instead, because the specification forbids animating a matrix. A GLB without anything to change or embed is returned
/// unchanged.
pub fn model(
    files: &FileSet,
    file: &str,
    skeleton: &Skeleton,
    own: &OwnClips,
    clips: &[&Clip],
) -> Result<Vec<u8>, WriteError> {
    let bytes = named(files, file)?;
    let container = container::open(file, bytes)?;
    let root = Document::read(file, &container)?.root;
    let text = as_text(container.json);
    let mut json: Object =
        serde_json::from_str(&text).map_err(|problem| json_error(file, &text, container.is_glb, &problem))?;
    if root.nodes.len() != skeleton.len() {
        let (nodes, joints) = (root.nodes.len(), skeleton.len());
        return Err(WriteError::OtherSkeleton { file: file.to_owned(), nodes, joints });
    }
    let outside = Outside::new(&root, container.is_glb);
    let is_unchanged = clips.is_empty() && own.are_unchanged();
    if container.is_glb && is_unchanged && !outside.buffers && outside.images.is_empty() {
        return Ok(bytes.to_vec());
    }
    let mut warnings = Warnings::default();
    let buffers = resolve_buffers(files, file, &container, &root, &mut warnings).map_err(|p| p.in_file(file))?;
    let mut binary = buffers.first().map_or(Vec::new(), |first| {
        // A first buffer without data is moved back below if anything is added.
        first.as_ref().map_or(Vec::new(), |first| first.as_slice().to_vec())
    });
    let (chunk, json_views) = (binary.len(), json.count("bufferViews"));
    join_buffers(&mut json, &root, &buffers, &outside, &mut binary);
    embed_images(files, file, &mut json, &root, &outside, &mut binary);
    own_clips::edit(&mut json, &root, own, Some(&mut binary).filter(|_| matches!(buffers.first(), Some(Some(_)))));
    let counts = Counts { accessors: json.count("accessors"), buffer_views: json.count("bufferViews") };
    let added = clip::add(clips, 0, skeleton, true, counts, &mut binary)?;
    json.extend("accessors", added.accessors);
    json.extend("bufferViews", added.buffer_views);
    json.extend("animations", added.animations);
    for clip in clips {
        split_matrices(&mut json, clip, skeleton);
    }
    if matches!(buffers.first(), Some(None)) {
        if !binary.is_empty() {
            insert_first_buffer(&mut json, binary.len(), json_views);
        }
        return glb::glb(serde_json::to_vec(&json).unwrap_or_default(), binary);
    }
    // A GLB's chunk is up to three bytes longer than its buffer. Other files may be longer than their buffer says, and
    // views may reach beyond it.
    let byte_length = match root.buffers.first() {
        Some(first) if container.is_glb && binary.len() == chunk && own.left_out.is_empty() => size(first.byte_length),
        _ => binary.len(),
    };
    set_first_buffer(&mut json, byte_length);
    let json = serde_json::to_vec(&json).unwrap_or_default();
    glb::glb(json, binary)
}

/// Data outside the binary chunk, which is embedded. In a .gltf that includes data URIs: base64 is a third larger.
struct Outside {
    buffers: bool,
    images: Vec<usize>,
}

impl Outside {
    fn new(root: &Root, is_glb: bool) -> Self {
        let outside = |uri: &Option<String>| uri.as_deref().is_some_and(|uri| !is_glb || !data::is_data_uri(uri));
        Self {
            buffers: root.buffers.iter().any(|buffer| outside(&buffer.uri)),
            images: (0..root.images.len()).filter(|&index| outside(&root.images[index].uri)).collect(),
        }
    }
}

/// Appends the other buffers to the first. If that is impossible (one has no data, or an extension refers to buffers by
/// number) they become data URIs.
fn join_buffers(json: &mut Object, root: &Root, buffers: &[Option<Bytes>], outside: &Outside, binary: &mut Vec<u8>) {
    if !outside.buffers || buffers.len() < 2 {
        return;
    }
    let mut views: Vec<Object> = json.read("bufferViews").unwrap_or_default();
    let named_elsewhere = views.iter().any(|view| {
        let extensions: Object = view.read("extensions").unwrap_or_default();
        extensions.values().any(|extension: Object| extension.read::<f64>("buffer").is_some())
    });
    let Some(all) = buffers.iter().map(Option::as_ref).collect::<Option<Vec<&Bytes>>>().filter(|_| !named_elsewhere)
    else {
        keep_as_data(json, root, buffers);
        return;
    };
    let mut starts = vec![0];
    for bytes in all.into_iter().skip(1) {
        glb::pad(binary, 0);
        starts.push(binary.len());
        binary.extend_from_slice(bytes.as_slice());
    }
    for (view, read) in views.iter_mut().zip(&root.buffer_views) {
        if let Some(&start) = starts.get(read.buffer.value()).filter(|_| read.buffer.value() > 0) {
            view.set("buffer", &0);
            view.set("byteOffset", &start.saturating_add(read.byte_offset.map_or(0, size)));
        }
    }
    let first: Array = json.read::<Array>("buffers").unwrap_or_default().into_iter().take(1).collect();
    json.set("buffers", &first);
    // An empty list is not allowed.
    if !views.is_empty() {
        json.set("bufferViews", &views);
    }
}

fn keep_as_data(json: &mut Object, root: &Root, buffers: &[Option<Bytes>]) {
    let mut written: Vec<Object> = json.read("buffers").unwrap_or_default();
    for ((buffer, read), bytes) in written.iter_mut().zip(&root.buffers).zip(buffers).skip(1) {
        if let (Some(uri), Some(bytes)) = (&read.uri, bytes)
            && !data::is_data_uri(uri)
        {
            let text = base64::engine::general_purpose::STANDARD.encode(bytes.as_slice());
            buffer.set("uri", &format!("data:application/octet-stream;base64,{text}"));
        }
    }
    json.set("buffers", &written);
}

/// Embeds images. Those that are not among the files keep their URI.
fn embed_images(files: &FileSet, file: &str, json: &mut Object, root: &Root, outside: &Outside, binary: &mut Vec<u8>) {
    if outside.images.is_empty() {
        return;
    }
    let mut images: Array = json.read("images").unwrap_or_default();
    let mut views: Array = Vec::new();
    let mut ktx2: Vec<usize> = Vec::new();
    let first_view = json.count("bufferViews");
    for &index in &outside.images {
        let Some(uri) = root.images[index].uri.as_deref() else { continue };
        let bytes: Option<Cow<[u8]>> = match data::is_data_uri(uri) {
            true => data::data_uri("", uri).ok().map(Cow::Owned),
            false => data::find(files, file, uri).map(|found| Cow::Borrowed(&found.bytes[..])),
        };
        let (Some(bytes), Some(text)) = (bytes, images.get_mut(index)) else { continue };
        let Ok(mut image) = serde_json::from_str::<Object>(text.get()) else { continue };
        let mime = mime(&bytes, uri, image.read("mimeType"));
        glb::pad(binary, 0);
        views.push(raw(&json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() })));
        binary.extend_from_slice(&bytes);
        image.remove("uri");
        if mime == KTX2 {
            ktx2.push(index);
        }
        image.set("mimeType", &mime);
        image.set("bufferView", &(first_view + views.len() - 1));
        *text = raw(&image);
    }
    json.extend("bufferViews", views);
    json.set("images", &images);
    declare_ktx2(json, &ktx2);
}

/// Moves textures that refer to these KTX2 images directly to the extension for it. An image in a file of its own may
/// be of any kind, one inside a GLB may not.
fn declare_ktx2(json: &mut Object, images: &[usize]) {
    let mut textures: Vec<Object> = json.read("textures").unwrap_or_default();
    let mut changed = false;
    for texture in &mut textures {
        let Some(source) = texture.read::<usize>("source").filter(|source| images.contains(source)) else { continue };
        let mut extensions: Object = texture.read("extensions").unwrap_or_default();
        if extensions.read::<Object>(BASISU).is_none() {
            extensions.set(BASISU, &json!({ "source": source }));
        }
        texture.remove("source");
        texture.set("extensions", &extensions);
        changed = true;
    }
    if changed {
        json.set("textures", &textures);
        let mut used: Vec<String> = json.read("extensionsUsed").unwrap_or_default();
        if !used.iter().any(|name| name == BASISU) {
            used.push(BASISU.to_owned());
            json.set("extensionsUsed", &used);
        }
    }
}

/// Returns the MIME type of an image by its content, else as the file declares it, else by its extension. An image of
/// an unknown kind is embedded as well: its file may be unavailable wherever the GLB goes.
fn mime(bytes: &[u8], uri: &str, said: Option<String>) -> String {
    let by_content = match imagesize::image_type(bytes) {
        Ok(ImageType::Png) => Some("image/png"),
        Ok(ImageType::Jpeg) => Some("image/jpeg"),
        Ok(ImageType::Webp) => Some("image/webp"),
        _ if bytes.starts_with(&gaitway_ktx2::MAGIC) => Some(KTX2),
        _ if is_avif(bytes) => Some(AVIF),
        _ => None,
    };
    let in_uri = || {
        let (kind, _) = uri.get(5..).filter(|_| data::is_data_uri(uri))?.split_once([';', ','])?;
        kind.starts_with("image/").then(|| kind.to_owned())
    };
    let by_extension = || match extension(uri).as_str() {
        "bmp" => "image/bmp",
        "dds" => "image/vnd-ms.dds",
        "gif" => "image/gif",
        "tga" => "image/x-tga",
        "tif" | "tiff" => "image/tiff",
        _ => "application/octet-stream",
    };
    by_content.map(str::to_owned).or(said).or_else(in_uri).unwrap_or_else(|| by_extension().to_owned())
}

/// Inserts the GLB's binary chunk before the first buffer, which has no data and must stay that way: only the file's
/// own `own_views` views refer to the buffers that were there.
fn insert_first_buffer(json: &mut Object, byte_length: usize, own_views: usize) {
    let mut views: Vec<Object> = json.read("bufferViews").unwrap_or_default();
    for view in views.iter_mut().take(own_views) {
        shift_buffer(view);
        let mut extensions: Object = view.read("extensions").unwrap_or_default();
        extensions.change_objects(shift_buffer);
        if !extensions.is_empty() {
            view.set("extensions", &extensions);
        }
    }
    if !views.is_empty() {
        json.set("bufferViews", &views);
    }
    let mut buffers: Array = json.read("buffers").unwrap_or_default();
    buffers.insert(0, raw(&json!({ "byteLength": byte_length })));
    json.set("buffers", &buffers);
}

fn shift_buffer(object: &mut Object) {
    if let Some(buffer) = object.read::<f64>("buffer") {
        object.set("buffer", &(buffer as u64 + 1));
    }
}

/// Makes the GLB's binary chunk the first buffer.
fn set_first_buffer(json: &mut Object, byte_length: usize) {
    let mut buffers: Array = json.read("buffers").unwrap_or_default();
    let mut first: Object =
        buffers.first().and_then(|first| serde_json::from_str(first.get()).ok()).unwrap_or_default();
    if buffers.is_empty() && byte_length == 0 {
        return;
    }
    first.remove("uri");
    first.set("byteLength", &byte_length);
    match buffers.first_mut() {
        Some(buffer) => *buffer = raw(&first),
        None => buffers.push(raw(&first)),
    }
    json.set("buffers", &buffers);
}

/// Replaces the matrix of nodes that the clip animates by translation, rotation and scale.
fn split_matrices(json: &mut Object, clip: &Clip, skeleton: &Skeleton) {
    let mut nodes: Array = json.read("nodes").unwrap_or_default();
    let mut changed = false;
    for channel in clip::written(clip, skeleton, false) {
        let Some(text) = nodes.get_mut(skeleton.source_index(channel.joint)) else { continue };
        if !text.get().contains("matrix") {
            continue;
        }
        let Ok(mut node) = serde_json::from_str::<Object>(text.get()) else { continue };
        if node.read::<[f64; 16]>("matrix").is_some() {
            node.replace("matrix", parts(skeleton, channel.joint));
            *text = raw(&node);
            changed = true;
        }
    }
    if changed {
        json.set("nodes", &nodes);
    }
}

fn parts(skeleton: &Skeleton, joint: JointIndex) -> Vec<(&'static str, Box<RawValue>)> {
    let rest = skeleton.rest().local(joint);
    // As f64: readers that go through f64 may parse the shortest form of an f32 as its neighbour.
    vec![
        ("translation", raw(&rest.translation.as_dvec3().to_array())),
        ("rotation", raw(&rest.rotation.as_dquat().to_array())),
        ("scale", raw(&rest.scale.as_dvec3().to_array())),
    ]
}
