//! Decodes the meshes of `KHR_draco_mesh_compression`. The glTF around them is the caller's: see
//! `crates/formats/src/gltf/draco.rs`.

mod number;
mod wire;

use draco_core::{DecodeLimits, DecoderBuffer, MeshDecoder, PointAttribute, PointIndex};
use gaitway_part::{Answer, Output};

pub use wire::{Attribute, Decoded, Mesh, write};

/// Decodes any number of meshes ([`write()`]). [`Decoded::read_all`] reads the output.
///
/// # Errors
/// If a mesh is damaged, or is not what its accessors declare; the message names it by its number in the input, from 0.
pub fn decode(input: &[u8]) -> Answer {
    let (mut bytes_left, meshes) = wire::read(input).ok_or("the decoder's input is damaged")?;
    let (mut facts, mut data) = (Vec::new(), Vec::new());
    for (number, mesh) in meshes.iter().enumerate() {
        let before = data.len();
        let decoded = decode_mesh(mesh, bytes_left, &mut data)
            .map_err(|problem| format!("compressed mesh {number} cannot be decoded ({problem})"))?;
        decoded.write(&mut facts);
        bytes_left = bytes_left.saturating_sub(data.len() - before);
    }
    facts.extend(data);
    Ok(Output { bytes: facts, warnings: Vec::new() })
}

fn decode_mesh(mesh: &Mesh, bytes_left: usize, data: &mut Vec<u8>) -> Result<Decoded, String> {
    let limits = DecodeLimits::default()
        .with_max_points(mesh.max_count.into())
        .with_max_faces(mesh.max_count.into())
        .with_max_decoded_bytes(bytes_left as u64);
    let mut decoded = draco_core::Mesh::new();
    let mut source = DecoderBuffer::new(mesh.source).with_limits(limits);
    MeshDecoder::new().decode(&mut source, &mut decoded).map_err(|problem| problem.to_string())?;

    let max_count = mesh.max_count as usize;
    let (vertices, faces) = (decoded.num_points(), decoded.num_faces());
    if vertices > max_count || faces > max_count {
        return Err(format!("it has {vertices} vertices and {faces} triangles, more than its accessors declare"));
    }
    let mut facts = Decoded { vertices: vertices as u32, indices: 3 * faces as u32, bounds: Vec::new() };
    let needed = facts.ranges(&mesh.attributes).last().map_or(0, |range| range.end);
    if needed > bytes_left {
        return Err(format!("it has {needed} bytes, and only {bytes_left} more are decoded"));
    }
    data.reserve(needed);
    indices(&decoded, &facts, data)?;
    for attribute in &mesh.attributes {
        let id = attribute.id;
        let found = decoded.attribute_by_unique_id(id).ok_or_else(|| format!("it has no attribute {id}"))?;
        let bounds =
            values(found, attribute, vertices, data).map_err(|problem| format!("attribute {id}: {problem}"))?;
        facts.bounds.push(bounds);
    }
    Ok(facts)
}

fn indices(mesh: &draco_core::Mesh, facts: &Decoded, data: &mut Vec<u8>) -> Result<(), String> {
    for &PointIndex(index) in mesh.faces().as_flattened() {
        if index >= facts.vertices {
            return Err(format!("index {index} of {} vertices", facts.vertices));
        }
        data.extend_from_slice(&index.to_le_bytes()[..facts.index_bytes()]);
    }
    data.resize(data.len().next_multiple_of(4), 0);
    Ok(())
}

