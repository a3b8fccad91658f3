//! Opening and removing motions, and retargeting their clips to the active model. Operations that fail change nothing; those
//! that succeed can be undone.

use gaitway_character::asset::Warning;
use gaitway_retarget::{JointMap, MapError};

use super::transact::Change;
use super::{Admit, Contents, Editor, Event, reconciled_maps, short_name};
use crate::library::{BorrowError, ClipId, Library, Model, ModelId, Motion, MotionId, names_checksum};
use crate::state::{
    ClipChoice, Command, MotionMap, NumberedMap, RetargetEdits, ViewerState, active_clip, active_map, active_maps,
    drop_orphaned_edits, resolve_clips, unknown_clip,
};

/// A retargeted clip, which plays on another model as well, with the time in it.
#[derive(Debug, Clone)]
pub(super) struct Playing {
    pub clip: ClipId,
    pub time_secs: f64,
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
        self.report(motions.iter().flat_map(about_motion).collect());
        self.choose_retargeted(self.first_of(&motions));
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
        let motion = Motion::of_model(model, self.files_of(model).cloned());
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
        self.state.character.retarget.map.extend(maps);
        self.transact(Change::View, |editor| editor.set_motions(all))
    }

    /// Returns the first clip of motions that were added last.
    pub(super) fn first_of(&self, motions: &[Motion]) -> Option<Playing> {
        let first = self.library.motions().len().checked_sub(motions.len())?;
        let motion = self.library.motions().get(first)?;
        Some(Playing { clip: ClipId::Borrowed(motion.id().clone(), 0), time_secs: 0.0 })
    }

    /// Returns the loaded motions whose origins are not among those of `motions`.
    fn others(&self, motions: &[Motion]) -> impl Iterator<Item = &Motion> {
        let is_other = |known: &&Motion| !motions.iter().any(|motion| motion.origin == known.origin);
        self.library.motions().iter().filter(is_other)
    }

    /// Returns the notice for clips that were retargeted from the motions that were added last; `None` without any.
    pub(super) fn added_from(&self, motions: &[Motion]) -> Option<String> {
        let first = self.library.motions().len().saturating_sub(motions.len());
        let borrowed = self.library.active()?.clips().borrowed();
        let lent = |motion: &Motion| borrowed.clone().filter(|(_, borrowed)| borrowed.motion == *motion.id()).count();
        let added = self.library.motions()[first..].iter().map(|motion| (short_name(&motion.source), lent(motion)));
        let (names, counts): (Vec<String>, Vec<usize>) = added.filter(|(_, lent)| *lent > 0).unzip();
        let count: usize = counts.iter().sum();
        let plural = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("Added {count} clip{plural} from {}.", names.join(", ")))
    }

    fn set_motions(&mut self, motions: Vec<Motion>) {
        let model = self.library.active().map(|model| model.origin.clone());
        self.state.character.sources.motion = Contents::motion_sources(&motions, model.as_deref());
        self.library.set_motions(motions);
        drop_orphaned_edits(&mut self.state, &self.library);
    }

    /// Returns why motions that were just added don't fit. Unlike the command line's error, it doesn't explain how to write a
    /// map: shells offer alternatives.
    fn why_refused(&self, motions: &[Motion], problems: &[String]) -> String {
        let proposal = self.library.motions().last().and_then(|last| self.library.proposal(last.id()));
        if let (Some(model), [motion]) = (self.library.active(), motions)
            && proposal.is_some_and(|proposal| proposal.pairs.is_empty())
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

    /// Retargets the motions' clips and applies the edits of clips where their inputs differ from before; returns problems not
    /// reported yet.
    pub(super) fn retarget(&mut self) -> Vec<String> {
        let (maps, problems) = reconciled_maps(&self.library, &self.state);
        let mut new: Vec<String> = problems.iter().map(|problem| self.map_problem(problem)).collect();
        if maps != self.state.character.retarget.map {
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
        self.needs_redraw |= resolve_clips(&mut self.state, &mut self.library);
        new
    }

    /// Returns the motion whose map the command matches again, and its map before that.
    pub(super) fn map_to_rematch(&self, command: &Command) -> Option<(MotionId, Option<JointMap>)> {
        let Command::SetMap { motion, map: None } = command else { return None };
        Some((motion.clone(), active_map(&self.library, &self.state, motion)))
    }

    /// Notifies the user if matching joints again has changed nothing.
    pub(super) fn notify_rematch(&mut self, motion: &MotionId, before: &Option<JointMap>) {
        let (Some(model), Some(about)) = (self.library.active(), self.library.motion(motion)) else { return };
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

    /// Returns the active clip if it is retargeted, and no copy: copies are the model's.
    pub(super) fn retargeted_clip(&self) -> Option<Playing> {
        let clip = active_clip(self.library.active()?, &self.state)?;
        let clip = clip.id().motion().map(|_| clip.id().clone())?;
        Some(Playing { clip, time_secs: self.state.character.playhead.time_secs })
    }

    /// Whether the model lacks the clip that the state asks for.
    pub(super) fn is_clip_unknown(&self) -> bool {
        self.library.active().is_some_and(|model| unknown_clip(model, &self.state).is_some())
    }

    fn has_clip(&self, clip: &ClipId) -> bool {
        self.library.active().is_some_and(|model| model.clip(clip).is_some())
    }

    /// Plays this clip if the model has it, otherwise the first retargeted one; does nothing for `None`.
    pub(super) fn choose_retargeted(&mut self, choice: Option<Playing>) {
        let (Some(choice), Some(model)) = (choice, self.library.active()) else { return };
        let first = model.clips().borrowed().next().map(|(clip, _)| clip.id().clone());
        if self.has_clip(&choice.clip) {
            self.apply(Command::SetClip(ClipChoice::Clip(choice.clip)));
            self.apply(Command::Seek(choice.time_secs));
        } else if let Some(first) = first {
            self.apply(Command::SetClip(ClipChoice::Clip(first)));
        }
    }

    /// Plays the clip that the newly opened model's file was written for, which may have been retargeted from a loaded motion.
    /// Returns a sentence about it; `None` without such a clip. `subject` is the model.
    pub(super) fn choose_added(&mut self, subject: &str) -> Option<String> {
        let model = self.library.active()?;
        let clip = model.clip(&ClipId::Own(model.asset.added_clip?))?;
        let sentence = format!("{subject} plays the clip “{}”, which Gaitway added to its file.", clip.title());
        let choice = ClipChoice::Clip(clip.id().clone());
        self.apply(Command::SetClip(choice));
        Some(sentence)
    }

    /// Goes on playing this retargeted clip on a newly opened model, whose own clips the user may expect. Returns a sentence about
    /// that. `subject` is the model.
    pub(super) fn continue_retargeted(&mut self, playing: Option<Playing>, subject: &str) -> Option<String> {
        self.choose_retargeted(playing);
        let (model, playing) = (self.library.active()?, self.retargeted_clip()?);
        let motion = self.library.motion(playing.clip.motion()?)?;
        let own = if model.asset.clips.is_empty() { "" } else { "; its own clips are in the clip list" };
        Some(format!("{subject} plays the motion borrowed from {}{own}.", short_name(&motion.source)))
    }

    /// Makes this clip active at the time and in the range that the state has; false if the model lacks it.
    pub(super) fn keep_retargeted(&mut self, playing: &Playing) -> bool {
        let is_there = self.has_clip(&playing.clip);
        if is_there {
            self.state.character.playhead.clip = ClipChoice::Clip(playing.clip.clone());
        }
        is_there
    }

    /// Drops motions that don't fit the active model. Returns a notice instead of an error, since the user didn't request them
    /// for this model.
    pub(super) fn drop_incompatible_motions(&mut self) -> Option<String> {
        let model = self.library.active()?;
        let fits = |motion: &Motion| model.clips().borrowed().any(|(_, borrowed)| borrowed.motion == *motion.id());
        let (fit, unfit): (Vec<_>, Vec<_>) = self.library.motions().iter().cloned().partition(fits);
        if unfit.is_empty() {
            return None;
        }
        let names: Vec<String> = unfit.iter().map(|motion| short_name(&motion.source)).collect();
        self.keep_motions(fit);
        let names = names.join(", ");
        Some(match unfit.len() {
            1 => format!("Removed motion {names}: it doesn't fit this model."),
            _ => format!("Removed motions {names}: they don't fit this model."),
        })
    }

    /// Removes all motions but these.
    pub(super) fn keep_motions(&mut self, motions: Vec<Motion>) {
        if motions.is_empty() {
            self.state.character.retarget = RetargetEdits::default();
        }
        self.transact(Change::View, |editor| editor.set_motions(motions));
    }

    /// Removes a motion and all others from the same archive.
    pub fn remove_motion(&mut self, id: &MotionId) {
        let Some(motion) = self.library.motion(id) else { return };
        let (origin, name) = (motion.origin.clone(), short_name(&motion.origin));
        let others = self.library.motions().iter().filter(|motion| motion.origin != origin).cloned().collect();
        let before = self.snapshot();
        let playing = before.as_ref().and_then(|before| before.playing.clone());
        self.keep_motions(others);
        self.remember(before);
        match playing {
            Some(playing) if self.has_clip(&playing.clip) => {}
            Some(playing) if !self.library.motions().is_empty() => self.choose_retargeted(Some(playing)),
            playing if playing.is_some() || self.is_clip_unknown() => self.apply(Command::SetClip(ClipChoice::First)),
            _ => {}
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
            if !self.state.character.retarget.map.contains(&map) && !maps.contains(&map) {
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

/// Returns what a motion's file lacks or was assumed about it: unlike a model's, its warnings are in no tab.
fn about_motion(motion: &Motion) -> impl Iterator<Item = String> + '_ {
    // Those of a conversion are about meshes and materials as well.
    let is_bare = motion.asset.meshes.is_empty();
    let is_about_motion = move |warning: &&Warning| match warning {
        Warning::FramesMissing { .. } => true,
        Warning::Other { code, .. } => is_bare && *code == "conversion",
        _ => false,
    };
    let told = motion.asset.warnings.iter().filter(is_about_motion);
    told.map(|warning| format!("{}: {warning}", short_name(&motion.source)))
}

/// Whether the map has no pairs yet: the user has just started it.
fn is_unfinished(error: &BorrowError) -> bool {
    matches!(error, BorrowError::Map { problem: MapError::NothingMapped, .. })
}
