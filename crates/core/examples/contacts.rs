//! Prints the figures of `contacts: keep` beside those without, for every character with a mesh and the dances and gestures of the
//! test data in `$GAITWAY_DATA`: `cargo run --release -p gaitway-core --example contacts [plant] [every=N] [MODEL<MOTION]`.

// The people of the tests name the package as users do.
extern crate gaitway_core as gaitway;

#[path = "../../../tests/support/data_folder.rs"]
mod data_folder;
#[allow(dead_code, reason = "shared with the tests")]
#[path = "../../../tests/retarget/people.rs"]
mod people;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use gaitway::anim::{Clip, JointIndex, Pose, SampleCursor, Skeleton, model_from_joint};
use gaitway::asset::{MeshInstance, Slot};
use gaitway::mesh::{DeformedVertices, Geometry, Skin, SkinningMode, deform, write_palette};
use gaitway::retarget::{Contacts, Figures, ResolvedMap, Retargeting};
use glam::{Affine3A, Vec3};
use people::{Loaded, load_people, planted, proposed};

/// Dances and gestures, by which the limits in `retarget/contacts` were chosen: files, and their clips unless they have only one.
const TUNED: [(&str, &str); 14] = [
    ("Samba_Dancing.glb", ""),
    ("RobotExpressive.glb", "Dance"),
    ("Knight.glb", "Cheer"),
    ("ArmyPilot.glb", "Idle_Reload"),
    ("Xbot.glb", "sad_pose"),
    ("mixamo-original-rig.glb", ""),
    ("animateddrawings_rokoko_jesse_dance.bvh", ""),
    ("cosc422_Dance.bvh", ""),
    ("animateddrawings_fair1_dab.bvh", ""),
    ("animateddrawings_fair1_zombie.bvh", ""),
    ("animateddrawings_cmu1_jumping_jacks.bvh", ""),
    ("threejs_pirouette.bvh", ""),
    ("assimp_Boxing_Toes.bvh", ""),
    ("chatvrm_idle_loop.vrma", ""),
];

/// Other motions; docs/retargeting.md says what was chosen with them in view.
const OTHERS: [(&str, &str); 14] = [
    ("RobotExpressive.glb", "Wave"),
    ("RobotExpressive.glb", "Sitting"),
    ("Knight.glb", "Interact"),
    ("Knight.glb", "Sit_Floor_Idle"),
    ("Knight.glb", "Sit_Chair_Idle"),
    ("Knight.glb", "Unarmed_Idle"),
    ("ArmyPilot.glb", "Standing_2"),
    ("Xbot.glb", "sneak_pose"),
    ("Soldier.glb", "Idle"),
    ("godot_mannequiny.glb", "idle_root.001"),
    ("godot_mannequiny.glb", "fight_idle_root.001"),
    ("mixamo-sample-rig.glb", ""),
    ("three-vrm_test.vrma", ""),
    ("deepmotion_blender_example.bvh", ""),
];

/// Figures of one clip, and the time that it took to bake.
struct Row {
    figures: Figures,
    /// Independent of the solids: by winding numbers of the skinned mesh.
    inside_mesh: Option<f64>,
    millis: f64,
    secs: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let plant = arguments.iter().any(|argument| argument == "plant");
    let every = arguments.iter().find_map(|argument| argument.strip_prefix("every=")?.parse().ok()).unwrap_or(1);
    let name = arguments.iter().find(|argument| argument.contains('<'));
    let folder = data_folder::data_folder().ok_or("no test data")?;
    let people = load_people(&folder);
    println!(
        "model\tmotion\tsolids\tkept\tmesh\tkept\terror\tkept\tlimbs\tkept\tslide\tkept\tjerk\tkept\tturn\tkept\tms\tkept"
    );
    let mut all: Vec<[Row; 2]> = Vec::new();
    for (set, motions) in [("tuned", &TUNED[..]), ("others", &OTHERS)] {
        let mut pairs: Vec<(&Loaded, &Loaded, usize)> = Vec::new();
        for (file, clip) in motions {
            let motion = people.iter().find(|person| person.name == *file).ok_or(*file)?;
            let clips = &motion.asset.clips;
            let clip = clips.iter().position(|other| clip.is_empty() || other.name() == *clip).ok_or(*clip)?;
            let models = people.iter().filter(|model| model.person.has_mesh && model.name != *file);
            pairs.extend(models.map(|model| (model, motion, clip)));
        }
        let is_wanted = |(model, motion, _): &(&Loaded, &Loaded, usize)| {
            name.is_none_or(|name| format!("{}<{}", model.name, motion.name).contains(name.as_str()))
        };
        let pairs: Vec<_> = pairs.into_iter().skip(every - 1).step_by(every).filter(is_wanted).collect();
        let rows = measured(&pairs, plant)?;
        print_means(set, &rows);
        all.extend(rows);
    }
    print_means("all", &all);
    Ok(())
}

