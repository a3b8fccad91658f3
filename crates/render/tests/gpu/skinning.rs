//! GPU skinning against the shared cases and the CPU: each vertex is drawn into a pixel that stores its position.

use bytemuck::Zeroable;
use gaitway_character::anim::model_from_joint;
use gaitway_character::mesh::{Geometry, Influences, PaletteEntry, SkinningMode, deform, palette_entry, write_palette};
use gaitway_formats::{FileSet, load};
use gaitway_render::geometry::{GpuGeometry, InfluenceSource, Pools, vertex_buffers};
use gaitway_render::palette::PaletteTexture;
use gaitway_render::shaders::SKINNED_VERTEX;
use gaitway_render::uniforms::{DrawUniform, FrameUniform};
use glam::{Affine3A, DVec3, Quat, Vec3};
use wgpu::util::DeviceExt;

use crate::coursework::{Exercise, pose};
use crate::data_folder::data_folder;
use crate::device::{Gpu, gpu};
use crate::skinning_cases::{Case, cases, expected, morphing, scattered};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 64;

const PROBE: &str = "
struct Probe {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
}

fn probe(vertex: u32, skinned: VertexOut) -> Probe {
    let pixel = vec2f(f32(vertex % 64u), f32(vertex / 64u)) + 0.5;
    let at = vec2f(pixel.x / 32.0 - 1.0, 1.0 - pixel.y / 32.0);
    return Probe(vec4f(at, 0.0, 1.0), frame.eye - skinned.to_eye, skinned.normal);
}

@vertex
fn probe_0(in: VertexIn) -> Probe {
    return probe(in.vertex, vertex_out(in, single(0u), 0.0));
}

@vertex
fn probe_4(in: VertexIn, influence: Influences4) -> Probe {
    return probe(in.vertex, vertex_out(in, blend_4(influence.joints, influence.weights), 0.0));
}

@vertex
fn probe_8(in: VertexIn, influence: Influences8) -> Probe {
    let blend = blend_8(influence.joints_0, influence.weights_0, influence.joints_1, influence.weights_1);
    return probe(in.vertex, vertex_out(in, blend, 0.0));
}

@vertex
fn probe_texture(in: VertexIn) -> Probe {
    return probe(in.vertex, vertex_out(in, blend_texture(in.vertex), 0.0));
}

struct Texels {
    @location(0) world: vec4f,
    @location(1) normal: vec4f,
}

@fragment
fn write(in: Probe) -> Texels {
    return Texels(vec4f(in.world, 1.0), vec4f(in.normal, 1.0));
}
";

/// Skins all vertices on the GPU; returns positions and normals.
fn on_gpu(
    gpu: &Gpu,
    geometry: &Geometry,
    palette: &[PaletteEntry],
    weights: &[f32],
    mode: SkinningMode,
) -> [Vec<Vec3>; 2] {
    let Gpu { device, queue } = gpu;
    let mut pools = Pools::new(device, [geometry].into_iter());
    let gpu_geometry = GpuGeometry::new(device, queue, &mut pools, geometry, &[], [0, 0]).unwrap();
    drop(pools);
    let mut palette_texture = PaletteTexture::new(device);
    // A preceding entry makes the offset matter.
    palette_texture.push_palette(&[PaletteEntry::default()]);
    let first = palette_texture.push_palette(palette);
    let (morph_weights, morph_count) = palette_texture.push_morph_weights(weights);
    palette_texture.upload(device, queue);
    let draw = DrawUniform {
        palette: first,
        morph_weights,
        morph_count: if gpu_geometry.morph_view.is_some() { morph_count } else { 0 },
        morph_attributes: gpu_geometry.morph_attributes,
        vertices: gpu_geometry.vertices,
        influence_stride: gpu_geometry.influence_stride,
        ..DrawUniform::zeroed()
    };
    let layouts = bind_group_layouts(device);
    let groups = bind_groups(device, &layouts, draw, &palette_texture, &gpu_geometry);
    let pipeline = probe_pipeline(device, &layouts, gpu_geometry.influences, mode);
    draw_probe(gpu, &pipeline, &groups, &gpu_geometry).map(|texture| {
        let bytes = gpu.read(&texture, 16);
        let texels: &[[f32; 4]] = bytemuck::cast_slice(&bytes);
        let vertices = &texels[..geometry.positions.len()];
        assert!(vertices.iter().all(|texel| texel[3] == 1.0), "not every vertex was drawn");
        vertices.iter().map(|texel| Vec3::from_slice(texel)).collect()
    })
}

