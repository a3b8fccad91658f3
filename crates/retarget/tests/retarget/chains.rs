//! Chains that share their bend, twist joints and helpers: reproductions built in code, and laws on real rigs whose skeletons are
//! changed while the body stays the same.

use std::collections::BTreeMap;

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Pose, SampleCursor, Skeleton, Transform,
    model_from_joint,
};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway_retarget::{Anatomy, Body, ChainPart, Chains, ResolvedMap, Retargeted, Retargeting, propose, recognize};
use glam::{Affine3A, DQuat, Quat, Vec3};

use crate::data_folder::data_folder;
use crate::laws::degrees;
use crate::people::{Loaded, load_people, model_rotations};
use crate::random::Random;
use crate::skeletons::{joint, with_skin};

/// A body with a number of spine joints and twist joints, in a T-pose that faces +Z.
#[derive(Debug, Clone, Copy)]
struct Build {
    spine: usize,
    neck: usize,
    twist: Twist,
    tail: usize,
    ears: usize,
}

/// Three joints of the spine, one of the neck.
const PLAIN: Build = Build { spine: 3, neck: 1, twist: Twist::None, tail: 0, ears: 0 };

#[derive(Debug, Clone, Copy, PartialEq)]
enum Twist {
    None,
    /// Two beside each segment.
    Beside,
    /// One between the joints of each segment.
    Between,
}

/// The joints of a body, added by name.
struct Builder {
    joints: Vec<Joint>,
}

impl Builder {
    fn add(&mut self, name: &str, parent: &str, offset: [f32; 3]) {
        let at = self.joints.iter().position(|joint| joint.name == parent);
        self.joints.push(joint(name, at, Transform::from_translation(Vec3::from(offset))));
    }

    /// So many joints below each other, `offset` together.
    fn line(&mut self, from: &str, name: &str, count: usize, offset: [f32; 3]) {
        let mut below = from.to_owned();
        for number in 1..=count {
            let name = format!("{name} {number}");
            self.add(&name, &below, offset.map(|value| value / count as f32));
            below = name;
        }
    }

    /// A segment from joint `from`, which exists, to the new joint `to`.
    fn segment(&mut self, from: &str, to: &str, offset: [f32; 3], twist: Twist) {
        let part = |share: f32| offset.map(|value| share * value);
        match twist {
            Twist::None => self.add(to, from, offset),
            Twist::Beside => {
                for (number, share) in [("1", 0.4), ("2", 0.8)] {
                    self.add(&format!("{from} twist {number}"), from, part(share));
                }
                self.add(to, from, offset);
            }
            Twist::Between => {
                let between = format!("{from} twist");
                self.add(&between, from, part(0.5));
                self.add(to, &between, part(0.5));
            }
        }
    }
}

fn body(build: Build) -> Asset {
    let mut builder = Builder { joints: Vec::new() };
    builder.add("hips", "", [0.0, 1.0, 0.0]);
    let mut below = "hips".to_owned();
    for number in 1..=build.spine {
        let name = format!("spine {number}");
        let step = if number == 1 { 0.1 } else { 0.4 / build.spine as f32 };
        builder.add(&name, &below, [0.0, step, 0.0]);
        below = name;
    }
    let chest = below;
    let mut below = chest.clone();
    for number in 1..=build.neck {
        let name = format!("neck {number}");
        builder.add(&name, &below, [0.0, 0.1 / build.neck as f32, 0.0]);
        below = name;
    }
    builder.add("head", &below, [0.0, 0.1 / build.neck as f32, 0.0]);
    builder.line("hips", "tail", build.tail, [0.0, 0.0, -0.4]);
    for (side, x) in [("left", 1.0), ("right", -1.0)] {
        let name = |part: &str| format!("{side} {part}");
        builder.line("head", &name("ear"), build.ears, [0.05 * x, 0.2, 0.0]);
        builder.add(&name("clavicle"), &chest, [0.03 * x, 0.05, 0.0]);
        builder.add(&name("upper arm"), &name("clavicle"), [0.15 * x, 0.0, 0.0]);
        builder.segment(&name("upper arm"), &name("lower arm"), [0.28 * x, 0.0, 0.0], build.twist);
        builder.segment(&name("lower arm"), &name("hand"), [0.26 * x, 0.0, 0.0], build.twist);
        builder.add(&name("upper leg"), "hips", [0.1 * x, -0.05, 0.0]);
        builder.segment(&name("upper leg"), &name("lower leg"), [0.0, -0.43, 0.0], build.twist);
        builder.segment(&name("lower leg"), &name("foot"), [0.0, -0.43, 0.0], build.twist);
        builder.add(&name("toes"), &name("foot"), [0.0, -0.07, 0.13]);
    }
    Asset::from(Skeleton::new(builder.joints).unwrap())
}

