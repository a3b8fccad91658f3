//! Sampling and skinning stop allocating once the buffers have grown.

use gaitway_character::anim::{ClipBuilder, Interpolation, Keys, SampleCursor, model_from_joint};
use gaitway_character::mesh::{DeformedVertices, Skin, SkinningMode, deform, write_palette};
use glam::{Affine3A, Quat, Vec3};

use crate::allocations::allocations_after;
use crate::build::chain;
use crate::skinning_cases::scattered;

#[test]
fn sampling_and_skinning_do_not_allocate() {
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
        model_from_joint(&skeleton, &pose, Affine3A::IDENTITY, &mut world);
        palette.clear();
        write_palette(&skin, &world, mode, &mut palette);
        deform(&geometry, &[], &palette, mode, &mut vertices);
    };
    let play = |frame: &mut dyn FnMut(f32, SkinningMode)| {
        for step in 0..200 {
            let modes = [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion];
            frame(step as f32 * 0.007, modes[step % 3]);
        }
    };
    let count = allocations_after(&mut frame, |frame| frame(0.0, SkinningMode::Linear), |frame| play(frame));
    assert_eq!(count, 0);
}
