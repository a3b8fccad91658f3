//! What becomes of opened files: a model takes the place of the present one, motions are borrowed from, a joint map is
//! put in force. What does not work leaves everything as it was.

use super::App;
use crate::files::Contents;
use crate::library::{BorrowError, Model, Motion};
use crate::retarget::{JointMap, MapError, propose};
use crate::state::{
    ClipChoice, Command, MapEdit, MotionMap, NumberedMap, ViewerState, active_clip, choice_of_clip, maps_in_force,
    names_checksum, numbered, settled_maps,
};
use crate::ui::{Tab, Toast, short_name};

/// Motions that could not be borrowed from, kept so that the person can say what to do with them.
pub(super) struct Refused {
    motions: Vec<Motion>,
    sources: Vec<String>,
}

impl App {
    /// Shows what was opened. With a state, that is taken over too (a link) and nothing is chosen anew.
    pub(super) fn show(&mut self, contents: Contents, state: Option<ViewerState>) -> Result<(), String> {
        let Contents { model, model_files, motions, motion_sources, map, problems } = contents;
        self.refused = None;
        self.panels.error = None;
        self.panels.motion_refused = false;
        let shown = match (model, motions) {
            (Some(model), motions) => {
                let shown = self.show_model(model, motions, motion_sources, map, state);
                if shown.is_ok() {
                    self.model_files = model_files;
                }
                shown
            }
            (None, Some(motions)) => self.borrow_from(motions, motion_sources, map, state),
            (None, None) => map.map_or(Ok(()), |map| self.use_map(&map)),
        };
        self.dirty = true;
        self.changed = true;
        self.tell(problems);
        shown
    }

    /// Puts a model in place of the present one, which stays when the new one does not fit on the device. Without a
    /// state, what is about the old model (clip, time, camera, …) starts anew and the rest is kept; without motions, those
    /// that are there are tried on the new model.
    fn show_model(
        &mut self,
        model: Model,
        motions: Option<Vec<Motion>>,
        motion_sources: Vec<String>,
        map: Option<JointMap>,
        state: Option<ViewerState>,
    ) -> Result<(), String> {
        let source = model.source.clone();
        let borrowed = self.borrowed_choice();
        let before = self.library.take();
        self.library.set(model);
        let uploaded = match self.library.active() {
            Some(model) => self.scene.upload(model, None).map_err(|error| error.to_string()),
            None => Ok(()),
        };
        if let Err(error) = uploaded {
            self.library.put_back(before);
            self.refresh_motion();
            return Err(error);
        }
        self.history.clear();
        let keeps_motions = motions.is_none() && state.is_none();
        if !keeps_motions {
            self.library.set_motions(motions.unwrap_or_default());
        }
        let is_link = state.is_some();
        if !keeps_motions && !is_link {
            self.host.motions_removed();
        }
        self.state = match state {
            Some(state) => state,
            None => {
                let old = std::mem::take(&mut self.state);
                let kept = if keeps_motions { old.clone() } else { ViewerState::default() };
                ViewerState {
                    model: vec![source],
                    motion: if keeps_motions { kept.motion } else { motion_sources },
                    map: kept.map,
                    unmapped: kept.unmapped,
                    root: kept.root,
                    feet: kept.feet,
                    scene: None,
                    clip: ClipChoice::First,
                    time_secs: 0.0,
                    range: None,
                    morph: Default::default(),
                    pose: Default::default(),
                    names: Default::default(),
                    vertex: None,
                    joint: None,
                    camera: Default::default(),
                    up: Default::default(),
                    ..old
                }
            }
        };
        let has_map = map.is_some();
        self.state.map.extend(map.map(MotionMap::Names));
        let problems = self.refresh_motion();
        if keeps_motions {
            self.put_unfit_away();
            self.choose_borrowed(borrowed);
        } else if is_link {
            self.tell(problems);
        } else {
            if !self.library.motions().is_empty() || has_map {
                self.tell(problems);
            }
            self.choose_borrowed(Some((0, 0)));
        }
        Ok(())
    }

