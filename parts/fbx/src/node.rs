//! The node hierarchy, with its cameras and lights.

use gaitway_glb::{Glb, Object, Warnings, number, numbers, push};
use ufbx::{Matrix, Node, Quat, Scene, Transform, Vec3};

/// Properties of cameras and lights to which other nodes are connected: the one they look at, and the one that defines up.
const TARGETS: [&str; 2] = ["LookAtProperty", "UpVectorProperty"];

/// A glTF node under construction.
pub struct Entry {
    name: Option<String>,
    transform: Transform,
    children: Vec<usize>,
    /// Its topmost ancestor, or the node itself.
    root: usize,
    visible: bool,
    hides_children: bool,
    is_bone: bool,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    camera: Option<usize>,
    light: Option<usize>,
}

impl Entry {
    fn new(transform: Transform, root: usize) -> Entry {
        Entry {
            name: None,
            transform,
            children: Vec::new(),
            root,
            visible: true,
            hides_children: false,
            is_bone: false,
            mesh: None,
            skin: None,
            camera: None,
            light: None,
        }
    }
}

/// The glTF nodes: those of the file in ufbx's order, without its root, then leaves that carry what a node can't.
pub struct Nodes {
    pub entries: Vec<Entry>,
    roots: Vec<usize>,
    /// glTF node of each ufbx node; none for the root.
    of_typed_id: Vec<Option<usize>>,
    /// Whether all nodes need a common one above them.
    needs_root: bool,
}

impl Nodes {
    pub fn new(scene: &Scene) -> Nodes {
        let mut of_typed_id = vec![None; scene.nodes.count];
        let mut count = 0;
        for (node, index) in scene.nodes.into_iter().zip(&mut of_typed_id) {
            if !node.is_root {
                *index = Some(count);
                count += 1;
            }
        }
        let mut nodes = Nodes { entries: Vec::with_capacity(count), roots: Vec::new(), of_typed_id, needs_root: false };
        // Parents come before their children.
        for node in scene.nodes.into_iter().filter(|node| !node.is_root) {
            let parent = node.parent.as_deref().and_then(|parent| nodes.index(parent));
            let root = parent.and_then(|parent| nodes.entries.get(parent)).map(|parent| parent.root);
            let entry = Entry {
                name: name(node),
                children: node.children.into_iter().filter_map(|child| nodes.index(child)).collect(),
                visible: node.visible,
                is_bone: node.attrib_type == ufbx::ElementType::Bone,
                ..Entry::new(finite(node.local_transform), root.unwrap_or(nodes.entries.len()))
            };
            nodes.entries.push(entry);
        }
        nodes.roots = scene.root_node.children.into_iter().filter_map(|child| nodes.index(child)).collect();
        nodes.hide_lower_levels_of_detail(scene);
        nodes.hide_targets(scene);
        nodes
    }

    /// Returns the glTF node of a node of the file.
    pub fn index(&self, node: &Node) -> Option<usize> {
        self.of_typed_id.get(node.element.typed_id as usize).copied().flatten()
    }

    /// Adds a nameless node below another one and returns its index.
    pub fn add_leaf(&mut self, parent: usize, rotation: Quat) -> usize {
        let index = self.entries.len();
        let root = self.entries.get(parent).map_or(index, |parent| parent.root);
        self.entries.push(Entry::new(Transform { rotation, ..ufbx::identity_transform() }, root));
        if let Some(parent) = self.entries.get_mut(parent) {
            parent.children.push(index);
        }
        index
    }

    /// Records the joints of a skin. glTF requires a common root for them; if there are several roots, FBX's nameless
    /// one is used.
    pub fn join(&mut self, joints: &[usize]) {
        let mut roots = joints.iter().filter_map(|&joint| self.entries.get(joint)).map(|entry| entry.root);
        let first = roots.next();
        self.needs_root |= roots.any(|root| Some(root) != first);
    }

    /// A group's children are versions of one object: only the first, the finest, is visible.
    fn hide_lower_levels_of_detail(&mut self, scene: &Scene) {
        for group in scene.lod_groups.into_iter().flat_map(|group| &group.element.instances) {
            for level in group.children.into_iter().skip(1) {
                if let Some(entry) = self.index(level).and_then(|index| self.entries.get_mut(index)) {
                    (entry.visible, entry.hides_children) = (false, true);
                }
            }
        }
    }

    /// Hides what cameras and lights only look at.
    fn hide_targets(&mut self, scene: &Scene) {
        for node in scene.nodes.into_iter().filter(|node| node.camera.is_some() || node.light.is_some()) {
            let connections = node.element.connections_dst.into_iter();
            let aims = connections.filter(|connection| TARGETS.contains(&&*connection.dst_prop));
            for target in aims.filter(|connection| connection.src.type_ == ufbx::ElementType::Node) {
                if let Some(&Some(index)) = self.of_typed_id.get(target.src.typed_id as usize) {
                    self.set(index, |entry| entry.visible = false);
                }
            }
        }
    }