/// The asset with a clip of one second that turns each of these joints from rest.
fn moving(asset: Asset, turns: &[(&str, Quat)]) -> Asset {
    let mut clip = ClipBuilder::new("clip", &asset.skeleton);
    for &(name, turn) in turns {
        let joint = asset.skeleton.find(name).unwrap();
        let keys = Keys::Rotation(vec![Quat::IDENTITY, turn]);
        clip.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).unwrap();
    }
    let clip = clip.build();
    Asset::new(AssetParts { clips: vec![clip], ..asset.into_parts() }).unwrap()
}

/// The asset with the clip of another one that has the same joints.
fn with_clip_of(asset: Asset, other: &Asset) -> Asset {
    Asset::new(AssetParts { clips: other.clips.clone(), ..asset.into_parts() }).unwrap()
}

fn map(model: &Asset, motion: &Asset) -> ResolvedMap {
    propose(model, motion).to_map(model, motion).resolve(model, motion).unwrap()
}

fn retarget(model: &Asset, motion: &Asset, map: &ResolvedMap) -> Retargeted {
    let slots = [model, motion].map(|asset| recognize(asset).humanoid());
    let [model, motion] = [Body { asset: model, slots: &slots[0] }, Body { asset: motion, slots: &slots[1] }];
    Retargeting::new(model, motion, 0, map).unwrap().bake().unwrap()
}

/// The angle from rest of each joint's local rotation at the end of a clip, in degrees.
fn bends(asset: &Asset, clip: &Clip) -> BTreeMap<String, f64> {
    let (skeleton, mut pose) = (&asset.skeleton, asset.skeleton.rest().clone());
    clip.sample(skeleton, clip.duration_secs(), &mut SampleCursor::default(), &mut pose);
    let rest = skeleton.rest();
    let bend = |joint: JointIndex| {
        let rotation = |pose: &Pose| pose.local(joint).rotation.as_dquat();
        (skeleton.name(joint).to_owned(), degrees(rotation(rest), rotation(&pose)))
    };
    skeleton.joints().map(bend).collect()
}

/// Retargets a bend by 60° that the source's joints share evenly, from `source` joints of one name to `target` joints.
fn check_shared(name: &str, [source, target]: [usize; 2], build: fn(usize) -> Build) {
    let named = |count: usize| (1..=count).map(move |number| format!("{name} {number}"));
    let bend = Quat::from_rotation_x((60.0 / source as f32).to_radians());
    let names: Vec<String> = named(source).collect();
    let turns: Vec<(&str, Quat)> = names.iter().map(|name| (name.as_str(), bend)).collect();
    let (model, motion) = (body(build(target)), moving(body(build(source)), &turns));
    // With the same names, these would decide instead of chains. Without them, the humanoid has to be declared.
    let slots = recognize(&motion).humanoid();
    let joints = motion.skeleton.joints().map(|at| {
        let parent = motion.skeleton.parent(at).map(JointIndex::get);
        joint(&format!("joint {}", at.get()), parent, motion.skeleton.rest().local(at))
    });
    let motion = with_clip_of(declaring(Skeleton::new(joints.collect()).unwrap(), &motion.skeleton, &slots), &motion);
    let found = bends(&model, &retarget(&model, &motion, &map(&model, &motion)).clip);
    // A neck of one joint points where the source's does on average.
    let mean = (source + 1) as f64 / (2 * source) as f64;
    let neck_alone = name == "neck" && target == 1;
    let (total, head) = if neck_alone { (60.0 * mean, 60.0 * (1.0 - mean)) } else { (60.0, 0.0) };
    for joint in named(target) {
        assert!((found[&joint] - total / target as f64).abs() < 0.1, "{source} → {target}: {found:?}");
    }
    assert!((found["head"] - head).abs() < 0.1 && found["left clavicle"] < 0.01, "{found:?}");
}

