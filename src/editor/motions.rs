//! Opening and removing motions, and retargeting their clips to the active model. Operations that fail change nothing; those
//! that succeed can be undone.

use std::collections::BTreeMap;

use super::{Admit, Contents, Editor, Event, reconciled_maps, short_name};
use crate::asset::Warning;
use crate::library::{BorrowError, BorrowedClip, Library, Model, ModelId, Motion, names_checksum};
use crate::retarget::{JointMap, MapError};
use crate::state::{
    ClipChoice, Command, MotionMap, NumberedMap, RetargetEdits, ViewerState, active_clip, active_map, active_maps,
    choice_of_clip, clip_called, clip_changes, clip_copies, edited_clips, name_of_clip, rename_clips, unknown_clip,
};

/// Identifies a motion's clip across models, with the time in it.
#[derive(Debug, Clone)]
pub(super) struct ClipIdentity {
    origin: String,
    source: String,
    source_clip: usize,
    time_secs: f64,
}

/// A motion's clip that edits refer to.
#[derive(Debug)]
pub(super) struct EditedClip {
    /// How they call it.
    name: String,
    title: String,
    clip: ClipIdentity,
}

impl ClipIdentity {
    pub fn first_of(motion: &Motion) -> Self {
        Self { origin: motion.origin.clone(), source: motion.source.clone(), source_clip: 0, time_secs: 0.0 }
    }

    fn is_of(&self, motion: &Motion) -> bool {
        self.origin == motion.origin && self.source == motion.source
    }
}

impl Editor {
    /// Adds motions, replacing those that are already loaded. Without a view, keeps the state and plays the first new clip. If
    /// none of them fits the model, nothing changes. `is_by_hand` is that of [`Contents`].
    pub(super) fn open_motions(
        &mut self,
        motions: Vec<Motion>,
        map: Option<MotionMap>,
        view: Option<ViewerState>,
        is_by_hand: bool,
        admit: Admit<'_>,
    ) -> Result<(), String> {
        if let Some(view) = view {
            return self.open_view(view, motions, map, admit);
        }
        let has_map = map.is_some();
        let (motions, still) = without_still(motions);
        if motions.is_empty() && !still.is_empty() {
            return Err(still.join("\n"));
        }
        // Nothing is there yet that it could move: it has a skeleton of its own.
        if let [motion] = &*motions
            && is_by_hand
            && self.library.active().is_some_and(Model::is_placeholder)
        {
            return self.open_alone(motion, admit);
        }
        self.check_room(&motions)?;
        let before = self.snapshot();
        let problems = self.add_motions(motions.clone(), map);
        let added = self.added_from(&motions);
        if added.is_none() && !motions.is_empty() {
            let why = self.why_refused(&motions, &problems);
            if let Some(before) = before {
                self.library.restore(before.loaded);
                self.state = before.state;
            }
            self.retarget();
            self.refused = motions;
            let lacks_skeleton = self.library.active().is_some_and(|model| !model.has_skeleton());
            self.events.push(Event::MotionsRefused { lacks_skeleton });
            return Err(why);
        }
        self.remember(before);
        self.report(problems);
        self.report(motions.iter().flat_map(lost_frames).collect());
        self.choose_retargeted(motions.first().map(ClipIdentity::first_of));
        self.events.push(Event::MotionsAdded);
        let mut notice = added.unwrap_or_default();
        if is_by_hand {
            if !has_map && let Some(about_feet) = self.suit_feet(motions.len()) {
                notice = format!("{notice} {about_feet}");
            }
            self.suits_follow = true;
            self.suit_follow();
        }
        // The new clip may leave the camera's view.
        self.apply(Command::FrameAll);
        self.notify_undoable(notice);
        self.report(still);
        Ok(())
    }

    /// Borrows the clips of another open model.
    ///
    /// # Errors
    /// The message for the user if none of them fits the active model.
    pub fn borrow_from(&mut self, id: ModelId, admit: Admit<'_>) -> Result<(), String> {
        let Some(model) = self.library.get(id) else { return Ok(()) };
        let mut motion = Motion::new(model.source.clone(), model.asset.clone());
        (motion.origin, motion.is_own) = (model.origin.clone(), model.is_own);
        let contents = Contents { motions: Some(vec![motion]), is_by_hand: true, ..Contents::default() };
        self.open(contents, None, admit)
    }