    /// A hidden node hides only itself, whereas in glTF it hides everything below: nodes that would hide others stay visible, and
    /// so do bones, which programs hide to show the mesh alone. Other hidden nodes aren't part of the scene, such as
    /// MotionBuilder's own cameras.
    fn show_what_hides_others(&mut self) {
        let mut is_needed = vec![false; self.entries.len()];
        // Children, and leaves even more, come after their parents.
        for index in (0..self.entries.len()).rev() {
            let below = self.entries[index].children.iter().any(|&child| is_needed[child]);
            let entry = &mut self.entries[index];
            entry.visible |= !entry.hides_children && (below || entry.is_bone);
            is_needed[index] = entry.visible || below || entry.mesh.is_some();
        }
    }

    /// Writes the nodes and the scene.
    pub fn write(&mut self, glb: &mut Glb) {
        self.show_what_hides_others();
        if self.needs_root {
            let root = self.entries.len();
            let children = std::mem::replace(&mut self.roots, vec![root]);
            self.entries.push(Entry { children, ..Entry::new(ufbx::identity_transform(), root) });
        }
        for entry in &self.entries {
            let mut node = Object::new();
            if let Some(name) = &entry.name {
                node.set("name", name.as_str());
            }
            if !entry.children.is_empty() {
                node.set("children", entry.children.as_slice());
            }
            add_transform(&mut node, &entry.transform);
            for (key, index) in [("mesh", entry.mesh), ("skin", entry.skin), ("camera", entry.camera)] {
                if let Some(index) = index {
                    node.set(key, index);
                }
            }
            let mut extensions = Object::new();
            if let Some(light) = entry.light {
                glb.use_extension("KHR_lights_punctual");
                extensions.set("KHR_lights_punctual", Object::new().with("light", light));
            }
            if !entry.visible {
                glb.use_extension("KHR_node_visibility");
                extensions.set("KHR_node_visibility", Object::new().with("visible", false));
            }
            if !extensions.is_empty() {
                node.set("extensions", extensions);
            }
            glb.nodes.push(node.into());
        }
        glb.scene_roots.clone_from(&self.roots);
    }
}

/// Returns the node's name. A helper of ufbx, which holds a scale that its siblings don't inherit, is named after its node.
fn name(node: &Node) -> Option<String> {
    let named = if node.is_scale_helper { node.parent.as_ref()? } else { node };
    let name = &*named.element.name;
    match (name.is_empty(), node.is_scale_helper) {
        (true, _) => None,
        (false, true) => Some(format!("{name} scale")),
        (false, false) => Some(name.to_owned()),
    }
}

/// Returns the transform with parts that aren't finite replaced by the identity's, and a unit quaternion.
pub fn finite(transform: Transform) -> Transform {
    let vector = |v: Vec3, or: f64| {
        let valid = [v.x, v.y, v.z].iter().all(|&component| (component as f32).is_finite());
        if valid { v } else { Vec3 { x: or, y: or, z: or } }
    };
    let q = transform.rotation;
    let length = (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w).sqrt();
    let rotation = if length.is_finite() && length > 1e-100 {
        Quat { x: q.x / length, y: q.y / length, z: q.z / length, w: q.w / length }
    } else {
        ufbx::identity_quat()
    };
    Transform { translation: vector(transform.translation, 0.0), rotation, scale: vector(transform.scale, 1.0) }
}

fn add_transform(node: &mut Object, transform: &Transform) {
    let (t, r, s) = (transform.translation, transform.rotation, transform.scale);
    if (t.x, t.y, t.z) != (0.0, 0.0, 0.0) {
        node.set("translation", numbers(&[t.x, t.y, t.z]));
    }
    if (r.x, r.y, r.z) != (0.0, 0.0, 0.0) {
        node.set("rotation", numbers(&[r.x, r.y, r.z, r.w]));
    }
    if (s.x, s.y, s.z) != (1.0, 1.0, 1.0) {
        node.set("scale", numbers(&[s.x, s.y, s.z]));
    }
}

/// Returns the 16 elements of a glTF matrix.
pub fn columns(m: &Matrix) -> [f32; 16] {
    [m.m00, m.m10, m.m20, 0.0, m.m01, m.m11, m.m21, 0.0, m.m02, m.m12, m.m22, 0.0, m.m03, m.m13, m.m23, 1.0]
        .map(|element| element as f32)
}

