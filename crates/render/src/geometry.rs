//! The GPU buffers and textures of a primitive: vertices, influences, morph targets and indices.

use std::collections::HashSet;

use bytemuck::{Pod, Zeroable};
use gaitway_character::mesh::{Geometry, Influences, Topology};
use glam::Vec3;

use super::pool::{Pool, Pooled};
use super::texture::texture_bytes;
use super::upload_error::UploadError;

/// Width of a vertex texture in texels; must match skinning.wgsl.
const VERTEX_TEXTURE_WIDTH: u32 = 2048;

/// Where the vertex stage reads influences from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InfluenceSource {
    /// Every vertex uses one palette entry: the draw's first or, for a copy, the copy's own.
    None,
    /// Four per vertex, as vertex attributes.
    Four,
    /// Eight per vertex, as vertex attributes.
    Eight,
    /// 12 or 16 per vertex, fetched from a texture by vertex index.
    Texture,
}

impl InfluenceSource {
    /// Returns the source for a [`stride`](Influences::stride), the number of influences per vertex.
    fn of(stride: usize) -> Self {
        match stride {
            0 => Self::None,
            4 => Self::Four,
            8 => Self::Eight,
            _ => Self::Texture,
        }
    }

    /// Entry point in vertex.wgsl; `position_only` selects the variant that outputs only the position.
    pub fn entry_point(self, position_only: bool) -> &'static str {
        match (self, position_only) {
            (Self::None, false) => "vertex_0",
            (Self::Four, false) => "vertex_4",
            (Self::Eight, false) => "vertex_8",
            (Self::Texture, false) => "vertex_texture",
            (Self::None, true) => "position_0",
            (Self::Four, true) => "position_4",
            (Self::Eight, true) => "position_8",
            (Self::Texture, true) => "position_texture",
        }
    }
}

/// Position and normal.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ShapeVertex {
    position: [f32; 3],
    normal: [f32; 3],
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct SurfaceVertex {
    tangent: [f32; 4],
    uv: [f32; 4],
    /// 0 to 65,535.
    color: [u16; 4],
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct FourInfluences {
    joints: [u16; 4],
    weights: [f32; 4],
}

/// Vertex buffer layouts in the order of [`GpuGeometry::bind`].
pub fn vertex_buffers(influences: InfluenceSource) -> Vec<Option<wgpu::VertexBufferLayout<'static>>> {
    const SHAPE: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    const SURFACE: [wgpu::VertexAttribute; 3] =
        wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Unorm16x4];
    const FOUR: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![5 => Uint16x4, 6 => Float32x4];
    const EIGHT: [wgpu::VertexAttribute; 4] =
        wgpu::vertex_attr_array![5 => Uint16x4, 6 => Float32x4, 7 => Uint16x4, 8 => Float32x4];
    let layout = |array_stride: usize, attributes| {
        Some(wgpu::VertexBufferLayout {
            array_stride: array_stride as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes,
        })
    };
    let mut buffers =
        vec![layout(size_of::<ShapeVertex>(), &SHAPE[..]), layout(size_of::<SurfaceVertex>(), &SURFACE[..])];
    match influences {
        InfluenceSource::None | InfluenceSource::Texture => {}
        InfluenceSource::Four => buffers.push(layout(size_of::<FourInfluences>(), &FOUR[..])),
        InfluenceSource::Eight => buffers.push(layout(2 * size_of::<FourInfluences>(), &EIGHT[..])),
    }
    buffers
}

/// A primitive on the GPU. Clones share its data.
#[derive(Clone)]
pub struct GpuGeometry {
    /// Whether the indices form points, lines or triangles.
    pub topology: Topology,
    /// Selects the vertex buffer layout and the entry point.
    pub influences: InfluenceSource,
    /// Influences per vertex, 0 if unskinned.
    pub influence_stride: u32,
    /// Number of vertices.
    pub vertices: u32,
    /// Texels per vertex and morph target: 1 position, 2 also normal, 3 also tangent.
    pub morph_attributes: u32,
    shape: Pooled,
    surface: Pooled,
    influence_part: Option<Pooled>,
    /// In [`wgpu::IndexFormat::Uint32`].
    pub indices: Pooled,
    /// Length of `indices`, in indices.
    pub index_count: u32,
    /// Deltas of the morph targets, one texel each: by target, then vertex, then attribute. None without targets.
    pub morph_view: Option<wgpu::TextureView>,
    /// Joints and weights by vertex, two pairs to a texel. None unless `influences` is [`InfluenceSource::Texture`].
    pub influence_view: Option<wgpu::TextureView>,
}