    /// Checks that the library has room for these motions beside the loaded ones.
    pub(super) fn check_room(&self, motions: &[Motion]) -> Result<(), String> {
        let (found, max) = (self.others(motions).count() + motions.len(), Library::MAX_MOTIONS);
        if found > max {
            return Err(format!("expected at most {max} motions in all, found {found}; remove some first"));
        }
        Ok(())
    }

    /// Appends motions with their maps, replacing motions of the same origins. Returns the problems.
    pub(super) fn add_motions(
        &mut self,
        motions: Vec<Motion>,
        maps: impl IntoIterator<Item = MotionMap>,
    ) -> Vec<String> {
        let mut all: Vec<Motion> = self.others(&motions).cloned().collect();
        all.extend(motions);
        self.state.retarget.map.extend(maps);
        let edited = self.edited_clips();
        self.set_motions(all);
        let problems = self.retarget();
        self.keep_edits(&edited);
        problems
    }

    /// Returns the loaded motions whose origins are not among those of `motions`.
    fn others(&self, motions: &[Motion]) -> impl Iterator<Item = &Motion> {
        let is_other = |known: &&Motion| !motions.iter().any(|motion| motion.origin == known.origin);
        self.library.motions().iter().filter(is_other)
    }

    /// Returns the notice for clips that were retargeted from the motions that were added last; `None` without any.
    pub(super) fn added_from(&self, motions: &[Motion]) -> Option<String> {
        let first = self.library.motions().len().saturating_sub(motions.len());
        let lenders = self.library.active()?.borrowed_clips().map(|(_, borrowed)| borrowed.motion);
        let lenders: Vec<usize> = lenders.filter(|&motion| motion >= first).collect();
        let has_lent = |(index, _): &(usize, &Motion)| lenders.contains(&(first + index));
        let names: Vec<String> =
            motions.iter().enumerate().filter(has_lent).map(|(_, motion)| short_name(&motion.source)).collect();
        let plural = if lenders.len() == 1 { "" } else { "s" };
        (!lenders.is_empty()).then(|| format!("Added {} clip{plural} from {}.", lenders.len(), names.join(", ")))
    }

    fn set_motions(&mut self, motions: Vec<Motion>) {
        let model = self.library.active().map(|model| model.origin.clone());
        self.state.sources.motion = Contents::motion_sources(&motions, model.as_deref());
        self.library.set_motions(motions);
    }

    /// Returns why motions that were just added don't fit. Unlike the command line's error, it doesn't explain how to write a
    /// map: shells offer alternatives.
    fn why_refused(&self, motions: &[Motion], problems: &[String]) -> String {
        let last = self.library.motions().len().saturating_sub(1);
        if let (Some(model), [motion]) = (self.library.active(), motions)
            && self.library.proposal(last).is_some_and(|proposal| proposal.pairs.is_empty())
        {
            let has_skeleton = model.has_skeleton();
            let (motion, model) = (short_name(&motion.source), short_name(&model.source));
            if !has_skeleton {
                return format!("{motion}: {model} {}", Model::NO_SKELETON);
            }
            return format!("{motion}: it has no joint in common with {model}, neither by name nor by body part");
        }
        problems.join("\n")
    }

    /// Retargets the motions' clips, copies clips and applies changes to them where their inputs differ from before; returns problems
    /// not reported yet.
    pub(super) fn retarget(&mut self) -> Vec<String> {
        let (maps, problems) = reconciled_maps(&self.library, &self.state);
        let mut new: Vec<String> = problems.iter().map(|problem| self.map_problem(problem)).collect();
        if maps != self.state.retarget.map {
            self.record(Command::ReconcileMaps(maps));
            self.is_changed = true;
        }
        let maps = active_maps(&self.library, &self.state);
        if self.library.borrow_each(maps) {
            self.needs_redraw = true;
            let errors = self.library.borrow_errors().iter().filter(|error| !is_unfinished(error));
            let errors: Vec<String> = errors.map(ToString::to_string).collect();
            new.extend(errors.iter().filter(|error| !self.reported.contains(error)).cloned());
            self.reported = errors;
        }
        let copies = self.library.active().map(|model| clip_copies(model, &self.state)).unwrap_or_default();
        self.needs_redraw |= self.library.copy_clips(&copies);
        let changes = self.library.active().map(|model| clip_changes(model, &self.state)).unwrap_or_default();
        self.needs_redraw |= self.library.change_clips(&changes);
        new
    }

