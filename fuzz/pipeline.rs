//! What follows reading: a motion is retargeted, measured, layered, pinned, shown, baked and written.

use std::collections::BTreeMap;
use std::sync::Arc;

use gaitway_formats::{FileSet, load, prepare};
use gaitway_retarget::{
    ClipLayer, ClipRef, Contacts, Feet, JointMap, Keep, LayerMode, Pin, PinGoal, PinTimes, RootPart, Unmapped,
};
use gaitway_scene::editor::{ClipFormat, write_clip};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{ClipId, LayeredClip, Library, Model, Motion, proposal_for};
use gaitway_scene::samples;
use gaitway_scene::state::{ClipChoice, UpAxis, ViewerState, take_of};
use glam::Vec3;

/// Number of bytes before the file, which hold the choices.
const CHOICES: usize = 4;

/// The choices as the digits of a number, each with its own base.
struct Choices(u32);

impl Choices {
    /// Returns the next choice, an index below `count`.
    fn below(&mut self, count: u32) -> usize {
        let choice = self.0 % count;
        self.0 /= count;
        choice as usize
    }

    fn one_of<T: Copy, const N: usize>(&mut self, all: [T; N]) -> T {
        all[self.below(N as u32)]
    }
}

/// Takes four bytes of choices and the file of a motion, which may be its own model.
pub fn pipeline(bytes: &[u8]) {
    let Some((choices, file)) = bytes.split_first_chunk::<CHOICES>() else { return };
    let mut choices = Choices(u32::from_le_bytes(*choices));
    let mut files = FileSet::default();
    if files.add("dropped", file.to_vec()).is_err() || prepare(&mut files).is_err() {
        return;
    }
    let Ok(asset) = load(&files) else { return };
    let asset = Arc::new(asset);
    let own = Model::new("model".to_owned(), asset.clone(), vec![None; asset.images.len()]);
    let model = match choices.below(3) {
        0 => own,
        _ => samples::load(samples::WALKER).unwrap_or(own),
    };
    let motion = Motion::new("motion".to_owned(), asset);
    let mut map = proposal_for(&model, &motion).to_map(&model.asset, &motion.asset);
    choose_options(&mut choices, &mut map);
    let mut library = Library::default();
    library.add(model);
    library.set_motions(vec![motion]);
    library.borrow_each(vec![Some(map)]);
    let Some(model) = library.active() else { return };
    let borrowed = model.clips().borrowed().next().map(|(clip, _)| clip.id().clone());
    let chosen = borrowed.unwrap_or(ClipId::Own(0));
    let _ = (library.figures(&chosen), library.foot_tracks(&chosen).len());
    let state = view(&mut choices, chosen.clone());
    let mut frame = Frame::default();
    for time_secs in [0.0, 0.1, 1e9] {
        let mut state = state.clone();
        state.character.playhead.time_secs = time_secs;
        evaluate(&library, &state, 1.0, &mut frame);
    }
    let take = take_of(model, model.clip(&chosen), &state);
    let baked = take.bake(None, None);
    for format in ClipFormat::ALL {
        // A clip may be impossible to write, but what is written must be readable.
        if let Ok(written) = write_clip(model, &model.asset.skeleton, &baked.clip, 30.0, format) {
            let mut files = FileSet::default();
            files.insert(format!("written.{}", format.extension()), written);
            load(&files).expect("a written clip can be loaded");
        }
    }
}

fn choose_options(choices: &mut Choices, map: &mut JointMap) {
    let parts = [RootPart::Keep, RootPart::InPlace, RootPart::Freeze];
    let keeps = [Keep::Auto, Keep::Keep, Keep::Drop];
    map.feet = choices.one_of([Feet::Off, Feet::Plant]);
    map.contacts = choices.one_of([Contacts::Off, Contacts::Keep]);
    map.root.horizontal = choices.one_of(parts);
    map.root.vertical = choices.one_of(parts);
    map.root.yaw = choices.one_of(parts);
    map.root.extract = choices.one_of([false, true]);
    map.translations = choices.one_of(keeps);
    map.scales = choices.one_of(keeps);
    map.unmapped = match choices.below(3) {
        0 => Unmapped::Rest,
        kind => Unmapped::Clip { clip: ClipRef::Index(0), frozen: kind == 1 },
    };
    map.crossfade_secs = choices.one_of([0.0, 0.3, 1e30]);
}

/// A view of a clip with the model's first clip over it, and pins.
fn view(choices: &mut Choices, clip: ClipId) -> ViewerState {
    let mut state = ViewerState::default();
    state.character.playhead.clip = ClipChoice::Clip(clip);
    let mode = choices.one_of([LayerMode::Override, LayerMode::Additive, LayerMode::AdditiveToRest]);
    let speed = choices.one_of([1.0, ClipLayer::MAX_SPEED]);
    let layer = ClipLayer { mode, speed, weight: 0.5, start_secs: 0.2, ..ClipLayer::default() };
    let edits = &mut state.character.edits;
    if choices.one_of([true, false]) {
        edits.layers = vec![LayeredClip { clip: ClipId::Own(0), layer }];
    }
    let times = Some(PinTimes { start_secs: 0.2, end_secs: 0.3, blend_secs: 0.1 });
    if choices.one_of([true, false]) {
        let goals = [PinGoal::Point(Vec3::ONE), PinGoal::Look(Vec3::Y)];
        edits.pins = (0..8).map(|joint| (joint, Pin { goal: goals[joint % 2], times })).collect::<BTreeMap<_, _>>();
    }
    edits.up = choices.one_of([UpAxis::Y, UpAxis::Z]);
    state
}
