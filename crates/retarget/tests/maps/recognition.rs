//! How many body parts of real skeletons are recognized, and what must not affect recognition.

use std::collections::BTreeMap;

use gaitway_character::anim::{ClipBuilder, Joint, JointIndex, Skeleton};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance, Slot};
use gaitway_character::mesh::Skin;
use gaitway_retarget::{ProposedPair, Reason, Recognized, propose, recognize};

use crate::data::open;
use crate::truth::{RIGS, each_file, is_called, without_humanoid};

/// Skeletons that aren't human bodies, and an arm that isn't enough of one.
const NOT_BODIES: [&str; 9] = [
    "khronos/Fox/glTF-Binary/Fox.glb",
    "khronos/Monster/glTF-Binary/Monster.glb",
    "khronos/RiggedSimple/glTF-Binary/RiggedSimple.glb",
    "mesh2motion/fox-animations.glb",
    "mesh2motion/bird-animations.glb",
    "mesh2motion/snake-animations.glb",
    "mesh2motion/spider-animations.glb",
    "misc/TRex.glb",
    "bvh/cosc422_Test.bvh",
];

/// Counts the correct parts and all that exist or were found, and describes the wrong ones.
fn score(asset: &Asset, found: &Recognized, truth: &BTreeMap<Slot, String>) -> (usize, usize, Vec<String>) {
    let (mut right, mut all, mut wrong) = (0, 0, Vec::new());
    for &slot in Slot::ALL {
        let (joint, name) = (found.joint(slot), truth.get(&slot));
        if joint.is_none() && name.is_none() {
            continue;
        }
        all += 1;
        if joint.zip(name).is_some_and(|(joint, name)| is_called(asset, joint, name)) {
            right += 1;
        } else {
            let joint = joint.map(|joint| asset.skeleton.name(joint));
            wrong.push(format!("{}: {joint:?}, not {name:?}", slot.name()));
        }
    }
    (right, all, wrong)
}

#[test]
fn parts_of_real_files_are_recognized() {
    let (mut right, mut all) = (0, 0);
    each_file(|path, asset, truth| {
        let found = recognize(asset);
        let (file_right, file_all, wrong) = score(asset, &found, truth);
        println!("{file_right:3} of {file_all:3}  {path}  {}", wrong.join("; "));
        for (slot, part) in &found.parts {
            let other = truth.get(&slot.mirrored()).filter(|_| slot.mirrored() != *slot);
            assert!(
                other.is_none_or(|other| !is_called(asset, part.joint, other)),
                "{path}: {slot:?} is on the wrong side"
            );
        }
        right += file_right;
        all += file_all;
    });
    println!("{right} of {all}");
    assert!(right as f64 >= 0.97 * all as f64, "{right} of {all}");
}

#[test]
fn skeletons_that_are_not_bodies_have_no_parts() {
    for path in NOT_BODIES {
        let Some(asset) = open(path) else { return };
        assert_eq!(recognize(&asset), Recognized::default(), "{path}");
    }
}

/// One of the files has a joint for `leftThumbMetacarpal`, but its map lacks it.
#[test]
fn a_files_own_map_is_used_as_it_is() {
    for path in ["vrm/vrm0_cryptovoxels.vrm", "vrm/chatvrm_idle_loop.vrma"] {
        let Some(asset) = open(path) else { return };
        let found = recognize(&asset);
        let own = asset.humanoid.as_ref().expect(path);
        assert!(own.0.len() >= 15, "{path}");
        for (&slot, &joint) in &own.0 {
            let part = found.parts[&slot];
            assert_eq!((part.joint, part.reason, part.confidence), (joint, Reason::File, 1.0), "{path} {slot:?}");
        }
        let more: Vec<Slot> = found.parts.keys().copied().filter(|slot| own.joint(*slot).is_none()).collect();
        assert_eq!(more.contains(&Slot::LeftThumbMetacarpal), path.contains("cryptovoxels"), "{path}");
    }
}