/// Frame, draw and primitive, without the group for light.
fn bind_group_layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 3] {
    let texture = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    };
    let uniform = wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    [vec![uniform, texture(1)], vec![uniform], vec![texture(11), texture(12)]].map(|entries| {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    })
}

fn bind_groups(
    device: &wgpu::Device,
    layouts: &[wgpu::BindGroupLayout; 3],
    draw: DrawUniform,
    palette: &PaletteTexture,
    geometry: &GpuGeometry,
) -> [wgpu::BindGroup; 3] {
    let uniform = |contents: &[u8]| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents,
            usage: wgpu::BufferUsages::UNIFORM,
        })
    };
    let (frame, draw) = (uniform(bytemuck::bytes_of(&FrameUniform::zeroed())), uniform(bytemuck::bytes_of(&draw)));
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    let texture = |binding, view| entry(binding, wgpu::BindingResource::TextureView(view));
    let placeholder = palette.view();
    let entries = [
        vec![entry(0, frame.as_entire_binding()), texture(1, palette.view())],
        vec![entry(0, draw.as_entire_binding())],
        vec![
            texture(11, geometry.morph_view.as_ref().unwrap_or(placeholder)),
            texture(12, geometry.influence_view.as_ref().unwrap_or(placeholder)),
        ],
    ];
    std::array::from_fn(|group| {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layouts[group],
            entries: &entries[group],
        })
    })
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

