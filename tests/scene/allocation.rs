//! Playing allocates nothing once a frame has grown.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use gaitway::frame::{Frame, evaluate};
use gaitway::state::{CameraOptions, Command, Selection, ViewerState, apply};

use crate::data::walker;

struct Counting;

thread_local! {
    /// Allocations of this thread alone: other tests run beside this one.
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // The thread may be ending, when its counter is gone already.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: everything is handed to the system's allocator as it comes.
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

#[test]
fn a_second_round_of_the_clip_allocates_nothing() {
    let library = walker();
    let mut state = ViewerState {
        camera_options: CameraOptions { follow: true, ..CameraOptions::default() },
        selection: Selection { joint: Some(5), ..Selection::default() },
        ..ViewerState::default()
    };
    state.display.show.skeleton = true;
    state.display.show.bounds = true;
    state.inspect.weights = true;
    state.inspect.split = true;
    state.edits.pose.insert(15, [20.0, 0.0, 0.0]);
    let mut frame = Frame::default();
    let mut play = |frames: usize| {
        for _ in 0..frames {
            apply(&mut state, &library, Command::Advance(1.0 / 60.0));
            evaluate(&library, &state, 1.5, &mut frame);
        }
    };
    play(70);
    let before = COUNT.with(Cell::get);
    assert!(before > 0, "the counter counts");
    play(200);
    assert_eq!(COUNT.with(Cell::get) - before, 0);
}