    /// Returns the motion whose map the command matches again, and its map before that.
    pub(super) fn map_to_rematch(&self, command: &Command) -> Option<(usize, Option<JointMap>)> {
        let Command::SetMap { motion, map: None } = *command else { return None };
        Some((motion, active_map(&self.library, &self.state, motion)))
    }

    /// Notifies the user if matching joints again has changed nothing.
    pub(super) fn notify_rematch(&mut self, motion: usize, before: &Option<JointMap>) {
        let (Some(model), Some(about)) = (self.library.active(), self.library.motions().get(motion)) else { return };
        let names = (short_name(&about.source), short_name(&model.source));
        if self.library.proposal(motion).is_none_or(|proposal| proposal.pairs.is_empty()) {
            let (about, model) = names;
            let text = format!(
                "{about} has no joint in common with {model}, neither by name nor by body part: choose sources in the table."
            );
            self.notify(text);
        } else if active_map(&self.library, &self.state, motion) == *before {
            self.notify("The joints are already mapped as proposed.".to_owned());
        }
    }

    /// Returns the active clip if it is retargeted.
    pub(super) fn retargeted_clip(&self) -> Option<ClipIdentity> {
        let model = self.library.active()?;
        let clip = self.identity_of(model, active_clip(model, &self.state)?)?;
        Some(ClipIdentity { time_secs: self.state.playhead.time_secs, ..clip })
    }

    /// Identifies a clip if it is retargeted. A copy keeps its name, whatever becomes of the others.
    fn identity_of(&self, model: &Model, clip: usize) -> Option<ClipIdentity> {
        let borrowed = model.borrowed(clip).filter(|_| !model.is_copy(clip))?;
        let first = ClipIdentity::first_of(self.library.motions().get(borrowed.motion)?);
        Some(ClipIdentity { source_clip: borrowed.source_clip, ..first })
    }

    /// Returns the retargeted clips that edits refer to, whose names may change with the list of clips.
    pub(super) fn edited_clips(&self) -> Vec<EditedClip> {
        let Some(model) = self.library.active() else { return Vec::new() };
        let edited = |name: &str| {
            let clip = clip_called(model, name)?;
            let (name, title) = (name.to_owned(), model.clip_titles()[clip].clone());
            Some(EditedClip { name, title, clip: self.identity_of(model, clip)? })
        };
        edited_clips(&self.state.edits).into_iter().filter_map(edited).collect()
    }

    /// Makes edits refer to the same clips as before. Those of clips whose motion is gone are dropped; those of clips that only wait
    /// for pairs in their map keep a name that no other clip has.
    pub(super) fn keep_edits(&mut self, edited: &[EditedClip]) {
        let Some(model) = self.library.active() else { return };
        let is_free = |name: &&String| clip_called(model, name).is_none();
        let new_name = |EditedClip { name, title, clip }: &EditedClip| match self.find_retargeted(clip) {
            Some(index) if clip_called(model, name) == Some(index) => Some(name.clone()),
            Some(index) => Some(name_of_clip(model, index)),
            None if self.is_loaded(clip) => [name, title].into_iter().find(is_free).cloned(),
            None => None,
        };
        let new_names = edited.iter().map(|edited| (edited.name.clone(), new_name(edited)));
        let renamed: BTreeMap<_, _> = new_names.filter(|(name, new)| new.as_ref() != Some(name)).collect();
        if !renamed.is_empty() {
            rename_clips(&mut self.state.edits, renamed);
            // Clips have been copied and changed by their former names.
            self.retarget();
        }
    }

