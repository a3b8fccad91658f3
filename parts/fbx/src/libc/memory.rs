//! Memory and strings.

use std::alloc::Layout;
use std::ffi::{c_char, c_int, c_void};

// SAFETY, here and below: the names are those that ufbx reserves for these functions, and it calls them as C does.
#[unsafe(no_mangle)]
extern "C" fn ufbx_malloc(size: usize) -> *mut c_void {
    let Some(layout) = layout(size) else { return std::ptr::null_mut() };
    // SAFETY: the size isn't 0.
    unsafe { std::alloc::alloc(layout) }.cast()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_realloc(place: *mut c_void, old_size: usize, size: usize) -> *mut c_void {
    let (Some(old), Some(new)) = (layout(old_size), layout(size)) else { return std::ptr::null_mut() };
    if place.is_null() {
        return ufbx_malloc(size);
    }
    // SAFETY: ufbx passes what `ufbx_malloc` returned, with the size it asked for; the new size isn't 0.
    unsafe { std::alloc::realloc(place.cast(), old, new.size()) }.cast()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_free(place: *mut c_void, size: usize) {
    let Some(layout) = layout(size) else { return };
    if !place.is_null() {
        // SAFETY: ufbx passes what `ufbx_malloc` returned, with the size it asked for.
        unsafe { std::alloc::dealloc(place.cast(), layout) }
    }
}

/// Returns the layout of a block; none if it is too large.
fn layout(size: usize) -> Option<Layout> {
    Layout::from_size_align(size.max(1), 8).ok()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memcpy(to: *mut c_void, from: *const c_void, count: usize) -> *mut c_void {
    // SAFETY: the caller passes ranges of `count` bytes that don't overlap.
    unsafe { from.cast::<u8>().copy_to_nonoverlapping(to.cast(), count) };
    to
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memmove(to: *mut c_void, from: *const c_void, count: usize) -> *mut c_void {
    // SAFETY: the caller passes ranges of `count` bytes.
    unsafe { from.cast::<u8>().copy_to(to.cast(), count) };
    to
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memset(to: *mut c_void, byte: c_int, count: usize) -> *mut c_void {
    // SAFETY: the caller passes a range of `count` bytes.
    unsafe { to.cast::<u8>().write_bytes(byte as u8, count) };
    to
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memchr(from: *const c_void, byte: c_int, count: usize) -> *const c_void {
    for offset in 0..count {
        // SAFETY: the caller passes a range of `count` bytes.
        let place = unsafe { from.cast::<u8>().add(offset) };
        // SAFETY: as above.
        if unsafe { *place } == byte as u8 {
            return place.cast();
        }
    }
    std::ptr::null()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memcmp(a: *const c_void, b: *const c_void, count: usize) -> c_int {
    // SAFETY: the caller passes ranges of `count` bytes.
    unsafe { compare(a.cast(), b.cast(), count, false) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_strlen(text: *const c_char) -> usize {
    let mut length = 0;
    // SAFETY: the caller passes a string that ends with 0.
    while unsafe { *text.add(length) } != 0 {
        length += 1;
    }
    length
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_strcmp(a: *const c_char, b: *const c_char) -> c_int {
    // SAFETY: the caller passes strings that end with 0.
    unsafe { compare(a.cast(), b.cast(), usize::MAX, true) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_strncmp(a: *const c_char, b: *const c_char, count: usize) -> c_int {
    // SAFETY: the caller passes strings that end with 0 or have `count` bytes.
    unsafe { compare(a.cast(), b.cast(), count, true) }
}

/// Compares up to `count` bytes, or up to the end of a string.
///
/// # Safety
///
/// Both ranges have `count` bytes, or with `text` end with 0 before.
unsafe fn compare(a: *const u8, b: *const u8, count: usize, text: bool) -> c_int {
    for offset in 0..count {
        // SAFETY: the caller's promise.
        let (a, b) = unsafe { (*a.add(offset), *b.add(offset)) };
        if a != b {
            return c_int::from(a) - c_int::from(b);
        }
        if text && a == 0 {
            return 0;
        }
    }
    0
}
