//! A clip that leaves as BVH or as a VRM animation and comes back to the same model is the same clip.

use std::collections::BTreeSet;

use gaitway_character::anim::{Clip, Interpolation, JointIndex, Skeleton, model_from_joint};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway_character::mesh::{Bounds, DeformedVertices, Skin, SkinningMode, deform, palette_entry, write_palette};
use gaitway_formats::{FileSet, LoadOptions, load_with, write_bvh, write_vrma};
use gaitway_retarget::{Body, Keep, Retargeting, propose, recognize};
use glam::{Affine3A, DQuat, DVec3, Vec3};

use crate::data_folder::data_folder;
use crate::figure::{Figure, Rig, build};
use crate::laws::degrees;
use crate::people::{load_one, load_people, measured, proposed};
use crate::random::Random;
use crate::rests::with_rest;

const FORMATS: [&str; 2] = ["written.bvh", "written.vrma"];

/// A clip of a model, written to a file and borrowed back.
struct Trip<'a> {
    asset: &'a Asset,
    slots: &'a Humanoid,
    forward: Option<Vec3>,
    /// The joints of a BVH.
    joints: &'a [JointIndex],
    clip: &'a Clip,
}

/// The largest deviation of a joint, in the model's units and degrees, with its name.
type Deviation<'a> = (f64, f64, &'a str);

impl<'a> Trip<'a> {
    /// Deviations at the keys of the file, of all joints that it has.
    fn deviation(&self, format: &str) -> Deviation<'a> {
        let motion = self.written(format);
        let proposal = propose(self.asset, &motion);
        let map = proposal.to_map(self.asset, &motion);
        let mut map = map.resolve(self.asset, &motion).unwrap();
        // BVH has the translations of all joints, but retargeting keeps them only between skeletons with the same rest.
        map.translations = if format.ends_with("bvh") { Keep::Keep } else { Keep::Auto };
        let slots = proposal.motion.humanoid();
        let [model, source] = [(self.asset, self.slots), (&motion, &slots)].map(|(asset, slots)| Body { asset, slots });
        let back = Retargeting::new(model, source, 0, &map).unwrap().bake().unwrap().clip;
        let times = motion.clips[0].timelines().iter().max_by_key(|times| times.len()).unwrap();
        let mut worst = (0.0, 0.0, "");
        for &time in times.iter().step_by(1 + times.len() / 24) {
            let [before, after] = [self.clip, &back].map(|clip| world(&self.asset.skeleton, clip, time));
            for pair in &map.pairs {
                let ((turn, at), (found_turn, found)) = (before[pair.target.get()], after[pair.target.get()]);
                let deviation = (at.distance(found), degrees(turn, found_turn));
                if deviation.0 > worst.0 {
                    worst.2 = self.asset.skeleton.name(pair.target);
                }
                worst = (deviation.0.max(worst.0), deviation.1.max(worst.1), worst.2);
            }
        }
        worst
    }

    fn written(&self, format: &str) -> Asset {
        let &Self { asset, slots, forward, joints, clip } = self;
        let bytes = match format.ends_with("bvh") {
            true => write_bvh(asset, &asset.skeleton, joints, clip, 30.0),
            false => write_vrma(asset, slots, forward, clip),
        };
        let mut files = FileSet::default();
        files.insert(format, bytes.unwrap());
        let options = LoadOptions { bvh_unit_metres: Some(1.0), bvh_z_up: Some(false), ..LoadOptions::default() };
        load_with(&files, &options).unwrap()
    }
}

/// Rotations, without scale, and positions of all joints.
fn world(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Vec<(DQuat, DVec3)> {
    let mut affines = Vec::new();
    let mut pose = skeleton.rest().clone();
    clip.sample(skeleton, time_secs, &mut gaitway_character::anim::SampleCursor::default(), &mut pose);
    gaitway_character::anim::model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut affines);
    let place = |joint: &Affine3A| {
        let (_, turn, at) = joint.to_scale_rotation_translation();
        (turn.as_dquat().normalize(), at.as_dvec3())
    };
    affines.iter().map(place).collect()
}

/// The figure with a skin that was bound in its pose, and nodes that rest up to `degrees` away from that.
fn bound(mut figure: Figure, degrees: f64, random: &mut Random) -> Figure {
    let parts = figure.asset.into_parts();
    let mut world = Vec::new();
    gaitway_character::anim::model_from_joint(&parts.skeleton, parts.skeleton.rest(), Affine3A::IDENTITY, &mut world);
    let joints: Vec<JointIndex> = parts.skeleton.joints().collect();
    let joint_from_bind = world.iter().map(Affine3A::inverse).collect();
    let skin = Skin::new(String::new(), joints, joint_from_bind, parts.skeleton.len()).unwrap();
    let hips = figure.slots.joint(Slot::Hips);
    let skeleton = with_rest(&parts.skeleton, |joint, rest| {
        // A skin can't tell how its topmost joint was turned when it was bound.
        if parts.skeleton.parent(joint).is_some() && Some(joint) != hips {
            rest.rotation = (rest.rotation.as_dquat() * random.rotation(degrees)).normalize().as_quat();
        }
    });
    figure.asset = Asset::new(AssetParts { skeleton, skins: vec![skin], ..parts }).unwrap();
    figure
}

