//! Prints the figures of `contacts: keep` beside those without, for characters with meshes and dances and gestures of the test
//! data in `$GAITWAY_DATA`: `cargo run --release -p gaitway-core --example contacts [plant] [NAME]`.

// The people of the tests name the package as users do.
extern crate gaitway_core as gaitway;

#[path = "../../../tests/support/data_folder.rs"]
mod data_folder;
#[allow(dead_code, reason = "shared with the tests")]
#[path = "../../../tests/retarget/people.rs"]
mod people;

use std::time::Instant;

use gaitway::anim::{Clip, Pose, SampleCursor, Skeleton, model_from_joint};
use gaitway::retarget::{Contacts, Figures, ResolvedMap, Retargeting};
use glam::{Affine3A, Vec3A};
use people::{Loaded, load_people, planted, proposed};

/// Dances and gestures: files, and the clip where it isn't the one of [`people::PEOPLE`].
const MOTIONS: [(&str, &str); 14] = [
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

/// Figures of one clip, and the time that it took to bake.
struct Row {
    figures: Figures,
    jerk: f64,
    millis_per_10_secs: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let plant = arguments.iter().any(|argument| argument == "plant");
    let every = arguments.iter().find_map(|argument| argument.strip_prefix("every=")?.parse::<usize>().ok()).unwrap_or(1);
    let name = arguments.iter().find(|argument| *argument != "plant" && !argument.starts_with("every="));
    let folder = data_folder::data_folder().ok_or("no test data")?;
    let mut people = load_people(&folder);
    for person in &mut people {
        let motion = MOTIONS.iter().find(|(name, _)| *name == person.name);
        person.clip = motion.and(person.clip);
        if let Some((_, clip)) = motion.filter(|(_, clip)| !clip.is_empty()) {
            let clips = &person.asset.clips;
            person.clip = Some(clips.iter().position(|other| other.name() == *clip).ok_or(*clip)?);
        }
    }
    println!("model\tmotion\tinside\tkept\terror\tkept\tlimbs\tkept\tslide\tkept\tjerk\tkept\tturn\tkept\tms\tkept");
    let mut rows: Vec<[Row; 2]> = Vec::new();
    let is_wanted = |pair: &str| name.is_none_or(|name| pair.contains(name.as_str()));
    for (at, (model, motion)) in people::each_pair(&people).enumerate() {
        if at % every != 0 {
            continue;
        }
        if !is_wanted(&format!("{}<{}", model.name, motion.name)) {
            continue;
        }
        let map = proposed(model, motion)?;
        let map = if plant { planted(map) } else { map };
        let [off, keep] = [Contacts::Off, Contacts::Keep]
            .map(|contacts| row(model, motion, &ResolvedMap { contacts, ..map.clone() }));
        let pair = [off?, keep?];
        if pair[0].figures.self_penetration_share.is_some() {
            print_row(&format!("{}\t{}", model.name, motion.name), &pair.each_ref().map(values));
            rows.push(pair);
        }
    }
    let mean = |side: usize, column: usize| {
        let values: Vec<f64> = rows.iter().filter_map(|row| values(&row[side])[column]).collect();
        Some(values.iter().sum::<f64>() / values.len() as f64)
    };
    print_row(
        &format!("mean of {}\t", rows.len()),
        &[0, 1].map(|side| std::array::from_fn(|column| mean(side, column))),
    );
    Ok(())
}

fn print_row(name: &str, sides: &[[Option<f64>; 7]; 2]) {
    let digits = [4, 4, 2, 3, 1, 1, 1];
    let cell = |side: usize, column: usize| {
        sides[side][column].map_or("–".to_owned(), |value| format!("{value:.0$}", digits[column]))
    };
    let cells: Vec<String> = (0..7).flat_map(|column| [cell(0, column), cell(1, column)]).collect();
    println!("{name}\t{}", cells.join("\t"));
}

fn values(row: &Row) -> [Option<f64>; 7] {
    let Figures {
        self_penetration_share,
        contact_error_metres_mean,
        limb_direction_error_degrees_mean,
        foot_slide_metres_per_sec,
        largest_turn_degrees_per_frame,
        ..
    } = row.figures;
    [
        self_penetration_share,
        contact_error_metres_mean,
        limb_direction_error_degrees_mean,
        foot_slide_metres_per_sec,
        Some(row.jerk),
        largest_turn_degrees_per_frame,
        Some(row.millis_per_10_secs),
    ]
}

fn row(model: &Loaded, motion: &Loaded, map: &ResolvedMap) -> Result<Row, Box<dyn std::error::Error>> {
    let clip = motion.clip.ok_or("no clip")?;
    let start = Instant::now();
    let pair = Retargeting::new(model.body(), motion.body(), clip, map)?;
    let made = pair.bake()?;
    let millis = 1000.0 * start.elapsed().as_secs_f64();
    let mut figures = pair.figures(&made);
    // Models come in metres and in centimetres.
    let height = height(&model.asset.skeleton);
    for length in [&mut figures.contact_error_metres_mean, &mut figures.foot_slide_metres_per_sec] {
        *length = length.map(|length| 1.7 * length / height);
    }
    let jerk = 1.7 * jerk(&model.asset.skeleton, &made.clip, map) / height;
    Ok(Row { figures, jerk, millis_per_10_secs: 10.0 * millis / f64::from(made.clip.duration_secs().max(0.1)) })
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

/// Mean of the third derivative of the mapped joints' positions, at 60 frames per second.
fn jerk(skeleton: &Skeleton, clip: &Clip, map: &ResolvedMap) -> f64 {
    let (mut pose, mut cursor, mut world) = (Pose::default(), SampleCursor::default(), Vec::new());
    let mut frames: Vec<Vec<Vec3A>> = Vec::new();
    for frame in 0..=(clip.duration_secs() * 60.0) as usize {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, frame as f32 / 60.0, &mut cursor, &mut pose);
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
        frames.push(map.pairs.iter().map(|pair| world[pair.target.get()].translation).collect());
    }
    let jerks = frames.windows(4).flat_map(|four| {
        (0..four[0].len())
            .map(|at| f64::from((four[3][at] - 3.0 * four[2][at] + 3.0 * four[1][at] - four[0][at]).length()))
    });
    let (sum, count) = jerks.fold((0.0, 0), |(sum, count), jerk| (sum + jerk, count + 1));
    sum / f64::from(count.max(1)) * 60.0_f64.powi(3)
}
