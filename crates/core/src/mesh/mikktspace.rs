//! MikkTSpace for triangle lists (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", and his mikktspace.c): the
//! tangents that normal maps are baked for. A test compares it with another implementation.

use foldhash::{HashMap, HashMapExt};
use glam::{Vec2, Vec3, Vec4};

/// No face or group.
const NONE: u32 = u32::MAX;
/// Maximum number of faces compared pairwise at an edge or around a vertex. Only hostile files have more.
const MAX_COMPARED: usize = 64;

struct Face {
    /// Welded vertices: equal vertices share an index.
    vertices: [u32; 3],
    /// Directions of increasing u and v, unit length.
    along_u: Vec3,
    along_v: Vec3,
    /// Whether the texture mapping preserves orientation, i.e. is not mirrored.
    preserving: bool,
    /// Whether the texture coordinates are degenerate, so that the face fits any group.
    any: bool,
    /// Whether two corners coincide.
    degenerate: bool,
    /// Faces across the edges that start at each corner.
    neighbors: [u32; 3],
    groups: [u32; 3],
}

/// Lower and higher vertex, face, and the corner at which the edge starts.
type Edge = (u64, u32, u8);

/// Faces around a vertex that share a tangent: a range in the list of group members.
struct Group {
    vertex: u32,
    preserving: bool,
    first: usize,
    end: usize,
}

/// Returns the tangent of every corner of a triangle list, w being the bitangent's sign in mikktspace.c's convention;
/// none if neither the corner nor its vertex has one. The attributes have one entry per vertex, and `indices` are in
/// range.
pub(super) fn corner_tangents(
    positions: &[Vec3],
    normals: &[Vec3],
    uvs: &[Vec2],
    indices: &[u32],
) -> Vec<Option<Vec4>> {
    let welded = weld(positions, normals, uvs);
    let triangles = indices.as_chunks::<3>().0;
    let mut faces: Vec<Face> = triangles
        .iter()
        .map(|triangle| Face::new(triangle.map(|vertex| welded[vertex as usize]), positions, uvs))
        .collect();
    find_neighbors(&mut faces, positions.len());
    let (groups, members) = find_groups(&mut faces);
    let mut tangents = vec![None; 3 * faces.len()];
    for group in &groups {
        let members = &members[group.first..group.end];
        let normal = normals[group.vertex as usize];
        let blend_all = |list: &mut dyn Iterator<Item = u32>| blend(&faces, list, group, positions, normal);
        let shared = blend_all(&mut members.iter().copied());
        let split = members.len() <= MAX_COMPARED && opposed(&faces, members, normal);
        for &face in members {
            let tangent = if split {
                let with = |other: &u32| agree(&faces[face as usize], &faces[*other as usize], normal);
                blend_all(&mut members.iter().filter(|other| with(other)).copied())
            } else {
                shared
            };
            let sign = if group.preserving { 1.0 } else { -1.0 };
            let corner = faces[face as usize].corner_at(group.vertex);
            tangents[3 * face as usize + corner] = Some(tangent.extend(sign));
        }
    }
    if faces.iter().any(|face| face.degenerate) {
        complete_degenerate(&faces, positions.len(), &mut tangents);
    }
    tangents
}

/// Gives corners of degenerate faces the tangent of the first corner at their vertex.
fn complete_degenerate(faces: &[Face], vertices: usize, tangents: &mut [Option<Vec4>]) {
    let mut first_at: Vec<Option<Vec4>> = vec![None; vertices];
    for (face, tangents) in faces.iter().zip(tangents.as_chunks::<3>().0) {
        for (&vertex, tangent) in face.vertices.iter().zip(tangents) {
            let first = &mut first_at[vertex as usize];
            *first = first.or(*tangent);
        }
    }
    for (face, tangents) in faces.iter().zip(tangents.as_chunks_mut::<3>().0).filter(|(face, _)| face.degenerate) {
        *tangents = face.vertices.map(|vertex| first_at[vertex as usize]);
    }
}

