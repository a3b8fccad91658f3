//! Proposed maps for two files.

use gaitway_character::anim::{Joint, JointIndex, Transform};
use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, load, prepare};
use gaitway_retarget::{JointMapFile, Proposal, Reason, propose};
use glam::Vec3;

use crate::data::open;
use crate::numpy::{npz, person};
use crate::skeletons;

/// Checks the number of the source joint that each named target follows.
fn check(model: &Asset, proposal: &Proposal, motion: &Asset, expected: &[(&str, usize)]) {
    for (name, number) in expected {
        let target = model.skeleton.find(name).unwrap_or_else(|| panic!("{name}"));
        let source = proposal.pairs.iter().find(|pair| pair.target == target).map(|pair| pair.source);
        assert_eq!(source.map(|joint| motion.skeleton.source_index(joint)), Some(*number), "{name}");
    }
}

#[test]
fn the_dwarf_gets_the_map_of_the_coursework() {
    let (Some(dwarf), Some(walk)) = (open("cosc422/dwarf.glb"), open("cosc422/original/Dwarf/avatar_walk.bvh")) else {
        return;
    };
    let proposal = propose(&dwarf, &walk);
    check(
        &dwarf,
        &proposal,
        &walk,
        &[
            ("head", 5),
            ("spine1", 4),
            ("spine2", 2),
            ("lhip", 18),
            ("rhip", 15),
            ("lknee", 19),
            ("rknee", 16),
            ("lankle", 20),
            ("rankle", 17),
        ],
    );
    assert!(proposal.model.by_position && !proposal.model.contradictions.is_empty(), "lhip is on the right");
    assert!(proposal.motion.contradictions.is_empty());
}

#[test]
fn joints_of_smpl_are_found() {
    let Some(xbot) = open("threejs/Xbot.glb") else { return };
    let mut files = FileSet::default();
    files.insert("walk.npz", npz(&person(52)));
    prepare(&mut files).unwrap();
    let motion = load(&files).unwrap();
    let proposal = propose(&xbot, &motion);
    let joints = [
        ("Hips", 0),
        ("LeftUpLeg", 1),
        ("RightUpLeg", 2),
        ("LeftLeg", 4),
        ("RightLeg", 5),
        ("LeftFoot", 7),
        ("RightFoot", 8),
        ("LeftToeBase", 10),
        ("RightToeBase", 11),
        ("Neck", 12),
        ("LeftShoulder", 13),
        ("RightShoulder", 14),
        ("Head", 15),
        ("LeftArm", 16),
        ("RightArm", 17),
        ("LeftForeArm", 18),
        ("RightForeArm", 19),
        ("LeftHand", 20),
        ("RightHand", 21),
        ("LeftHandIndex1", 22),
        ("LeftHandThumb3", 36),
        ("RightHandPinky2", 44),
    ];
    let named = joints.map(|(name, number)| (format!("mixamorig:{name}"), number));
    check(&xbot, &proposal, &motion, &named.each_ref().map(|(name, number)| (name.as_str(), *number)));
}

/// A motion that shows no side of its own follows the names of a mirrored model that it was made for.
#[test]
fn names_decide_between_a_mirrored_model_and_a_motion_without_feet() {
    let Some(dwarf) = open("cosc422/dwarf.glb") else { return };
    let mut rest = dwarf.skeleton.rest().clone();
    for joint in dwarf.skeleton.joints() {
        rest.set_local(joint, Transform::IDENTITY);
    }
    let motion = Asset::from(dwarf.skeleton.with_rest(&rest));
    let proposal = propose(&dwarf, &motion);
    assert!(proposal.model.by_position && !proposal.motion.by_position);
    assert!(proposal.pairs.iter().all(|pair| pair.target == pair.source));
    assert_eq!(proposal.pairs.len(), dwarf.skeleton.len());
}