#[test]
fn spines_and_necks_of_different_numbers_of_joints_share_a_bend_by_length() {
    for (source, target) in [1, 2, 4, 5, 7].into_iter().flat_map(|source| [1, 2, 3, 5].map(|target| (source, target))) {
        check_shared("spine", [source, target], |spine| Build { spine, ..PLAIN });
    }
    for (source, target) in [1, 2, 3].into_iter().flat_map(|source| [1, 2, 3].map(|target| (source, target))) {
        check_shared("neck", [source, target], |neck| Build { neck, ..PLAIN });
    }
}

#[test]
fn the_options_of_old_maps_leave_chains_alone() {
    let (model, motion) = (body(Build { spine: 5, twist: Twist::Beside, ..PLAIN }), body(Build { spine: 1, ..PLAIN }));
    let turns = [("spine 1", Quat::from_rotation_x(1.0)), ("left hand", Quat::from_rotation_x(2.0))];
    let motion = moving(motion, &turns);
    let proposed = map(&model, &motion);
    assert_eq!(proposed.chains, Chains::Share);
    let done = retarget(&model, &motion, &ResolvedMap { chains: Chains::Off, ..proposed.clone() });
    assert_eq!(done.resampled, []);
    let moving = bends(&model, &done.clip).into_values().filter(|&bend| bend > 0.01).count();
    assert_eq!(moving, 2);
    // A joint that is deliberately without a source rests.
    let rests = model.skeleton.find("left lower arm twist 1").unwrap();
    let done = retarget(&model, &motion, &ResolvedMap { without_source: vec![rests], ..proposed });
    assert!(done.clip.channels().iter().all(|channel| channel.joint != rests));
}

#[test]
fn equal_numbers_of_joints_keep_the_keys_of_the_source() {
    let motion = body(Build { spine: 4, ..PLAIN });
    let model = Asset::from(crate::rests::with_rest(&motion.skeleton, |_, rest| rest.translation *= 1.1));
    let names = ["spine 1", "spine 2", "spine 3", "spine 4"];
    let motion = moving(motion, &names.map(|name| (name, Quat::from_rotation_x(0.2))));
    let done = retarget(&model, &motion, &map(&model, &motion));
    assert_eq!(done.resampled, []);
}

