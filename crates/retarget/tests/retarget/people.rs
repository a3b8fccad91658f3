//! Real characters and motions, and the result of retargeting each pair.

use std::path::Path;

use gaitway_character::anim::{Clip, JointIndex, Pose, SampleCursor, Skeleton, model_from_joint};
use gaitway_character::asset::{Asset, Humanoid, Slot};
use gaitway_formats::{FileSet, load};
use gaitway_retarget::{Body, Feet, Figures, ResolvedMap, Retargeted, Retargeting, propose, recognize};
use glam::{Affine3A, DQuat};

use crate::data_folder::data_folder;

/// A file with a person: its path under the data folder, and the clip to retarget; none for targets only.
pub struct Person {
    pub file: &'static str,
    pub clip: Option<&'static str>,
    pub has_mesh: bool,
}

const fn person(file: &'static str, clip: &'static str) -> Person {
    Person { file, clip: Some(clip), has_mesh: true }
}

const fn borrower(file: &'static str) -> Person {
    Person { file, clip: None, has_mesh: true }
}

/// A motion whose only clip is used.
const fn motion(file: &'static str) -> Person {
    Person { file, clip: Some(""), has_mesh: false }
}

pub const PEOPLE: [Person; 37] = [
    person("threejs/Xbot.glb", "walk"),
    person("threejs/Soldier.glb", "Run"),
    person("threejs/Samba_Dancing.glb", ""),
    person("threejs/RobotExpressive.glb", "Walking"),
    person("mesh2motion/retarget/mixamo-original-rig.glb", ""),
    person("mesh2motion/retarget/m2m-sample-rig.glb", ""),
    person("mesh2motion/retarget/mixamo-sample-rig.glb", ""),
    borrower("mesh2motion/human-male.glb"),
    borrower("mesh2motion/human-zombie.glb"),
    borrower("mesh2motion/human-interleaved-buffer-mesh.glb"),
    person("kaykit/Knight.glb", "Walking_A"),
    person("misc/godot_mannequiny.glb", "run_root.001"),
    borrower("misc/babylon_riggedMesh.glb"),
    borrower("cosc422/mannequin.glb"),
    person("cosc422/ArmyPilot.glb", "Run_Forwards"),
    person("cosc422/dwarf.glb", ""),
    person("khronos/CesiumMan/glTF-Binary/CesiumMan.glb", ""),
    person("khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb", ""),
    borrower("playcanvas/bitmoji.glb"),
    borrower("vrm/vrm0_cryptovoxels.vrm"),
    motion("cosc422/mannequin_run.glb"),
    motion("mesh2motion/cmu_91_48.glb"),
    motion("vrm/three-vrm_test.vrma"),
    motion("vrm/chatvrm_idle_loop.vrma"),
    motion("cosc422/original/Dwarf/avatar_walk.bvh"),
    motion("bvh/cmu_01_01.bvh"),
    motion("bvh/assimp_Boxing_Toes.bvh"),
    motion("bvh/animateddrawings_cmu1_jumping_jacks.bvh"),
    motion("bvh/animateddrawings_fair1_dab.bvh"),
    motion("bvh/animateddrawings_fair1_zombie.bvh"),
    motion("bvh/animateddrawings_rokoko_jesse_dance.bvh"),
    motion("bvh/threejs_pirouette.bvh"),
    motion("bvh/cosc422_Dance.bvh"),
    motion("bvh/cosc422_Walk.bvh"),
    motion("bvh/deepmotion_xia_neutral_16_000.bvh"),
    motion("bvh/deepmotion_xia_depressed_18_000.bvh"),
    motion("bvh/deepmotion_blender_example.bvh"),
];

/// Read once, used in many pairs.
pub struct Loaded {
    pub person: &'static Person,
    pub name: &'static str,
    pub asset: Asset,
    pub slots: Humanoid,
    pub clip: Option<usize>,
}

pub fn load_people(folder: &Path) -> Vec<Loaded> {
    PEOPLE.iter().map(|person| load_person(folder, person)).collect()
}

/// Loads the person of one file.
pub fn load_one(folder: &Path, name: &str) -> Loaded {
    let person = PEOPLE.iter().find(|person| person.file.ends_with(name));
    load_person(folder, person.unwrap_or_else(|| panic!("{name} is no person")))
}

