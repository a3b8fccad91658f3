//! What lights meshes and ground, bound together: environment, reflectance table, shadow map and transmission buffer.

use super::environment::{self, Environment, Source};
use super::layouts::Layouts;
use super::shadow::ShadowMap;
use super::texture::single_texel;

pub(super) struct LightSources {
    pub environment: Environment,
    pub shadow_map: ShadowMap,
    pub sampler: wgpu::Sampler,
    reflectance: wgpu::TextureView,
    /// The transmission buffer; a single texel until a transmissive surface is drawn.
    transmission: wgpu::TextureView,
    pub group: wgpu::BindGroup,
    /// Used while the shadow map itself is drawn: binds a placeholder instead.
    pub without_shadow: wgpu::BindGroup,
    /// The environment as a background; created when it is first shown.
    pub sky: Option<wgpu::BindGroup>,
}

impl LightSources {
    /// `samples` as for [`ShadowMap::new`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, layouts: &Layouts, samples: u32) -> Self {
        let environment = Environment::new(device, queue, Source::Dark);
        let shadow_map = ShadowMap::new(device, samples);
        let sampler = environment::sampler(device);
        let reflectance = environment::reflectance_table(device, queue);
        let transmission = single_texel(device, queue, wgpu::TextureFormat::Rgba8Unorm, &[0; 4]);
        let [group, without_shadow] = [&shadow_map.view, &shadow_map.placeholder].map(|shadow| {
            let views = [&environment.view, shadow, &reflectance, &environment.irradiance, &transmission];
            light_group(device, layouts, views, [&sampler, &shadow_map.sampler])
        });
        Self { environment, shadow_map, sampler, reflectance, transmission, group, without_shadow, sky: None }
    }

    /// Replaces the transmission buffer.
    pub fn set_transmission(&mut self, device: &wgpu::Device, layouts: &Layouts, buffer: &wgpu::TextureView) {
        if self.transmission != *buffer {
            self.transmission = buffer.clone();
            self.bind(device, layouts);
        }
    }

    fn bind(&mut self, device: &wgpu::Device, layouts: &Layouts) {
        let shadows = [&self.shadow_map.view, &self.shadow_map.placeholder];
        [self.group, self.without_shadow] = shadows.map(|shadow| {
            let environment = &self.environment;
            let views = [&environment.view, shadow, &self.reflectance, &environment.irradiance, &self.transmission];
            light_group(device, layouts, views, [&self.sampler, &self.shadow_map.sampler])
        });
    }

    /// Creates another environment, unless it is the current one.
    pub fn choose(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, layouts: &Layouts, source: Source) {
        if self.environment.source == source {
            return;
        }
        self.environment = Environment::new(device, queue, source);
        self.sky = None;
        self.bind(device, layouts);
    }

    /// Creates the background from the environment, unless it exists.
    pub fn prepare_sky(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, layouts: &Layouts) {
        if self.sky.is_some() {
            return;
        }
        let panorama = self.environment.panorama(device, queue);
        let resources = [
            wgpu::BindingResource::TextureView(&self.environment.view),
            wgpu::BindingResource::Sampler(&self.sampler),
            wgpu::BindingResource::TextureView(&panorama),
        ];
        self.sky = Some(bind_group(device, &layouts.sky, "sky", resources));
    }
}

fn light_group(
    device: &wgpu::Device,
    layouts: &Layouts,
    [environment, shadow, reflectance, irradiance, transmission]: [&wgpu::TextureView; 5],
    [environment_sampler, shadow_sampler]: [&wgpu::Sampler; 2],
) -> wgpu::BindGroup {
    let resources = [
        wgpu::BindingResource::TextureView(environment),
        wgpu::BindingResource::Sampler(environment_sampler),
        wgpu::BindingResource::TextureView(shadow),
        wgpu::BindingResource::Sampler(shadow_sampler),
        wgpu::BindingResource::TextureView(reflectance),
        wgpu::BindingResource::TextureView(irradiance),
        wgpu::BindingResource::TextureView(transmission),
    ];
    bind_group(device, &layouts.light, "light", resources)
}

/// Binds resources in order, starting at binding 0.
fn bind_group<const N: usize>(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    label: &str,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let mut bindings = 0..;
    let entries = resources.map(|resource| wgpu::BindGroupEntry { binding: bindings.next().unwrap_or(0), resource });
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
