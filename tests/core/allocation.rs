//! Nothing is allocated per sample once the buffers have grown.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use gaitway::anim::{ClipBuilder, Interpolation, Keys, SampleCursor, model_from_joint};
use gaitway::mesh::{DeformedVertices, Skin, SkinningMode, deform, write_palette};
use glam::{Affine3A, Quat, Vec3};

use crate::build::chain;
use crate::skinning_cases::scattered;

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
fn a_character_frame_allocates_nothing() {
    let skeleton = chain(20);
    let mut builder = ClipBuilder::new("", &skeleton);
    let times: Vec<f32> = (0..30).map(|key| key as f32 / 30.0).collect();
    for joint in skeleton.joints() {
        let rotations = times.iter().map(|&time| Quat::from_rotation_x(time)).collect();
        builder.channel(joint, Interpolation::Linear, &times, Keys::Rotation(rotations)).unwrap();
        let moves = times.iter().flat_map(|&time| [Vec3::X, Vec3::Y * time, Vec3::X]).collect();
        builder.channel(joint, Interpolation::CubicSpline, &times, Keys::Translation(moves)).unwrap();
    }
    let clip = builder.build();
    let bind = vec![Affine3A::IDENTITY; skeleton.len()];
    let skin = Skin::new(String::new(), skeleton.joints().collect(), bind, skeleton.len()).unwrap();
    let geometry = scattered(13, 20);
    let mut cursor = SampleCursor::default();
    let mut pose = skeleton.rest().clone();
    let (mut world, mut palette, mut vertices) = (Vec::new(), Vec::new(), DeformedVertices::default());
    let mut frame = |time_secs: f32, mode: SkinningMode| {
        pose.copy_from(skeleton.rest());
        clip.sample(&skeleton, time_secs, &mut cursor, &mut pose);
        model_from_joint(&skeleton, &pose.locals, Affine3A::IDENTITY, &mut world);
        palette.clear();
        write_palette(&skin, &world, mode, &mut palette);
        deform(&geometry, &[], &palette, mode, &mut vertices);
    };
    frame(0.0, SkinningMode::Linear);
    let before = COUNT.get();
    assert!(before > 0, "the counter counts");
    for step in 0..200 {
        let modes = [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion];
        frame(step as f32 * 0.007, modes[step % 3]);
    }
    assert_eq!(COUNT.get() - before, 0);
}
