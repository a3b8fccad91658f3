//! Motion that translations carry: travel that moves to a root joint, and creatures, which hop.

use gaitway_character::anim::{ClipBuilder, Interpolation, JointIndex, Keys, Property, Transform};
use gaitway_character::asset::{Asset, AssetParts, Slot};
use gaitway_retarget::{ResolvedMap, Retargeting};
use glam::{DVec3, Quat, Vec3};

use crate::carriers::{positions, retargeted};
use crate::figure::{Figure, Rig, build};
use crate::laws::{body, degrees, map};
use crate::skeletons;

/// Makes a figure walk along a curve for 6 s, facing along it: places and headings at each share of the time.
fn walking(mut figure: Figure, path: impl Fn(f32) -> (Vec3, f32)) -> Figure {
    const KEYS: usize = 61;
    let times: Vec<f32> = (0..KEYS).map(|key| key as f32 * 6.0 / (KEYS - 1) as f32).collect();
    let (hips, skeleton) = (figure.joint(Slot::Hips), &figure.asset.skeleton);
    let rest = skeleton.rest().local(hips);
    let places = times.iter().map(|&time| rest.translation + path(time / 6.0).0).collect();
    let turns = times.iter().map(|&time| Quat::from_rotation_y(path(time / 6.0).1) * rest.rotation).collect();
    let mut clip = ClipBuilder::new("walk", skeleton);
    clip.channel(hips, Interpolation::Linear, &times, Keys::Translation(places)).unwrap();
    clip.channel(hips, Interpolation::Linear, &times, Keys::Rotation(turns)).unwrap();
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

fn circle(share: f32) -> (Vec3, f32) {
    let angle = share * std::f32::consts::TAU;
    (Vec3::new(2.0 * (1.0 - angle.cos()), 0.0, 2.0 * angle.sin()), angle)
}

/// Sways while it goes straight on.
fn straight(share: f32) -> (Vec3, f32) {
    let sway = (share * 40.0).sin();
    (Vec3::new(0.05 * sway, 0.02 * sway, 6.0 * share), 0.1 * sway)
}

/// Turns round in the middle.
fn there_and_back(share: f32) -> (Vec3, f32) {
    let turned = ((share - 0.4) / 0.2).clamp(0.0, 1.0);
    (Vec3::new(0.4 * turned, 0.0, 3.0 * (1.0 - (2.0 * share - 1.0).abs())), turned * std::f32::consts::PI)
}

#[test]
fn an_extracted_root_goes_below_the_hips() {
    let model = build(&Rig { axes: 6, armature: true, size: 1.3, ..Rig::default() });
    let (hips, root) = (model.joint(Slot::Hips), model.asset.skeleton.find("Armature").unwrap());
    for (path, is_straight) in [(circle as fn(f32) -> (Vec3, f32), false), (straight, true), (there_and_back, false)] {
        let motion = walking(build(&Rig { prefix: "m_", ..Rig::default() }), path);
        let bake = |extract: bool| {
            let mut map: ResolvedMap = map(&model, &motion);
            map.root.extract = extract;
            Retargeting::new(body(&model), body(&motion), 0, &map).unwrap().bake().unwrap().clip
        };
        let (kept, extracted) = (bake(false), bake(true));
        let mut travelled: f64 = 0.0;
        for step in 0..=60 {
            let time = step as f32 * 0.1;
            let (wanted, found) = (model.world(&kept, time), model.world(&extracted, time));
            for (wanted, found) in wanted.iter().zip(&found).skip(hips.get()) {
                assert!(wanted.1.distance(found.1) < 5e-3, "{} m at {time}", wanted.1.distance(found.1));
                assert!(degrees(wanted.0, found.0) < 0.2, "{} degrees at {time}", degrees(wanted.0, found.0));
            }
            let apart = (found[hips.get()].1 - found[root.get()].1) * DVec3::new(1.0, 0.0, 1.0);
            assert!(apart.length() < 0.2, "the hips are {} m from the root at {time}", apart.length());
            travelled = travelled.max(found[root.get()].1.length());
        }
        assert!(travelled > 3.0, "{travelled}");
        let root_channel = |property: Property| {
            extracted.channels().iter().find(|channel| channel.joint == root && channel.keys.property() == property)
        };
        let travel = root_channel(Property::Translation).unwrap();
        assert_eq!(extracted.timelines()[travel.timeline as usize].len() == 2, is_straight);
        assert_eq!(root_channel(Property::Rotation).is_some(), !is_straight, "the root turns with the path");
    }
}

/// Four legs, with feet beside them as inverse kinematics leaves them, at some size.
fn creature(size: f32) -> Asset {
    let mut joints = Vec::new();
    let mut add = |name: String, parent: Option<usize>, at: [f32; 3]| {
        joints.push(skeletons::joint(&name, parent, Transform::from_translation(size * Vec3::from(at))));
        joints.len() - 1
    };
    let root = add("root".into(), None, [0.0; 3]);
    let trunk = add("Body".into(), Some(root), [0.0, 0.4, 0.0]);
    let neck = add("Neck1".into(), Some(trunk), [0.0, 0.05, 0.2]);
    add("Head".into(), Some(neck), [0.0, 0.1, 0.05]);
    add("Tail1".into(), Some(trunk), [0.0, 0.0, -0.2]);
    for (side, x) in [("L", 0.075), ("R", -0.075)] {
        for (end, z) in [("Front", 0.175), ("Back", -0.175)] {
            let upper = add(format!("{end}UpperLeg.{side}"), Some(trunk), [x, -0.025, z]);
            add(format!("{end}LowerLeg.{side}"), Some(upper), [0.0, -0.175, 0.025]);
            add(format!("{end}Foot.{side}"), Some(root), [x, 0.04, z]);
        }
    }
    skeletons::asset(joints)
}

/// Body and feet rise by 0.4 m, one foot after the other.
fn hopping(asset: Asset) -> Asset {
    let moves = |name: &str| name == "Body" || name.contains("Foot");
    let mut clip = ClipBuilder::new("hop", &asset.skeleton);
    for (at, joint) in asset.skeleton.joints().filter(|&joint| moves(asset.skeleton.name(joint))).enumerate() {
        let rest = asset.skeleton.rest().local(joint).translation;
        let keys = Keys::Translation(vec![rest, rest + 0.4 * Vec3::Y + 0.1 * Vec3::Z, rest + 0.2 * Vec3::Z]);
        clip.channel(joint, Interpolation::Linear, &[0.0, 1.0 + 0.1 * at as f32, 2.0], keys).unwrap();
    }
    let clips = vec![clip.build()];
    Asset::new(AssetParts { clips, ..asset.into_parts() }).unwrap()
}

#[test]
fn creatures_hop_at_their_size() {
    let (motion, model) = (hopping(creature(1.0)), creature(2.6));
    let clip = retargeted(&model, &motion);
    for time in [0.0, 0.5, 1.0, 1.3, 2.0] {
        let (wanted, found) = (positions(&motion, &motion.clips[0], time), positions(&model, &clip, time));
        for joint in motion.skeleton.joints() {
            let name = motion.skeleton.name(joint);
            let twin: JointIndex = model.skeleton.find(name).unwrap();
            let off = (2.6 * wanted[joint.get()]).distance(found[twin.get()]);
            assert!(off < 1e-3, "{name} is {off} m away at {time}");
        }
    }
}