#[test]
fn tails_and_ears_share_their_bend_whatever_their_joints_are_called() {
    let motion = body(Build { tail: 3, ears: 1, ..PLAIN });
    let bend = Quat::from_rotation_x(20.0_f32.to_radians());
    let turns = ["tail 1", "tail 2", "tail 3", "left ear 1"].map(|name| (name, bend));
    let motion = moving(motion, &turns);
    let model = body(Build { tail: 5, ears: 2, ..PLAIN });
    let renamed = |prefix: &str| {
        let appendages = model.skeleton.joints().filter_map(|joint| {
            let name = model.skeleton.name(joint);
            let new = if name.starts_with("tail") { format!("{prefix}{name}") } else { return None };
            Some((model.skeleton.source_index(joint), new))
        });
        let names: Vec<(usize, String)> = appendages.collect();
        Asset::from(model.skeleton.with_names(names.iter().map(|(joint, name)| (*joint, name.as_str()))))
    };
    for prefix in ["", "bushy "] {
        let model = renamed(prefix);
        let found = bends(&model, &retarget(&model, &motion, &map(&model, &motion)).clip);
        for number in 1..=5 {
            let bend = found[&format!("{prefix}tail {number}")];
            assert!((bend - 12.0).abs() < 0.1, "tail {number}: {found:?}");
        }
        for (name, degrees) in [("left ear 1", 10.0), ("left ear 2", 10.0), ("right ear 1", 0.0)] {
            assert!((found[name] - degrees).abs() < 0.1, "{name}: {found:?}");
        }
    }
    // The other way round, the last joints correspond, too.
    let turns = [1, 2, 3, 4, 5].map(|number| format!("bushy tail {number}"));
    let model = moving(renamed("bushy "), &turns.each_ref().map(|name| (name.as_str(), bend)));
    let short = body(Build { tail: 3, ears: 1, ..PLAIN });
    let found = bends(&short, &retarget(&short, &model, &map(&short, &model)).clip);
    for number in 1..=3 {
        let bend = found[&format!("tail {number}")];
        assert!((bend - 100.0 / 3.0).abs() < 0.2, "tail {number}: {found:?}");
    }
}

#[test]
fn what_is_called_a_tail_elsewhere_is_none() {
    let parts = |asset: &Asset| -> Vec<ChainPart> {
        let anatomy = Anatomy::new(asset, &recognize(asset).humanoid());
        anatomy.chains.iter().map(|chain| chain.part).filter(|part| part.is_appendage()).collect()
    };
    let with = |add: &dyn Fn(&mut Builder)| {
        let mut builder = Builder { joints: Vec::new() };
        let plain = body(PLAIN);
        for at in plain.skeleton.joints() {
            let parent = plain.skeleton.parent(at).map(JointIndex::get);
            builder.joints.push(joint(plain.skeleton.name(at), parent, plain.skeleton.rest().local(at)));
        }
        add(&mut builder);
        Asset::from(Skeleton::new(builder.joints).unwrap())
    };
    assert_eq!(parts(&with(&|_| ())), []);
    assert_eq!(parts(&with(&|body| body.line("hips", "tail", 3, [0.0, 0.0, -0.3]))), [ChainPart::Tail]);
    assert_eq!(parts(&with(&|body| body.line("head", "pony tail", 3, [0.0, -0.3, 0.0]))), []);
    let coat = with(&|body| {
        body.line("hips", "left coat tail", 2, [0.1, -0.3, -0.1]);
        body.line("hips", "right coat tail", 2, [-0.1, -0.3, -0.1]);
    });
    assert_eq!(parts(&coat), []);
    let fox = with(&|body| {
        body.line("hips", "tail a", 2, [0.1, 0.0, -0.3]);
        body.line("hips", "tail b", 2, [-0.1, 0.0, -0.3]);
    });
    assert_eq!(parts(&fox), []);
}

#[test]
fn twist_joints_take_their_share_of_a_turn() {
    let source = body(PLAIN);
    let turn = |degrees: f32| Quat::from_rotation_x(degrees.to_radians());
    let turns = [("left hand", turn(150.0)), ("right upper arm", turn(-90.0))];
    let motion = moving(source, &turns);
    let beside = body(Build { twist: Twist::Beside, ..PLAIN });
    let found = bends(&beside, &retarget(&beside, &motion, &map(&beside, &motion)).clip);
    let wanted = [
        ("left lower arm twist 1", 60.0),
        ("left lower arm twist 2", 120.0),
        ("left hand", 150.0),
        // Near the shoulder, skin turns less than the arm.
        ("right upper arm", 90.0),
        ("right upper arm twist 1", 54.0),
        ("right upper arm twist 2", 18.0),
        ("left upper arm twist 1", 0.0),
    ];
    for (name, degrees) in wanted {
        assert!((found[name] - degrees).abs() < 0.2, "{name}: {found:?}");
    }
    let between = body(Build { twist: Twist::Between, ..PLAIN });
    let found = bends(&between, &retarget(&between, &motion, &map(&between, &motion)).clip);
    let wanted = [
        ("left lower arm twist", 75.0),
        ("left hand", 75.0),
        ("right upper arm", 0.0),
        ("right upper arm twist", 90.0),
        ("right lower arm", 0.0),
    ];
    for (name, degrees) in wanted {
        assert!((found[name] - degrees).abs() < 0.2, "{name}: {found:?}");
    }
}