    /// Borrows from these files instead of those that are there. Without a state the view stays, and the first clip that
    /// came is chosen; when none did, everything stays as it was.
    fn borrow_from(
        &mut self,
        motions: Vec<Motion>,
        sources: Vec<String>,
        map: Option<JointMap>,
        state: Option<ViewerState>,
    ) -> Result<(), String> {
        if let Some(state) = state {
            self.state = state;
            self.state.map.extend(map.map(MotionMap::Names));
            self.library.set_motions(motions);
            self.history.clear();
            let problems = self.refresh_motion();
            self.tell(problems);
            return Ok(());
        }
        let before = (self.library.motions().to_vec(), self.state.clone());
        self.state = ViewerState {
            motion: sources.clone(),
            map: map.map(MotionMap::Names).into_iter().collect(),
            unmapped: None,
            root: None,
            feet: None,
            ..before.1.clone()
        };
        self.library.set_motions(motions.clone());
        let problems = self.refresh_motion();
        let works = self.library.active().is_some_and(|model| model.clip_count() > model.asset.clips.len());
        if !works && !motions.is_empty() {
            self.library.set_motions(before.0);
            self.state = before.1;
            self.refresh_motion();
            self.refused = Some(Refused { motions, sources });
            self.panels.motion_refused = true;
            return Err(self.why_refused(problems));
        }
        self.history.clear();
        self.tell(problems);
        self.choose_borrowed(Some((0, 0)));
        // The new clip may go elsewhere than the one that the camera was turned to.
        self.apply(Command::FrameAll);
        let names: Vec<String> = sources.iter().map(|source| short_name(source)).collect();
        let clips = self.library.active().map_or(0, |model| model.clip_count() - model.asset.clips.len());
        let clips = if clips == 1 { "A clip is".to_owned() } else { format!("{clips} clips are") };
        self.toast(format!("{clips} borrowed from {}.", names.join(", ")));
        Ok(())
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
    fn use_map(&mut self, map: &JointMap) -> Result<(), String> {
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
        for (motion, map) in fitting {
            self.apply(Command::EditMap { motion, edit: MapEdit::Load(Box::new(map)) });
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

    pub(super) fn tell(&mut self, problems: Vec<String>) {
        if !problems.is_empty() {
            let before = self.panels.error.take().into_iter();
            self.panels.error = Some(before.chain(problems).collect::<Vec<_>>().join("\n"));
        }
    }

    /// Which motion plays, and which of its clips.
    fn borrowed_choice(&self) -> Option<(usize, usize)> {
        let model = self.library.active()?;
        let borrowed = model.borrowed(active_clip(model, &self.state)?)?;
        Some((borrowed.motion, borrowed.source_clip))
    }

    /// Plays this clip of this motion, else the first borrowed one; nothing for none.
    fn choose_borrowed(&mut self, choice: Option<(usize, usize)>) {
        let (Some(choice), Some(model)) = (choice, self.library.active()) else { return };
        let own = model.asset.clips.len();
        let is_it = |&clip: &usize| {
            model.borrowed(clip).is_some_and(|borrowed| (borrowed.motion, borrowed.source_clip) == choice)
        };
        if let Some(clip) = (own..model.clip_count()).find(is_it).or((own < model.clip_count()).then_some(own)) {
            let choice = choice_of_clip(model, clip);
            self.apply(Command::SetClip(choice));
        }
    }

    /// A model has been opened that motions do not fit: they go, quietly, since nobody asked for them.
    fn put_unfit_away(&mut self) {
        let Some(model) = self.library.active() else { return };
        let fits = |motion: usize| {
            (model.asset.clips.len()..model.clip_count())
                .any(|clip| model.borrowed(clip).is_some_and(|borrowed| borrowed.motion == motion))
        };
        let motions = self.library.motions().iter().enumerate();
        let (fit, unfit): (Vec<_>, Vec<_>) = motions.partition(|(index, _)| fits(*index));
        let names: Vec<String> = unfit.iter().map(|(_, motion)| motion.source.clone()).collect();
        let fit: Vec<Motion> = fit.into_iter().map(|(_, motion)| motion.clone()).collect();
        if names.is_empty() {
            return;
        }
        if fit.is_empty() {
            self.state.motion.clear();
            self.state.map.clear();
            self.host.motions_removed();
        }
        self.library.set_motions(fit);
        self.refresh_motion();
        self.toast(format!("Nothing is borrowed from {} any more: it does not fit this model.", names.join(", ")));
    }

    pub(super) fn toast(&mut self, text: String) {
        const SECS: f64 = 2.5;
        const SECS_PER_LETTER: f64 = 0.03;
        let secs = SECS + SECS_PER_LETTER * text.len() as f64;
        let until_secs = self.context.input(|input| input.time) + secs;
        self.panels.toast = Some(Toast { text, until_secs });
    }

    pub(super) fn remove_motions(&mut self) {
        let was_borrowed = self.borrowed_choice().is_some();
        self.library.set_motions(Vec::new());
        self.state.motion.clear();
        self.state.map.clear();
        (self.state.unmapped, self.state.root, self.state.feet) = (None, None, None);
        self.refresh_motion();
        self.history.clear();
        if was_borrowed {
            self.apply(Command::SetClip(ClipChoice::First));
        }
        self.dirty = true;
        self.changed = true;
        self.host.motions_removed();
    }

    /// Shows a motion's own skeleton instead of the model; nothing is borrowed then.
    pub(super) fn show_motion_alone(&mut self, motion: &Motion, sources: Vec<String>) {
        let model = Model::new(motion.source.clone(), motion.asset.clone(), vec![None; motion.asset.images.len()]);
        match self.show_model(model, Some(Vec::new()), Vec::new(), None, None) {
            Ok(()) => {
                self.model_files = None;
                self.state.model = sources;
                self.host.motion_is_model();
            }
            Err(error) => self.panels.error = Some(error),
        }
        self.dirty = true;
        self.changed = true;
    }

    pub(super) fn show_refused_alone(&mut self) {
        if let Some(Refused { motions, sources }) = self.refused.take()
            && let Some(motion) = motions.first()
        {
            self.show_motion_alone(motion, sources);
        }
    }

    /// Takes refused motions in with empty maps, to be filled in by hand.
    pub(super) fn map_refused_by_hand(&mut self) {
        let (Some(Refused { motions, sources }), Some(model)) = (self.refused.take(), self.library.active()) else {
            return;
        };
        let mut maps: Vec<MotionMap> = Vec::new();
        for motion in &motions {
            let checksum = names_checksum(&model.asset, &motion.asset);
            maps.push(MotionMap::Numbers(NumberedMap { checksum, map: JointMap::default() }));
        }
        maps.dedup();
        (self.state.motion, self.state.map) = (sources, maps);
        (self.state.unmapped, self.state.root, self.state.feet) = (None, None, None);
        self.library.set_motions(motions);
        let problems = self.refresh_motion();
        self.tell(problems);
        self.history.clear();
        self.panels.tab = Tab::Motion;
        self.panels.inspector_open = true;
        self.dirty = true;
        self.changed = true;
    }
}

/// A map without any pair is one that a person has just begun.
fn is_unfinished(error: &BorrowError) -> bool {
    matches!(error, BorrowError::Map { problem: MapError::NothingMapped, .. })
}
