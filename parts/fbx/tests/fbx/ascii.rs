//! Writes small ASCII FBX files, so that the converter is tested without real ones.

use std::fmt::Write;

use crate::glb::Glb;

/// Ticks of FBX per second.
const SECOND: i64 = 46_186_158_000;

/// Builds an FBX 7.4 text from objects and connections.
pub struct Fbx {
    settings: String,
    objects: String,
    connections: String,
    next: i64,
}

impl Fbx {
    /// Starts a Y-up scene; its unit is in centimetres.
    pub fn new(unit: f64) -> Fbx {
        Fbx::with_axes(unit, [(1, 1), (2, 1), (0, 1)])
    }

    /// Starts a scene with other axes: up, front and right, each as axis and sign.
    pub fn with_axes(unit: f64, axes: [(i32, i32); 3]) -> Fbx {
        let mut settings = String::new();
        for ((axis, sign), name) in axes.into_iter().zip(["UpAxis", "FrontAxis", "CoordAxis"]) {
            writeln!(settings, "P: \"{name}\", \"int\", \"Integer\", \"\",{axis}").unwrap();
            writeln!(settings, "P: \"{name}Sign\", \"int\", \"Integer\", \"\",{sign}").unwrap();
        }
        writeln!(settings, "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{unit}").unwrap();
        Fbx { settings, objects: String::new(), connections: String::new(), next: 1 }
    }

    /// Adds an object: its class as in the file ("Model", "Geometry", …), name, kind and contents.
    pub fn object(&mut self, class: &str, name: &str, kind: &str, contents: &str) -> i64 {
        let id = self.next;
        self.next += 1;
        let prefix = match class {
            "AnimationStack" => "AnimStack",
            "AnimationLayer" => "AnimLayer",
            "AnimationCurveNode" => "AnimCurveNode",
            "AnimationCurve" => "AnimCurve",
            "Deformer" if kind == "Cluster" || kind == "BlendShapeChannel" => "SubDeformer",
            other => other,
        };
        writeln!(self.objects, "{class}: {id}, \"{prefix}::{name}\", \"{kind}\" {{\n{contents}\n}}").unwrap();
        id
    }

    /// Adds a node with properties such as `("Lcl Translation", [1.0, 2.0, 3.0])` below a parent; 0 is the root.
    pub fn node(&mut self, name: &str, kind: &str, parent: i64, properties: &[(&str, [f64; 3])]) -> i64 {
        let mut contents = "Properties70: {\n".to_owned();
        for (name, [x, y, z]) in properties {
            writeln!(contents, "P: \"{name}\", \"{name}\", \"\", \"A\",{x},{y},{z}").unwrap();
        }
        contents.push('}');
        let id = self.object("Model", name, kind, &contents);
        self.connect(id, parent);
        id
    }

    pub fn connect(&mut self, child: i64, parent: i64) {
        writeln!(self.connections, "C: \"OO\",{child},{parent}").unwrap();
    }

    /// Binds vertices to a joint, with weights, where the joint is at this height.
    pub fn cluster(&mut self, skin: i64, joint: i64, weights: &[(u32, f64)], height: f64) {
        let (count, list) = (weights.len(), |texts: Vec<String>| texts.join(","));
        let vertices = list(weights.iter().map(|(vertex, _)| vertex.to_string()).collect());
        let weights = list(weights.iter().map(|(_, weight)| weight.to_string()).collect());
        let contents = format!(
            "Indexes: *{count} {{\na: {vertices}\n}}\nWeights: *{count} {{\na: {weights}\n}}\n\
             Transform: *16 {{\na: 1,0,0,0,0,1,0,0,0,0,1,0,0,{},0,1\n}}\n\
             TransformLink: *16 {{\na: 1,0,0,0,0,1,0,0,0,0,1,0,0,{height},0,1\n}}",
            -height
        );
        let cluster = self.object("Deformer", "", "Cluster", &contents);
        self.connect(cluster, skin);
        self.connect(joint, cluster);
    }

    pub fn connect_property(&mut self, child: i64, parent: i64, property: &str) {
        writeln!(self.connections, "C: \"OP\",{child},{parent}, \"{property}\"").unwrap();
    }

    /// Adds a quad of two units, facing +Z, to a node.
    pub fn quad(&mut self, node: i64) -> i64 {
        let contents = "Vertices: *12 {\na: -1,-1,0,1,-1,0,1,1,0,-1,1,0\n}\nPolygonVertexIndex: *4 {\na: 0,1,2,-4\n}\n\
            LayerElementUV: 0 {\nName: \"map1\"\nMappingInformationType: \"ByPolygonVertex\"\n\
            ReferenceInformationType: \"Direct\"\nUV: *8 {\na: 0,0,1,0,1,1,0,1\n}\n}\n\
            Layer: 0 {\nLayerElement: {\nType: \"LayerElementUV\"\nTypedIndex: 0\n}\n}";
        let id = self.object("Geometry", "quad", "Mesh", contents);
        self.connect(id, node);
        id
    }