#[test]
fn a_clip_that_is_written_and_borrowed_back_is_the_same() {
    let mut random = Random(3);
    for seed in 0..12 {
        let rig = Rig {
            axes: seed,
            armature: seed % 2 == 1,
            arms_down_degrees: [0.0, 50.0, 20.0][seed as usize % 3],
            facing_degrees: if seed % 4 == 3 { 180.0 } else { 0.0 },
            ..Rig::default()
        };
        let mut figure = bound(build(&rig), [0.0, 30.0, 90.0][seed as usize / 4], &mut random);
        figure.dance(50 + seed, 60.0, Interpolation::Linear);
        let joints: Vec<JointIndex> =
            figure.slots.0.values().copied().collect::<std::collections::BTreeSet<_>>().into_iter().collect();
        let forward = DQuat::from_rotation_y(rig.facing_degrees.to_radians()) * DVec3::Z;
        let trip = Trip {
            asset: &figure.asset,
            slots: &figure.slots,
            forward: Some(forward.as_vec3()),
            joints: &joints,
            clip: &figure.asset.clips[0],
        };
        for format in FORMATS {
            let worst = trip.deviation(format);
            assert!(worst.0 < 1e-3 && worst.1 < 0.15, "{seed}, {format}: {worst:?}");
        }
    }
}

/// Shares of the model's size. Legs that rest bent are longer in a T-pose, so the path of the hips is scaled by slightly less.
const MAX_SHARES: [f64; 2] = [1e-4, 5e-3];
const MAX_DEGREES: f64 = 0.2;

/// The joints of the skins and those between them.
fn bones(asset: &Asset) -> Vec<JointIndex> {
    let skeleton = &asset.skeleton;
    let in_skin: BTreeSet<JointIndex> = asset.skins.iter().flat_map(|skin| skin.joints()).copied().collect();
    let mut bones = in_skin.clone();
    for &joint in &in_skin {
        let parents = std::iter::successors(skeleton.parent(joint), |&joint| skeleton.parent(joint));
        let between: Vec<JointIndex> = parents.take_while(|parent| !in_skin.contains(parent)).collect();
        let top = between.last().map_or(joint, |&top| top);
        if skeleton.parent(top).is_some() {
            bones.extend(between);
        }
    }
    bones.into_iter().collect()
}

/// The largest extent of the surfaces at rest.
fn size(asset: &Asset) -> f64 {
    let (rest, mut world) = (asset.skeleton.rest(), Vec::new());
    model_from_joint(&asset.skeleton, rest, Affine3A::IDENTITY, &mut world);
    let (mut bounds, mut deformed) = (Bounds::EMPTY, DeformedVertices::default());
    for instance in &asset.instances {
        let mut palette = Vec::new();
        match instance.skin {
            Some(skin) => write_palette(&asset.skins[skin], &world, SkinningMode::Linear, &mut palette),
            None => {
                let world_from_mesh = world[instance.joint.get()] * instance.joint_from_mesh;
                palette.push(palette_entry(&world_from_mesh, SkinningMode::Linear));
            }
        }
        let weights = &rest.morph_weights[asset.skeleton.morph_range(instance.joint)];
        for geometry in &asset.meshes[instance.mesh].primitives {
            deform(geometry, weights, &palette, SkinningMode::Linear, &mut deformed);
            bounds = deformed.positions.iter().fold(bounds, |bounds, &position| bounds.including(position));
        }
    }
    f64::from(bounds.size().max_element())
}

/// Every real character dances, and borrows its own dance back.
#[test]
fn real_characters_borrow_their_own_clips_back() {
    let Some(folder) = data_folder() else { return };
    let dance = load_one(&folder, "Samba_Dancing.glb");
    let mut problems = Vec::new();
    for person in load_people(&folder).into_iter().filter(|person| person.person.has_mesh) {
        let map = proposed(&person, &dance).unwrap();
        let clip = measured(&person, &dance, &map).unwrap().1.clip;
        let (asset, recognized) = (&person.asset, recognize(&person.asset));
        let (joints, slots, forward) = (bones(asset), recognized.humanoid(), recognized.facing.forward);
        let trip = Trip { asset, slots: &slots, forward, joints: &joints, clip: &clip };
        for (format, max_share) in FORMATS.into_iter().zip(MAX_SHARES) {
            let (distance, degrees, joint) = trip.deviation(format);
            let share = distance / size(asset);
            if share > max_share || degrees > MAX_DEGREES {
                problems.push(format!(
                    "{}, {format}: {joint} is {share} of the size off, turned by {degrees}°",
                    person.name
                ));
            }
        }
    }
    assert_eq!(problems, Vec::<String>::new());
}
