//! Overlays: instanced lines and bones.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use gaitway_scene::frame::{Bone, Line};
use glam::Vec3;
use wgpu::util::DeviceExt;

use super::layouts::{Layouts, pipeline_layout};
use super::pipelines::ScenePipeline;
use super::shaders;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LineInstance {
    from: [f32; 3],
    width_pixels: f32,
    to: [f32; 3],
    color: [f32; 4],
}

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct BoneInstance {
    head: [f32; 3],
    radius: f32,
    tail: [f32; 3],
    color: [f32; 4],
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct BoneVertex {
    position: [f32; 3],
    /// w: 0 octahedron, 1 ball.
    normal: [f32; 4],
}

/// Instances uploaded only when they differ from the last upload.
struct Instances<T> {
    label: &'static str,
    buffer: wgpu::Buffer,
    current: Vec<T>,
    uploaded: Vec<T>,
}

impl<T: Pod + PartialEq> Instances<T> {
    fn new(device: &wgpu::Device, label: &'static str) -> Self {
        Self { label, buffer: instance_buffer(device, label, 1024), current: Vec::new(), uploaded: Vec::new() }
    }

    fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        if self.current == self.uploaded {
            return;
        }
        let bytes: &[u8] = bytemuck::cast_slice(&self.current);
        if bytes.len() as u64 > self.buffer.size() {
            self.buffer = instance_buffer(device, self.label, (bytes.len() as u64).next_power_of_two());
        }
        queue.write_buffer(&self.buffer, 0, bytes);
        self.uploaded.clone_from(&self.current);
    }
}

fn instance_buffer(device: &wgpu::Device, label: &'static str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Created on first use.
struct OverlayPipelines {
    lines: wgpu::RenderPipeline,
    bones: wgpu::RenderPipeline,
    clear_depth: wgpu::RenderPipeline,
}

impl OverlayPipelines {
    fn new(device: &wgpu::Device, layouts: &Layouts, samples: u32) -> Self {
        let frame_layout = pipeline_layout(device, "frame only", &[Some(&layouts.frame)]);
        let empty_layout = pipeline_layout(device, "nothing", &[]);

        let line_module = shaders::LINES.module(device);
        let line_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Float32x4];
        let lines = ScenePipeline {
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<LineInstance>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &line_attributes,
            })],
            ..ScenePipeline::new("lines", &line_module, &frame_layout, ["line_vertex", "line_fragment"])
        }
        .create(device, samples);

        let bone_module = shaders::BONES.module(device);
        let bone_shape = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4];
        let bone_instance = wgpu::vertex_attr_array![2 => Float32x3, 3 => Float32, 4 => Float32x3, 5 => Float32x4];
        let bones = ScenePipeline {
            buffers: &[
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<BoneVertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &bone_shape,
                }),
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<BoneInstance>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &bone_instance,
                }),
            ],
            depth_write: true,
            cull: Some(wgpu::Face::Back),
            ..ScenePipeline::new("bones", &bone_module, &frame_layout, ["bone_vertex", "bone_fragment"])
        }
        .create(device, samples);

        let clear_module = shaders::DEPTH_CLEAR.module(device);
        let clear_depth = ScenePipeline {
            depth_write: true,
            depth_compare: wgpu::CompareFunction::Always,
            writes: wgpu::ColorWrites::empty(),
            ..ScenePipeline::new("clear depth", &clear_module, &empty_layout, ["full_screen", "nothing"])
        }
        .create(device, samples);
        Self { lines, bones, clear_depth }
    }
}

pub(super) struct Overlay {
    samples: u32,
    pipelines: Option<OverlayPipelines>,
    lines: Instances<LineInstance>,
    /// Lines before this index are depth-tested against the scene, the rest are drawn on top.
    lines_on_top: u32,
    bones: Instances<BoneInstance>,
    bone_shape: wgpu::Buffer,
    bone_ranges: BoneRanges,
    /// The range in use.
    bone_vertices: Range<u32>,
}

/// Vertex ranges of the octahedron with its ball, and of the ball with the box.
#[derive(Clone)]
struct BoneRanges {
    pointed: Range<u32>,
    boxes: Range<u32>,
}