/// Calls a test with each of these characters, each of these motions, and the proposed map.
pub fn with_pairs(models: &[&str], motions: &[&str], check: impl Fn(&Loaded, &Loaded, ResolvedMap)) {
    let Some(folder) = data_folder() else { return };
    let load = |names: &[&str]| names.iter().map(|name| load_one(&folder, name)).collect::<Vec<_>>();
    let motions = load(motions);
    for model in load(models) {
        for motion in &motions {
            check(&model, motion, proposed(&model, motion).unwrap());
        }
    }
}

fn load_person(folder: &Path, person: &'static Person) -> Loaded {
    let bytes = std::fs::read(folder.join(person.file)).unwrap_or_else(|error| panic!("{}: {error}", person.file));
    let name = person.file.rsplit('/').next().unwrap_or(person.file);
    let mut files = FileSet::default();
    files.insert(name, bytes);
    let asset = load(&files).unwrap_or_else(|error| panic!("{error}"));
    let slots = recognize(&asset).humanoid();
    let clip = person.clip.map(|clip| {
        let found = asset.clips.iter().position(|other| clip.is_empty() || other.name() == clip);
        found.unwrap_or_else(|| panic!("{name} has no clip {clip}"))
    });
    Loaded { person, name, asset, slots, clip }
}

/// Every character with every motion of another file.
pub fn each_pair(people: &[Loaded]) -> impl Iterator<Item = (&Loaded, &Loaded)> {
    let models = people.iter().filter(|model| model.person.has_mesh);
    models.flat_map(|model| {
        let motions = people.iter().filter(move |motion| motion.clip.is_some() && !std::ptr::eq(model, *motion));
        motions.map(move |motion| (model, motion))
    })
}

impl Loaded {
    pub fn body(&self) -> Body<'_> {
        Body { asset: &self.asset, slots: &self.slots }
    }
}

/// The result of one pair.
pub struct Outcome {
    pub mapped: usize,
    pub figures: Figures,
    pub planted: Option<Figures>,
    pub hips_scale: Option<f64>,
}

/// The columns of `docs/retargeting-pairs.tsv` after model and motion, with their decimal places.
pub const COLUMNS: [(&str, usize); 17] = [
    ("joints", 0),
    ("coverage", 2),
    ("hips_scale", 3),
    ("limb_direction_error_mean_deg", 2),
    ("limb_direction_error_max_deg", 1),
    ("facing_error_mean_deg", 2),
    ("facing_error_max_deg", 1),
    ("orientation_error_mean_deg", 3),
    ("orientation_error_max_deg", 2),
    ("foot_slide_m_per_s", 3),
    ("foot_slide_source_m_per_s", 3),
    ("foot_slide_planted_m_per_s", 3),
    ("foot_hover_m", 3),
    ("foot_hover_planted_m", 3),
    ("sole_penetration_max_m", 3),
    ("sole_penetration_planted_max_m", 3),
    ("ground_penetration_max_m", 3),
];

impl Outcome {
    /// One value per column; none where there is nothing to measure.
    pub fn values(&self) -> [Option<f64>; COLUMNS.len()] {
        let figures = &self.figures;
        [
            Some(self.mapped as f64),
            figures.coverage,
            self.hips_scale,
            figures.limb_direction_error_degrees_mean,
            figures.limb_direction_error_degrees_max,
            figures.facing_error_degrees_mean,
            figures.facing_error_degrees_max,
            figures.orientation_error_degrees_mean,
            figures.orientation_error_degrees_max,
            figures.foot_slide_metres_per_sec,
            figures.foot_slide_source_metres_per_sec,
            self.planted.as_ref().and_then(|planted| planted.foot_slide_metres_per_sec),
            figures.foot_hover_metres_mean,
            self.planted.as_ref().and_then(|planted| planted.foot_hover_metres_mean),
            figures.sole_penetration_metres_max,
            self.planted.as_ref().and_then(|planted| planted.sole_penetration_metres_max),
            figures.ground_penetration_metres_max,
        ]
    }

    /// The values as the file writes them.
    pub fn cells(&self) -> [String; COLUMNS.len()] {
        let values = self.values();
        std::array::from_fn(|column| {
            let digits = COLUMNS[column].1;
            values[column].map_or(String::new(), |value| format!("{value:.digits$}"))
        })
    }
}

