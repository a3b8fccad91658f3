//! The renderer: holds the models' GPU data and draws frames.

use std::ops::AddAssign;

use gaitway_scene::frame::Frame;
use gaitway_scene::library::{Model, ModelId};
use gaitway_scene::state::Background;

use super::draw_list::{DrawList, Item};
use super::environment::Source;
use super::frame_uniform::{GroundPlane, frame_uniform};
use super::layouts::Layouts;
use super::light::LightSources;
use super::model::{GpuModel, ModelUploader};
use super::overlay::Overlay;
use super::palette::PaletteTexture;
use super::pipelines::Pipelines;
use super::refine::{Accumulator, SAMPLE_OFFSETS};
use super::targets::Targets;
#[cfg(target_arch = "wasm32")]
use super::texture::ImageUploader;
use super::thumbnail::thumbnails;
use super::transmission::TransmissionPass;
use super::uniform_buffer::UniformBuffer;
use super::uniforms::FrameUniform;
use super::upload_error::UploadError;

/// Settings that last as long as the renderer.
#[derive(Debug, Clone, Copy)]
pub struct RendererOptions {
    /// Samples per pixel of a picture that isn't refined.
    pub samples: u32,
}

impl RendererOptions {
    /// One sample per pixel for software rendering, where four samples double the frame time, and four otherwise.
    pub fn for_adapter(info: &wgpu::AdapterInfo) -> Self {
        Self { samples: if is_software(info) { 1 } else { 4 } }
    }
}

/// Whether the adapter renders on the CPU. Browsers hide the adapter's type, but name software adapters.
fn is_software(info: &wgpu::AdapterInfo) -> bool {
    let names = format!("{} {} {}", info.name, info.driver, info.driver_info).to_lowercase();
    info.device_type == wgpu::DeviceType::Cpu
        || ["swiftshader", "llvmpipe", "lavapipe", "software"].iter().any(|name| names.contains(name))
}

/// Counts for one picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Draw calls of the shadow pass and of all panes.
    pub draw_calls: u32,
    /// Triangles of meshes and bones in all panes, without the shadow pass, background, ground and lines.
    pub triangles: u32,
}

impl AddAssign for RenderStats {
    fn add_assign(&mut self, other: Self) {
        self.draw_calls += other.draw_calls;
        self.triangles += other.triangles;
    }
}

/// Draws frames. Every call must pass the device that the renderer was created with.
pub struct Renderer {
    options: RendererOptions,
    layouts: Layouts,
    pipelines: Pipelines,
    uploader: ModelUploader,
    models: Vec<GpuModel>,
    palette: PaletteTexture,
    overlay: Overlay,
    draws: DrawList,
    targets: Targets,
    frame_buffer: UniformBuffer<FrameUniform>,
    /// The frame's uniform with the light's projection.
    shadow_buffer: UniformBuffer<FrameUniform>,
    frame_group: wgpu::BindGroup,
    shadow_group: wgpu::BindGroup,
    light: LightSources,
    /// The last picture's uniform, without a sample's offset.
    uniform: FrameUniform,
    /// How many of [`SAMPLE_OFFSETS`] the last picture has. Multisampling counts as all of them.
    samples_drawn: usize,
    /// Created when a picture is first refined.
    accumulator: Option<Accumulator>,
    /// Created for the first picture with transmissive surfaces.
    transmission: Option<TransmissionPass>,
    stats: RenderStats,
}

impl UniformBuffer<FrameUniform> {
    fn bind_group(&self, device: &wgpu::Device, layouts: &Layouts, palette: &PaletteTexture) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &layouts.frame,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(palette.view()) },
            ],
        })
    }
}

/// The target of another sample of a picture.
#[derive(Clone, Copy)]
struct Sample<'a> {
    view: &'a wgpu::TextureView,
    /// The same, bound for the transmission pass to copy; `None` until a picture has transmissive surfaces.
    copied: Option<&'a wgpu::BindGroup>,
}