impl Overlay {
    pub fn new(device: &wgpu::Device, samples: u32) -> Self {
        let (shape, bone_ranges) = bone_shape();
        Self {
            samples,
            pipelines: None,
            lines: Instances::new(device, "lines"),
            lines_on_top: 0,
            bones: Instances::new(device, "bones"),
            bone_shape: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("bone shape"),
                contents: bytemuck::cast_slice(&shape),
                usage: wgpu::BufferUsages::VERTEX,
            }),
            bone_vertices: bone_ranges.pointed.clone(),
            bone_ranges,
        }
    }

    /// `boxes` draws bones as boxes.
    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        (lines, bones): (&[Line], &[Bone]),
        boxes: bool,
    ) {
        if !(lines.is_empty() && bones.is_empty()) {
            self.pipelines.get_or_insert_with(|| OverlayPipelines::new(device, layouts, self.samples));
        }
        let BoneRanges { pointed, boxes: as_boxes } = &self.bone_ranges;
        self.bone_vertices = if boxes { as_boxes.clone() } else { pointed.clone() };
        let instance = |line: &Line| LineInstance {
            from: line.from.to_array(),
            width_pixels: line.width_pixels,
            to: line.to.to_array(),
            color: line.color.to_array(),
        };
        self.lines.current.clear();
        self.lines.current.extend(lines.iter().filter(|line| !line.on_top).map(instance));
        self.lines_on_top = self.lines.current.len() as u32;
        self.lines.current.extend(lines.iter().filter(|line| line.on_top).map(instance));
        self.lines.upload(device, queue);

        self.bones.current.clear();
        self.bones.current.extend(bones.iter().filter(|bone| bone.visible).map(|bone| BoneInstance {
            head: bone.head.to_array(),
            radius: bone.radius,
            tail: bone.tail.to_array(),
            color: bone.color.to_array(),
        }));
        self.bones.upload(device, queue);
    }

    /// Instance range of the lines on top, or of the others.
    pub fn lines(&self, on_top: bool) -> Range<u32> {
        if on_top { self.lines_on_top..self.lines.current.len() as u32 } else { 0..self.lines_on_top }
    }

    pub fn bones(&self) -> u32 {
        self.bones.current.len() as u32
    }

    pub fn bone_triangles(&self) -> u32 {
        self.bones() * self.bone_vertices.len() as u32 / 3
    }

    /// Clears the depth buffer, so that everything drawn afterwards is on top.
    pub fn clear_depth(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(pipelines) = &self.pipelines else { return };
        pass.set_pipeline(&pipelines.clear_depth);
        pass.draw(0..3, 0..1);
    }

    pub fn draw_lines(&self, pass: &mut wgpu::RenderPass<'_>, on_top: bool) {
        let Some(pipelines) = &self.pipelines else { return };
        pass.set_pipeline(&pipelines.lines);
        pass.set_vertex_buffer(0, self.lines.buffer.slice(..));
        pass.draw(0..6, self.lines(on_top));
    }

    pub fn draw_bones(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(pipelines) = &self.pipelines else { return };
        pass.set_pipeline(&pipelines.bones);
        pass.set_vertex_buffer(0, self.bone_shape.slice(..));
        pass.set_vertex_buffer(1, self.bones.buffer.slice(..));
        pass.draw(self.bone_vertices.clone(), 0..self.bones());
    }
}

/// Builds the triangles of the flat-shaded octahedron from head (y 0) to tail (y 1), the smooth ball around the head,
/// and the box that can replace the octahedron.
fn bone_shape() -> (Vec<BoneVertex>, BoneRanges) {
    /// Position along the bone of its widest cross-section.
    const WAIST: f32 = 0.12;
    let mut shape = Vec::new();
    let waist = [Vec3::X, Vec3::NEG_Z, Vec3::NEG_X, Vec3::Z].map(|corner| corner + WAIST * Vec3::Y);
    for side in 0..4 {
        let (a, b) = (waist[side], waist[(side + 1) % 4]);
        for triangle in [[a, b, Vec3::Y], [b, a, Vec3::ZERO]] {
            let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalize_or_zero();
            shape.extend(
                triangle
                    .map(|corner| BoneVertex { position: corner.to_array(), normal: normal.extend(0.0).to_array() }),
            );
        }
    }
    let ball_start = shape.len() as u32;
    for x in [Vec3::X, Vec3::NEG_X] {
        for y in [Vec3::Y, Vec3::NEG_Y] {
            for z in [Vec3::Z, Vec3::NEG_Z] {
                let (a, b, c) = if x.dot(y.cross(z)) > 0.0 { (x, y, z) } else { (x, z, y) };
                ball_triangles([a, b, c], 2, &mut shape);
            }
        }
    }
    let ball_end = shape.len() as u32;
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        box_side(normal, &mut shape);
    }
    let ranges = BoneRanges { pointed: 0..ball_end, boxes: ball_start..shape.len() as u32 };
    (shape, ranges)
}

/// The box is half as thick as the ball.
fn box_side(normal: Vec3, shape: &mut Vec<BoneVertex>) {
    let right = Vec3::new(normal.y, normal.z, normal.x);
    let up = normal.cross(right);
    let corner = |x: f32, y: f32| {
        let unit = 0.5 * (normal + x * right + y * up);
        let position = (unit + 0.5 * Vec3::Y).to_array();
        BoneVertex { position, normal: normal.extend(0.0).to_array() }
    };
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    shape.extend([a, b, c, a, c, d]);
}

fn ball_triangles([a, b, c]: [Vec3; 3], splits: u32, shape: &mut Vec<BoneVertex>) {
    if splits == 0 {
        shape.extend(
            [a, b, c].map(|corner| BoneVertex { position: corner.to_array(), normal: corner.extend(1.0).to_array() }),
        );
        return;
    }
    let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize_or_zero);
    for triangle in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
        ball_triangles(triangle, splits - 1, shape);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bone_triangles_face_outwards() {
        let (shape, ranges) = bone_shape();
        for (triangle, first) in shape.as_chunks::<3>().0.iter().zip((0..).step_by(3)) {
            let [a, b, c] = triangle.map(|vertex| Vec3::from(vertex.position));
            let winding = (b - a).cross(c - a);
            let ball = triangle[0].normal[3] == 1.0;
            let is_box = !ranges.pointed.contains(&first);
            let inside = if ball {
                0.0
            } else if is_box {
                0.5
            } else {
                0.2
            };
            let middle = (a + b + c) / 3.0 - inside * Vec3::Y;
            assert!(winding.dot(middle) > 0.0, "{a} {b} {c}");
            for vertex in triangle {
                assert!(winding.dot(Vec3::from_slice(&vertex.normal)) > 0.0, "{a} {b} {c}");
            }
        }
    }
}