    /// Plays this clip if the model has it, otherwise the first retargeted one; does nothing for `None`.
    pub(super) fn choose_retargeted(&mut self, choice: Option<ClipIdentity>) {
        let (Some(choice), Some(model)) = (choice, self.library.active()) else { return };
        let first = model.borrowed_clips().next().map(|(clip, _)| choice_of_clip(model, clip));
        if let Some(clip) = self.find_retargeted(&choice) {
            self.apply(Command::SetClip(choice_of_clip(model, clip)));
            self.apply(Command::Seek(choice.time_secs));
        } else if let Some(first) = first {
            self.apply(Command::SetClip(first));
        }
    }

    /// Plays the clip that the newly opened model's file was written for, which may have been retargeted from a loaded motion.
    /// Returns a sentence about it; `None` without such a clip. `subject` is the model.
    pub(super) fn choose_added(&mut self, subject: &str) -> Option<String> {
        let model = self.library.active()?;
        let clip = model.asset.added_clip?;
        let sentence =
            format!("{subject} plays the clip “{}”, which Gaitway added to its file.", model.clip_titles()[clip]);
        let choice = choice_of_clip(model, clip);
        self.apply(Command::SetClip(choice));
        Some(sentence)
    }

    /// Goes on playing this retargeted clip on a newly opened model, whose own clips the user may expect. Returns a sentence about
    /// that. `subject` is the model.
    pub(super) fn continue_retargeted(&mut self, playing: Option<ClipIdentity>, subject: &str) -> Option<String> {
        self.choose_retargeted(playing);
        let (model, clip) = (self.library.active()?, self.retargeted_clip()?);
        let motion = self.library.motions().iter().find(|motion| clip.is_of(motion))?;
        let own = if model.asset.clips.is_empty() { "" } else { "; its own clips are in the clip list" };
        Some(format!("{subject} plays the motion borrowed from {}{own}.", short_name(&motion.source)))
    }

    fn is_loaded(&self, clip: &ClipIdentity) -> bool {
        self.library.motions().iter().any(|motion| clip.is_of(motion))
    }

    fn find_retargeted(&self, wanted: &ClipIdentity) -> Option<usize> {
        let model = self.library.active()?;
        let is_wanted = |borrowed: &BorrowedClip| {
            let motion = self.library.motions().get(borrowed.motion);
            borrowed.source_clip == wanted.source_clip && motion.is_some_and(|motion| wanted.is_of(motion))
        };
        model.borrowed_clips().find(|(_, borrowed)| is_wanted(borrowed)).map(|(clip, _)| clip)
    }

    /// Makes this clip active at the time and in the range that the state has; false if the model lacks it.
    pub(super) fn keep_retargeted(&mut self, clip: &ClipIdentity) -> bool {
        let choice = |model| Some(choice_of_clip(model, self.find_retargeted(clip)?));
        let Some(choice) = self.library.active().and_then(choice) else { return false };
        self.state.playhead.clip = choice;
        true
    }

    /// Keeps the clip that was active before its map changed. A map without pairs leaves no clip: the rest pose is active until
    /// the clip is back, unless the user chooses another one. If its motion is gone, the state's own clip is active.
    pub(super) fn follow_clip(&mut self, playing: Option<ClipIdentity>) {
        let waited = self.waiting_clip.take().filter(|_| self.state.playhead.clip == ClipChoice::RestPose);
        let Some(clip) = playing.or(waited) else { return };
        if self.is_loaded(&clip) && !self.keep_retargeted(&clip) {
            self.state.playhead.clip = ClipChoice::RestPose;
            self.waiting_clip = Some(clip);
        }
    }

    /// Drops motions that don't fit the active model. Returns a notice instead of an error, since the user didn't request them
    /// for this model.
    pub(super) fn drop_incompatible_motions(&mut self) -> Option<String> {
        let model = self.library.active()?;
        let fits = |motion: usize| model.borrowed_clips().any(|(_, borrowed)| borrowed.motion == motion);
        let motions = self.library.motions().iter().cloned().enumerate();
        let (fit, unfit): (Vec<_>, Vec<_>) = motions.partition(|(index, _)| fits(*index));
        if unfit.is_empty() {
            return None;
        }
        let names: Vec<String> = unfit.iter().map(|(_, motion)| short_name(&motion.source)).collect();
        self.keep_motions(fit.into_iter().map(|(_, motion)| motion).collect());
        let names = names.join(", ");
        Some(match unfit.len() {
            1 => format!("Removed motion {names}: it doesn't fit this model."),
            _ => format!("Removed motions {names}: they don't fit this model."),
        })
    }

