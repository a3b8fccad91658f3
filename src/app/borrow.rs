//! What becomes of opened motions and joint maps: clips are borrowed, a map is put in force. What does not work leaves
//! everything as it was; what works can be undone.

use super::App;
use crate::files::Contents;
use crate::library::{BorrowError, BorrowedClip, Library, Motion};
use crate::retarget::{JointMap, MapError, propose};
use crate::state::{
    ClipChoice, Command, MapEdit, MotionMap, NumberedMap, ViewerState, active_clip, choice_of_clip, maps_in_force,
    names_checksum, numbered, settled_maps,
};
use crate::ui::{Tab, short_name};

/// Motions that could not be borrowed from, kept so that the person can say what to do with them.
pub(super) struct Refused {
    motions: Vec<Motion>,
}

/// A borrowed clip, whichever model it is made over for.
pub(super) struct BorrowedChoice {
    origin: String,
    source: String,
    source_clip: usize,
    time_secs: f64,
}

impl BorrowedChoice {
    pub fn first_of(motion: &Motion) -> Self {
        Self { origin: motion.origin.clone(), source: motion.source.clone(), source_clip: 0, time_secs: 0.0 }
    }

    fn is_of(&self, motion: &Motion) -> bool {
        self.origin == motion.origin && self.source == motion.source
    }
}

impl App {
    /// Borrows from these files too; one that is there already is read anew. Without a state the view stays, and the first
    /// clip that came is chosen; when none did, everything stays as it was.
    pub(super) fn borrow_from(
        &mut self,
        motions: Vec<Motion>,
        map: Option<JointMap>,
        state: Option<ViewerState>,
    ) -> Result<(), String> {
        let before = self.before_opening();
        if let Some(state) = state {
            if state.model != self.state.model {
                let held = self.held(&state).ok_or("something else was opened meanwhile")?;
                self.library.show(held);
                self.upload(&before)?;
            }
            self.remember(before);
            self.state = state;
            self.state.map.extend(map.map(MotionMap::Names));
            self.library.set_motions(motions);
            let problems = self.refresh_motion();
            self.tell(problems);
            return Ok(());
        }
        let problems = self.borrow_also(motions.clone(), map.map(MotionMap::Names))?;
        let first = self.library.motions().len() - motions.len();
        let clips = self
            .library
            .active()
            .map_or(0, |model| model.borrowed_clips().filter(|(_, borrowed)| borrowed.motion >= first).count());
        if clips == 0 && !motions.is_empty() {
            if let Some((state, loaded)) = before {
                self.library.restore(loaded);
                self.state = state;
            }
            self.refresh_motion();
            self.refused = Some(Refused { motions });
            self.panels.motion_refused = true;
            return Err(self.why_refused(problems));
        }
        self.remember(before);
        self.tell(problems);
        self.choose_borrowed(motions.first().map(BorrowedChoice::first_of));
        // The new clip may go elsewhere than the one that the camera was turned to.
        self.apply(Command::FrameAll);
        self.toast_undoable(borrowed_from(clips, &motions));
        Ok(())
    }

    /// Puts motions behind those that are there; what came from the same places gives way. Gives back what does not work.
    /// `maps` are for them.
    fn borrow_also(
        &mut self,
        motions: Vec<Motion>,
        maps: impl IntoIterator<Item = MotionMap>,
    ) -> Result<Vec<String>, String> {
        let is_new = |known: &Motion| motions.iter().any(|motion| motion.origin == known.origin);
        let mut all: Vec<Motion> = self.library.motions().iter().filter(|known| !is_new(known)).cloned().collect();
        all.extend(motions);
        let (together, most) = (all.len(), Library::MAX_MOTIONS);
        if together > most {
            return Err(format!("{together} motions together; at most {most} are borrowed from, remove some first"));
        }
        self.state.map.extend(maps);
        let model = self.library.active().map(|model| model.origin.clone());
        self.state.motion = Contents::motion_sources(&all, model.as_deref());
        self.library.set_motions(all);
        Ok(self.refresh_motion())
    }