/// Appends the attribute of each vertex, in the type that the accessor declares. Returns the smallest and largest components.
fn values(
    found: &PointAttribute,
    attribute: &Attribute,
    vertices: usize,
    data: &mut Vec<u8>,
) -> Result<[Vec<f32>; 2], String> {
    let components = attribute.components as usize;
    if usize::from(found.num_components()) != components {
        return Err(format!("{} components, {components} declared", found.num_components()));
    }
    let (from, to) = (found.data_type(), number::Target::new(attribute.component_type).ok_or("unknown type")?);
    let size = from.byte_length();
    let source = found.buffer().data();
    let mut bounds = [vec![f32::INFINITY; components], vec![f32::NEG_INFINITY; components]];
    for vertex in 0..vertices as u32 {
        let at = (found.mapped_index(PointIndex(vertex)).0 as usize).checked_mul(components * size);
        let value = at.and_then(|at| source.get(at..)?.get(..components * size));
        let value = value.ok_or_else(|| format!("vertex {vertex} has no value"))?;
        for (component, bytes) in value.chunks_exact(size.max(1)).enumerate() {
            let number = to.append(from, found.normalized(), bytes, data);
            bounds[0][component] = bounds[0][component].min(number);
            bounds[1][component] = bounds[1][component].max(number);
        }
        data.resize(data.len().next_multiple_of(4), 0);
    }
    Ok(bounds)
}

#[cfg(test)]
#[path = "../../../tests/support/damage.rs"]
mod damage;

#[cfg(test)]
mod tests {
    use super::damage::{Damage, cases};
    use draco_core::{DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, MeshEncoder};

    use super::*;

    const FLOAT: u32 = 5126;
    const POSITION: Attribute = Attribute { id: 0, component_type: FLOAT, components: 3 };
    const JOINTS: Attribute = Attribute { id: 1, component_type: 5121, components: 4 };

    /// A strip of squares: position and joints of each corner.
    fn strip(squares: u32) -> draco_core::Mesh {
        let vertices = 2 * (squares + 1);
        let mut mesh = draco_core::Mesh::new();
        let mut attribute = |kind, components, data_type, value: &dyn Fn(u32) -> Vec<u8>| {
            let mut attribute = PointAttribute::new();
            attribute.init(kind, components, data_type, false, vertices as usize);
            let bytes: Vec<u8> = (0..vertices).flat_map(value).collect();
            attribute.buffer_mut().write(0, &bytes);
            mesh.add_attribute(attribute);
        };
        attribute(GeometryAttributeType::Position, 3, DataType::Float32, &|vertex| {
            [(vertex / 2) as f32, (vertex % 2) as f32, -1.5].into_iter().flat_map(f32::to_le_bytes).collect()
        });
        attribute(GeometryAttributeType::Generic, 4, DataType::Uint16, &|vertex| {
            [vertex as u16, 1, 0, 3].into_iter().flat_map(u16::to_le_bytes).collect()
        });
        mesh.set_num_faces(2 * squares as usize);
        for square in 0..squares {
            let corner = 2 * square;
            mesh.set_face_from_indices(2 * square as usize, [corner, corner + 2, corner + 1]);
            mesh.set_face_from_indices(2 * square as usize + 1, [corner + 1, corner + 2, corner + 3]);
        }
        mesh
    }

    fn compressed(mesh: draco_core::Mesh, speed: i32) -> Vec<u8> {
        let mut options = EncoderOptions::new();
        options.set_global_int("encoding_speed", speed);
        options.set_global_int("decoding_speed", speed);
        let (mut encoder, mut encoded) = (MeshEncoder::new(), EncoderBuffer::new());
        encoder.set_mesh(mesh);
        encoder.encode(&options, &mut encoded).unwrap();
        encoded.data().to_vec()
    }

    fn one(source: &[u8], attributes: &[Attribute]) -> Vec<u8> {
        write(1 << 20, &[Mesh { source, max_count: 1000, attributes: attributes.to_vec() }])
    }

    /// The first components of each triangle's corners, in an order that doesn't depend on the encoder.
    fn triangles(facts: &Decoded, data: &[u8]) -> Vec<[[u8; 4]; 3]> {
        let ranges = facts.ranges(&[POSITION, JOINTS]);
        let joint = |vertex: usize| -> [u8; 4] { data[ranges[2].start + 4 * vertex..][..4].try_into().unwrap() };
        let indices = data[ranges[0].clone()].chunks_exact(facts.index_bytes()).take(facts.indices as usize);
        let corners: Vec<_> =
            indices.map(|index| joint(index.iter().rfold(0, |sum, &byte| sum << 8 | usize::from(byte)))).collect();
        let mut triangles = corners.as_chunks::<3>().0.to_vec();
        for triangle in &mut triangles {
            let first = (0..3).min_by_key(|&corner| triangle[corner]).unwrap();
            triangle.rotate_left(first);
        }
        triangles.sort_unstable();
        triangles
    }

