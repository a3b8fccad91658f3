//! A small reader and evaluator of GLB, written from the glTF specification and independent of the converters that it checks.

// Each test program uses a part of it.
#![allow(dead_code)]

use std::collections::HashMap;

use serde_json::Value;

pub type Matrix = [[f64; 4]; 4];

pub struct Glb {
    pub json: Value,
    bin: Vec<u8>,
}

/// Local transform: translation, rotation, scale.
#[derive(Clone)]
struct Local {
    translation: [f64; 3],
    rotation: [f64; 4],
    scale: [f64; 3],
}

/// The nodes at a time.
pub struct Pose {
    pub worlds: Vec<Matrix>,
    weights: HashMap<usize, Vec<f64>>,
}

impl Glb {
    pub fn new(bytes: &[u8]) -> Glb {
        assert_eq!(&bytes[..4], b"glTF");
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((word(4), word(8)), (2, bytes.len()));
        let json = &bytes[20..20 + word(12)];
        let bin = bytes.get(20 + json.len() + 8..).unwrap_or_default().to_vec();
        Glb { json: serde_json::from_slice(json).unwrap(), bin }
    }

    pub fn list(&self, key: &str) -> &[Value] {
        self.json[key].as_array().map_or(&[], Vec::as_slice)
    }

    /// Returns the index of the only node of that name.
    pub fn node(&self, name: &str) -> usize {
        let mut found = self.list("nodes").iter().enumerate().filter(|(_, node)| node["name"] == name);
        let index = found.next().unwrap_or_else(|| panic!("no node {name}")).0;
        assert!(found.next().is_none(), "two nodes {name}");
        index
    }

    /// Returns a clip's duration.
    pub fn duration(&self, clip: usize) -> f64 {
        let samplers = self.list("animations")[clip]["samplers"].as_array().unwrap();
        let ends = samplers.iter().map(|sampler| *self.accessor(&sampler["input"]).last().unwrap());
        ends.fold(0.0, f64::max)
    }

    /// Returns all components of an accessor.
    pub fn accessor(&self, index: &Value) -> Vec<f64> {
        let accessor = &self.list("accessors")[index.as_u64().unwrap() as usize];
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let count = accessor["count"].as_u64().unwrap() as usize;
        let mut values = match &accessor["bufferView"] {
            Value::Null => vec![0.0; count * width],
            view => {
                let offset = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
                self.read(view, offset, &accessor["componentType"], count * width)
            }
        };
        if let Some(sparse) = accessor["sparse"].as_object() {
            let count = sparse["count"].as_u64().unwrap() as usize;
            let places = self.read(&sparse["indices"]["bufferView"], 0, &sparse["indices"]["componentType"], count);
            let elements = self.read(&sparse["values"]["bufferView"], 0, &accessor["componentType"], count * width);
            for (place, element) in places.iter().zip(elements.chunks(width)) {
                values[*place as usize * width..][..width].copy_from_slice(element);
            }
        }
        values
    }