    /// Removes all motions but these.
    fn keep_motions(&mut self, motions: Vec<Motion>) {
        if motions.is_empty() {
            self.state.retarget = RetargetEdits::default();
        }
        let edited = self.edited_clips();
        self.set_motions(motions);
        self.retarget();
        self.keep_edits(&edited);
        (self.needs_redraw, self.is_changed) = (true, true);
    }

    /// Removes a motion and all others from the same archive.
    pub fn remove_motion(&mut self, index: usize) {
        let Some(motion) = self.library.motions().get(index) else { return };
        let (origin, name) = (motion.origin.clone(), short_name(&motion.origin));
        let others = self.library.motions().iter().filter(|motion| motion.origin != origin).cloned().collect();
        let before = self.snapshot();
        let playing = before.as_ref().and_then(|before| before.playing.clone());
        self.keep_motions(others);
        self.remember(before);
        match playing {
            Some(_) if self.library.motions().is_empty() => self.apply(Command::SetClip(ClipChoice::First)),
            Some(clip) if self.keep_retargeted(&clip) => {}
            None if self.library.active().is_some_and(|model| unknown_clip(model, &self.state).is_some()) => {
                self.apply(Command::SetClip(ClipChoice::First));
            }
            playing => self.choose_retargeted(playing),
        }
        self.notify_undoable(format!("Removed motion {name}."));
    }

    /// Opens the first refused motion as the model.
    ///
    /// # Errors
    /// The message for the user if it cannot be shown.
    pub fn open_refused_alone(&mut self, admit: Admit<'_>) -> Result<(), String> {
        match std::mem::take(&mut self.refused).first() {
            Some(motion) => self.open_alone(motion, admit),
            None => Ok(()),
        }
    }

    /// Adds the refused motions with empty maps, for the user to fill in.
    pub fn map_refused_manually(&mut self) {
        let refused = std::mem::take(&mut self.refused);
        let (Some(model), false) = (self.library.active(), refused.is_empty()) else { return };
        let mut maps: Vec<MotionMap> = Vec::new();
        for motion in &refused {
            let checksum = names_checksum(&model.asset, &motion.asset);
            let map = MotionMap::Numbers(NumberedMap { checksum, map: JointMap::with_proposed_options() });
            if !self.state.retarget.map.contains(&map) && !maps.contains(&map) {
                maps.push(map);
            }
        }
        if let Err(error) = self.check_room(&refused) {
            return self.report(vec![error]);
        }
        let before = self.snapshot();
        let problems = self.add_motions(refused, maps);
        self.remember(before);
        self.report(problems);
        self.events.push(Event::MapStarted);
        (self.needs_redraw, self.is_changed) = (true, true);
    }
}

/// Takes out the motions without animation, which no map can make useful. Returns the others, and what to tell the user.
pub(super) fn without_still(motions: Vec<Motion>) -> (Vec<Motion>, Vec<String>) {
    let (still, moving): (Vec<Motion>, Vec<Motion>) =
        motions.into_iter().partition(|motion| motion.asset.clips.is_empty());
    let why =
        |motion: &Motion| format!("{}: it has no animation, so there is nothing to borrow", short_name(&motion.source));
    (moving, still.iter().map(why).collect())
}

/// Returns what is missing of a BVH that was cut short: unlike a model's, the warnings of a motion are in no tab.
fn lost_frames(motion: &Motion) -> impl Iterator<Item = String> + '_ {
    let lost = motion.asset.warnings.iter().filter(|warning| matches!(warning, Warning::FramesMissing { .. }));
    lost.map(|warning| format!("{}: {warning}", short_name(&motion.source)))
}

/// Whether the map has no pairs yet: the user has just started it.
fn is_unfinished(error: &BorrowError) -> bool {
    matches!(error, BorrowError::Map { problem: MapError::NothingMapped, .. })
}