#[test]
fn a_source_with_twist_joints_turns_whole_limbs() {
    let source = body(Build { twist: Twist::Between, ..PLAIN });
    let turn = |degrees: f32| Quat::from_rotation_x(degrees.to_radians());
    let turns =
        [("left lower arm twist", turn(70.0)), ("left hand", turn(20.0)), ("right upper arm twist", turn(50.0))];
    let (model, motion) = (body(PLAIN), moving(source, &turns));
    let found = bends(&model, &retarget(&model, &motion, &map(&model, &motion)).clip);
    for (name, degrees) in
        [("left hand", 90.0), ("left lower arm", 0.0), ("right upper arm", 50.0), ("right lower arm", 0.0)]
    {
        assert!((found[name] - degrees).abs() < 0.1, "{name}: {found:?}");
    }
}

#[test]
fn helpers_beside_the_body_follow_hands_and_feet() {
    let plain = body(PLAIN);
    let at = |name: &str| {
        let mut world = Vec::new();
        model_from_joint(&plain.skeleton, plain.skeleton.rest(), Affine3A::IDENTITY, &mut world);
        Vec3::from(world[plain.skeleton.find(name).unwrap().get()].translation)
    };
    let mut joints = vec![joint("root", None, Transform::default())];
    for joint in plain.skeleton.joints() {
        let parent = plain.skeleton.parent(joint).map_or(0, |parent| parent.get() + 1);
        joints.push(crate::skeletons::joint(
            plain.skeleton.name(joint),
            Some(parent),
            plain.skeleton.rest().local(joint),
        ));
    }
    let helper = |name: &str, parent: usize, at: Vec3| joint(name, Some(parent), Transform::from_translation(at));
    let first = joints.len();
    joints.push(helper("ik_foot_root", 0, Vec3::ZERO));
    joints.push(helper("ik_foot_l", first, at("left foot") + Vec3::X * 0.02));
    joints.push(helper("ik_hand_root", 0, Vec3::ZERO));
    joints.push(helper("ik_hand_gun", first + 2, at("right hand")));
    joints.push(helper("ik_hand_l", first + 3, at("left hand") - at("right hand")));
    let skeleton = Skeleton::new(joints).unwrap();
    let skinned: Vec<&str> = plain.skeleton.joints().map(|joint| plain.skeleton.name(joint)).collect();
    let model = with_skin(&Asset::from(skeleton), &skinned);
    let turn = Quat::from_rotation_y(1.0) * Quat::from_rotation_x(0.6);
    let turns = ["hips", "left upper leg", "left foot", "left lower arm", "right upper arm"].map(|name| (name, turn));
    let motion = moving(body(PLAIN), &turns);
    let done = retarget(&model, &motion, &map(&model, &motion));
    let rest = places(&model, None);
    for step in 0..=20 {
        let time = step as f32 / 20.0;
        let now = places(&model, Some((&done.clip, time)));
        for (helper, joint) in [("ik_foot_l", "left foot"), ("ik_hand_gun", "right hand"), ("ik_hand_l", "left hand")] {
            let relative = |places: &BTreeMap<&str, Affine3A>| places[joint].inverse() * places[helper];
            let (now, rest) = (relative(&now), relative(&rest));
            assert!(now.translation.distance(rest.translation) < 0.003, "{helper} at {time}: {now:?}, {rest:?}");
            assert!(now.matrix3.abs_diff_eq(rest.matrix3, 0.01), "{helper} at {time}: {now:?}, {rest:?}");
        }
    }
}

