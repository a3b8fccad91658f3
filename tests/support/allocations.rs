//! Counts heap allocations, to test that playback does not allocate.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    /// Per thread, because tests run in parallel.
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // Fails only while the thread is shutting down.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call is forwarded unchanged to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Runs `warm_up`, then `work`, on the same state and returns the number of allocations made by `work`.
pub fn allocations_after<T>(state: &mut T, warm_up: impl FnOnce(&mut T), work: impl FnOnce(&mut T)) -> usize {
    warm_up(state);
    let before = COUNT.get();
    assert!(before > 0, "the warm-up fills buffers, so the counter must have counted");
    work(state);
    COUNT.get() - before
}
