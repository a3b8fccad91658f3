//! A clip that leaves as BVH or as a VRM animation and comes back to the same model is the same clip.

use gaitway::anim::{Clip, Interpolation, JointIndex, Skeleton};
use gaitway::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway::formats::{FileSet, LoadOptions, load_with, write_bvh, write_vrma};
use gaitway::library::Model;
use gaitway::mesh::Skin;
use gaitway::retarget::{Body, Keep, Retargeting, propose};
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
    clip.sample(skeleton, time_secs, &mut gaitway::anim::SampleCursor::default(), &mut pose);
    gaitway::anim::model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut affines);
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
    gaitway::anim::model_from_joint(&parts.skeleton, parts.skeleton.rest(), Affine3A::IDENTITY, &mut world);
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

/// Every real character dances, and borrows its own dance back.
#[test]
fn real_characters_borrow_their_own_clips_back() {
    let Some(folder) = data_folder() else { return };
    let dance = load_one(&folder, "Samba_Dancing.glb");
    let mut problems = Vec::new();
    for person in load_people(&folder).into_iter().filter(|person| person.person.has_mesh) {
        let map = proposed(&person, &dance).unwrap();
        let clip = measured(&person, &dance, &map).unwrap().1.clip;
        let model = Model::new(person.name.to_owned(), person.asset, Vec::new());
        let joints: Vec<JointIndex> =
            model.asset.skeleton.joints().filter(|&joint| model.rig().is_real(joint)).collect();
        let (asset, slots, forward) = (&model.asset, model.body().slots, model.forward());
        let trip = Trip { asset, slots, forward, joints: &joints, clip: &clip };
        for (format, max_share) in FORMATS.into_iter().zip(MAX_SHARES) {
            let (distance, degrees, joint) = trip.deviation(format);
            let share = distance / model.size_metres();
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