/// Measures and prints pairs on all cores, without contacts kept and with; those without a mesh aren't returned.
fn measured(pairs: &[(&Loaded, &Loaded, usize)], plant: bool) -> Result<Vec<[Row; 2]>, String> {
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(Vec::new());
    let work = || -> Result<(), String> {
        while let Some(&(model, motion, clip)) = pairs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let map = proposed(model, motion)?;
            let map = if plant { planted(map) } else { map };
            let [off, keep] = [Contacts::Off, Contacts::Keep]
                .map(|contacts| row(model, motion, clip, &ResolvedMap { contacts, ..map.clone() }));
            let pair = [off?, keep?];
            if pair[0].figures.self_penetration_share.is_some() {
                let name = format!("{}\t{} {}", model.name, motion.name, motion.asset.clips[clip].name());
                print_row(&name, &pair.each_ref().map(values));
                rows.lock().map_err(|error| error.to_string())?.push(pair);
            }
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a thread panicked".to_owned())?)
    })?;
    rows.into_inner().map_err(|error| error.to_string())
}

fn print_means(set: &str, rows: &[[Row; 2]]) {
    let mean = |side: usize, column: usize| {
        let values: Vec<f64> = rows.iter().filter_map(|row| values(&row[side])[column]).collect();
        Some(values.iter().sum::<f64>() / values.len() as f64)
    };
    let secs: f64 = rows.iter().map(|row| row[1].secs).sum();
    let millis: f64 = rows.iter().map(|row| row[1].millis).sum();
    println!("{set}: {:.1} ms per 10 s", 10.0 * millis / secs);
    let means = [0, 1].map(|side| std::array::from_fn(|column| mean(side, column)));
    print_row(&format!("{set}, mean of {}\t", rows.len()), &means);
}

fn print_row(name: &str, sides: &[[Option<f64>; 8]; 2]) {
    let digits = [4, 4, 4, 2, 3, 1, 1, 1];
    let cell = |side: usize, column: usize| {
        sides[side][column].map_or("–".to_owned(), |value| format!("{value:.0$}", digits[column]))
    };
    let cells: Vec<String> = (0..8).flat_map(|column| [cell(0, column), cell(1, column)]).collect();
    println!("{name}\t{}", cells.join("\t"));
}

fn values(row: &Row) -> [Option<f64>; 8] {
    let Figures {
        self_penetration_share,
        contact_error_metres_mean,
        limb_direction_error_degrees_mean,
        foot_slide_metres_per_sec,
        largest_turn_degrees_per_frame,
        jerk_metres_per_sec3_mean,
        ..
    } = row.figures;
    [
        self_penetration_share,
        row.inside_mesh,
        contact_error_metres_mean,
        limb_direction_error_degrees_mean,
        foot_slide_metres_per_sec,
        jerk_metres_per_sec3_mean,
        largest_turn_degrees_per_frame,
        Some(row.millis),
    ]
}