/// The same skeleton, skins and first clip with the nodes listed in reverse, which reverses siblings.
fn with_nodes_reversed(asset: &Asset) -> Asset {
    let old = &asset.skeleton;
    let count = old.len();
    let joints = (0..count).rev().map(|source| {
        let joint = old.joint_of_source(source).expect("every node is a joint");
        let parent = old.parent(joint).map(|parent| count - 1 - old.source_index(parent));
        let morph_weights = old.rest().morph_weights[old.morph_range(joint)].to_vec();
        Joint { name: old.name(joint).to_owned(), parent, rest: old.rest().local(joint), morph_weights }
    });
    let skeleton = Skeleton::new(joints.collect()).expect("still a tree");
    let moved = |joint: &JointIndex| {
        skeleton.joint_of_source(count - 1 - old.source_index(*joint)).expect("every node is a joint")
    };
    let skins = asset.skins.iter().map(|skin| {
        let joints = skin.joints().iter().map(moved).collect();
        Skin::new(skin.name().to_owned(), joints, skin.joint_from_bind().to_vec(), count).expect("still a skin")
    });
    let clips = asset.clips.first().map(|clip| {
        let mut moved_clip = ClipBuilder::new(clip.name(), &skeleton);
        for channel in clip.channels() {
            let times_secs = &clip.timelines()[channel.timeline as usize];
            let keys = channel.keys.clone();
            moved_clip
                .channel(moved(&channel.joint), channel.interpolation, times_secs, keys)
                .expect("still a channel");
        }
        moved_clip.build()
    });
    let instances = asset.instances.iter().map(|instance| MeshInstance { joint: moved(&instance.joint), ..*instance });
    let (skins, clips, instances) = (skins.collect(), clips.into_iter().collect(), instances.collect());
    let parts = AssetParts {
        skeleton,
        skins,
        clips,
        instances,
        meshes: asset.meshes.clone(),
        materials: asset.materials.clone(),
        textures: asset.textures.clone(),
        images: asset.images.clone(),
        ..AssetParts::default()
    };
    Asset::new(parts).expect("still valid")
}

#[test]
fn the_order_of_nodes_does_not_affect_recognition() {
    each_file(|path, asset, _| {
        let reversed = with_nodes_reversed(asset);
        let last = asset.skeleton.len() - 1;
        let found: Vec<_> = recognize(asset)
            .parts
            .into_iter()
            .map(|(slot, part)| (slot, asset.skeleton.source_index(part.joint), part.reason, part.confidence))
            .collect();
        let found_reversed: Vec<_> = recognize(&reversed)
            .parts
            .into_iter()
            .map(|(slot, part)| (slot, last - reversed.skeleton.source_index(part.joint), part.reason, part.confidence))
            .collect();
        assert_eq!(found, found_reversed, "{path}");
    });
}

/// The same skeleton in another file of a series, whose character wears and holds other things.
#[test]
fn accessories_do_not_affect_recognition() {
    let Some(knight) = open("kaykit/Knight.glb") else { return };
    let skinned: Vec<JointIndex> = knight.skins.iter().flat_map(|skin| skin.joints().iter().copied()).collect();
    let carriers: Vec<JointIndex> = knight.instances.iter().map(|instance| instance.joint).collect();
    let worn = carriers.into_iter().filter(|joint| !skinned.contains(joint));
    let things = ["Barbarian_BearTail", "Barbarian_Wings", "head", "Barbarian_ArmLeft", "LeftHand", "hips"];
    let numbers: Vec<usize> = worn.map(|joint| knight.skeleton.source_index(joint)).collect();
    assert!(numbers.len() > things.len());
    let skeleton = knight.skeleton.with_names(numbers.into_iter().zip(things.into_iter().cycle()));
    let motion = open("cosc422/original/Dwarf/avatar_walk.bvh").expect("in the same folder");
    let answer = |model: &Asset| (recognize(model), propose(model, &motion), propose(&motion, model));
    let found = answer(&knight);
    let other = Asset::new(AssetParts { skeleton, ..knight.into_parts() }).expect("still valid");
    assert_eq!(answer(&other), found);
}

/// Every rig with every other one: no left joint follows a right one, and most parts are mapped.
#[test]
fn no_proposal_crosses_sides() {
    let mut files: Vec<(String, Asset, BTreeMap<JointIndex, Slot>)> = Vec::new();
    for rig in RIGS {
        let Some(asset) = rig.files.first().and_then(|path| open(path)).map(without_humanoid) else { return };
        let slots = rig.truth().into_iter().map(|(slot, name)| {
            let joint = asset.skeleton.joints().find(|&joint| is_called(&asset, joint, &name));
            (joint.unwrap_or_else(|| panic!("{name}")), slot)
        });
        let slots = slots.collect();
        files.push((rig.files[0].to_owned(), asset, slots));
    }
    for (model_path, model, target_slots) in &files {
        for (motion_path, motion, source_slots) in &files {
            let proposal = propose(model, motion);
            for pair in &proposal.pairs {
                let slots = (target_slots.get(&pair.target), source_slots.get(&pair.source));
                if let (Some(target), Some(source)) = slots {
                    let crossed = *target == source.mirrored() && target != source;
                    assert!(!crossed, "{model_path} from {motion_path}: {target:?} follows {source:?}");
                }
            }
            let common = target_slots.values().filter(|slot| source_slots.values().any(|other| other == *slot));
            let (mut count, mut mapped) = (0, 0);
            for slot in common {
                count += 1;
                let is_mapped = |pair: &ProposedPair| target_slots.get(&pair.target) == Some(slot);
                mapped += usize::from(proposal.pairs.iter().any(is_mapped));
            }
            assert!(mapped as f64 >= 0.9 * count as f64, "{model_path} from {motion_path}: {mapped} of {count}");
        }
    }
}
