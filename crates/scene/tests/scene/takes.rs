//! What plays is one value: its bounds hold every pose that is shown, and baking it gives the clip that is shown.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gaitway_character::anim::{Pose, SampleCursor, model_from_joint};
use gaitway_character::asset::{SceneJoints, Slot};
use gaitway_character::mesh::Bounds;
use gaitway_retarget::{ClipLayer, LayerMode, Pin, PinGoal};
use gaitway_scene::library::{ClipId, Held, LayeredClip, Library, Model, ModelClip, Moment, Take, TakeSampler};
use gaitway_scene::state::{CharacterView, ClipChoice, Edits, Playhead, UpAxis, ViewerState, resolved_bounds};
use glam::{Affine3A, Vec3};

use crate::data::{moving_box, walker};
use crate::data_folder::data_folder;
use crate::extent::exact;
use crate::model_files::models_under;
use crate::opened;

/// The first clip of a file.
const FIRST: ClipId = ClipId::Own(0);
const UPPER_ARM: usize = 7;
const HAND: usize = 9;

fn additive(start_secs: f64) -> LayeredClip {
    let mode = LayerMode::AdditiveToRest;
    LayeredClip { clip: FIRST, layer: ClipLayer { mode, start_secs, ..ClipLayer::default() } }
}

/// Checks that the bounds for the camera, the grid and the shadow hold what is drawn, at 40 times in two loops.
fn check_view(what: &str, library: &Library, state: &ViewerState) {
    let bounds = resolved_bounds(library, state);
    let slack = 0.02 * bounds.diagonal();
    let duration_secs = f64::from(library.active().expect("a model").asset.clips[0].duration_secs());
    for step in 0..40 {
        let playhead =
            Playhead { time_secs: 2.0 * duration_secs * f64::from(step) / 40.0, ..state.character.playhead.clone() };
        let shown = exact(
            library,
            &ViewerState { character: CharacterView { playhead, ..state.clone().character }, ..state.clone() },
        );
        let is_inside = (bounds.min - slack).cmple(shown.min).all() && (bounds.max + slack).cmpge(shown.max).all();
        assert!(is_inside, "{what}: {shown:?} leaves {bounds:?} in step {step}");
    }
}

#[test]
fn what_is_laid_over_a_clip_stays_in_the_picture() {
    let edits = |edits: Edits| ViewerState {
        character: CharacterView { edits, ..CharacterView::default() },
        ..ViewerState::default()
    };
    let jump = moving_box(0.5, &[0.0, 0.5, 1.0], &[Vec3::ZERO, Vec3::Y * 3.0, Vec3::ZERO]);
    for up in [UpAxis::Y, UpAxis::Z] {
        let layered = Edits { layers: vec![additive(0.0)], up, ..Edits::default() };
        check_view("a layered jump", &jump, &edits(layered));
    }
    let playhead = Playhead { clip: ClipChoice::RestPose, ..Playhead::default() };
    let over_rest = CharacterView {
        edits: Edits { layers: vec![additive(0.0)], ..Edits::default() },
        playhead,
        ..CharacterView::default()
    };
    check_view("a jump over the rest pose", &jump, &ViewerState { character: over_rest, ..ViewerState::default() });
    let walker = walker();
    let above = Pin { goal: PinGoal::Point(Vec3::new(0.2, 3.0, 0.3)), times: None };
    let pinned = Edits { pins: BTreeMap::from([(HAND, above)]), ..Edits::default() };
    check_view("a pinned hand", &walker, &edits(pinned));
    let raised = Edits { pose: BTreeMap::from([(UPPER_ARM, [0.0, 0.0, 80.0])]), ..Edits::default() };
    check_view("an arm that is held", &walker, &edits(raised));
}

/// What is laid over a clip.
struct Laid {
    layers: Vec<LayeredClip>,
    rotations: BTreeMap<usize, [f32; 3]>,
    pins: BTreeMap<usize, Pin>,
}

impl Laid {
    fn nothing() -> Self {
        Self { layers: Vec::new(), rotations: BTreeMap::new(), pins: BTreeMap::new() }
    }

    /// A layer of the clip itself, a turned joint, and a pinned hand.
    fn over(model: &Model, clip: &ModelClip) -> Self {
        let layer = ClipLayer { weight: 0.5, ..additive(0.25 * clip.duration_secs()).layer };
        let skeleton = &model.asset.skeleton;
        let number = |slot| Some(skeleton.source_index(model.recognition().joint(slot)?));
        let place = Vec3::new(0.3, 1.2, 0.4);
        let pin = Pin { goal: PinGoal::Point(place), times: None };
        let hand =
            number(Slot::RightHand).filter(|&hand| Take::new(model, Some(clip)).pinning(None).allows(hand, pin.goal));
        Self {
            layers: vec![LayeredClip { clip: clip.id().clone(), layer }],
            rotations: number(Slot::Head).map(|head| (head, [10.0, 20.0, 5.0])).into_iter().collect(),
            pins: hand.map(|hand| (hand, pin)).into_iter().collect(),
        }
    }

