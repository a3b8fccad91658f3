//! Limits that the graphics device sets for images.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Waker;

use gaitway_ktx2::Formats;

/// Shared by the code that creates the device and the code that opens files, which starts first. Without a device, as on the
/// command line, images keep their size.
#[derive(Debug, Clone, Default)]
pub struct ImageLimits(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    device: Option<Device>,
    /// Tasks that wait for it.
    waiting: Vec<Waker>,
}

#[derive(Debug, Clone, Copy)]
struct Device {
    /// In pixels.
    longest_edge: u32,
    /// Compressed formats that it can sample.
    formats: Formats,
}

/// In pixels, until the device is known. The page decodes the images of its first model before that, for what every common
/// device holds.
const EDGE_WITHOUT_DEVICE: u32 = if cfg!(target_arch = "wasm32") { 8192 } else { u32::MAX };

impl ImageLimits {
    /// Sets what the device holds, for images decoded from now on: the longest edge in pixels, and the compressed formats that it
    /// can sample.
    pub fn set(&self, longest_edge: u32, formats: Formats) {
        let waiting = {
            let mut state = self.state();
            state.device = Some(Device { longest_edge: longest_edge.max(1), formats });
            std::mem::take(&mut state.waiting)
        };
        waiting.into_iter().for_each(Waker::wake);
    }

    /// Returns the longest edge that the device holds, in pixels.
    pub(super) fn longest_edge(&self) -> u32 {
        self.state().device.map_or(EDGE_WITHOUT_DEVICE, |device| device.longest_edge)
    }

    /// Returns the compressed formats that the device can sample: none if there is no device.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn formats(&self) -> Formats {
        self.state().device.map(|device| device.formats).unwrap_or_default()
    }

    /// Returns the compressed formats that the device can sample. The page creates the device while the first files arrive.
    #[cfg(target_arch = "wasm32")]
    pub(super) async fn formats(&self) -> Formats {
        use std::task::Poll;

        std::future::poll_fn(|context| {
            let mut state = self.state();
            match state.device {
                Some(device) => Poll::Ready(device.formats),
                None => {
                    state.waiting.push(context.waker().clone());
                    Poll::Pending
                }
            }
        })
        .await
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