    /// The page offers what else can be done, where other places say how to write a map.
    fn why_refused(&self, problems: Vec<String>) -> String {
        let Some(Refused { motions, .. }) = &self.refused else { return problems.join("\n") };
        let (Some(model), [motion]) = (self.library.active(), &motions[..]) else { return problems.join("\n") };
        let has_clips = !motion.asset.clips.is_empty();
        if has_clips && propose(&model.asset, &motion.asset).pairs.is_empty() {
            return format!(
                "{}: it has no joint in common with {}: neither names nor parts of a body agree",
                short_name(&motion.source),
                short_name(&model.source)
            );
        }
        problems.join("\n")
    }

    /// Puts a map in force for every motion that it fits.
    pub(super) fn use_map(&mut self, map: &JointMap) -> Result<(), String> {
        let Some(model) = self.library.active() else { return Ok(()) };
        if self.library.motions().is_empty() {
            return Err(
                "this is a joint map, and there is no motion to use it for; open the motion first, or both together"
                    .to_owned(),
            );
        }
        let mut fitting = Vec::new();
        let mut problem = None;
        for (index, motion) in self.library.motions().iter().enumerate() {
            match numbered(map, &model.asset, &motion.asset) {
                Ok(map) => fitting.push((index, map)),
                Err(error) => problem = problem.or(Some(format!("{}: {error}", motion.source))),
            }
        }
        if let Some(problem) = problem.filter(|_| fitting.is_empty()) {
            return Err(problem);
        }
        let names: Vec<String> = fitting
            .iter()
            .filter_map(|(motion, _)| Some(short_name(&self.library.motions().get(*motion)?.source)))
            .collect();
        self.history.end_gesture();
        let steps = self.history.steps();
        for (motion, map) in fitting {
            self.apply(Command::EditMap { motion, edit: MapEdit::Load(Box::new(map)) });
        }
        self.history.end_gesture();
        let text = format!("The joint map is used for {}.", names.join(", "));
        if self.history.steps() == steps {
            self.toast(text)
        } else {
            self.toast_undoable(text)
        }
        Ok(())
    }

    /// Makes the borrowed clips again if anything they hang on has changed, and gives back what does not work and has not
    /// been told before.
    pub(super) fn refresh_motion(&mut self) -> Vec<String> {
        let (maps, problems) = settled_maps(&self.library, &self.state);
        let mut told: Vec<String> = problems.iter().map(ToString::to_string).collect();
        if maps != self.state.map {
            self.history.apply(&mut self.state, &self.library, Command::SettleMaps);
            self.changed = true;
        }
        let maps = maps_in_force(&self.library, &self.state);
        if self.library.borrow_each(maps) {
            self.dirty = true;
            let errors = self.library.borrow_errors().iter().filter(|error| !is_unfinished(error));
            let errors: Vec<String> = errors.map(ToString::to_string).collect();
            told.extend(errors.iter().filter(|error| !self.borrow_errors.contains(error)).cloned());
            self.borrow_errors = errors;
        }
        told
    }

    pub(super) fn borrowed_choice(&self) -> Option<BorrowedChoice> {
        let model = self.library.active()?;
        let borrowed = model.borrowed(active_clip(model, &self.state)?)?;
        let choice = BorrowedChoice::first_of(self.library.motions().get(borrowed.motion)?);
        Some(BorrowedChoice { source_clip: borrowed.source_clip, time_secs: self.state.time_secs, ..choice })
    }

    /// Plays this clip, else the first borrowed one; nothing for none.
    pub(super) fn choose_borrowed(&mut self, choice: Option<BorrowedChoice>) {
        let (Some(choice), Some(model)) = (choice, self.library.active()) else { return };
        let is_it = |borrowed: &BorrowedClip| {
            let motion = self.library.motions().get(borrowed.motion);
            borrowed.source_clip == choice.source_clip && motion.is_some_and(|motion| choice.is_of(motion))
        };
        let found = model.borrowed_clips().find(|(_, borrowed)| is_it(borrowed));
        if let Some((clip, _)) = found.or_else(|| model.borrowed_clips().next()) {
            let found = found.is_some();
            let clip = choice_of_clip(model, clip);
            self.apply(Command::SetClip(clip));
            if found {
                self.apply(Command::Seek(choice.time_secs));
            }
        }
    }

