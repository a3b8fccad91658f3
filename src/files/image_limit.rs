//! How large an image may be on the device that will draw it: larger ones are made smaller where they are decoded.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::asset::Warning;

/// Edge in pixels, until the device is known: a page's first model is decoded before, and every common device can hold this
/// much. The command line keeps images as they are.
static LARGEST: AtomicU32 = AtomicU32::new(if cfg!(target_arch = "wasm32") { 8192 } else { u32::MAX });

/// Images decoded from now on have no edge longer than this, which is what the device can hold.
pub fn set_largest_image(pixels: u32) {
    LARGEST.store(pixels.max(1), Ordering::Relaxed);
}

/// The size that fits; none: it fits as it is.
pub(super) fn fitted(width: u32, height: u32) -> Option<[u32; 2]> {
    let largest = LARGEST.load(Ordering::Relaxed);
    let edge = width.max(height);
    let scaled = |length: u32| (u64::from(length) * u64::from(largest) / u64::from(edge.max(1))).max(1) as u32;
    (edge > largest).then(|| [scaled(width), scaled(height)])
}

pub(super) fn made_smaller(image: &str, from: [u32; 2], to: [u32; 2]) -> Warning {
    let problem = format!(
        "{} × {} pixels are more than this device can hold; it is shown with {} × {}",
        from[0], from[1], to[0], to[1]
    );
    Warning::Other { code: "image-made-smaller", place: image.to_owned(), problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_keeps_its_shape() {
        set_largest_image(1000);
        assert_eq!(fitted(1000, 1000), None);
        assert_eq!(fitted(4000, 2000), Some([1000, 500]));
        assert_eq!(fitted(1, 5000), Some([1, 1000]));
        set_largest_image(u32::MAX);
        assert_eq!(fitted(u32::MAX, 1), None);
    }
}
