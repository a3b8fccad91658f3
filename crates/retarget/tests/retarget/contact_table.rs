//! The figures of `contacts: keep` beside those without, for every character with a mesh and the dances and gestures of the test data.
//! `UPDATE_PAIRS=1` rewrites the published table, docs/retargeting-contacts.tsv, and prints its means.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use gaitway_character::anim::{Skeleton, model_from_joint};
use gaitway_retarget::{Contacts, ResolvedMap, Retargeting};
use glam::Affine3A;

use crate::data_folder::data_folder;
use crate::people::{Loaded, load_people, proposed};
use crate::surface::mesh_penetration;

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

/// The tuned motions whose hands rest on the ground.
const GROUND: [&str; 2] = ["mixamo-original-rig.glb", "assimp_Boxing_Toes.bvh"];

/// The figures of a row, each without contacts kept and with, and their decimal places. Lengths are for a height of 1.7 m.
const COLUMNS: [(&str, usize); 7] = [
    ("self_penetration_share", 4),
    ("mesh_penetration_share", 4),
    ("contact_error_m", 4),
    ("limb_direction_error_mean_deg", 2),
    ("foot_slide_m_per_s", 3),
    ("jerk_m_per_s3", 1),
    ("largest_turn_deg_per_frame", 1),
];
const BY_SOLIDS: usize = 0;
const BY_MESH: usize = 1;
const CONTACT_ERROR: usize = 2;
const LIMBS: usize = 3;
const SLIDE: usize = 4;
const JERK: usize = 5;

/// None where there is nothing to measure.
type Values = [Option<f64>; COLUMNS.len()];

/// A motion's clip on a model, without contacts kept and with.
struct Row {
    name: String,
    is_tuned: bool,
    values: [Values; 2],
}

/// A model, and a motion with its clip.
struct Case<'a> {
    model: &'a Loaded,
    motion: &'a Loaded,
    clip: usize,
    is_tuned: bool,
}

fn cases(people: &[Loaded]) -> Vec<Case<'_>> {
    let mut cases = Vec::new();
    for (motions, is_tuned) in [(TUNED, true), (OTHERS, false)] {
        for (file, name) in motions {
            let motion = people.iter().find(|person| person.name == file).expect(file);
            let clips = &motion.asset.clips;
            let clip = clips.iter().position(|other| name.is_empty() || other.name() == name).expect(name);
            let models = people.iter().filter(|model| model.person.has_mesh && model.name != file);
            cases.extend(models.map(|model| Case { model, motion, clip, is_tuned }));
        }
    }
    cases
}

/// Measures on all cores; models whose body has no mesh have no row.
fn measured(cases: &[Case]) -> Vec<Row> {
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(Vec::new());
    let work = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(at) else { return };
            if let Some(row) = row(case) {
                rows.lock().unwrap().push((at, row));
            }
        }
    };
    std::thread::scope(|scope| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        (0..cores).for_each(|_| drop(scope.spawn(work)));
    });
    let mut rows = rows.into_inner().unwrap();
    rows.sort_by_key(|(at, _)| *at);
    rows.into_iter().map(|(_, row)| row).collect()
}

fn row(&Case { model, motion, clip, is_tuned }: &Case) -> Option<Row> {
    let map = proposed(model, motion).unwrap();
    let name = format!("{}\t{}\t{}", model.name, motion.name, motion.asset.clips[clip].name());
    let values = [Contacts::Off, Contacts::Keep].map(|contacts| {
        let map = ResolvedMap { contacts, ..map.clone() };
        let pair = Retargeting::new(model.body(), motion.body(), clip, &map).unwrap();
        let made = pair.bake().unwrap();
        let figures = pair.figures(&made);
        // Models come in metres and in centimetres.
        let metres = |value: Option<f64>| value.map(|value| 1.7 * value / height(&model.asset.skeleton));
        [
            figures.self_penetration_share,
            mesh_penetration(model, &made.clip),
            metres(figures.contact_error_metres_mean),
            figures.limb_direction_error_degrees_mean,
            metres(figures.foot_slide_metres_per_sec),
            metres(figures.jerk_metres_per_sec3_mean),
            figures.largest_turn_degrees_per_frame,
        ]
    });
    values[0][BY_SOLIDS]?;
    Some(Row { name, is_tuned, values })
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

/// Means of a column over rows that have it, without contacts kept and with.
fn means(rows: &[&Row], column: usize) -> [f64; 2] {
    [0, 1].map(|side| {
        let values: Vec<f64> = rows.iter().filter_map(|row| row.values[side][column]).collect();
        values.iter().sum::<f64>() / values.len() as f64
    })
}

/// What docs/retargeting.md promises: less of the limbs inside the body, contacts that meet, and nothing else much worse.
fn check_means(rows: &[&Row]) {
    let [solids, mesh, error, limbs, slide, jerk] =
        [BY_SOLIDS, BY_MESH, CONTACT_ERROR, LIMBS, SLIDE, JERK].map(|column| means(rows, column));
    assert!(solids[0] > 0.01 && solids[1] < 0.6 * solids[0], "inside the body, by solids: {solids:?}");
    assert!(mesh[0] > 0.01 && mesh[1] < 0.6 * mesh[0], "inside the body, by the mesh: {mesh:?}");
    assert!(error[0] > 0.05 && error[1] < 0.5 * error[0], "contact error: {error:?}");
    assert!(limbs[1] <= limbs[0] + 1.5, "limb direction error: {limbs:?}");
    assert!(slide[1] <= slide[0] + 5e-4, "foot slide: {slide:?}");
    assert!(jerk[1] <= 1.1 * jerk[0], "jerk: {jerk:?}");
}

#[test]
fn published_contacts_meet_their_targets() {
    let published = published();
    assert!(published.len() > 500, "{}", published.len());
    check_means(&published.iter().collect::<Vec<&Row>>());
}

/// Every ninth row of the published table is measured again.
#[test]
fn kept_contacts_are_as_published() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let cases = cases(&people);
    if std::env::var_os("UPDATE_PAIRS").is_some() {
        return update(&measured(&cases));
    }
    let published = published();
    let sample: Vec<Case> = cases.into_iter().skip(8).step_by(9).collect();
    let rows = measured(&sample);
    assert!(rows.len() > 55, "{}", rows.len());
    let mut problems = Vec::new();
    for row in &rows {
        match published.iter().find(|other| other.name == row.name) {
            Some(other) => problems.extend(changes(row, other)),
            None => problems.push(format!("{} is not in docs/retargeting-contacts.tsv", row.name)),
        }
    }
    assert_eq!(problems, Vec::<String>::new());
}

