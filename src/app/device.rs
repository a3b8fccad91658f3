//! Choosing the graphics adapter and device, and reporting when the device is lost.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use eframe::egui_wgpu;

use crate::render::COMPRESSED_FORMATS;

/// Called with the message of a fatal graphics error; see [`set_fatal_hook`].
pub type FatalHook = fn(&str);

static FATAL_HOOK: Mutex<Option<FatalHook>> = Mutex::new(None);

/// Sets the hook that is called when the device is lost or a drawing call fails. Nothing can be drawn after that.
pub fn set_fatal_hook(hook: FatalHook) {
    if let Ok(mut slot) = FATAL_HOOK.lock() {
        *slot = Some(hook);
    }
}

fn fatal(message: &str) {
    let hook = FATAL_HOOK.lock().ok().and_then(|hook| *hook);
    match hook {
        Some(hook) => hook(message),
        None => eprintln!("error: {message}"),
    }
}

/// Reports a lost device and uncaptured errors, until `closing` is set: closing the app drops its device.
pub(super) fn watch(device: &wgpu::Device, closing: &Arc<AtomicBool>) {
    let closed = closing.clone();
    device.set_device_lost_callback(move |_, message| {
        if !closed.load(Ordering::Relaxed) {
            fatal(&format!("the graphics device was lost: {message}"));
        }
    });
    let closed = closing.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        if !closed.load(Ordering::Relaxed) {
            fatal(&format!("the graphics device reported an error: {error}"));
        }
    }));
}

/// Returns `webgpu` or `webgl2` in the page; `vulkan`, `metal`, `dx12` or `gl` natively.
pub(super) fn backend_name(info: &wgpu::AdapterInfo) -> &'static str {
    match info.backend {
        wgpu::Backend::BrowserWebGpu => "webgpu",
        wgpu::Backend::Gl if cfg!(target_arch = "wasm32") => "webgl2",
        wgpu::Backend::Gl => "gl",
        wgpu::Backend::Vulkan => "vulkan",
        wgpu::Backend::Metal => "metal",
        wgpu::Backend::Dx12 => "dx12",
        wgpu::Backend::Noop => "noop",
    }
}

/// Requests WebGL2's limits on every device, so that what works on one works on all; only texture sizes use the adapter's.
fn configuration(backends: Option<wgpu::Backends>) -> egui_wgpu::WgpuConfiguration {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    if let Some(backends) = backends {
        setup.instance_descriptor.backends = backends;
    }
    setup.device_descriptor = Arc::new(|adapter| wgpu::DeviceDescriptor {
        label: Some("gaitway"),
        required_features: adapter.features() & COMPRESSED_FORMATS,
        required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
        ..Default::default()
    });
    egui_wgpu::WgpuConfiguration { wgpu_setup: setup.into(), ..Default::default() }
}

/// Returns the options of the native window.
#[cfg(not(target_arch = "wasm32"))]
pub fn native_options() -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Gaitway")
            .with_app_id("gaitway")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([340.0, 420.0])
            .with_drag_and_drop(true),
        wgpu_options: configuration(None),
        ..Default::default()
    }
}

/// Returns the options for the page's canvas. They name both back ends; the program has one of them.
#[cfg(target_arch = "wasm32")]
pub fn web_options() -> eframe::WebOptions {
    let backends = wgpu::Backends::BROWSER_WEBGPU | wgpu::Backends::GL;
    eframe::WebOptions { wgpu_options: configuration(Some(backends)), ..Default::default() }
}