    fn take<'a>(&'a self, model: &'a Model, clip: &'a ModelClip) -> Take<'a> {
        let held = Held { rotations: &self.rotations, ..Held::NOTHING };
        Take { layers: &self.layers, pins: &self.pins, held, ..Take::new(model, Some(clip)) }
    }
}

/// Compares a take with its baked clip at times between keys, and its bounds with its poses. Avatars
/// aren't baked, so clips are compared without them.
fn check_take(take: &Take<'_>) -> Result<(), String> {
    let (model, skeleton) = (take.model, &take.model.asset.skeleton);
    let baked = take.bake(None, None).clip;
    let bounds = take.bounds(None, false, &[]);
    // The baker's limits are for each step, and grow with the height; a pinned limb that is nearly straight turns by more than its
    // end is off.
    let height = model.rest_bounds().size().max_element().max(1.0);
    let (max_metres, max_degrees) = (5e-4 * height, 0.25);
    let (mut sampler, mut cursor) = (TakeSampler::default(), SampleCursor::default());
    let (mut again, mut shown, mut shown_again) = (Pose::default(), Vec::new(), Vec::new());
    let mut scene = SceneJoints::new(&model.asset, model.asset.default_scene);
    let duration_secs = f64::from(baked.duration_secs());
    for step in 0..24 {
        let elapsed_secs = duration_secs * (f64::from(step) + 0.37) / 24.5;
        let moment = Moment { elapsed_secs, from: None };
        sampler.sample(take, moment, None);
        model_from_joint(skeleton, &sampler.pose, Affine3A::IDENTITY, &mut shown);
        scene.show(&model.asset, &sampler.properties);
        let at_time = model.pose_bounds(&shown, &sampler.pose.morph_weights, &scene);
        let slack = 0.05 * bounds.diagonal() + 1e-4;
        if !at_time.is_empty() && !holds(bounds, at_time, slack) {
            return Err(format!("{at_time:?} at {elapsed_secs} s leaves {bounds:?}"));
        }
        again.copy_from(skeleton.rest());
        baked.sample(skeleton, elapsed_secs as f32, &mut cursor, &mut again);
        sampler.sample_motion(take, moment);
        if !take.pins.is_empty() {
            take.pinning(None).apply(take.clip_secs(elapsed_secs), &mut sampler.pose);
        }
        model_from_joint(skeleton, &sampler.pose, Affine3A::IDENTITY, &mut shown);
        model_from_joint(skeleton, &again, Affine3A::IDENTITY, &mut shown_again);
        for joint in skeleton.joints() {
            let metres = shown[joint.get()].translation.distance(shown_again[joint.get()].translation);
            let turns = [&sampler.pose, &again].map(|pose| pose.local(joint).rotation.normalize());
            let degrees = 2.0 * (turns[0].conjugate() * turns[1]).xyz().length().min(1.0).asin().to_degrees();
            if metres > max_metres || degrees > max_degrees {
                let joint = skeleton.label(joint);
                return Err(format!("{joint}: {metres} m and {degrees}° apart at {elapsed_secs} s"));
            }
        }
    }
    Ok(())
}

fn holds(bounds: Bounds, inner: Bounds, slack: f32) -> bool {
    (bounds.min - slack).cmple(inner.min).all() && (bounds.max + slack).cmpge(inner.max).all()
}

fn check_file(data: &Path, path: &Path) -> (usize, Vec<String>) {
    let file = path.strip_prefix(data).expect("found there").display().to_string();
    let Some(model) = opened::try_model(path.to_str().expect("a plain path")) else { return (0, Vec::new()) };
    let model = &model;
    let mut failures = Vec::new();
    for clip in model.clips() {
        for (laid, what) in [(Laid::nothing(), "alone"), (Laid::over(model, clip), "with all")] {
            let result = check_take(&laid.take(model, clip));
            failures.extend(result.err().map(|why| format!("{file}, {}, {what}: {why}", clip.title())));
        }
    }
    (model.clips().len(), failures)
}

#[test]
fn every_real_clip_is_baked_as_it_plays_and_stays_in_its_bounds() {
    let Some(data) = data_folder() else { return };
    let mut paths = Vec::new();
    models_under(&data, &["glb", "gltf", "vrm", "vrma", "fbx", "bvh"], &mut paths);
    paths.retain(|path| !path.starts_with(data.join("validator-invalid")));
    let (halves, started) = (paths.split_at(paths.len() / 2), std::time::Instant::now());
    let results: Vec<(usize, Vec<String>)> = std::thread::scope(|scope| {
        let check = |paths: &[PathBuf]| -> Vec<_> { paths.iter().map(|path| check_file(&data, path)).collect() };
        let other = scope.spawn(move || check(halves.1));
        let mut results: Vec<_> = halves.0.iter().map(|path| check_file(&data, path)).collect();
        results.extend(other.join().expect("no panic"));
        results
    });
    let clips: usize = results.iter().map(|(clips, _)| clips).sum();
    let failures: Vec<String> = results.into_iter().flat_map(|(_, failures)| failures).collect();
    println!("{clips} clips of {} files in {:?}", paths.len(), started.elapsed());
    assert!(clips > 300, "only {clips} clips");
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), 2 * clips, failures.join("\n"));
}