fn row(model: &Loaded, motion: &Loaded, clip: usize, map: &ResolvedMap) -> Result<Row, String> {
    let start = Instant::now();
    let pair = Retargeting::new(model.body(), motion.body(), clip, map).map_err(|error| error.to_string())?;
    let made = pair.bake().map_err(|error| error.to_string())?;
    let millis = 1000.0 * start.elapsed().as_secs_f64();
    let mut figures = pair.figures(&made);
    // Models come in metres and in centimetres.
    let height = height(&model.asset.skeleton);
    let lengths = [
        &mut figures.contact_error_metres_mean,
        &mut figures.foot_slide_metres_per_sec,
        &mut figures.jerk_metres_per_sec3_mean,
    ];
    for length in lengths {
        *length = length.map(|length| 1.7 * length / height);
    }
    let inside_mesh = mesh_penetration(model, &made.clip);
    Ok(Row { figures, inside_mesh, millis, secs: f64::from(made.clip.duration_secs()) })
}

fn height(skeleton: &Skeleton) -> f64 {
    let mut world = Vec::new();
    model_from_joint(skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut world);
    let size = |axis: usize| {
        let values = world.iter().map(|joint| joint.translation[axis]);
        values.clone().fold(f32::MIN, f32::max) - values.fold(f32::MAX, f32::min)
    };
    f64::from(size(1).max(size(2)).max(1e-6))
}

/// Regions of the body, and the slots in them that are limb ends.
const REGIONS: [(&[Slot], &[Slot]); 5] = {
    use Slot::*;
    [
        (&[Hips, Spine, Chest, UpperChest, Neck, Head], &[]),
        (&[LeftUpperArm, LeftLowerArm, LeftHand], &[LeftLowerArm, LeftHand]),
        (&[RightUpperArm, RightLowerArm, RightHand], &[RightLowerArm, RightHand]),
        (&[LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes], &[LeftLowerLeg, LeftFoot, LeftToes]),
        (&[RightUpperLeg, RightLowerLeg, RightFoot, RightToes], &[RightLowerLeg, RightFoot, RightToes]),
    ]
};

const MAX_LIMB_POINTS: usize = 240;
const MAX_FRAMES: usize = 40;

/// The skinned mesh: triangles by region, and points of limb ends.
struct Surface {
    vertices: Vec<Vec3>,
    triangles: [Vec<[usize; 3]>; 5],
    points: Vec<(usize, usize)>,
}

impl Surface {
    fn new(model: &Loaded) -> Self {
        let part_of: Vec<_> = model.asset.skeleton.joints().map(|joint| part_of(model, joint)).collect();
        let mut surface = Self { vertices: Vec::new(), triangles: Default::default(), points: Vec::new() };
        let mut count = 0;
        for instance in &model.asset.instances {
            let skin = instance.skin.map(|skin| &model.asset.skins[skin]);
            for geometry in &model.asset.meshes[instance.mesh].primitives {
                let part = |vertex: usize| {
                    let joint = joint_of(instance, skin, geometry, vertex);
                    part_of[joint.get()].filter(|_| skin.is_some() || model.slots.slot(joint).is_some())
                };
                let vertices = geometry.positions.len();
                for triangle in geometry.indices.chunks_exact(3) {
                    let triangle = [triangle[0], triangle[1], triangle[2]].map(|index| index as usize);
                    let region = part(triangle[0]).map(|(region, _)| &mut surface.triangles[region]);
                    region.into_iter().for_each(|region| region.push(triangle.map(|index| count + index)));
                }
                surface.points.extend((0..vertices).filter_map(|vertex| {
                    let (region, _) = part(vertex).filter(|(_, is_end)| *is_end)?;
                    Some((count + vertex, region))
                }));
                count += vertices;
            }
        }
        let step = surface.points.len().div_ceil(MAX_LIMB_POINTS).max(1);
        surface.points = surface.points.into_iter().step_by(step).collect();
        surface
    }

