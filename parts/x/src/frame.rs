//! The node hierarchy.

use gaitway_glb::{Glb, Object, Warnings, numbers};
use glam::{DAffine3, DVec3};

use crate::document::{Document, Names, short, text};
use crate::too_large;
use crate::transform::{columns, matrix, parts};

const MAX_NODES: usize = 1 << 16;

/// A glTF node under construction.
pub struct Entry {
    name: String,
    pub matrix: DAffine3,
    children: Vec<usize>,
    /// Its topmost ancestor, or the node itself.
    root: usize,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub is_animated: bool,
}

/// The glTF nodes: the frames in the file's order, then what meshes need.
pub struct Nodes<'a> {
    pub entries: Vec<Entry>,
    roots: Vec<usize>,
    /// Node of each object that is a frame.
    of_object: Vec<Option<usize>>,
    names: Names<'a>,
    /// Whether all nodes need a common one above them.
    needs_root: bool,
    /// Whether the nodes are what animations move, in a file without frames and meshes.
    pub are_targets: bool,
}

impl<'a> Nodes<'a> {
    pub fn new(document: &Document<'a>) -> Result<Nodes<'a>, String> {
        let of_object = vec![None; document.objects.len()];
        let names = Names::of(document, "Frame");
        let mut nodes =
            Nodes { entries: Vec::new(), roots: Vec::new(), of_object, names, needs_root: false, are_targets: false };
        for (index, object) in document.all("Frame") {
            if nodes.entries.len() == MAX_NODES {
                return Err(too_large(MAX_NODES, "frames", document.all("Frame").count()));
            }
            let mut local = DAffine3::IDENTITY;
            if let Some((transform, _)) = document.children(index, "FrameTransformMatrix").next() {
                local = matrix(document.numbers(transform).array("a matrix")?);
            }
            let parent = nodes.of_object[object.parent];
            nodes.of_object[index] = Some(nodes.add(parent, text(object.name), local));
        }
        if nodes.entries.is_empty() && document.all("Mesh").next().is_none() {
            nodes.add_targets(document)?;
        }
        Ok(nodes)
    }

    /// Adds the frames that the animations of a file without frames name, in the file's order.
    fn add_targets(&mut self, document: &Document<'a>) -> Result<(), String> {
        self.are_targets = true;
        self.names = Names::of_targets(document);
        let mut objects: Vec<usize> = self.names.objects().collect();
        if objects.len() > MAX_NODES {
            return Err(too_large(MAX_NODES, "animated frames", objects.len()));
        }
        objects.sort_unstable();
        for object in objects {
            self.of_object[object] = Some(self.add(None, text(document.objects[object].name), DAffine3::IDENTITY));
        }
        Ok(())
    }

    /// Returns the node of an object that is a frame.
    pub fn of(&self, object: usize) -> Option<usize> {
        self.of_object[object]
    }

    /// Returns the node of the first frame of that name.
    pub fn named(&self, name: &[u8]) -> Option<usize> {
        self.of_object[self.names.find(name)?]
    }

    /// Adds a node and returns its index.
    pub fn add(&mut self, parent: Option<usize>, name: String, matrix: DAffine3) -> usize {
        let index = self.entries.len();
        let root = parent.map_or(index, |parent| self.entries[parent].root);
        let children = Vec::new();
        self.entries.push(Entry { name, matrix, children, root, mesh: None, skin: None, is_animated: false });
        match parent {
            Some(parent) => self.entries[parent].children.push(index),
            None => self.roots.push(index),
        }
        index
    }

    /// Records the joints of a skin: glTF requires a common root for them.
    pub fn join(&mut self, joints: &[usize]) {
        let mut roots = joints.iter().map(|&joint| self.entries[joint].root);
        let first = roots.next();
        self.needs_root |= roots.any(|root| Some(root) != first);
    }

    /// Writes the nodes and the scene.
    pub fn write(&mut self, glb: &mut Glb, warnings: &mut Warnings) {
        if self.needs_root {
            let children = std::mem::take(&mut self.roots);
            let root = self.add(None, String::new(), DAffine3::IDENTITY);
            self.entries[root].children = children;
        }
        for entry in &self.entries {
            let mut node = Object::new();
            if !entry.name.is_empty() {
                node.set("name", entry.name.as_str());
            }
            if !entry.children.is_empty() {
                node.set("children", entry.children.as_slice());
            }
            add_transform(&mut node, entry, warnings);
            for (key, index) in [("mesh", entry.mesh), ("skin", entry.skin)] {
                if let Some(index) = index {
                    node.set(key, index);
                }
            }
            glb.nodes.push(node.into());
        }
        glb.scene_roots.clone_from(&self.roots);
    }
}

fn add_transform(node: &mut Object, entry: &Entry, warnings: &mut Warnings) {
    let local = parts(&entry.matrix);
    if local.is_sheared && !entry.is_animated {
        node.set("matrix", numbers(&columns(&entry.matrix)));
        return;
    }
    if local.is_sheared {
        let name = short(entry.name.as_bytes());
        warnings.add(format!("Frame \"{name}\": its matrix is sheared, which an animated node can't be."));
    }
    if local.translation != DVec3::ZERO {
        node.set("translation", numbers(&local.translation.to_array()));
    }
    let rotation = local.rotation.to_array();
    if rotation[..3] != [0.0; 3] {
        node.set("rotation", numbers(&rotation));
    }
    if local.scale != DVec3::ONE {
        node.set("scale", numbers(&local.scale.to_array()));
    }
}