    /// Reads the elements of a view without gaps between them.
    fn read(&self, view: &Value, offset: usize, kind: &Value, count: usize) -> Vec<f64> {
        let view = &self.list("bufferViews")[view.as_u64().unwrap() as usize];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        let size = match kind.as_u64().unwrap() {
            5121 => 1,
            5123 => 2,
            _ => 4,
        };
        let bytes = &self.bin[start..start + view["byteLength"].as_u64().unwrap() as usize][offset..][..count * size];
        match kind.as_u64().unwrap() {
            5121 => bytes.iter().map(|&byte| f64::from(byte)).collect(),
            5123 => bytes.chunks(2).map(|b| f64::from(u16::from_le_bytes(b.try_into().unwrap()))).collect(),
            5125 => bytes.chunks(4).map(|b| f64::from(u32::from_le_bytes(b.try_into().unwrap()))).collect(),
            _ => bytes.chunks(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect(),
        }
    }

    /// Evaluates the nodes: at rest, or a clip at a time.
    pub fn pose(&self, clip: Option<(usize, f64)>) -> Pose {
        let nodes = self.list("nodes");
        let array = |value: &Value, or: &[f64]| -> Vec<f64> {
            value.as_array().map_or(or.to_vec(), |list| list.iter().map(|x| x.as_f64().unwrap()).collect())
        };
        let mut locals: Vec<Local> = nodes
            .iter()
            .map(|node| Local {
                translation: array(&node["translation"], &[0.0; 3]).try_into().unwrap(),
                rotation: array(&node["rotation"], &[0.0, 0.0, 0.0, 1.0]).try_into().unwrap(),
                scale: array(&node["scale"], &[1.0; 3]).try_into().unwrap(),
            })
            .collect();
        let mut weights = HashMap::new();
        for (index, node) in nodes.iter().enumerate() {
            if let Some(mesh) = node["mesh"].as_u64() {
                weights.insert(index, array(&self.list("meshes")[mesh as usize]["weights"], &[]));
            }
        }
        if let Some((clip, time)) = clip {
            let clip = &self.list("animations")[clip];
            for channel in clip["channels"].as_array().unwrap() {
                let sampler = &clip["samplers"][channel["sampler"].as_u64().unwrap() as usize];
                let node = channel["target"]["node"].as_u64().unwrap() as usize;
                let path = channel["target"]["path"].as_str().unwrap();
                let value = self.sample(sampler, time, path == "rotation");
                match path {
                    "translation" => locals[node].translation = value.try_into().unwrap(),
                    "rotation" => locals[node].rotation = value.try_into().unwrap(),
                    "scale" => locals[node].scale = value.try_into().unwrap(),
                    _ => drop(weights.insert(node, value)),
                }
            }
        }
        let mut worlds = vec![IDENTITY; nodes.len()];
        let roots = self.json["scenes"][0]["nodes"].as_array().map_or(&[][..], Vec::as_slice);
        let mut open: Vec<(usize, Matrix)> =
            roots.iter().map(|root| (root.as_u64().unwrap() as usize, IDENTITY)).collect();
        while let Some((index, parent)) = open.pop() {
            let local = match nodes[index]["matrix"].as_array() {
                Some(_) => columns(&array(&nodes[index]["matrix"], &[])),
                None => matrix(&locals[index]),
            };
            worlds[index] = multiply(&parent, &local);
            for child in nodes[index]["children"].as_array().map_or(&[][..], Vec::as_slice) {
                open.push((child.as_u64().unwrap() as usize, worlds[index]));
            }
        }
        Pose { worlds, weights }
    }

    fn sample(&self, sampler: &Value, time: f64, rotation: bool) -> Vec<f64> {
        let times = self.accessor(&sampler["input"]);
        let values = self.accessor(&sampler["output"]);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "times ascend: {times:?}");
        let cubic = sampler["interpolation"] == "CUBICSPLINE";
        let width = values.len() / times.len() / if cubic { 3 } else { 1 };
        let value = |key: usize, part: usize| {
            let at = if cubic { 3 * key + part } else { key };
            values[at * width..][..width].to_vec()
        };
        let after = times.partition_point(|&key| key <= time);
        if after == 0 || after == times.len() {
            return value(if after == 0 { 0 } else { after - 1 }, 1);
        }
        let (a, b) = (after - 1, after);
        let duration = times[b] - times[a];
        let t = (time - times[a]) / duration;
        let (start, end) = (value(a, 1), value(b, 1));
        let mut out = match sampler["interpolation"].as_str().unwrap() {
            "STEP" => start,
            "CUBICSPLINE" => {
                let (leaving, arriving) = (value(a, 2), value(b, 0));
                let (t2, t3) = (t * t, t * t * t);
                let weights = [
                    2.0 * t3 - 3.0 * t2 + 1.0,
                    duration * (t3 - 2.0 * t2 + t),
                    3.0 * t2 - 2.0 * t3,
                    duration * (t3 - t2),
                ];
                (0..width)
                    .map(|i| {
                        weights[0] * start[i] + weights[1] * leaving[i] + weights[2] * end[i] + weights[3] * arriving[i]
                    })
                    .collect()
            }
            _ if rotation => slerp(&start, &end, t),
            _ => start.iter().zip(&end).map(|(a, b)| a + t * (b - a)).collect(),
        };
        if rotation {
            let length = out.iter().map(|x| x * x).sum::<f64>().sqrt();
            out.iter_mut().for_each(|x| *x /= length);
        }
        out
    }

    /// Returns the vertices of all meshes in world space.
    pub fn vertices(&self, pose: &Pose) -> Vec<[f64; 3]> {
        let mut all = Vec::new();
        for (index, node) in self.list("nodes").iter().enumerate() {
            let Some(mesh) = node["mesh"].as_u64() else { continue };
            let palette = node["skin"].as_u64().map(|skin| self.palette(skin as usize, pose));
            for primitive in self.list("meshes")[mesh as usize]["primitives"].as_array().unwrap() {
                all.extend(self.primitive(primitive, &pose.weights[&index], palette.as_deref(), &pose.worlds[index]));
            }
        }
        all
    }