/// Retargets the motion's clip to the model with the proposed map.
pub fn borrow(model: &Loaded, motion: &Loaded, plant: bool) -> Result<Outcome, String> {
    let map = proposed(model, motion)?;
    let (figures, made) = measured(model, motion, &map)?;
    let planted = if plant { Some(measured(model, motion, &planted(map.clone()))?.0) } else { None };
    Ok(Outcome { mapped: map.pairs.len(), figures, planted, hips_scale: made.hips_scale })
}

pub fn proposed(model: &Loaded, motion: &Loaded) -> Result<ResolvedMap, String> {
    let map = propose(&model.asset, &motion.asset).to_map(&model.asset, &motion.asset);
    map.resolve(&model.asset, &motion.asset).map_err(|error| error.to_string())
}

pub fn planted(map: ResolvedMap) -> ResolvedMap {
    ResolvedMap { feet: Feet::Plant, ..map }
}

pub fn measured(model: &Loaded, motion: &Loaded, map: &ResolvedMap) -> Result<(Figures, Retargeted), String> {
    let clip = motion.clip.ok_or("no clip")?;
    let pair = Retargeting::new(model.body(), motion.body(), clip, map).map_err(|error| error.to_string())?;
    let made = pair.bake().map_err(|error| error.to_string())?;
    Ok((pair.figures(&made), made))
}

/// The largest angle in degrees by which a leg joint turns more than its source within 1/60 s. Both arrays hold the
/// model's item first, then the motion's.
pub fn largest_excess_turn(assets: [&Asset; 2], clips: [&Clip; 2], map: &ResolvedMap, slots: &Humanoid) -> f64 {
    const LEGS: [Slot; 6] = [
        Slot::LeftUpperLeg,
        Slot::LeftLowerLeg,
        Slot::LeftFoot,
        Slot::RightUpperLeg,
        Slot::RightLowerLeg,
        Slot::RightFoot,
    ];
    let targets: Vec<_> = LEGS.iter().filter_map(|&slot| slots.joint(slot)).collect();
    let is_leg = |target| targets.contains(target);
    let legs: Vec<[usize; 2]> = map
        .pairs
        .iter()
        .filter(|pair| is_leg(&pair.target))
        .map(|pair| [pair.target.get(), pair.source.get()])
        .collect();
    let at =
        |frame: usize| [0, 1].map(|side| model_rotations(&assets[side].skeleton, clips[side], frame as f32 / 60.0));
    let mut largest: f64 = 0.0;
    let mut before = at(0);
    for frame in 1..=(clips[1].duration_secs() * 60.0) as usize {
        let now = at(frame);
        for leg in &legs {
            let [target, source] = [0, 1].map(|side| {
                let turn = before[side][leg[side]].conjugate() * now[side][leg[side]];
                (2.0 * turn.xyz().length().atan2(turn.w.abs())).to_degrees()
            });
            largest = largest.max(target - source);
        }
        before = now;
    }
    largest
}

/// The share of a clip's time, at 30 frames per second, in which the left ankle is to the right of the right one, along the line
/// through both hip joints. `None` if the body has no legs.
pub fn crossed_share(skeleton: &Skeleton, clip: &Clip, slots: &Humanoid) -> Option<f64> {
    let legs = [Slot::LeftUpperLeg, Slot::RightUpperLeg, Slot::LeftFoot, Slot::RightFoot];
    let [Some(left_hip), Some(right_hip), Some(left_ankle), Some(right_ankle)] = legs.map(|slot| slots.joint(slot))
    else {
        return None;
    };
    let frames = (clip.duration_secs() * 30.0) as usize;
    let (mut pose, mut cursor, mut world) = (Pose::default(), SampleCursor::default(), Vec::new());
    let crossed = (0..=frames).filter(|&frame| {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, frame as f32 / 30.0, &mut cursor, &mut pose);
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
        let at = |joint: JointIndex| world[joint.get()].translation;
        (at(left_ankle) - at(right_ankle)).dot(at(left_hip) - at(right_hip)) < 0.0
    });
    Some(crossed.count() as f64 / (frames + 1) as f64)
}

/// Model-space rotations of all joints, in double precision.
pub fn model_rotations(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Vec<DQuat> {
    let mut pose: Pose = skeleton.rest().clone();
    clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    let mut rotations: Vec<DQuat> = Vec::new();
    for (local, parent) in pose.locals().zip(skeleton.parents()) {
        let parent = parent.map_or(DQuat::IDENTITY, |parent| rotations[parent.get()]);
        rotations.push((parent * local.rotation.as_dquat()).normalize());
    }
    rotations
}