impl Renderer {
    /// Creates what takes little time. The rest follows when it is first drawn.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, options: RendererOptions) -> Self {
        let layouts = Layouts::new(device);
        let pipelines = Pipelines::new(queue, &layouts, options.samples);
        let light = LightSources::new(device, queue, &layouts, options.samples);
        let palette = PaletteTexture::new(device);
        let frame_buffer = UniformBuffer::new(device, "frame");
        let shadow_buffer = UniformBuffer::new(device, "shadow");
        let targets = Targets::new(device, [1, 1], options.samples);
        // On software adapters extra samples and texels are expensive, so both are disabled.
        let anisotropy = if options.samples > 1 { 4 } else { 1 };
        Self {
            options,
            pipelines,
            uploader: ModelUploader::new(device, queue, anisotropy),
            models: Vec::new(),
            overlay: Overlay::new(device, options.samples),
            draws: DrawList::new(device, &layouts),
            frame_group: frame_buffer.bind_group(device, &layouts, &palette),
            shadow_group: shadow_buffer.bind_group(device, &layouts, &palette),
            light,
            palette,
            targets,
            frame_buffer,
            shadow_buffer,
            layouts,
            uniform: FrameUniform::default(),
            samples_drawn: SAMPLE_OFFSETS.len(),
            accumulator: None,
            transmission: None,
            stats: RenderStats::default(),
        }
    }

    /// Uploads a model's geometry and textures, unless it is already uploaded as it is.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, model: &Model) -> Result<(), UploadError> {
        if !self.models.iter().any(|known| known.is_of(model)) {
            let uploaded = self.uploader.upload(device, queue, model)?;
            self.models.retain(|known| known.id != model.id);
            self.models.push(uploaded);
        }
        Ok(())
    }

    /// Uploads images in advance.
    #[cfg(target_arch = "wasm32")]
    pub fn images(&mut self) -> &mut ImageUploader {
        &mut self.uploader.images
    }

    /// Returns small copies of an uploaded model's images, gamma-encoded; `None` for those that no material uses.
    pub fn thumbnails(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        model: ModelId,
    ) -> Vec<Option<wgpu::TextureView>> {
        let model = self.models.iter().find(|known| known.id == model);
        model.map_or_else(Vec::new, |model| thumbnails(device, queue, model.images()))
    }

    /// Returns the memory of all uploaded models in bytes: their geometry and their images.
    pub fn device_bytes(&self) -> [u64; 2] {
        self.models.iter().fold([0, 0], |sums, model| [0, 1].map(|kind: usize| sums[kind] + model.device_bytes[kind]))
    }

    /// Frees the GPU data of all other models.
    pub fn retain(&mut self, keep: &[ModelId]) {
        self.models.retain(|model| keep.contains(&model.id));
    }

    /// Draws the frame into a texture of this size in pixels. Returns a view of an Rgba8Unorm texture, gamma-encoded with
    /// premultiplied alpha, which stays the same until the size changes. Models that are not uploaded are skipped.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &Frame,
        size: [u32; 2],
    ) -> &wgpu::TextureView {
        let max_size = device.limits().max_texture_dimension_2d;
        let size = size.map(|edge| edge.clamp(1, max_size));
        if self.targets.size() != size {
            self.targets = Targets::new(device, size, self.options.samples);
        }

        self.pipelines.prepare_ground(device, &self.layouts);
        self.pipelines.prepare_backdrop(device, &self.layouts);
        // A browser compiles the pipelines in another process meanwhile.
        self.light.choose(device, queue, &self.layouts, Source::of(frame));
        if matches!(frame.look.background, Background::Environment | Background::Blurred) {
            self.light.prepare_sky(device, queue, &self.layouts);
            self.pipelines.prepare_sky(device, &self.layouts, frame.look.tone_map);
        }
        let ground = GroundPlane::of(frame);
        let panes = Panes::new(frame.panes, size);
        let (uniform, shadow_uniform) = frame_uniform(frame, ground.as_ref(), panes.size, &self.light);
        self.frame_buffer.write(queue, uniform);
        self.uniform = uniform;
        let shadow = shadow_uniform.is_some();
        if let Some(uniform) = shadow_uniform {
            self.shadow_buffer.write(queue, uniform);
        }
        for character in &frame.characters {
            if let Some(model) = self.models.iter_mut().find(|model| model.id == character.model) {
                model.animate(queue, &character.materials);
            }
        }
        self.draws.collect(device, frame, &mut self.models, &mut self.pipelines, &mut self.palette, shadow);
        self.draws.upload(device, queue, &self.layouts);
        if self.draws.has_transmission() {
            let pass = self.transmission.get_or_insert_with(|| TransmissionPass::new(device));
            let output = &self.targets.output_view;
            let buffer = self.targets.transmission.get_or_insert_with(|| pass.create_buffer(device, output, size));
            self.light.set_transmission(device, &self.layouts, &buffer.view);
        }
        if self.palette.upload(device, queue) {
            self.frame_group = self.frame_buffer.bind_group(device, &self.layouts, &self.palette);
            self.shadow_group = self.shadow_buffer.bind_group(device, &self.layouts, &self.palette);
        }
        let bones = &frame.bones[..];
        self.overlay.upload(device, queue, &self.layouts, (&frame.lines, bones), frame.look.boxes);
        self.stats = RenderStats::default();
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("picture") });
        if shadow {
            self.draw_shadow(&mut encoder);
        }
        self.draw_scene(&mut encoder, None, frame.look.background, ground.as_ref(), &panes);
        queue.submit([encoder.finish()]);
        self.samples_drawn = if self.options.samples > 1 { SAMPLE_OFFSETS.len() } else { 1 };
        &self.targets.output_view
    }

    /// Whether [`Self::refine`] can add a sample to the last picture. Never with multisampling.
    pub fn can_refine(&self) -> bool {
        self.samples_drawn < SAMPLE_OFFSETS.len()
    }

    /// Adds a sample per pixel to the last picture, which must show this frame. Returns whether it can be refined
    /// further.
    pub fn refine(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, frame: &Frame) -> bool {
        let Some([right, down]) = SAMPLE_OFFSETS.get(self.samples_drawn) else { return false };
        let panes = Panes::new(frame.panes, self.targets.size());
        let mut uniform = self.uniform;
        let jitter = [-2.0 * right / panes.size[0], 2.0 * down / panes.size[1]];
        for column in &mut uniform.projection_from_world {
            column[0] += jitter[0] * column[3];
            column[1] += jitter[1] * column[3];
        }
        self.frame_buffer.write(queue, uniform);
        let sample = self.targets.sample_target(device);
        let stats = self.stats;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("sample") });
        let ground = GroundPlane::of(frame);
        let copied = self.transmission.as_ref().map(|pass| pass.bind(device, &sample));
        let target = Sample { view: &sample, copied: copied.as_ref() };
        self.draw_scene(&mut encoder, Some(target), frame.look.background, ground.as_ref(), &panes);
        self.stats = stats;
        let accumulator = self.accumulator.get_or_insert_with(|| Accumulator::new(device));
        let group = accumulator.bind(device, &sample);
        self.samples_drawn += 1;
        accumulator.add(&mut encoder, &group, &self.targets.output_view, 1.0 / self.samples_drawn as f64);
        queue.submit([encoder.finish()]);
        self.can_refine()
    }

    /// Like [`Self::draw`], with at least four samples per pixel on every device.
    pub fn draw_refined(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, frame: &Frame, size: [u32; 2]) {
        self.draw(device, queue, frame, size);
        while self.refine(device, queue, frame) {}
    }

    /// Makes the next picture use a new texture, so that the caller can keep the last one.
    pub fn give_output_away(&mut self, device: &wgpu::Device) {
        self.targets = Targets::new(device, [1, 1], self.options.samples);
        self.samples_drawn = SAMPLE_OFFSETS.len();
    }

    /// The texture of the last picture.
    pub fn output(&self) -> &wgpu::Texture {
        &self.targets.output
    }

    /// Statistics of the last picture.
    pub fn stats(&self) -> RenderStats {
        self.stats
    }

    fn draw_shadow(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.light.shadow_map.view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.shadow_group, &[]);
        pass.set_bind_group(1, &self.light.without_shadow, &[]);
        let draw = self.draws.bind_group();
        let stats = draw_items(&mut pass, self.draws.shadow(), 0, draw, &self.models, &self.pipelines);
        self.stats.draw_calls += stats.draw_calls;
    }

    /// Draws everything in one pass or, with transmissive surfaces, in two: the first one's opaque surfaces are copied
    /// for the second.
    fn draw_scene(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        sample: Option<Sample>,
        background: Background,
        ground: Option<&GroundPlane>,
        panes: &Panes,
    ) {
        let clear = match background {
            Background::Color(color) => {
                let [r, g, b] = color.map(|channel| f64::from(channel) / 255.0);
                wgpu::Color { r, g, b, a: 1.0 }
            }
            Background::Transparent => wgpu::Color::TRANSPARENT,
            // The background is drawn over it; masked surfaces keep its alpha.
            _ => wgpu::Color::BLACK,
        };
        let clear = (wgpu::LoadOp::Clear(clear), wgpu::LoadOp::Clear(1.0));
        let transmission = self.transmission.as_ref().zip(self.targets.transmission.as_ref());
        let transmission = transmission.filter(|_| self.draws.has_transmission());
        let copied = sample.and_then(|sample| sample.copied);
        let view = sample.map(|sample| sample.view);
        let mut stats = RenderStats::default();
        let mut pass = self.scene_pass(encoder, view, clear, transmission.is_some());
        for pane in 0..panes.count() {
            panes.set_viewport(&mut pass, pane);
            stats += self.draw_opaque(&mut pass, background, ground, pane);
            if transmission.is_none() {
                stats += self.draw_transparent(&mut pass, pane);
            }
        }
        drop(pass);
        if let Some((copy, buffer)) = transmission {
            copy.record(buffer, encoder, copied);
            let mut pass = self.scene_pass(encoder, view, (wgpu::LoadOp::Load, wgpu::LoadOp::Load), false);
            for pane in 0..panes.count() {
                panes.set_viewport(&mut pass, pane);
                stats += self.draw_transparent(&mut pass, pane);
            }
        }
        self.stats += stats;
    }

    /// Begins a pass into the scene's targets, or into a further `sample`. `continues` keeps the contents for another
    /// pass.
    fn scene_pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        sample: Option<&wgpu::TextureView>,
        (color, depth): (wgpu::LoadOp<wgpu::Color>, wgpu::LoadOp<f32>),
        continues: bool,
    ) -> wgpu::RenderPass<'a> {
        let (view, resolve_target) = match (sample, &self.targets.multisampled) {
            (Some(sample), _) => (sample, None),
            (None, Some(samples)) => (samples, Some(&self.targets.output_view)),
            (None, None) => (&self.targets.output_view, None),
        };
        let store = |is_needed| if is_needed { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: color, store: store(continues || resolve_target.is_none()) },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: Some(wgpu::Operations { load: depth, store: store(continues) }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_bind_group(1, &self.light.group, &[]);
        pass
    }

    /// Draws opaque surfaces, the background and the ground.
    fn draw_opaque(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        background: Background,
        ground: Option<&GroundPlane>,
        pane: u32,
    ) -> RenderStats {
        let mut stats = RenderStats::default();
        let overlay_call = RenderStats { draw_calls: 1, triangles: 0 };
        let draw = self.draws.bind_group();
        stats += draw_items(pass, self.draws.solid(), pane, draw, &self.models, &self.pipelines);
        if let Some((pipeline, group)) = self.pipelines.sky(background).zip(self.light.sky.as_ref()) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, group, &[]);
            pass.draw(0..3, 0..1);
            pass.set_bind_group(1, &self.light.group, &[]);
            stats += overlay_call;
        }
        if let (Background::Studio, Some(backdrop)) = (background, &self.pipelines.backdrop) {
            pass.set_pipeline(backdrop);
            pass.draw(0..3, 0..1);
            stats += overlay_call;
        }
        let (Some(ground), Some(pipelines)) = (ground, &self.pipelines.ground) else { return stats };
        if ground.grid {
            pass.set_pipeline(&pipelines.grid);
            pass.draw(0..18, 0..1);
            stats += overlay_call;
        }
        // After the grid, so that the shadow darkens its lines.
        if ground.shadow {
            pass.set_pipeline(&pipelines.shadow);
            pass.draw(0..6, 0..1);
            stats += overlay_call;
        }
        stats
    }

    /// Draws transmissive and blended surfaces, and overlays.
    fn draw_transparent(&self, pass: &mut wgpu::RenderPass<'_>, pane: u32) -> RenderStats {
        let mut stats = RenderStats::default();
        let overlay_call = RenderStats { draw_calls: 1, triangles: 0 };
        let draw = self.draws.bind_group();
        for items in [self.draws.transmissive(), self.draws.blended()] {
            stats += draw_items(pass, items, pane, draw, &self.models, &self.pipelines);
        }
        for on_top in [false, true] {
            if on_top && (self.overlay.bones() > 0 || !self.overlay.lines(true).is_empty()) {
                self.overlay.clear_depth(pass);
                stats += overlay_call;
            }
            if on_top && self.overlay.bones() > 0 {
                self.overlay.draw_bones(pass);
                stats += RenderStats { draw_calls: 1, triangles: self.overlay.bone_triangles() };
            }
            if !self.overlay.lines(on_top).is_empty() {
                self.overlay.draw_lines(pass, on_top);
                stats += overlay_call;
            }
        }
        stats
    }
}