fn probe_pipeline(
    device: &wgpu::Device,
    layouts: &[wgpu::BindGroupLayout; 3],
    influences: InfluenceSource,
    mode: SkinningMode,
) -> wgpu::RenderPipeline {
    // Renumbers the groups, since the one for light is missing.
    let source = (SKINNED_VERTEX.source() + PROBE).replace("@group(2)", "@group(1)").replace("@group(3)", "@group(2)");
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("probe"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &layouts.each_ref().map(Some),
        immediate_size: 0,
    });
    let skinning = match mode {
        SkinningMode::Linear => 0.0,
        SkinningMode::Rigid => 1.0,
        SkinningMode::DualQuaternion => 2.0,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("probe"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(match influences {
                InfluenceSource::None => "probe_0",
                InfluenceSource::Four => "probe_4",
                InfluenceSource::Eight => "probe_8",
                InfluenceSource::Texture => "probe_texture",
            }),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("SKINNING", skinning)],
                ..Default::default()
            },
            buffers: &vertex_buffers(influences),
        },
        primitive: wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::PointList, ..Default::default() },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("write"),
            compilation_options: Default::default(),
            targets: &[Some(FORMAT.into()), Some(FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Draws every vertex as a pixel; returns the textures of positions and normals.
fn draw_probe(
    gpu: &Gpu,
    pipeline: &wgpu::RenderPipeline,
    groups: &[wgpu::BindGroup; 3],
    geometry: &GpuGeometry,
) -> [wgpu::Texture; 2] {
    let Gpu { device, queue } = gpu;
    let targets = [(); 2].map(|()| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    });
    let views = targets.each_ref().map(|texture| texture.create_view(&Default::default()));
    let attachments = views.each_ref().map(|view| {
        Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder
        .begin_render_pass(&wgpu::RenderPassDescriptor { color_attachments: &attachments, ..Default::default() });
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    geometry.bind(&mut pass);
    pass.draw(0..geometry.vertices, 0..1);
    drop(pass);
    queue.submit([encoder.finish()]);
    targets
}

/// The tolerance allows for approximate reciprocal square roots and fused multiply-adds on the GPU.
fn compare(name: &str, found: &[Vec3], expected: &[DVec3], tolerance: f64) {
    let size = expected.iter().map(|value| value.abs().max_element()).fold(1e-9, f64::max);
    assert_eq!(found.len(), expected.len(), "{name}");
    for (vertex, (found, expected)) in found.iter().zip(expected).enumerate() {
        let distance = found.as_dvec3().distance(*expected);
        assert!(distance <= tolerance * size, "{name}, vertex {vertex}: {found} instead of {expected}");
    }
}

fn palette_of(case: &Case) -> Vec<PaletteEntry> {
    case.world_from_bind.iter().map(|matrix| palette_entry(matrix, case.mode)).collect()
}

#[test]
fn the_gpu_passes_the_shared_cases() {
    let Some(gpu) = gpu() else { return };
    for case in cases() {
        let [positions, normals] = on_gpu(&gpu, &case.geometry, &palette_of(&case), &case.morph_weights, case.mode);
        let (expected_positions, expected_normals) = expected(&case);
        compare(case.name, &positions, &expected_positions, 1e-5);
        compare(case.name, &normals, &expected_normals, 1e-4);
    }
}

/// With more joints than a uniform buffer of WebGL2 can hold, in every mode and with every source of influences.
#[test]
fn a_thousand_joints_match_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let joints: Vec<Affine3A> = (0..1000)
        .map(|joint| {
            let share = joint as f32 / 1000.0;
            let rotation = Quat::from_euler(glam::EulerRot::XYZ, 3.0 * share, 2.0 * share, 0.3 - share);
            Affine3A::from_rotation_translation(rotation, Vec3::new(share, 2.0 * share, -0.5))
        })
        .collect();
    for influences in [4, 8, 13, 16] {
        for mode in [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion] {
            let geometry = morphing(scattered(influences, 1000));
            assert!(geometry.influences.joints.iter().any(|joint| *joint > 900));
            let palette: Vec<_> = joints.iter().map(|matrix| palette_entry(matrix, mode)).collect();
            let mut on_cpu = Default::default();
            deform(&geometry, &[0.5, -0.25], &palette, mode, &mut on_cpu);
            let [positions, normals] = on_gpu(&gpu, &geometry, &palette, &[0.5, -0.25], mode);
            let name = format!("{influences} influences, {mode:?}");
            let wide = |values: &[Vec3]| values.iter().map(|value| value.as_dvec3()).collect::<Vec<_>>();
            compare(&name, &positions, &wide(&on_cpu.positions), 1e-5);
            compare(&name, &normals, &wide(&on_cpu.normals), 1e-4);
        }
    }
}

/// The models of the skinning exercise, with up to 13 weights per vertex, against its formula in double precision.
#[test]
fn the_exercise_models_match_the_formula() {
    let (Some(gpu), Some(folder)) = (gpu(), data_folder()) else { return };
    for (name, seed) in [("Model1", 1), ("Model2", 2), ("Model3", 3), ("Model4", 4)] {
        let text = |kind: &str| std::fs::read_to_string(folder.join(format!("mit6837/{name}.{kind}"))).unwrap();
        let mut files = FileSet::default();
        for kind in ["obj", "skel", "attach"] {
            files.insert(format!("{name}.{kind}"), text(kind).into_bytes());
        }
        let asset = load(&files).unwrap();
        let full = &asset.meshes[0].primitives[0];
        // The probe has 4,096 pixels: keep every fourth vertex.
        let kept: Vec<usize> = (0..full.positions.len()).step_by(4).collect();
        let stride = full.influences.stride;
        let of_kept = |vertex: &usize| vertex * stride..(vertex + 1) * stride;
        let geometry = Geometry {
            positions: kept.iter().map(|&vertex| full.positions[vertex]).collect(),
            normals: vec![Vec3::Y; kept.len()],
            influences: Influences {
                stride,
                joints: kept.iter().flat_map(|vertex| full.influences.joints[of_kept(vertex)].to_vec()).collect(),
                weights: kept.iter().flat_map(|vertex| full.influences.weights[of_kept(vertex)].to_vec()).collect(),
            },
            indices: (0..kept.len() as u32).collect(),
            ..Geometry::default()
        };
        let (exact, rounded) = pose(18, seed);
        let mut posed = asset.skeleton.rest().clone();
        for (source, rotation) in rounded.into_iter().enumerate() {
            posed.set_rotation(asset.skeleton.joint_of_source(source).unwrap(), rotation);
        }
        let (mut world, mut palette) = (Vec::new(), Vec::new());
        model_from_joint(&asset.skeleton, &posed, Affine3A::IDENTITY, &mut world);
        write_palette(&asset.skins[0], &world, SkinningMode::Linear, &mut palette);
        let [positions, _] = on_gpu(&gpu, &geometry, &palette, &[], SkinningMode::Linear);
        let skinned = Exercise::read(&text("obj"), &text("skel"), &text("attach")).skinned(&exact);
        let expected: Vec<DVec3> = kept.iter().map(|&vertex| skinned[vertex]).collect();
        compare(name, &positions, &expected, 2e-6);
    }
}
