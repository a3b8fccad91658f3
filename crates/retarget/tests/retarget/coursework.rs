//! Scenes of the COSC422 coursework with its own numbers, and real files retargeted to themselves.

use gaitway_character::anim::{Clip, JointIndex, Pose, Property, SampleCursor, Skeleton, model_from_joint};
use gaitway_character::asset::Asset;
use gaitway_retarget::{
    Body, Feet, JointMap, JointMapFile, MutedChannel, MutedProperty, ResolvedMap, Retargeted, Retargeting, RootPart,
    baking, layer_clips, propose, recognize,
};
use glam::{Affine3A, Quat, Vec3};

use crate::data_folder::data_folder;
use crate::real::read;

fn retarget(model: &Asset, motion: &Asset, clip: usize, map: &ResolvedMap) -> Retargeted {
    let slots = [recognize(model).humanoid(), recognize(motion).humanoid()];
    let pair =
        Retargeting::new(Body { asset: model, slots: &slots[0] }, Body { asset: motion, slots: &slots[1] }, clip, map);
    pair.unwrap().bake().unwrap()
}

fn locals(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Pose {
    let mut pose = skeleton.rest().clone();
    clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    pose
}

fn world(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Vec<Affine3A> {
    let mut world = Vec::new();
    model_from_joint(skeleton, &locals(skeleton, clip, time_secs), Affine3A::IDENTITY, &mut world);
    world
}

fn joint(asset: &Asset, name: &str) -> JointIndex {
    asset.skeleton.find(name).unwrap_or_else(|| panic!("no joint {name}"))
}

const DWARF_MAP: &str = r#"{ "gaitway_map": 1,
  "joints": {
    "head": { "source": 5 }, "spine1": { "source": 4 }, "spine2": { "source": 2 },
    "lhip": { "source": 15 }, "rhip": { "source": 18 }, "lknee": { "source": 16 }, "rknee": { "source": 19 },
    "lankle": { "source": 17 }, "rankle": { "source": 20 },
    "middle": { "source": null, "unmapped": { "clip": 0, "hold": "first-key" } } },
  "unmapped": { "clip": 0 } }"#;

#[test]
fn the_dwarf_walks_like_the_avatar_while_its_arms_play_its_own_clip() {
    let Some(folder) = data_folder() else { return };
    let (dwarf, avatar) = (read(&folder, "cosc422/dwarf.glb"), read(&folder, "cosc422/original/Dwarf/avatar_walk.bvh"));
    let map = JointMapFile::from_json(DWARF_MAP).unwrap().resolve(&dwarf, &avatar).unwrap();
    let done = retarget(&dwarf, &avatar, 0, &map);
    let (skeleton, walk) = (&dwarf.skeleton, &avatar.clips[0]);
    // Both face +Z and neither rest has rotations, so the coursework's own rule holds: a joint turns in the world as
    // its channel does. The legs' rests differ slightly in direction.
    for frame in 0..=13 {
        let time = frame as f32 * walk.duration_secs() / 13.0;
        let rotation = |world: Affine3A| -> Quat { world.to_scale_rotation_translation().1 };
        let (avatar_world, dwarf_world) = (world(&avatar.skeleton, walk, time), world(skeleton, &done.clip, time));
        for (name, channel) in [("head", 5), ("spine1", 4), ("spine2", 2)] {
            let source = avatar.skeleton.joint_of_source(channel).unwrap();
            let turned = rotation(dwarf_world[joint(&dwarf, name).get()]);
            let wanted = rotation(avatar_world[source.get()]);
            assert!(turned.angle_between(wanted).to_degrees() < 0.2, "{name} at {time}");
        }
        for (upper, lower, channels) in [("lknee", "lankle", [16, 17]), ("rhip", "rknee", [18, 19])] {
            let along = |world: &[Affine3A], from: JointIndex, to: JointIndex| {
                Vec3::from(world[to.get()].translation - world[from.get()].translation).normalize()
            };
            let [from, to] = channels.map(|channel| avatar.skeleton.joint_of_source(channel).unwrap());
            let wanted = along(&avatar_world, from, to);
            let found = along(&dwarf_world, joint(&dwarf, upper), joint(&dwarf, lower));
            assert!(found.angle_between(wanted).to_degrees() < 0.2, "{upper} at {time}");
        }
    }
    // 13 ticks of walk over 55 ticks of idle: each loops with its own duration.
    let layers = layer_clips(&dwarf, &map);
    assert_eq!(layers.len(), 2, "one plays, one is frozen");
    let own = &dwarf.clips[0];
    let moving = layers.iter().find(|layer| !layer.frozen).unwrap();
    assert!((moving.duration_secs - 2.2).abs() < 1e-3 && (walk.duration_secs() - 0.8667).abs() < 1e-3);
    let arm = joint(&dwarf, "lelbo");
    let mut pose = skeleton.rest().clone();
    moving.sample(skeleton, 2.2 + 0.5, &mut SampleCursor::default(), &mut pose);
    let wanted = locals(skeleton, own, 0.5).local(arm).rotation;
    assert!(pose.local(arm).rotation.angle_between(wanted) < 1e-3);
    let frozen = layers.iter().find(|layer| layer.frozen).unwrap();
    frozen.sample(skeleton, 1.1, &mut SampleCursor::default(), &mut pose);
    let middle = joint(&dwarf, "middle");
    assert_eq!(pose.local(middle), locals(skeleton, own, 0.0).local(middle));
    assert_eq!(baking(&done.clip, &layers, &[], None).loops, 5, "5 × 0.867 s is within a tenth of 2 × 2.2 s");
}

#[test]
fn the_mannequin_runs_away_or_in_place() {
    let Some(folder) = data_folder() else { return };
    let (model, motion) = (read(&folder, "cosc422/mannequin.glb"), read(&folder, "cosc422/mannequin_run.glb"));
    let proposed = propose(&model, &motion).to_map(&model, &motion);
    let travel = |map: &JointMap| {
        let done = retarget(&model, &motion, 0, &map.resolve(&model, &motion).unwrap());
        let hips = joint(&model, "hips").get();
        let at = |time| Vec3::from(world(&model.skeleton, &done.clip, time)[hips].translation);
        let gone = at(done.clip.duration_secs()) - at(0.0);
        Vec3::new(gone.x, 0.0, gone.z).length()
    };
    let away = travel(&proposed);
    assert!(away > 1.0, "{away}");
    let mut in_place = proposed.clone();
    in_place.root.horizontal = RootPart::InPlace;
    assert!(travel(&in_place) < 1e-3 * away, "{}", travel(&in_place));
    let mut muted = proposed.clone();
    let source = motion.skeleton.source_index(joint(&motion, "free3dmodel_skeleton"));
    muted.muted_channels = vec![MutedChannel { source, property: Some(MutedProperty::Translation) }];
    assert!(travel(&muted) < 0.1 * away, "{}", travel(&muted));
}

#[test]
fn the_mannequins_original_files_run_like_the_converted_ones() {
    let Some(folder) = data_folder() else { return };
    let running = |model: &str, motion: &str| {
        let [model, motion] = [model, motion].map(|name| read(&folder, name));
        let map = propose(&model, &motion).to_map(&model, &motion).resolve(&model, &motion).unwrap();
        let done = retarget(&model, &motion, 0, &map);
        (model, done.clip)
    };
    let originals = ["mannequin.fbx", "run.fbx"].map(|name| format!("cosc422/original/Mannequin/{name}"));
    let (own, clip) = running(&originals[0], &originals[1]);
    let (converted, expected) = running("cosc422/mannequin.glb", "cosc422/mannequin_run.glb");
    assert!((clip.duration_secs() - expected.duration_secs()).abs() < 1e-4);
    let size = size(&converted);
    // The converter baked the curves at 30 frames per second, so anything between those frames is lost.
    for frame in 0..=22 {
        let time = (frame as f32 / 30.0).min(expected.duration_secs());
        let [found, wanted] =
            [(&own, &clip), (&converted, &expected)].map(|(asset, clip)| world(&asset.skeleton, clip, time));
        // One of the converter's nodes is not in the file.
        for at in converted.skeleton.joints().filter(|&at| converted.skeleton.name(at) != "RootNode") {
            let name = converted.skeleton.name(at);
            let off = found[joint(&own, name).get()].translation.distance(wanted[at.get()].translation) / size;
            assert!(off < 1e-4, "{name} at frame {frame}: {off} of the height");
        }
    }
}

#[test]
fn real_files_retargeted_to_themselves_keep_their_clips() {
    let Some(folder) = data_folder() else { return };
    for name in [
        "threejs/Xbot.glb",
        "threejs/Soldier.glb",
        "threejs/RobotExpressive.glb",
        "kaykit/Knight.glb",
        "misc/godot_mannequiny.glb",
        "cosc422/ArmyPilot.glb",
        "cosc422/dwarf.glb",
        "cosc422/original/ArmyPilot/ArmyPilot.x",
        "cosc422/original/Dwarf/dwarf.x",
        "khronos/CesiumMan/glTF-Binary/CesiumMan.glb",
        "mesh2motion/fox-animations.glb",
        "mesh2motion/spider-animations.glb",
        "misc/TRex.glb",
    ] {
        let asset = read(&folder, name);
        let map = propose(&asset, &asset).to_map(&asset, &asset).resolve(&asset, &asset).unwrap();
        let size = size(&asset);
        for (index, clip) in asset.clips.iter().enumerate() {
            let done = retarget(&asset, &asset, index, &map);
            assert_eq!(done.resampled, [], "{name}, {}", clip.name());
            for part in 0..=10 {
                let time = clip.duration_secs() * part as f32 / 10.0;
                let (wanted, found) = (world(&asset.skeleton, clip, time), world(&asset.skeleton, &done.clip, time));
                for pair in &map.pairs {
                    let at = pair.target.get();
                    let off = Vec3::from(wanted[at].translation - found[at].translation).length() / size;
                    let joint = asset.skeleton.name(pair.target);
                    assert!(off < 1e-6, "{name}, {}, {joint} at {time}: {off} of the height", clip.name());
                }
            }
        }
    }
}

fn size(asset: &Asset) -> f32 {
    let mut rest = Vec::new();
    model_from_joint(&asset.skeleton, asset.skeleton.rest(), Affine3A::IDENTITY, &mut rest);
    let heights = rest.iter().map(|world| world.translation);
    let (low, high) =
        heights.fold((glam::Vec3A::INFINITY, glam::Vec3A::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    (high - low).max_element()
}

/// The root of these persons is in the chest: the chest carries the hips along their path.
#[test]
fn hips_below_the_root_go_where_the_source_takes_them() {
    let Some(folder) = data_folder() else { return };
    let (model, motion) = (read(&folder, "mit6837/Model1.obj"), read(&folder, "bvh/cmu_01_01.bvh"));
    let slots = [recognize(&model).humanoid(), recognize(&motion).humanoid()];
    let proposed = propose(&model, &motion).to_map(&model, &motion).resolve(&model, &motion).unwrap();
    for feet in [Feet::Off, Feet::Plant] {
        let map = ResolvedMap { feet, ..proposed.clone() };
        let bodies = [Body { asset: &model, slots: &slots[0] }, Body { asset: &motion, slots: &slots[1] }];
        let pair = Retargeting::new(bodies[0], bodies[1], 0, &map).unwrap();
        let done = pair.bake().unwrap();
        let moved = done.clip.channels().iter().filter(|channel| channel.keys.property() == Property::Translation);
        let moved: Vec<usize> = moved.map(|channel| model.skeleton.source_index(channel.joint)).collect();
        assert_eq!(moved, [0], "the body comes apart");
        let figures = pair.figures(&done);
        assert!(figures.limb_direction_error_degrees_mean.unwrap() < 2.0, "{figures:?}");
        let [ours, theirs] = [figures.foot_slide_metres_per_sec, figures.foot_slide_source_metres_per_sec];
        assert!(ours.unwrap() < 1.5 * theirs.unwrap(), "{figures:?}");
        // Unplanted, it hovers like the capture.
        let hover = figures.foot_hover_metres_mean.unwrap().abs() / done.hips_scale.unwrap();
        assert!((feet == Feet::Off) == (hover > 0.01), "{figures:?}");
    }
}
