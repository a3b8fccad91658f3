//! Opening and removing motions and joint maps, and retargeting their clips to the active model. Operations that fail change
//! nothing; those that succeed can be undone.

use super::{Admit, Contents, Editor, Event, short_name};
use crate::library::{BorrowError, BorrowedClip, Library, Motion, names_checksum};
use crate::retarget::{JointMap, JointMapFile, MapError, propose};
use crate::state::{
    ClipChoice, Command, MapEdit, MotionMap, NumberedMap, RetargetEdits, ViewerState, active_clip, active_maps,
    choice_of_clip, reconciled_maps,
};

/// Identifies a motion's clip across models, with the time in it.
pub(super) struct ClipIdentity {
    origin: String,
    source: String,
    source_clip: usize,
    time_secs: f64,
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
    /// none of them fits the model, nothing changes.
    pub(super) fn open_motions(
        &mut self,
        motions: Vec<Motion>,
        map: Option<JointMapFile>,
        view: Option<ViewerState>,
        admit: Admit<'_>,
    ) -> Result<(), String> {
        if let Some(view) = view {
            return self.open_view(view, motions, map, admit);
        }
        let before = self.snapshot();
        let problems = self.add_motions(motions.clone(), map.map(MotionMap::Names))?;
        let first = self.library.motions().len() - motions.len();
        let is_new = |(_, borrowed): &(usize, &BorrowedClip)| borrowed.motion >= first;
        let clips = self.library.active().map_or(0, |model| model.borrowed_clips().filter(is_new).count());
        if clips == 0 && !motions.is_empty() {
            if let Some((state, loaded)) = before {
                self.library.restore(loaded);
                self.state = state;
            }
            self.retarget();
            self.refused = motions;
            self.events.push(Event::MotionsRefused);
            return Err(self.why_refused(&problems));
        }
        self.remember(before);
        self.report(problems);
        self.choose_retargeted(motions.first().map(ClipIdentity::first_of));
        // The new clip may leave the camera's view.
        self.apply(Command::FrameAll);
        self.notify_undoable(added_from(clips, &motions));
        Ok(())
    }

    /// Appends motions with their maps, replacing motions of the same origins. Returns the problems.
    fn add_motions(
        &mut self,
        motions: Vec<Motion>,
        maps: impl IntoIterator<Item = MotionMap>,
    ) -> Result<Vec<String>, String> {
        let is_replaced = |known: &Motion| motions.iter().any(|motion| motion.origin == known.origin);
        let mut all: Vec<Motion> = self.library.motions().iter().filter(|known| !is_replaced(known)).cloned().collect();
        all.extend(motions);
        let (found, max) = (all.len(), Library::MAX_MOTIONS);
        if found > max {
            return Err(format!("expected at most {max} motions in all, found {found}; remove some first"));
        }
        self.state.retarget.map.extend(maps);
        self.set_motions(all);
        Ok(self.retarget())
    }

    fn set_motions(&mut self, motions: Vec<Motion>) {
        let model = self.library.active().map(|model| model.origin.clone());
        self.state.sources.motion = Contents::motion_sources(&motions, model.as_deref());
        self.library.set_motions(motions);
    }

    /// Returns why motions were refused. Unlike the command line's error, it doesn't explain how to write a map: shells offer
    /// alternatives.
    fn why_refused(&self, problems: &[String]) -> String {
        if let (Some(model), [motion]) = (self.library.active(), &self.refused[..])
            && !motion.asset.clips.is_empty()
            && propose(&model.asset, &motion.asset).pairs.is_empty()
        {
            let (motion, model) = (short_name(&motion.source), short_name(&model.source));
            return format!("{motion}: it has no joint in common with {model}, neither by name nor by body part");
        }
        problems.join("\n")
    }