    fn pose(&mut self, model: &Loaded, pose: &Pose) {
        let mut world = Vec::new();
        model_from_joint(&model.asset.skeleton, pose, Affine3A::IDENTITY, &mut world);
        self.vertices.clear();
        let (mut palette, mut out) = (Vec::new(), DeformedVertices::default());
        for instance in &model.asset.instances {
            palette.clear();
            match instance.skin {
                Some(skin) => write_palette(&model.asset.skins[skin], &world, SkinningMode::Linear, &mut palette),
                None => palette.push(gaitway::mesh::palette_entry(
                    &(world[instance.joint.get()] * instance.joint_from_mesh),
                    SkinningMode::Linear,
                )),
            }
            for geometry in &model.asset.meshes[instance.mesh].primitives {
                deform(geometry, &[], &palette, SkinningMode::Linear, &mut out);
                self.vertices.extend(&out.positions);
            }
        }
    }

    /// Whether each point is inside other regions, one bit each. Arms are tested against all others, legs against the other leg.
    fn inside(&self) -> Vec<u8> {
        let boxes = self.triangles.each_ref().map(|triangles| {
            triangles.iter().flatten().fold((Vec3::MAX, Vec3::MIN), |(low, high), &vertex| {
                (low.min(self.vertices[vertex]), high.max(self.vertices[vertex]))
            })
        });
        let inside = |&(vertex, own): &(usize, usize)| {
            let point = self.vertices[vertex];
            (0..5).filter(|&region| region != own && (own < 3 || region >= 3)).fold(0, |bits, region| {
                let (low, high) = boxes[region];
                let is_near = point.cmpge(low).all() && point.cmple(high).all();
                if is_near && self.winding(region, point).abs() > 0.5 { bits | 1 << region } else { bits }
            })
        };
        self.points.iter().map(inside).collect()
    }

    fn winding(&self, region: usize, point: Vec3) -> f32 {
        let angles = self.triangles[region].iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| self.vertices[vertex] - point);
            let [la, lb, lc] = [a, b, c].map(Vec3::length);
            a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        });
        angles.sum::<f32>() / std::f32::consts::TAU
    }
}

/// The region that a joint is in, and whether it is a limb's end.
fn part_of(model: &Loaded, joint: JointIndex) -> Option<(usize, bool)> {
    let in_region = |joint: JointIndex| {
        REGIONS.iter().enumerate().find_map(|(region, (slots, ends))| {
            let slot = slots.iter().find(|&&slot| model.slots.joint(slot) == Some(joint))?;
            Some((region, ends.contains(slot)))
        })
    };
    std::iter::successors(Some(joint), |&joint| model.asset.skeleton.parent(joint)).find_map(in_region)
}

/// The joint that a vertex follows most.
fn joint_of(instance: &MeshInstance, skin: Option<&Skin>, geometry: &Geometry, vertex: usize) -> JointIndex {
    let Some(skin) = skin.filter(|_| !geometry.influences.is_empty()) else { return instance.joint };
    let strongest = geometry.influences.of_vertex(vertex).max_by(|a, b| a.1.total_cmp(&b.1));
    skin.joints()[usize::from(strongest.map_or(0, |(joint, _)| joint))]
}

/// Share of the vertices of limb ends that are inside other regions of the body, and aren't at rest.
fn mesh_penetration(model: &Loaded, clip: &Clip) -> Option<f64> {
    let skeleton = &model.asset.skeleton;
    let mut surface = Surface::new(model);
    if surface.points.is_empty() {
        return None;
    }
    let mut pose = skeleton.rest().clone();
    surface.pose(model, &pose);
    let at_rest = surface.inside();
    let mut cursor = SampleCursor::default();
    let mut count = 0;
    for frame in 0..MAX_FRAMES {
        pose.copy_from(skeleton.rest());
        let time = clip.duration_secs() * (frame as f32 + 0.5) / MAX_FRAMES as f32;
        clip.sample(skeleton, time, &mut cursor, &mut pose);
        surface.pose(model, &pose);
        count += surface.inside().iter().zip(&at_rest).filter(|(now, rest)| **now & !**rest != 0).count();
    }
    Some(count as f64 / (MAX_FRAMES * surface.points.len()) as f64)
}