    /// Adds a take with one layer and returns the layer.
    pub fn take(&mut self, name: &str, end_secs: f64) -> i64 {
        let stop = (end_secs * SECOND as f64) as i64;
        let contents = format!(
            "Properties70: {{\nP: \"LocalStart\", \"KTime\", \"Time\", \"\",0\nP: \"LocalStop\", \"KTime\", \"Time\", \"\",{stop}\n}}"
        );
        let stack = self.object("AnimationStack", name, "", &contents);
        let layer = self.object("AnimationLayer", "Base", "", "");
        self.connect(layer, stack);
        layer
    }

    /// Animates one component of a property with keys of (seconds, value). `flags`: 2 constant, 4 linear.
    pub fn curve(
        &mut self,
        layer: i64,
        (object, property, component): (i64, &str, &str),
        flags: i32,
        keys: &[(f64, f64)],
    ) {
        let value = self.object("AnimationCurveNode", property, "", "");
        self.connect(value, layer);
        self.connect_property(value, object, property);
        let list = |values: Vec<String>| format!("*{} {{\na: {}\n}}", values.len(), values.join(","));
        let times = keys.iter().map(|(time, _)| ((time * SECOND as f64) as i64).to_string()).collect();
        let values = keys.iter().map(|(_, value)| value.to_string()).collect();
        let contents = format!(
            "KeyVer: 4008\nKeyTime: {}\nKeyValueFloat: {}\nKeyAttrFlags: *1 {{\na: {flags}\n}}\n\
             KeyAttrDataFloat: *4 {{\na: 0,0,0,0\n}}\nKeyAttrRefCount: *1 {{\na: {}\n}}",
            list(times),
            list(values),
            keys.len()
        );
        let curve = self.object("AnimationCurve", "", "", &contents);
        self.connect_property(curve, value, component);
    }

    pub fn text(&self) -> String {
        format!(
            "; FBX 7.4.0 project file\nFBXHeaderExtension: {{\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}}\n\
             GlobalSettings: {{\nVersion: 1000\nProperties70: {{\n{}}}\n}}\n\
             Objects: {{\n{}}}\nConnections: {{\n{}}}\n",
            self.settings, self.objects, self.connections
        )
    }

    pub fn glb(&self) -> (Glb, Vec<String>) {
        let converted = gaitway_fbx::convert(self.text().as_bytes()).unwrap();
        (Glb::new(&converted.bytes), converted.warnings)
    }
}

/// Returns a quad that turns about its own pivot.
pub fn cube() -> String {
    let mut fbx = Fbx::new(1.0);
    let node = fbx.node("Cube", "Mesh", 0, &[("RotationPivot", [1.0, 0.0, 0.0])]);
    fbx.quad(node);
    let layer = fbx.take("Take 001", 1.0);
    fbx.curve(layer, (node, "Lcl Rotation", "d|Z"), 4, &[(0.0, 0.0), (1.0, 180.0)]);
    fbx.text()
}

/// Returns a character of two joints with a skin, a blend shape and a clip.
pub fn character() -> String {
    two_joints().text()
}

/// The skin's object in `two_joints`: the fifth.
pub const SKIN: i64 = 5;

/// `Hips` at the origin and `Spine` 100 units above; the quad's lower half follows the one, its upper half the other.
pub fn two_joints() -> Fbx {
    let mut fbx = Fbx::new(1.0);
    let hips = fbx.node("mixamorig:Hips", "LimbNode", 0, &[]);
    let spine = fbx.node("mixamorig:Spine", "LimbNode", hips, &[("Lcl Translation", [0.0, 100.0, 0.0])]);
    let body = fbx.node("Body", "Mesh", 0, &[]);
    let mesh = fbx.quad(body);
    let skin = fbx.object("Deformer", "", "Skin", "");
    fbx.connect(skin, mesh);
    for (joint, vertices, height) in [(hips, 0, 0.0), (spine, 2, 100.0)] {
        fbx.cluster(skin, joint, &[(vertices, 1.0), (vertices + 1, 1.0)], height);
    }
    let blend = fbx.object("Deformer", "", "BlendShape", "");
    fbx.connect(blend, mesh);
    let channel =
        fbx.object("Deformer", "smile", "BlendShapeChannel", "DeformPercent: 0\nFullWeights: *1 {\na: 100\n}");
    fbx.connect(channel, blend);
    let shape = "Indexes: *1 {\na: 2\n}\nVertices: *3 {\na: 0,0,5\n}\nNormals: *3 {\na: 0,0,0\n}";
    let shape = fbx.object("Geometry", "smile", "Shape", shape);
    fbx.connect(shape, channel);
    let layer = fbx.take("mixamo.com", 2.0);
    fbx.curve(layer, (spine, "Lcl Rotation", "d|X"), 4, &[(0.0, 0.0), (2.0, 90.0)]);
    fbx.curve(layer, (channel, "DeformPercent", "d|DeformPercent"), 4, &[(0.0, 0.0), (2.0, 100.0)]);
    fbx
}