    #[test]
    fn every_way_to_encode_is_decoded() {
        for speed in [0, 5, 10] {
            let source = compressed(strip(20), speed);
            let meshes = [&[POSITION, JOINTS][..], &[POSITION, JOINTS]];
            let input =
                write(1 << 20, &meshes.map(|own| Mesh { source: &source, max_count: 120, attributes: own.to_vec() }));
            let output = decode(&input).unwrap().bytes;
            let (facts, data) = Decoded::read_all(&output, meshes.into_iter()).unwrap();
            assert_eq!((facts[0].vertices, facts[0].indices), (42, 120));
            assert_eq!(facts[0].bounds[0], [[0.0, 0.0, -1.5], [20.0, 1.0, -1.5]]);
            assert_eq!(facts[0].bounds[1], [[0.0, 1.0, 0.0, 3.0], [41.0, 1.0, 0.0, 3.0]]);
            let end = facts[0].ranges(meshes[0]).pop().unwrap().end;
            assert_eq!(end, 120 * 2 + 42 * (12 + 4));
            assert_eq!(data[..end], data[end..], "the second is the same");
            let expected: Vec<_> = (0..20_u8)
                .flat_map(|square| {
                    let corner = |number: u8| [2 * square + number, 1, 0, 3];
                    [[corner(0), corner(2), corner(1)], [corner(1), corner(2), corner(3)]]
                })
                .collect();
            assert_eq!(triangles(&facts[0], data), expected, "speed {speed}");
        }
    }

    #[test]
    fn large_meshes_have_wide_indices() {
        let source = compressed(strip(40_000), 5);
        let mesh = Mesh { source: &source, max_count: 240_000, attributes: vec![POSITION] };
        let output = decode(&write(1 << 30, &[mesh])).unwrap().bytes;
        let (facts, data) = Decoded::read_all(&output, [&[POSITION][..]].into_iter()).unwrap();
        assert_eq!(facts[0].index_bytes(), 4);
        assert_eq!(data.len(), 80_000 * 3 * 4 + 80_002 * 12);
    }

    #[test]
    fn what_the_accessors_do_not_declare_is_an_error() {
        let source = compressed(strip(20), 5);
        let check = |input: &[u8], expected: &str| {
            let problem = decode(input).unwrap_err();
            assert!(problem.contains(expected), "{expected}: {problem}");
        };
        check(&one(&source, &[Attribute { id: 7, ..POSITION }]), "no attribute 7");
        check(&one(&source, &[Attribute { components: 2, ..POSITION }]), "attribute 0: 3 components, 2 declared");
        check(&one(&source, &[Attribute { component_type: 1, ..POSITION }]), "unknown type");
        check(&one(b"PLY", &[POSITION]), "compressed mesh 0");
        check(&one(&source[..source.len() / 2], &[POSITION]), "compressed mesh 0");
        let limited =
            |max_bytes, max_count| write(max_bytes, &[Mesh { source: &source, max_count, attributes: vec![POSITION] }]);
        check(&limited(1 << 20, 41), "vertices");
        check(&limited(1 << 20, 39), "faces");
        check(&limited(100, 120), "bytes");
        let input = one(&source, &[POSITION]);
        check(&input[..input.len() - 1], "input is damaged");
    }

    /// Flipped bits, cut and overwritten streams, the same on every run.
    #[test]
    fn damaged_meshes_never_panic() {
        let mut damage = Damage::new();
        let mut decoded = 0;
        for speed in [0, 5, 10] {
            let source = compressed(strip(20), speed);
            for _ in 0..cases() {
                let damaged = damage.of(&source);
                decoded += usize::from(decode(&one(&damaged, &[POSITION, JOINTS])).is_ok());
            }
        }
        assert!(decoded > 10, "only {decoded} were decoded: the damage hides what it should test");
    }
}