/// Maps each vertex to the first one that equals it.
fn weld(positions: &[Vec3], normals: &[Vec3], uvs: &[Vec2]) -> Vec<u32> {
    let mut first: HashMap<[u32; 8], u32> = HashMap::with_capacity(positions.len());
    (0..positions.len())
        .map(|vertex| {
            let (p, n, t) = (positions[vertex], normals[vertex], uvs[vertex]);
            // Adding zero makes -0 equal to 0.
            let key = [p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y].map(|number| (number + 0.0).to_bits());
            *first.entry(key).or_insert(vertex as u32)
        })
        .collect()
}

fn is_zero(number: f32) -> bool {
    number.abs() <= f32::MIN_POSITIVE
}

impl Face {
    fn new(vertices: [u32; 3], positions: &[Vec3], uvs: &[Vec2]) -> Self {
        let [p, q, r] = vertices.map(|vertex| positions[vertex as usize]);
        let [a, b, c] = vertices.map(|vertex| uvs[vertex as usize]);
        let (ab, ac) = (b - a, c - a);
        let (pq, pr) = (q - p, r - p);
        let area = ab.x * ac.y - ab.y * ac.x;
        let along_u = ac.y * pq - ab.y * pr;
        let along_v = -ac.x * pq + ab.x * pr;
        let preserving = area > 0.0;
        let (u_length, v_length) = (along_u.length(), along_v.length());
        let sign = if preserving { 1.0 } else { -1.0 };
        let unit = |vector: Vec3, length: f32| if is_zero(length) { vector } else { vector * (sign / length) };
        let known = !is_zero(area) && !is_zero(u_length / area.abs()) && !is_zero(v_length / area.abs());
        Self {
            vertices,
            along_u: if is_zero(area) { along_u } else { unit(along_u, u_length) },
            along_v: if is_zero(area) { along_v } else { unit(along_v, v_length) },
            preserving,
            any: !known,
            degenerate: p == q || p == r || q == r,
            neighbors: [NONE; 3],
            groups: [NONE; 3],
        }
    }

    fn corner_at(&self, vertex: u32) -> usize {
        self.vertices.iter().position(|&other| other == vertex).unwrap_or(0)
    }
}

/// Pairs up faces that traverse an edge in opposite directions; if more than two share it, each pairs with the next.
fn find_neighbors(faces: &mut [Face], vertices: usize) {
    let mut edges: Vec<Edge> = Vec::with_capacity(3 * faces.len());
    for (index, face) in faces.iter().enumerate().filter(|(_, face)| !face.degenerate) {
        for corner in 0..3 {
            let (from, to) = (face.vertices[corner], face.vertices[(corner + 1) % 3]);
            edges.push((u64::from(from.min(to)) << 32 | u64::from(from.max(to)), index as u32, corner as u8));
        }
    }
    let edges = sorted(&edges, vertices);
    for (at, &(edge, face, corner)) in edges.iter().enumerate() {
        let from = faces[face as usize].vertices[corner as usize];
        if faces[face as usize].neighbors[corner as usize] != NONE {
            continue;
        }
        for &(other_edge, other, other_corner) in edges[at + 1..].iter().take(MAX_COMPARED) {
            if other_edge != edge {
                break;
            }
            let found = &faces[other as usize];
            let free = found.neighbors[other_corner as usize] == NONE;
            if free && other != face && found.vertices[other_corner as usize] != from {
                faces[face as usize].neighbors[corner as usize] = other;
                faces[other as usize].neighbors[other_corner as usize] = face;
                break;
            }
        }
    }
}