/// Where each joint is in model space, at a time of a clip or at rest.
fn places<'a>(asset: &'a Asset, at: Option<(&Clip, f32)>) -> BTreeMap<&'a str, Affine3A> {
    let (skeleton, mut pose) = (&asset.skeleton, asset.skeleton.rest().clone());
    if let Some((clip, time_secs)) = at {
        clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    }
    let mut world = Vec::new();
    model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
    skeleton.joints().map(|joint| (skeleton.name(joint), world[joint.get()])).collect()
}

/// The file with another joint halfway between two that follow each other, and the same for twist joints beside the limbs.
fn with_more_joints(asset: &Asset, slots: &Humanoid) -> Asset {
    let skeleton = &asset.skeleton;
    let in_file: Vec<JointIndex> = (0..skeleton.len()).filter_map(|number| skeleton.joint_of_source(number)).collect();
    let number = |joint: JointIndex| in_file.iter().position(|&other| other == joint);
    let mut joints: Vec<Joint> = in_file
        .iter()
        .map(|&at| joint(skeleton.name(at), skeleton.parent(at).and_then(number), skeleton.rest().local(at)))
        .collect();
    let mut halve = |slot: Slot, is_inside: bool| {
        let Some(below) = slots.joint(slot).and_then(number) else { return };
        let Some(above) = joints[below].parent else { return };
        let half = Transform::from_translation(0.5 * joints[below].rest.translation);
        if is_inside {
            joints[below].parent = Some(joints.len());
            joints[below].rest.translation *= 0.5;
        }
        joints.push(joint(&format!("between {above} and {below}"), Some(above), half));
    };
    halve(Slot::Chest, true);
    halve(Slot::UpperChest, true);
    for slot in [Slot::LeftLowerArm, Slot::LeftHand, Slot::LeftLowerLeg, Slot::LeftFoot] {
        halve(slot, false);
        halve(slot.mirrored(), true);
    }
    declaring(Skeleton::new(joints).unwrap(), skeleton, slots)
}

/// A file with a skeleton that has all joints of another one by number, and declares the same humanoid.
fn declaring(skeleton: Skeleton, of: &Skeleton, slots: &Humanoid) -> Asset {
    let number = |joint: JointIndex| of.source_index(joint);
    let humanoid = slots.0.iter().filter_map(|(&slot, &joint)| Some((slot, skeleton.joint_of_source(number(joint))?)));
    let humanoid = Some(Humanoid(humanoid.collect()));
    Asset::new(AssetParts { humanoid, ..Asset::from(skeleton).into_parts() }).unwrap()
}

/// Spine and twist joints may be added to a real rig: hands, head and feet turn as they did.
#[test]
fn real_rigs_with_more_joints_move_alike() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let named = |name: &str| people.iter().find(|person| person.name == name).unwrap();
    let models = ["Xbot.glb", "RobotExpressive.glb", "human-male.glb", "CesiumMan.glb", "godot_mannequiny.glb"];
    let motions = ["Samba_Dancing.glb", "assimp_Boxing_Toes.bvh", "threejs_pirouette.bvh"];
    let mut checked = 0;
    for (model, motion) in models.iter().flat_map(|model| motions.map(|motion| (named(model), named(motion)))) {
        let skeleton = &model.asset.skeleton;
        let plain = declaring(skeleton.clone(), skeleton, &model.slots);
        let more = with_more_joints(&plain, &model.slots);
        let [wanted, found] = [&plain, &more].map(|asset| ends(asset, motion));
        for (slot, wanted) in wanted {
            let Some(found) = found.get(&slot) else { continue };
            checked += 1;
            for (wanted, found) in wanted.iter().zip(found) {
                let apart = degrees(*wanted, *found);
                assert!(apart < 0.5, "{} ← {}: {slot:?} is turned by {apart}°", model.name, motion.name);
            }
        }
    }
    assert!(checked > 60, "{checked}");
}

