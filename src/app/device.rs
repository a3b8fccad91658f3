//! Choosing the graphics adapter and device, and reporting when the device is lost.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use eframe::egui_wgpu;
use gaitway_render::device_descriptor;
#[cfg(target_arch = "wasm32")]
use gaitway_render::next_turn;

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

/// Returns the options of the native window.
#[cfg(not(target_arch = "wasm32"))]
pub fn native_options() -> eframe::NativeOptions {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = Arc::new(device_descriptor);
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Gaitway")
            .with_app_id("gaitway")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([340.0, 420.0])
            .with_drag_and_drop(true),
        wgpu_options: configuration(setup.into()),
        ..Default::default()
    }
}

fn configuration(wgpu_setup: egui_wgpu::WgpuSetup) -> egui_wgpu::WgpuConfiguration {
    egui_wgpu::WgpuConfiguration { wgpu_setup, ..Default::default() }
}

/// A browser's display needs no handle, but wgpu asks for it.
#[cfg(target_arch = "wasm32")]
#[derive(Clone, Debug)]
struct WebDisplay;

#[cfg(target_arch = "wasm32")]
impl wgpu::rwh::HasDisplayHandle for WebDisplay {
    fn display_handle(&self) -> Result<wgpu::rwh::DisplayHandle<'_>, wgpu::rwh::HandleError> {
        Ok(wgpu::rwh::DisplayHandle::web())
    }
}

/// Returns the options for the page's canvas, with a device for it. WebGL2 has no asynchronous calls: eframe would block the page
/// while it requests the context, the adapter and the device, and compiles all that this calls. So we do it, in steps. `back_end` is
/// `webgpu` or `webgl2`.
///
/// # Errors
/// If there is no adapter or device for the canvas.
#[cfg(target_arch = "wasm32")]
pub async fn web_options(canvas: &web_sys::HtmlCanvasElement, back_end: &str) -> Result<eframe::WebOptions, String> {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::from_display_handle(WebDisplay);
    // A quick build has both.
    setup.instance_descriptor.backends =
        if back_end == "webgpu" { wgpu::Backends::BROWSER_WEBGPU } else { wgpu::Backends::GL };
    let power_preference = setup.power_preference;
    let instance = egui_wgpu::WgpuSetup::from(setup).new_instance().await;
    // WebGL2's adapter is that of a canvas. A canvas has one context: eframe will get the same one.
    let surface =
        instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas.clone())).map_err(|error| error.to_string())?;
    next_turn().await;
    let request =
        wgpu::RequestAdapterOptions { power_preference, compatible_surface: Some(&surface), ..Default::default() };
    let adapter = instance.request_adapter(&request).await.map_err(|error| error.to_string())?;
    next_turn().await;
    let (device, queue) =
        adapter.request_device(&device_descriptor(&adapter)).await.map_err(|error| error.to_string())?;
    next_turn().await;
    if adapter.get_info().backend == wgpu::Backend::Gl {
        // The browser compiles the translator of shaders as it is first called; eframe creates the same renderer next.
        drop(egui_wgpu::Renderer::new(&device, wgpu::TextureFormat::Rgba8Unorm, Default::default()));
        next_turn().await;
    }
    let existing = egui_wgpu::WgpuSetupExisting { instance, adapter, device, queue };
    Ok(eframe::WebOptions { wgpu_options: configuration(existing.into()), ..Default::default() })
}