/// Sorts edges by their vertices, keeping the order of equal ones. Buckets by lower vertex come first: few edges share one, so
/// that this takes a fraction of the time.
fn sorted(edges: &[Edge], vertices: usize) -> Vec<Edge> {
    let lower = |(edge, ..): &Edge| (edge >> 32) as usize;
    let mut places = vec![0; vertices + 1];
    edges.iter().for_each(|edge| places[lower(edge) + 1] += 1);
    for vertex in 1..=vertices {
        places[vertex] += places[vertex - 1];
    }
    let mut sorted = vec![Edge::default(); edges.len()];
    for edge in edges {
        let place = &mut places[lower(edge)];
        sorted[*place] = *edge;
        *place += 1;
    }
    sorted.chunk_by_mut(|a, b| lower(a) == lower(b)).for_each(|edges| edges.sort_by_key(|&(edge, ..)| edge));
    sorted
}

/// Flood-fills faces around each vertex, stopping where the texture mapping flips orientation.
fn find_groups(faces: &mut [Face]) -> (Vec<Group>, Vec<u32>) {
    let mut groups: Vec<Group> = Vec::new();
    let mut members: Vec<u32> = Vec::with_capacity(3 * faces.len());
    let mut waiting = Vec::new();
    for start in 0..faces.len() {
        for corner in 0..3 {
            let face = &faces[start];
            if face.degenerate || face.any || face.groups[corner] != NONE {
                continue;
            }
            let (vertex, preserving) = (face.vertices[corner], face.preserving);
            let number = groups.len() as u32;
            let first = members.len();
            waiting.push(start as u32);
            while let Some(index) = waiting.pop() {
                let face = &mut faces[index as usize];
                let Some(corner) = face.vertices.iter().position(|&other| other == vertex) else { continue };
                if face.groups[corner] != NONE {
                    continue;
                }
                if face.any && face.groups == [NONE; 3] {
                    face.preserving = preserving;
                }
                if face.preserving != preserving {
                    continue;
                }
                face.groups[corner] = number;
                members.push(index);
                let around = [face.neighbors[(corner + 2) % 3], face.neighbors[corner]];
                waiting.extend(around.into_iter().filter(|&neighbor| neighbor != NONE));
            }
            groups.push(Group { vertex, preserving, first, end: members.len() });
        }
    }
    (groups, members)
}

fn on_plane(vector: Vec3, normal: Vec3) -> Vec3 {
    (vector - normal * normal.dot(vector)).normalize_or_zero()
}

/// Whether two faces at a vertex may share a tangent, that is, their own are not exactly opposite.
fn agree(a: &Face, b: &Face, normal: Vec3) -> bool {
    let above = |a: Vec3, b: Vec3| on_plane(a, normal).dot(on_plane(b, normal)) > -1.0;
    a.any || b.any || std::ptr::eq(a, b) || (above(a.along_u, b.along_u) && above(a.along_v, b.along_v))
}

/// Whether any two of the faces might disagree. They cannot if all are within a right angle of the first.
fn opposed(faces: &[Face], members: &[u32], normal: Vec3) -> bool {
    let Some(first) = members.first().map(|&face| &faces[face as usize]) else { return false };
    let (u, v) = (on_plane(first.along_u, normal), on_plane(first.along_v, normal));
    let beside = |face: &Face| face.any || (u.dot(face.along_u) > 0.0 && v.dot(face.along_v) > 0.0);
    first.any || !members.iter().all(|&face| beside(&faces[face as usize]))
}

/// Averages the faces' tangents, weighted by their angles at the vertex.
fn blend(
    faces: &[Face],
    members: &mut dyn Iterator<Item = u32>,
    group: &Group,
    positions: &[Vec3],
    normal: Vec3,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for face in members.map(|face| &faces[face as usize]).filter(|face| !face.any) {
        let corner = face.corner_at(group.vertex);
        let [before, here, after] =
            [corner + 2, corner, corner + 1].map(|corner| positions[face.vertices[corner % 3] as usize]);
        let cos = on_plane(before - here, normal).dot(on_plane(after - here, normal));
        sum += cos.clamp(-1.0, 1.0).acos() * on_plane(face.along_u, normal);
    }
    sum.normalize_or_zero()
}