/// The file with random names, and with every joint's axes turned at random. Returns these turns by number in the file.
fn renamed_and_rolled(asset: &Asset, slots: &Humanoid, seed: u64) -> (Asset, Vec<DQuat>) {
    let skeleton = &asset.skeleton;
    let mut random = Random(seed);
    let rolls: Vec<DQuat> = (0..skeleton.len()).map(|_| random.rotation(180.0)).collect();
    let number = |joint: JointIndex| skeleton.source_index(joint);
    let mut joints: Vec<Joint> = vec![Joint::default(); skeleton.len()];
    for at in skeleton.joints() {
        let mut rest = skeleton.rest().local(at);
        let above = skeleton.parent(at).map_or(DQuat::IDENTITY, |parent| rolls[number(parent)]).conjugate();
        rest.translation = (above * rest.translation.as_dvec3()).as_vec3();
        rest.rotation = (above * rest.rotation.as_dquat() * rolls[number(at)]).normalize().as_quat();
        joints[number(at)] = joint(&format!("node {}", random.bits()), skeleton.parent(at).map(number), rest);
    }
    let rolled = Skeleton::new(joints).unwrap();
    (declaring(rolled, skeleton, slots), rolls)
}

/// All at once: joints added to the spine and as twist joints, random names, other axes.
#[test]
fn real_rigs_that_differ_in_everything_but_the_body_move_alike() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let motions: Vec<&Loaded> = ["Samba_Dancing.glb", "assimp_Boxing_Toes.bvh"]
        .map(|name| people.iter().find(|person| person.name == name).unwrap())
        .into();
    let mut checked = 0;
    for (seed, model) in (1..).zip(people.iter().filter(|model| model.person.has_mesh)) {
        // Turned axes can't undo a scale that differs by axis, nor a mirror.
        let is_even = |local: Transform| (local.scale - local.scale.x).length() < 1e-3 * local.scale.x;
        let skeleton = &model.asset.skeleton;
        if !skeleton.rest().locals().all(is_even) {
            continue;
        }
        let plain = declaring(skeleton.clone(), skeleton, &model.slots);
        let more = with_more_joints(&plain, &model.slots);
        let slots = recognize(&more).humanoid();
        let (other, rolls) = renamed_and_rolled(&more, &slots, seed);
        let roll = |slot: Slot| {
            let slots = recognize(&other).humanoid();
            rolls[other.skeleton.source_index(slots.joint(slot).unwrap())]
        };
        for motion in &motions {
            let [wanted, found] = [&plain, &other].map(|asset| ends(asset, motion));
            for (slot, wanted) in wanted {
                let Some(found) = found.get(&slot) else { continue };
                checked += 1;
                let back = roll(slot).conjugate();
                for (wanted, found) in wanted.iter().zip(found) {
                    let apart = degrees(*wanted, *found * back);
                    assert!(apart < 0.5, "{} ← {}: {slot:?} is turned by {apart}°", model.name, motion.name);
                }
            }
        }
    }
    assert!(checked > 100, "{checked}");
}