    /// Applies a joint map file to every motion it fits.
    pub(super) fn apply_map_file(&mut self, map: &JointMapFile) -> Result<(), String> {
        let Some(model) = self.library.active() else { return Ok(()) };
        if self.library.motions().is_empty() {
            let problem = "this is a joint map, but no motion is loaded; open the motion first, or both together";
            return Err(problem.to_owned());
        }
        let mut fitting = Vec::new();
        let mut problem = None;
        for (index, motion) in self.library.motions().iter().enumerate() {
            match map.to_joint_map(&model.asset, &motion.asset) {
                Ok(map) => fitting.push((index, short_name(&motion.source), map)),
                Err(error) => problem = problem.or(Some(format!("{}: {error}", motion.source))),
            }
        }
        if let Some(problem) = problem.filter(|_| fitting.is_empty()) {
            return Err(problem);
        }
        self.end_gesture();
        let steps = self.undo_steps();
        let mut names = Vec::new();
        for (motion, name, map) in fitting {
            self.apply(Command::EditMap { motion, edit: MapEdit::Load(Box::new(map)) });
            names.push(name);
        }
        self.end_gesture();
        let undoable = self.undo_steps() != steps;
        let text = format!("Applied the joint map to {}.", names.join(", "));
        self.events.push(Event::Notice { text, undoable });
        Ok(())
    }

    /// Retargets the motions' clips if anything they depend on has changed; returns problems not reported before.
    pub(super) fn retarget(&mut self) -> Vec<String> {
        let (maps, problems) = reconciled_maps(&self.library, &self.state);
        let mut new: Vec<String> = problems.iter().map(ToString::to_string).collect();
        if maps != self.state.retarget.map {
            self.record(Command::ReconcileMaps);
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
        new
    }

    /// Returns the active clip if it is retargeted.
    pub(super) fn retargeted_clip(&self) -> Option<ClipIdentity> {
        let model = self.library.active()?;
        let borrowed = model.borrowed(active_clip(model, &self.state)?)?;
        let first = ClipIdentity::first_of(self.library.motions().get(borrowed.motion)?);
        let time_secs = self.state.playhead.time_secs;
        Some(ClipIdentity { source_clip: borrowed.source_clip, time_secs, ..first })
    }

    /// Plays this clip if the model has it, otherwise the first retargeted one; does nothing for `None`.
    pub(super) fn choose_retargeted(&mut self, choice: Option<ClipIdentity>) {
        let (Some(choice), Some(model)) = (choice, self.library.active()) else { return };
        let is_choice = |borrowed: &BorrowedClip| {
            let motion = self.library.motions().get(borrowed.motion);
            borrowed.source_clip == choice.source_clip && motion.is_some_and(|motion| choice.is_of(motion))
        };
        let found = model.borrowed_clips().find(|(_, borrowed)| is_choice(borrowed));
        if let Some((clip, _)) = found.or_else(|| model.borrowed_clips().next()) {
            let found = found.is_some();
            let clip = choice_of_clip(model, clip);
            self.apply(Command::SetClip(clip));
            if found {
                self.apply(Command::Seek(choice.time_secs));
            }
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
        self.set_motions(motions);
        self.retarget();
        (self.needs_redraw, self.is_changed) = (true, true);
    }

    /// Removes a motion and all others from the same archive.
    pub fn remove_motion(&mut self, index: usize) {
        let Some(motion) = self.library.motions().get(index) else { return };
        let (origin, name) = (motion.origin.clone(), short_name(&motion.origin));
        let others = self.library.motions().iter().filter(|motion| motion.origin != origin).cloned().collect();
        let before = self.snapshot();
        let playing = self.retargeted_clip();
        self.keep_motions(others);
        self.remember(before);
        match playing {
            Some(_) if self.library.motions().is_empty() => self.apply(Command::SetClip(ClipChoice::First)),
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
            let map = MotionMap::Numbers(NumberedMap { checksum, map: JointMap::default() });
            if !self.state.retarget.map.contains(&map) && !maps.contains(&map) {
                maps.push(map);
            }
        }
        let before = self.snapshot();
        match self.add_motions(refused, maps) {
            Ok(problems) => {
                self.remember(before);
                self.report(problems);
                self.events.push(Event::MapStarted);
                (self.needs_redraw, self.is_changed) = (true, true);
            }
            Err(error) => self.report(vec![error]),
        }
    }
}

/// Returns the notice for clips that were retargeted from motions.
pub(super) fn added_from(clips: usize, motions: &[Motion]) -> String {
    let names: Vec<String> = motions.iter().map(|motion| short_name(&motion.source)).collect();
    let plural = if clips == 1 { "" } else { "s" };
    format!("Added {clips} clip{plural} from {}.", names.join(", "))
}

/// Whether the map has no pairs yet: the user has just started it.
fn is_unfinished(error: &BorrowError) -> bool {
    matches!(error, BorrowError::Map { problem: MapError::NothingMapped, .. })
}