    fn palette(&self, skin: usize, pose: &Pose) -> Vec<Matrix> {
        let skin = &self.list("skins")[skin];
        let bind = self.accessor(&skin["inverseBindMatrices"]);
        let joints = skin["joints"].as_array().unwrap().iter().map(|joint| joint.as_u64().unwrap() as usize);
        joints.zip(bind.chunks(16)).map(|(joint, bind)| multiply(&pose.worlds[joint], &columns(bind))).collect()
    }

    fn primitive(
        &self,
        primitive: &Value,
        weights: &[f64],
        palette: Option<&[Matrix]>,
        world: &Matrix,
    ) -> Vec<[f64; 3]> {
        let attributes = &primitive["attributes"];
        let mut positions = self.accessor(&attributes["POSITION"]);
        let targets = primitive["targets"].as_array().map_or(&[][..], Vec::as_slice);
        assert_eq!(targets.len(), weights.len());
        for (target, weight) in targets.iter().zip(weights) {
            for (position, offset) in positions.iter_mut().zip(self.accessor(&target["POSITION"])) {
                *position += weight * offset;
            }
        }
        let sets: Vec<[Vec<f64>; 2]> = (0..4)
            .filter(|set| !attributes[format!("JOINTS_{set}")].is_null())
            .map(|set| ["JOINTS", "WEIGHTS"].map(|name| self.accessor(&attributes[format!("{name}_{set}")])))
            .collect();
        let vertex = |(vertex, position): (usize, &[f64])| {
            let Some(palette) = palette else { return point(world, position) };
            let mut out = [0.0; 3];
            let mut sum = 0.0;
            for [joints, weights] in &sets {
                for i in 4 * vertex..4 * vertex + 4 {
                    let moved = point(&palette[joints[i] as usize], position);
                    (0..3).for_each(|axis| out[axis] += weights[i] * moved[axis]);
                    sum += weights[i];
                }
            }
            assert!((sum - 1.0).abs() < 1e-5, "weights sum to {sum}");
            out
        };
        positions.chunks(3).enumerate().map(vertex).collect()
    }

    /// Returns the nodes in depth-first order.
    pub fn depth_first(&self) -> Vec<usize> {
        let children = |value: &Value| -> Vec<usize> {
            let list = value.as_array().map_or(&[][..], Vec::as_slice);
            list.iter().rev().map(|child| child.as_u64().unwrap() as usize).collect()
        };
        let mut order = Vec::new();
        let mut open = children(&self.json["scenes"][0]["nodes"]);
        while let Some(index) = open.pop() {
            order.push(index);
            open.extend(children(&self.list("nodes")[index]["children"]));
        }
        order
    }
}

/// By columns.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn columns(elements: &[f64]) -> Matrix {
    std::array::from_fn(|column| std::array::from_fn(|row| elements[4 * column + row]))
}

fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|column| std::array::from_fn(|row| (0..4).map(|k| a[k][row] * b[column][k]).sum()))
}

fn point(m: &Matrix, p: &[f64]) -> [f64; 3] {
    std::array::from_fn(|row| m[0][row] * p[0] + m[1][row] * p[1] + m[2][row] * p[2] + m[3][row])
}

fn matrix(local: &Local) -> Matrix {
    let [x, y, z, w] = local.rotation;
    let columns = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let mut matrix = IDENTITY;
    for axis in 0..3 {
        for row in 0..3 {
            matrix[axis][row] = columns[axis][row] * local.scale[axis];
        }
        matrix[3][axis] = local.translation[axis];
    }
    matrix
}

fn slerp(a: &[f64], b: &[f64], t: f64) -> Vec<f64> {
    let cosine: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let sign = if cosine < 0.0 { -1.0 } else { 1.0 };
    let angle = cosine.abs().min(1.0).acos();
    let weights = if angle < 1e-6 {
        [1.0 - t, t]
    } else {
        [((1.0 - t) * angle).sin() / angle.sin(), (t * angle).sin() / angle.sin()]
    };
    a.iter().zip(b).map(|(a, b)| weights[0] * a + sign * weights[1] * b).collect()
}

/// Reads a GLB completely, and checks that every index is in range, every number finite, and weights sum to 1.
pub fn check(glb: &[u8]) {
    let glb = Glb::new(glb);
    for (index, _) in glb.list("accessors").iter().enumerate() {
        assert!(glb.accessor(&index.into()).iter().all(|value| value.is_finite()), "accessor {index}");
    }
    let mut poses = vec![glb.pose(None)];
    poses.extend((0..glb.list("animations").len()).map(|clip| glb.pose(Some((clip, 0.3 * glb.duration(clip))))));
    for pose in &poses {
        glb.vertices(pose);
    }
}
