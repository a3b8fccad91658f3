//! Opening a GLB before its images have arrived. Most exporters write images last, and they are often the larger part of a file.
//! The JSON says where each buffer view lies, so the bytes before the first image are a smaller GLB, with everything but images.

use super::container::{self, Beginning};
use super::document::{Document, size};
use super::{draco, meshopt};

/// Fewer bytes than this arrive soon enough.
const MIN_SAVED_BYTES: usize = 128 << 10;

/// What can be done with the beginning of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Early {
    /// So many bytes must be there to know more.
    Wait(usize),
    /// A GLB without the images, to be loaded with
    /// [`LoadOptions::awaits_images`](crate::LoadOptions::awaits_images).
    Ready(Vec<u8>),
}

/// Returns what can be done with a file that begins with `start`; `None` if it has to be complete.
pub fn early(start: &[u8]) -> Option<Early> {
    let Beginning { container, binary_at, length } = match container::begin(start)? {
        Ok(beginning) => beginning,
        Err(needed) => return Some(Early::Wait(needed)),
    };
    let end = binary_at.checked_add(first_image(&Document::read("", &container).ok()?)?)?;
    if length.checked_sub(end)? < MIN_SAVED_BYTES {
        return None;
    }
    let Some(before) = start.get(..end) else { return Some(Early::Wait(end)) };
    Some(Early::Ready(container::shortened(before, binary_at)))
}

/// Returns where the images begin in the binary chunk, if nothing else follows.
fn first_image(document: &Document) -> Option<usize> {
    let root = &document.root;
    // Decoders need more than the buffer views.
    let is_compressed = |name: &String| name == draco::NAME || meshopt::NAMES.contains(&name.as_str());
    if root.extensions_used.iter().any(is_compressed) {
        return None;
    }
    let mut is_image = vec![false; root.buffer_views.len()];
    for view in root.images.iter().filter_map(|image| image.buffer_view) {
        *is_image.get_mut(view.value())? = true;
    }
    for accessor in &root.accessors {
        let sparse = accessor.sparse.as_ref();
        let views = [
            accessor.buffer_view,
            sparse.map(|sparse| sparse.indices.buffer_view),
            sparse.map(|sparse| sparse.values.buffer_view),
        ];
        if views.into_iter().flatten().any(|view| is_image.get(view.value()) == Some(&true)) {
            return None;
        }
    }
    let (mut first, mut last) = (usize::MAX, 0);
    // Other buffers are files of their own.
    for (view, is_image) in root.buffer_views.iter().zip(is_image).filter(|(view, _)| view.buffer.value() == 0) {
        let start = view.byte_offset.map_or(0, size);
        if is_image {
            first = first.min(start);
        } else {
            last = last.max(start.saturating_add(size(view.byte_length)));
        }
    }
    (last <= first).then_some(first)
}