/// Where the vertices and indices of a model's primitives go. Drop it before anything is drawn.
pub struct Pools<'a> {
    vertices: Pool<'a>,
    indices: Pool<'a>,
}

impl<'a> Pools<'a> {
    /// Expects these primitives.
    pub fn new<'g>(device: &'a wgpu::Device, primitives: impl Iterator<Item = &'g Geometry> + Clone) -> Self {
        let vertices = primitives.clone().flat_map(vertex_bytes);
        let indices = primitives.map(|geometry| size_of_val(&geometry.indices[..]) as u64);
        Self {
            vertices: Pool::new(device, "vertices", wgpu::BufferUsages::VERTEX, vertices),
            indices: Pool::new(device, "indices", wgpu::BufferUsages::INDEX, indices),
        }
    }
}

/// Bytes of a primitive's vertices in each of its [`vertex_buffers`].
fn vertex_bytes(geometry: &Geometry) -> impl Iterator<Item = u64> {
    let count = geometry.positions.len() as u64;
    let buffers = vertex_buffers(InfluenceSource::of(geometry.influences.stride));
    buffers.into_iter().flatten().map(move |layout| layout.array_stride * count)
}

impl GpuGeometry {
    /// `smooth` are the normals from [`smooth_normals`](gaitway_character::mesh::smooth_normals), used if the geometry has none. `mesh`
    /// and `primitive` are for error messages. The geometry must be valid and have indices.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pools: &mut Pools<'_>,
        geometry: &Geometry,
        smooth: &[Vec3],
        [mesh, primitive]: [usize; 2],
    ) -> Result<Self, UploadError> {
        let count = geometry.positions.len();
        let too_many = || UploadError::TooManyVertices { mesh, primitive, vertices: count };
        let max_bytes = device.limits().max_buffer_size;
        let vertices = u32::try_from(count).map_err(|_| too_many())?;
        if vertex_bytes(geometry).any(|bytes| bytes > max_bytes) || geometry.indices.len() as u64 * 8 > max_bytes {
            return Err(too_many());
        }

        let influences = InfluenceSource::of(geometry.influences.stride);
        let joints = used_joints(&geometry.influences);
        let influence_part = matches!(influences, InfluenceSource::Four | InfluenceSource::Eight).then(|| {
            let fours = influences_by_four(&joints, &geometry.influences.weights);
            pools.vertices.add(bytemuck::cast_slice(&fours))
        });
        let influence_view = match influences {
            InfluenceSource::Texture => {
                let pairs = joints.iter().zip(&geometry.influences.weights);
                let numbers: Vec<f32> = pairs.flat_map(|(&joint, &weight)| [f32::from(joint), weight]).collect();
                Some(vertex_texture(device, queue, "influences", numbers).ok_or_else(too_many)?)
            }
            _ => None,
        };
        let (morph_attributes, morph_numbers) = morph_numbers(geometry);
        let targets = geometry.morph_targets.len();
        let morph_view = match targets {
            0 => None,
            _ => Some(
                vertex_texture(device, queue, "morph targets", morph_numbers)
                    .ok_or(UploadError::TooManyMorphTargets { mesh, primitive, vertices: count, targets })?,
            ),
        };
        let (shape, surface) = (shape_vertices(geometry, smooth), surface_vertices(geometry));
        Ok(Self {
            topology: geometry.topology,
            influences,
            influence_stride: geometry.influences.stride as u32,
            vertices,
            morph_attributes,
            shape: pools.vertices.add(bytemuck::cast_slice(&shape)),
            surface: pools.vertices.add(bytemuck::cast_slice(&surface)),
            influence_part,
            indices: pools.indices.add(bytemuck::cast_slice(&geometry.indices)),
            index_count: geometry.indices.len() as u32,
            morph_view,
            influence_view,
        })
    }

    /// Returns the memory of all buffers and textures in bytes.
    pub fn device_bytes(&self) -> u64 {
        let parts = [Some(&self.shape), Some(&self.surface), self.influence_part.as_ref(), Some(&self.indices)];
        let textures = [&self.morph_view, &self.influence_view].into_iter().flatten();
        parts.into_iter().flatten().map(Pooled::size).sum::<u64>() + textures.map(texture_bytes).sum::<u64>()
    }

    /// Binds the vertex buffers but not the index buffer.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.shape.slice());
        pass.set_vertex_buffer(1, self.surface.slice());
        if let Some(influences) = &self.influence_part {
            pass.set_vertex_buffer(2, influences.slice());
        }
    }
}

