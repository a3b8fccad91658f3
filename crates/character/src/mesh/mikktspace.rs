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

/// An edge of a face, between two welded vertices.
#[derive(Clone, Copy, Default)]
struct Edge {
    lower: u32,
    higher: u32,
    face: u32,
    /// Where the edge starts.
    corner: u8,
    /// Whether it goes from the higher to the lower vertex.
    is_down: bool,
}

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
        let split = members.len() <= MAX_COMPARED && opposed(&faces, members, normal);
        let shared = (!split).then(|| blend(&faces, members, |_| true, group, positions, normal));
        for &face in members {
            let with = |other: &Face| agree(&faces[face as usize], other, normal);
            let tangent = shared.unwrap_or_else(|| blend(&faces, members, with, group, positions, normal));
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

impl Edge {
    /// The face across it.
    fn neighbor<'a>(&self, faces: &'a mut [Face]) -> &'a mut u32 {
        &mut faces[self.face as usize].neighbors[usize::from(self.corner)]
    }
}

/// Pairs up faces that traverse an edge in opposite directions; if more than two share it, each pairs with the next.
fn find_neighbors(faces: &mut [Face], vertices: usize) {
    let mut edges = edges_by_lower(faces, vertices);
    for edges in edges.chunk_by_mut(|a, b| a.lower == b.lower) {
        // Equal edges would be too far apart to be compared.
        if edges.len() > MAX_COMPARED {
            edges.sort_by_key(|edge| edge.higher);
        }
        for at in 0..edges.len() {
            let edge = edges[at];
            if *edge.neighbor(faces) != NONE {
                continue;
            }
            let others = edges[at + 1..].iter().take(MAX_COMPARED);
            for other in others.filter(|other| other.higher == edge.higher && other.is_down != edge.is_down) {
                if other.face != edge.face && *other.neighbor(faces) == NONE {
                    *edge.neighbor(faces) = other.face;
                    *other.neighbor(faces) = edge.face;
                    break;
                }
            }
        }
    }
}

/// Lists the edges of all but degenerate faces by their lower vertices, those of a vertex in the order of faces.
fn edges_by_lower(faces: &[Face], vertices: usize) -> Vec<Edge> {
    let of_face = |(face, Face { vertices, .. }): (usize, &Face)| {
        let [p, q, r] = *vertices;
        [(p, q), (q, r), (r, p)].into_iter().zip(0..).map(move |((from, to), corner)| Edge {
            lower: from.min(to),
            higher: from.max(to),
            face: face as u32,
            corner,
            is_down: from > to,
        })
    };
    let edges = || faces.iter().enumerate().filter(|(_, face)| !face.degenerate).flat_map(of_face);
    let mut places = vec![0; vertices + 1];
    edges().for_each(|edge| places[edge.lower as usize + 1] += 1);
    for vertex in 1..=vertices {
        places[vertex] += places[vertex - 1];
    }
    let mut sorted = vec![Edge::default(); places[vertices]];
    for edge in edges() {
        let place = &mut places[edge.lower as usize];
        sorted[*place] = edge;
        *place += 1;
    }
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

fn flattened(vector: Vec3, normal: Vec3) -> Vec3 {
    vector - normal * normal.dot(vector)
}

fn on_plane(vector: Vec3, normal: Vec3) -> Vec3 {
    flattened(vector, normal).normalize_or_zero()
}

/// The exact angle, a right one if a length is zero. glam's own is approximate, and NaN then.
fn angle(a: Vec3, b: Vec3) -> f32 {
    let lengths = a.length() * b.length();
    let cos = if lengths > 0.0 { a.dot(b) / lengths } else { 0.0 };
    cos.clamp(-1.0, 1.0).acos()
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

/// Averages the tangents of those faces that `with` accepts, weighted by their angles at the vertex.
fn blend(
    faces: &[Face],
    members: &[u32],
    with: impl Fn(&Face) -> bool,
    group: &Group,
    positions: &[Vec3],
    normal: Vec3,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for face in members.iter().map(|&face| &faces[face as usize]).filter(|face| !face.any && with(face)) {
        let corner = face.corner_at(group.vertex);
        let [before, here, after] =
            [corner + 2, corner, corner + 1].map(|corner| positions[face.vertices[corner % 3] as usize]);
        let angle = angle(flattened(before - here, normal), flattened(after - here, normal));
        sum += angle * on_plane(face.along_u, normal);
    }
    sum.normalize_or_zero()
}