/// Joints that a motion has and doesn't move change nothing.
#[test]
fn motions_with_more_joints_move_everything_alike() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let named = |name: &str| people.iter().find(|person| person.name == name).unwrap();
    let motions = ["Samba_Dancing.glb", "cosc422_Walk.bvh", "threejs_pirouette.bvh"];
    for (model, motion) in ["Xbot.glb", "Knight.glb", "vrm0_cryptovoxels.vrm"]
        .iter()
        .flat_map(|model| motions.map(|motion| (named(model), named(motion))))
    {
        let plain = &motion.asset;
        let more = with_more_joints(plain, &motion.slots);
        let mut clip = ClipBuilder::new("clip", &more.skeleton);
        let source = &plain.clips[motion.clip.unwrap()];
        for channel in source.channels() {
            let joint = more.skeleton.joint_of_source(plain.skeleton.source_index(channel.joint)).unwrap();
            let times = &source.timelines()[channel.timeline as usize];
            let mut keys = channel.keys.clone();
            if let Keys::Translation(values) = &mut keys {
                // Half of the way is the new joint's.
                let rest = |asset: &Asset, joint| asset.skeleton.rest().local(joint).translation;
                let scale = rest(&more, joint).length() / rest(plain, channel.joint).length().max(f32::EPSILON);
                let scale = if rest(plain, channel.joint).length() > 0.0 { scale } else { 1.0 };
                values.iter_mut().for_each(|value| *value *= scale);
            }
            clip.channel(joint, channel.interpolation, times, keys).unwrap();
        }
        let more = Asset::new(AssetParts { clips: vec![clip.build()], ..more.into_parts() }).unwrap();
        let plain = with_clip_of(
            declaring(plain.skeleton.clone(), &plain.skeleton, &motion.slots),
            &Asset::new(AssetParts { clips: vec![source.clone()], ..Asset::from(plain.skeleton.clone()).into_parts() })
                .unwrap(),
        );
        let clips = [&plain, &more].map(|motion| retarget(&model.asset, motion, &map(&model.asset, motion)).clip);
        for step in 0..=20 {
            let time = clips[0].duration_secs() * step as f32 / 20.0;
            let [wanted, found] = [0, 1].map(|at: usize| model_rotations(&model.asset.skeleton, &clips[at], time));
            for joint in model.asset.skeleton.joints() {
                let apart = degrees(wanted[joint.get()], found[joint.get()]);
                let name = model.asset.skeleton.name(joint);
                assert!(apart < 0.5, "{} ← {}: {name} is turned by {apart}° at {time}", model.name, motion.name);
            }
        }
    }
}

/// The rotations in model space of hands, head and feet over a motion.
fn ends(model: &Asset, motion: &Loaded) -> BTreeMap<Slot, Vec<DQuat>> {
    let map = map(model, &motion.asset);
    assert_eq!(map.chains, Chains::Share);
    let slots = recognize(model).humanoid();
    let clip = motion.clip.unwrap();
    let body = Body { asset: model, slots: &slots };
    let done = Retargeting::new(body, motion.body(), clip, &map).unwrap().bake().unwrap();
    let times: Vec<f32> = (0..=20).map(|step| done.clip.duration_secs() * step as f32 / 20.0).collect();
    let poses: Vec<Vec<DQuat>> = times.iter().map(|&time| model_rotations(&model.skeleton, &done.clip, time)).collect();
    let of = |joint: JointIndex| poses.iter().map(|pose| pose[joint.get()]).collect();
    let parts = [Slot::Head, Slot::LeftHand, Slot::RightHand, Slot::LeftFoot, Slot::RightFoot];
    parts.into_iter().filter_map(|slot| Some((slot, of(slots.joint(slot)?)))).collect()
}

/// `LeftHandIndex` may be a bone in the palm above `LeftHandIndex1`, or the first of the phalanges itself.
#[test]
fn a_finger_begins_with_its_first_phalanx() {
    let first = |lengths: [f32; 4]| {
        let mut builder = Builder { joints: Vec::new() };
        let plain = body(PLAIN);
        for at in plain.skeleton.joints() {
            let parent = plain.skeleton.parent(at).map(JointIndex::get);
            builder.joints.push(joint(plain.skeleton.name(at), parent, plain.skeleton.rest().local(at)));
        }
        let mut above = "left hand".to_owned();
        for (number, length) in ["", "1", "2", "3"].into_iter().zip(lengths) {
            let name = format!("LeftHandIndex{number}");
            builder.add(&name, &above, [length, 0.0, 0.0]);
            above = name;
        }
        let asset = Asset::from(Skeleton::new(builder.joints).unwrap());
        let joint = recognize(&asset).joint(Slot::LeftIndexProximal).unwrap();
        asset.skeleton.name(joint).to_owned()
    };
    assert_eq!(first([0.03, 0.05, 0.04, 0.025]), "LeftHandIndex1");
    assert_eq!(first([0.09, 0.04, 0.03, 0.02]), "LeftHandIndex");
}