#[test]
fn names_decide_where_most_are_shared() {
    let (Some(mannequin), Some(run)) = (open("cosc422/mannequin.glb"), open("cosc422/mannequin_run.glb")) else {
        return;
    };
    let proposal = propose(&mannequin, &run);
    // Every name of the motion is in the model.
    assert_eq!(proposal.pairs.len(), run.skeleton.len());
    assert!(proposal.unused_sources.is_empty() && proposal.unmapped_targets.is_empty());
    let name = |asset: &Asset, joint: JointIndex| asset.skeleton.name(joint).to_owned();
    assert!(proposal.pairs.iter().all(|pair| name(&mannequin, pair.target) == name(&run, pair.source)));
}

/// Files made for each other: names decide although the motion lacks joints of the trunk.
#[test]
fn a_motion_with_fewer_joints_is_matched_by_name() {
    let (Some(model), Some(motion)) = (open("playcanvas/bitmoji.glb"), open("playcanvas/bitmoji-anim/jump-flip.glb"))
    else {
        return;
    };
    let proposal = propose(&model, &motion);
    assert_eq!(proposal.pairs.len(), motion.skeleton.len());
    for pair in &proposal.pairs {
        assert_eq!(model.skeleton.name(pair.target), motion.skeleton.name(pair.source));
    }
}

/// Exporters rewrite names: `upper_arm.L` becomes `upper_armFBXASC046L`.
#[test]
fn names_from_two_exporters_match() {
    let (Some(model), Some(motion)) = (open("misc/babylon_riggedMesh.glb"), open("cosc422/mannequin_run.glb")) else {
        return;
    };
    let proposal = propose(&model, &motion);
    // All but the root, which only wraps the skeleton.
    assert_eq!(proposal.pairs.len(), motion.skeleton.len() - 1);
    assert!(proposal.pairs.iter().all(|pair| pair.reason == Reason::SameName));
}

#[test]
fn every_joint_of_a_file_follows_itself() {
    for path in [
        "threejs/RobotExpressive.glb",
        "threejs/Xbot.glb",
        "kaykit/Knight.glb",
        "khronos/Fox/glTF-Binary/Fox.glb",
        "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
        "mesh2motion/spider-animations.glb",
    ] {
        let Some(asset) = open(path) else { return };
        let proposal = propose(&asset, &asset);
        assert_eq!(proposal.pairs.len(), asset.skeleton.len(), "{path}");
        assert!(proposal.pairs.iter().all(|pair| pair.target == pair.source), "{path}");
        let map = proposal.to_map(&asset, &asset).to_file(&asset, &asset);
        let read = JointMapFile::from_json(&map.to_json().expect("plain data")).expect("what was written");
        let resolved = read.resolve(&asset, &asset).expect(path);
        assert!(resolved.pairs.iter().all(|pair| pair.target == pair.source), "{path}");
        assert_eq!(resolved.pairs.len(), asset.skeleton.len(), "{path}");
    }
}

#[test]
fn proposals_read_back_from_their_file_form() {
    for (model, motion) in [
        ("threejs/RobotExpressive.glb", "threejs/Xbot.glb"),
        ("khronos/CesiumMan/glTF-Binary/CesiumMan.glb", "bvh/cmu_01_01.bvh"),
        ("cosc422/ArmyPilot.glb", "vrm/chatvrm_idle_loop.vrma"),
    ] {
        let (Some(model), Some(motion)) = (open(model), open(motion)) else { return };
        let proposal = propose(&model, &motion);
        let text = proposal.to_map(&model, &motion).to_file(&model, &motion).to_json().expect("plain data");
        let resolved = JointMapFile::from_json(&text).expect(&text).resolve(&model, &motion).expect(&text);
        let proposed: Vec<_> = proposal.pairs.iter().map(|pair| (pair.target, pair.source)).collect();
        assert_eq!(resolved.pairs.iter().map(|pair| (pair.target, pair.source)).collect::<Vec<_>>(), proposed);
        assert!(proposed.len() > 10);
    }
}

#[test]
fn skeletons_with_nothing_in_common_get_no_pairs() {
    let (Some(snake), Some(walk)) = (open("mesh2motion/snake-animations.glb"), open("bvh/cosc422_Walk.bvh")) else {
        return;
    };
    let proposal = propose(&snake, &walk);
    assert!(proposal.pairs.is_empty(), "{:?}", proposal.pairs);
    assert_eq!(proposal.unused_sources.len(), walk.skeleton.len());
}