/// Meshes without normals get smooth ones here; the FLAT feature ignores them.
fn shape_vertices(geometry: &Geometry, smooth: &[Vec3]) -> Vec<ShapeVertex> {
    let normals = if geometry.normals.is_empty() { smooth } else { &geometry.normals };
    let normal = |vertex: usize| normals.get(vertex).map_or([0.0; 3], |normal| normal.to_array());
    let positions = geometry.positions.iter().enumerate();
    positions.map(|(vertex, position)| ShapeVertex { position: position.to_array(), normal: normal(vertex) }).collect()
}

fn surface_vertices(geometry: &Geometry) -> Vec<SurfaceVertex> {
    let vertex = |vertex: usize| {
        let uv = |set: usize| geometry.uvs[set].get(vertex).map_or([0.0; 2], |uv| uv.to_array());
        let ([u0, v0], [u1, v1]) = (uv(0), uv(1));
        SurfaceVertex {
            tangent: geometry.tangents.get(vertex).map_or([0.0; 4], |tangent| tangent.to_array()),
            uv: [u0, v0, u1, v1],
            color: geometry.colors.get(vertex).map_or([u16::MAX; 4], |color| {
                color.to_array().map(|channel| (channel.clamp(0.0, 1.0) * 65_535.0).round() as u16)
            }),
        }
    };
    (0..geometry.positions.len()).map(vertex).collect()
}

fn influences_by_four(joints: &[u16], weights: &[f32]) -> Vec<FourInfluences> {
    let (joints, weights) = (joints.as_chunks::<4>().0, weights.as_chunks::<4>().0);
    joints.iter().zip(weights).map(|(&joints, &weights)| FourInfluences { joints, weights }).collect()
}

/// The joints of all influences. Unused influences get the vertex's first joint, so the vertex stage need not skip
/// them: a joint without weight never affects a vertex, not even one with an infinite matrix.
fn used_joints(influences: &Influences) -> Vec<u16> {
    let mut joints = influences.joints.clone();
    let stride = influences.stride.max(1);
    for (joints, weights) in joints.chunks_mut(stride).zip(influences.weights.chunks(stride)) {
        let first = joints.first().copied().unwrap_or_default();
        for (joint, _) in joints.iter_mut().zip(weights).filter(|(_, weight)| **weight == 0.0) {
            *joint = first;
        }
    }
    joints
}

/// Returns the number of texels per vertex and target, and the deltas: by target, then vertex, then attribute (position,
/// normal, tangent).
fn morph_numbers(geometry: &Geometry) -> (u32, Vec<f32>) {
    let targets = &geometry.morph_targets;
    let attributes = if targets.iter().any(|target| !target.tangents.is_empty()) {
        3
    } else if targets.iter().any(|target| !target.normals.is_empty()) {
        2
    } else {
        1
    };
    let mut numbers = Vec::with_capacity(4 * attributes * targets.len() * geometry.positions.len());
    for target in targets {
        for vertex in 0..geometry.positions.len() {
            for deltas in [&target.positions, &target.normals, &target.tangents].into_iter().take(attributes) {
                let delta = deltas.get(vertex).copied().unwrap_or_default();
                numbers.extend([delta.x, delta.y, delta.z, 0.0]);
            }
        }
    }
    (attributes as u32, numbers)
}

/// Packs numbers into a texture, four to a texel; none if the device cannot hold them.
fn vertex_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    mut numbers: Vec<f32>,
) -> Option<wgpu::TextureView> {
    let row = 4 * VERTEX_TEXTURE_WIDTH as usize;
    let height = u32::try_from(numbers.len().div_ceil(row)).ok()?.max(1);
    if height > device.limits().max_texture_dimension_2d {
        return None;
    }
    numbers.resize(row * height as usize, 0.0);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: VERTEX_TEXTURE_WIDTH, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&numbers),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * VERTEX_TEXTURE_WIDTH), rows_per_image: None },
        texture.size(),
    );
    Some(texture.create_view(&Default::default()))
}

/// Returns every triangle edge once, as pairs of vertex indices.
pub(super) fn edges(indices: &[u32]) -> Vec<u32> {
    let mut seen = HashSet::with_capacity(indices.len());
    let mut edges = Vec::with_capacity(indices.len());
    for &[a, b, c] in indices.as_chunks::<3>().0 {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if seen.insert((from.min(to), from.max(to))) {
                edges.extend([from, to]);
            }
        }
    }
    edges
}