/// The panes of a picture: equal rectangles in rows.
struct Panes {
    columns: u32,
    rows: u32,
    /// Size of a pane in pixels.
    size: [f32; 2],
}

impl Panes {
    fn new([columns, rows]: [u32; 2], [width, height]: [u32; 2]) -> Self {
        let (columns, rows) = (columns.max(1), rows.max(1));
        Self { columns, rows, size: [width as f32 / columns as f32, height as f32 / rows as f32] }
    }

    fn count(&self) -> u32 {
        self.columns * self.rows
    }

    fn set_viewport(&self, pass: &mut wgpu::RenderPass<'_>, pane: u32) {
        let [x, y, width, height] = self.rect(pane);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
    }

    /// Left, top, width and height in whole pixels, as OpenGL requires.
    fn rect(&self, pane: u32) -> [f32; 4] {
        let edges = |at: u32, size: f32| [at, at + 1].map(|edge| (edge as f32 * size).round());
        let [left, right] = edges(pane % self.columns, self.size[0]);
        let [top, bottom] = edges(pane / self.columns, self.size[1]);
        [left, top, right - left, bottom - top]
    }
}

fn draw_items(
    pass: &mut wgpu::RenderPass<'_>,
    items: &[Item],
    pane: u32,
    draw_group: &wgpu::BindGroup,
    models: &[GpuModel],
    pipelines: &Pipelines,
) -> RenderStats {
    let mut stats = RenderStats::default();
    let mut pipeline = None;
    for item in items.iter().filter(|item| item.pane.is_none_or(|item_pane| item_pane == pane)) {
        let Some(primitive) = item.primitive(models) else { continue };
        let (indices, count) = match (&primitive.edges, item.edges) {
            (Some((edges, count)), true) => (edges.slice(..), *count),
            _ => (primitive.geometry.indices.slice(), primitive.geometry.index_count),
        };
        if pipeline != Some(item.pipeline) {
            pass.set_pipeline(pipelines.get(item.pipeline));
            pipeline = Some(item.pipeline);
        }
        pass.set_bind_group(2, draw_group, &[item.offset]);
        pass.set_bind_group(3, &primitive.bind_group, &[]);
        primitive.geometry.bind(pass);
        pass.set_index_buffer(indices, wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..count, 0, 0..item.copies);
        stats.draw_calls += 1;
        if !item.edges
            && !item.depth_only
            && primitive.geometry.topology == gaitway_character::mesh::Topology::Triangles
        {
            stats.triangles += item.copies * (count / 3);
        }
    }
    stats
}