/// Two foxes by different people: their names say left, right, front and hind, which the shape must agree with.
#[test]
fn creatures_are_matched_along_their_limbs() {
    let (Some(model), Some(motion)) = (open("khronos/Fox/glTF-Binary/Fox.glb"), open("mesh2motion/fox-animations.glb"))
    else {
        return;
    };
    for (model, motion) in [(&model, &motion), (&motion, &model)] {
        let proposal = propose(model, motion);
        let name = |asset: &Asset, joint: JointIndex| asset.skeleton.name(joint).to_owned();
        for pair in &proposal.pairs {
            let names = [name(model, pair.target), name(motion, pair.source)];
            println!("{} from {} ({})", names[0], names[1], pair.confidence);
            let is = |words: &[&str], end: &str| {
                names.each_ref().map(|name| name.ends_with(end) || words.iter().any(|word| name.contains(word)))
            };
            for (words, end) in [
                (&["Left"][..], "_L"),
                (&["Right"], "_R"),
                (&["Tail"], "Tail_End"),
                (&["Arm", "Hand", "Front_"], "Arm"),
                (&["Leg0", "Foot0", "Back_"], "Leg"),
            ] {
                let [target, source] = is(words, end);
                assert_eq!(target, source, "{names:?}");
            }
            assert!(pair.confidence < 0.6 || pair.reason == Reason::SameName, "a guess");
        }
        assert!(proposal.pairs.len() >= 16, "{}", proposal.pairs.len());
    }
}

/// A horse and a winged horse with names of its own for the wings: shared joints are mapped.
#[test]
fn creatures_follow_the_names_they_share() {
    let horse = ["body", "neck1", "head1", "tail1", "tail2", "frontleg_l", "frontleg_r", "hindleg_l", "hindleg_r"];
    let parents = [None, Some(0), Some(1), Some(0), Some(3), Some(0), Some(0), Some(0), Some(0)];
    let build = |extra: &[&str]| {
        let joints =
            horse.iter().zip(parents).map(|(name, parent)| skeletons::joint(name, parent, Transform::IDENTITY));
        let more = extra.iter().map(|name| skeletons::joint(name, Some(0), Transform::IDENTITY));
        skeletons::asset(joints.chain(more).collect())
    };
    let (horse, dragon) = (build(&["mane", "saddle"]), build(&["wing_l", "wing_r", "fang", "horn"]));
    let proposal = propose(&horse, &dragon);
    assert_eq!(proposal.pairs.len(), 9);
    assert!(proposal.pairs.iter().all(|pair| pair.target == pair.source && pair.reason == Reason::SameName));
    // Two shared names may be a coincidence.
    let pair = |names: [&str; 2]| skeletons::asset(skeletons::chain(names, Vec3::Y));
    assert!(propose(&pair(["tail", "a"]), &pair(["tail", "b"])).pairs.is_empty());
}

/// Returns a dragon with meaningless joint names, and the limb of each joint. `joints`: how many joints the tail, the neck and
/// each wing have.
fn dragon(prefix: &str, joints: [usize; 3]) -> (Asset, Vec<&'static str>) {
    let (mut found, mut limbs) = (Vec::new(), Vec::new());
    let mut chain = |limb, mut parent: Option<usize>, first: Vec3, step: Vec3, count: usize| {
        for at in 0..count {
            let step = Transform::from_translation(if at == 0 { first } else { step });
            found.push(skeletons::joint(&format!("{prefix}{}", 7 * found.len() % 31), parent, step));
            limbs.push(limb);
            parent = Some(found.len() - 1);
        }
        found.len() - 1
    };
    let [tail, neck, wing] = joints;
    // Only twin bones have equal lengths.
    let back = 3.0 / tail as f32;
    let hips = chain("trunk", None, Vec3::Y, Vec3::ZERO, 1);
    let chest = chain("trunk", Some(hips), Vec3::Z * 0.4, Vec3::Z * 0.4, 2);
    chain("tail", Some(hips), Vec3::Z * -0.2, Vec3::Z * -back, tail);
    chain("neck", Some(chest), Vec3::new(0.0, 0.2, 0.2), Vec3::new(0.0, 1.7, 1.7) / neck as f32, neck);
    for (side, names) in
        [(1.0, ["left hind", "left front", "left wing"]), (-1.0, ["right hind", "right front", "right wing"])]
    {
        for (name, on) in [(names[0], hips), (names[1], chest)] {
            chain(name, Some(on), Vec3::X * 0.2 * side, Vec3::Y * -0.3, 4);
        }
        let out = Vec3::new(6.0 * side, 0.2, 0.0);
        chain(names[2], Some(chest), Vec3::new(0.15 * side, 0.1, 0.0), out / wing as f32, wing);
    }
    (skeletons::asset(found), limbs)
}