fn changes<'a>(row: &'a Row, published: &'a Row) -> impl Iterator<Item = String> + 'a {
    let cells = (0..2).flat_map(|side| (0..COLUMNS.len()).map(move |column| (side, column)));
    cells.filter_map(move |(side, column)| {
        let (name, digits) = COLUMNS[column];
        let [found, expected] = [row, published].map(|row| row.values[side][column]);
        // The last digit may be rounded the other way on another machine, and a vertex may be on the other side of a surface.
        let tolerance = 2.01 * 10.0_f64.powi(-(digits as i32));
        let is_same = match (found, expected) {
            (Some(found), Some(expected)) => (found - expected).abs() < tolerance.max(1e-3 * expected.abs()),
            (found, expected) => found.is_none() && expected.is_none(),
        };
        (!is_same).then(|| format!("{}: {name} is {found:?}, docs/retargeting-contacts.tsv has {expected:?}", row.name))
    })
}

fn header() -> String {
    let columns = COLUMNS.map(|(name, _)| format!("{name}\t{name}_kept"));
    format!("model\tmotion\tclip\tset\t{}", columns.join("\t"))
}

fn published() -> Vec<Row> {
    let mut lines = include_str!("../../../../docs/retargeting-contacts.tsv").lines();
    assert_eq!(lines.next(), Some(header().as_str()));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('\t').collect();
        let values = [0, 1].map(|side| std::array::from_fn(|column| cells[4 + 2 * column + side].parse().ok()));
        Row { name: cells[..3].join("\t"), is_tuned: cells[3] == "tuned", values }
    };
    lines.map(row).collect()
}

/// Writes the table that [`published`] reads, which takes a minute in a release build, and prints its means.
fn update(rows: &[Row]) {
    let mut table = header() + "\n";
    for Row { name, is_tuned, values } in rows {
        let set = if *is_tuned { "tuned" } else { "others" };
        let cell = |side: usize, column: usize| {
            values[side][column].map_or(String::new(), |value: f64| format!("{value:.0$}", COLUMNS[column].1))
        };
        let cells = (0..COLUMNS.len()).flat_map(|column| [cell(0, column), cell(1, column)]);
        table += &format!("{name}\t{set}\t{}\n", cells.collect::<Vec<String>>().join("\t"));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/retargeting-contacts.tsv");
    std::fs::write(path, table).expect("the table can be written");
    let on_ground = |row: &&Row| GROUND.iter().any(|motion| row.name.split('\t').nth(1) == Some(motion));
    for (name, rows) in [
        ("tuned", rows.iter().filter(|row| row.is_tuned).collect::<Vec<&Row>>()),
        ("others", rows.iter().filter(|row| !row.is_tuned).collect()),
        ("all", rows.iter().collect()),
        ("on the ground", rows.iter().filter(on_ground).collect()),
    ] {
        println!("{name}, {} pairs:", rows.len());
        for (column, (what, _)) in COLUMNS.iter().enumerate() {
            let [off, kept] = means(&rows, column);
            println!("  {what}: {off:.4} → {kept:.4} ({:+.1} %)", 100.0 * (kept / off - 1.0));
        }
    }
}