    /// A model is shown that motions do not fit: they go, without an error, since nobody asked for them. Gives back what is
    /// to be said about it.
    pub(super) fn put_unfit_away(&mut self) -> Option<String> {
        let model = self.library.active()?;
        let fits = |motion: usize| model.borrowed_clips().any(|(_, borrowed)| borrowed.motion == motion);
        let motions = self.library.motions().iter().cloned().enumerate();
        let (fit, unfit): (Vec<_>, Vec<_>) = motions.partition(|(index, _)| fits(*index));
        if unfit.is_empty() {
            return None;
        }
        let names: Vec<String> = unfit.iter().map(|(_, motion)| short_name(&motion.source)).collect();
        self.borrow_only(fit.into_iter().map(|(_, motion)| motion).collect());
        Some(format!("Nothing is borrowed from {} any more: it does not fit this model.", names.join(", ")))
    }

    /// Lets go of all motions but these.
    fn borrow_only(&mut self, motions: Vec<Motion>) {
        let model = self.library.active().map(|model| model.origin.clone());
        self.state.motion = Contents::motion_sources(&motions, model.as_deref());
        if motions.is_empty() {
            self.state.map.clear();
            (self.state.unmapped, self.state.root, self.state.feet) = (None, None, None);
        }
        self.library.set_motions(motions);
        self.refresh_motion();
        (self.dirty, self.changed) = (true, true);
    }

    /// Borrows no more from a motion, and from what came with it out of the same archive.
    pub(super) fn remove_motion(&mut self, index: usize) {
        let Some(motion) = self.library.motions().get(index) else { return };
        let (origin, name) = (motion.origin.clone(), short_name(&motion.origin));
        let others = self.library.motions().iter().filter(|motion| motion.origin != origin).cloned().collect();
        let before = self.before_opening();
        let choice = self.borrowed_choice();
        self.borrow_only(others);
        self.remember(before);
        match choice {
            Some(_) if self.library.motions().is_empty() => self.apply(Command::SetClip(ClipChoice::First)),
            choice => self.choose_borrowed(choice),
        }
        self.toast_undoable(format!("Nothing is borrowed from {name} any more."));
    }

    pub(super) fn show_refused_alone(&mut self) {
        if let Some(Refused { motions }) = self.refused.take()
            && let Some(motion) = motions.first()
        {
            self.show_motion_alone(motion);
        }
    }

    /// Takes refused motions in with empty maps, to be filled in by hand.
    pub(super) fn map_refused_by_hand(&mut self) {
        let (Some(Refused { motions }), Some(model)) = (self.refused.take(), self.library.active()) else {
            return;
        };
        let before = self.before_opening();
        let mut maps: Vec<MotionMap> = Vec::new();
        for motion in &motions {
            let checksum = names_checksum(&model.asset, &motion.asset);
            let map = MotionMap::Numbers(NumberedMap { checksum, map: JointMap::default() });
            if !self.state.map.contains(&map) && !maps.contains(&map) {
                maps.push(map);
            }
        }
        match self.borrow_also(motions, maps) {
            Ok(problems) => {
                self.remember(before);
                self.tell(problems);
            }
            Err(error) => self.tell(vec![error]),
        }
        self.panels.tab = Tab::Motion;
        self.panels.inspector_open = true;
        self.dirty = true;
        self.changed = true;
    }
}

/// Says how many clips came from motions.
pub(super) fn borrowed_from(clips: usize, motions: &[Motion]) -> String {
    let names: Vec<String> = motions.iter().map(|motion| short_name(&motion.source)).collect();
    let clips = match clips {
        1 => "A clip is".to_owned(),
        clips => format!("{clips} clips are"),
    };
    format!("{clips} borrowed from {}.", names.join(", "))
}

/// A map without any pair is one that a person has just begun.
fn is_unfinished(error: &BorrowError) -> bool {
    matches!(error, BorrowError::Map { problem: MapError::NothingMapped, .. })
}