#[test]
fn wings_legs_and_tail_are_matched_by_shape() {
    let (model, targets) = dragon("a", [5, 3, 3]);
    let (motion, sources) = dragon("b", [3, 4, 4]);
    let proposal = propose(&model, &motion);
    let limb_of = |asset: &Asset, limbs: &[&'static str], joint| limbs[asset.skeleton.source_index(joint)];
    let mut matched: Vec<&str> = Vec::new();
    for pair in &proposal.pairs {
        let limb = limb_of(&model, &targets, pair.target);
        assert_eq!(limb_of(&motion, &sources, pair.source), limb);
        assert!(pair.confidence < 0.5, "{limb}: a guess");
        matched.push(limb);
    }
    for limb in targets {
        let pairs = matched.iter().filter(|matched| **matched == limb).count();
        assert!(pairs >= 3, "{pairs} joints of the {limb}");
    }
}

#[test]
fn trunks_of_different_length_are_matched_at_their_ends() {
    let (Some(bot), Some(mannequiny)) = (open("threejs/Xbot.glb"), open("misc/godot_mannequiny.glb")) else { return };
    let source = |model: &Asset, motion: &Asset, name: &str| {
        let target = model.skeleton.find(name).expect(name);
        let proposal = propose(model, motion);
        let pair = proposal.pairs.iter().find(|pair| pair.target == target).copied();
        pair.map(|pair| motion.skeleton.name(pair.source).to_owned())
    };
    let to_bot = |name: &str| source(&bot, &mannequiny, name);
    assert_eq!(to_bot("mixamorig:Spine").as_deref(), Some("spine_01"));
    assert_eq!(to_bot("mixamorig:Spine1"), None);
    assert_eq!(to_bot("mixamorig:Spine2").as_deref(), Some("spine_02"));
    let from_bot = |name: &str| source(&mannequiny, &bot, name);
    assert_eq!(from_bot("spine_01").as_deref(), Some("mixamorig:Spine"));
    assert_eq!(from_bot("spine_02").as_deref(), Some("mixamorig:Spine2"));
}

/// Many joints with known words must not take minutes.
#[test]
fn large_scenes_are_fast() {
    let count = 40_000;
    let chain = |at: usize| at.checked_sub(1);
    let star = |at: usize| (at > 0).then_some(0);
    let comb = |at: usize| (at > 0).then(|| at - 1 - usize::from(at.is_multiple_of(3) && at > 1));
    let names = ["head", "LeftArm", "", "hips", "Spine", "twin"];
    for parent in [chain as fn(usize) -> Option<usize>, star, comb] {
        let joints = (0..count).map(|at| Joint {
            name: names[at % names.len()].to_owned(),
            parent: parent(at),
            rest: Transform::from_translation(Vec3::new((at % 7) as f32, 1.0, 0.0)),
            ..Joint::default()
        });
        let unnamed = joints.clone().map(|joint| Joint { name: String::new(), ..joint });
        let (named, unnamed) = (skeletons::asset(joints.collect()), skeletons::asset(unnamed.collect()));
        let start = std::time::Instant::now();
        propose(&named, &unnamed);
        propose(&unnamed, &named);
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }
}