/// Adds cameras and lights on leaves that turn them: FBX cameras look along +X and lights shine along -Y, glTF's along -Z.
pub fn add_cameras_and_lights(scene: &Scene, nodes: &mut Nodes, glb: &mut Glb, warnings: &mut Warnings) {
    let mirrored = scene.metadata.mirror_axis == ufbx::MirrorAxis::X;
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    let camera_turn = Quat { x: 0.0, y: if mirrored { quarter } else { -quarter }, z: 0.0, w: quarter };
    let light_turn = Quat { x: -quarter, y: 0.0, z: 0.0, w: quarter };
    let mut cameras = vec![None; scene.cameras.count];
    let mut lights = vec![None; scene.lights.count];
    let mut unsupported = 0;
    for node in &scene.nodes {
        let Some(parent) = nodes.index(node) else { continue };
        if let Some(camera) = &node.camera
            && let Some(written) = cameras.get_mut(camera.element.typed_id as usize)
        {
            let index = *written.get_or_insert_with(|| write_camera(camera, glb));
            let leaf = nodes.add_leaf(parent, camera_turn);
            nodes.set(leaf, |entry| (entry.camera, entry.visible) = (Some(index), node.visible));
        }
        if let Some(light) = &node.light
            && let Some(written) = lights.get_mut(light.element.typed_id as usize)
        {
            unsupported += usize::from(matches!(light.type_, ufbx::LightType::Area | ufbx::LightType::Volume));
            let index = *written.get_or_insert_with(|| write_light(light, glb));
            let leaf = nodes.add_leaf(parent, light_turn);
            nodes.set(leaf, |entry| entry.light = Some(index));
        }
    }
    if unsupported > 0 {
        warnings.add(format!("{unsupported} area or volume lights became point lights."));
    }
}

impl Nodes {
    fn set(&mut self, index: usize, change: impl FnOnce(&mut Entry)) {
        if let Some(entry) = self.entries.get_mut(index) {
            change(entry);
        }
    }
}

fn write_camera(camera: &ufbx::Camera, glb: &mut Glb) -> usize {
    let mut json = Object::new();
    if !camera.element.name.is_empty() {
        json.set("name", &*camera.element.name);
    }
    let near = if camera.near_plane > 0.0 && camera.near_plane.is_finite() { camera.near_plane } else { 0.01 };
    let far = if camera.far_plane > near && camera.far_plane.is_finite() { camera.far_plane } else { near * 1e5 };
    let aspect = if camera.aspect_ratio > 0.0 && camera.aspect_ratio.is_finite() { camera.aspect_ratio } else { 1.0 };
    if camera.projection_mode == ufbx::ProjectionMode::Orthographic {
        let half = |size: f64| if size > 0.0 && size.is_finite() { size / 2.0 } else { 1.0 };
        let size = camera.orthographic_size;
        json.set("type", "orthographic");
        json.set(
            "orthographic",
            Object::new()
                .with("xmag", number(half(size.x)))
                .with("ymag", number(half(size.y)))
                .with("zfar", number(far))
                .with("znear", number(near)),
        );
    } else {
        let degrees = camera.field_of_view_deg.y;
        let degrees = if degrees > 0.1 && degrees < 179.0 { degrees } else { 35.0 };
        json.set("type", "perspective");
        json.set(
            "perspective",
            Object::new()
                .with("aspectRatio", number(aspect))
                .with("yfov", number(degrees.to_radians()))
                .with("zfar", number(far))
                .with("znear", number(near)),
        );
    }
    push(&mut glb.cameras, json)
}

/// Writes a light. FBX has no physical units: its intensity of 100 % is written as 1.
fn write_light(light: &ufbx::Light, glb: &mut Glb) -> usize {
    let mut json = Object::new();
    if !light.element.name.is_empty() {
        json.set("name", &*light.element.name);
    }
    let unit = |value: f64| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
    json.set("color", numbers(&[light.color.x, light.color.y, light.color.z].map(unit)));
    let lit = light.cast_light && light.intensity.is_finite();
    json.set("intensity", number(if lit { light.intensity.max(0.0) } else { 0.0 }));
    let kind = match light.type_ {
        ufbx::LightType::Directional => "directional",
        ufbx::LightType::Spot => "spot",
        _ => "point",
    };
    json.set("type", kind);
    if kind == "spot" {
        let half = |degrees: f64| (degrees / 2.0).to_radians();
        let outer =
            if light.outer_angle > 0.0 && light.outer_angle <= 180.0 { half(light.outer_angle) } else { half(45.0) };
        let inner = if light.inner_angle > 0.0 { half(light.inner_angle).min(outer * 0.999) } else { 0.0 };
        json.set("spot", Object::new().with("innerConeAngle", number(inner)).with("outerConeAngle", number(outer)));
    }
    push(&mut glb.lights, json)
}
