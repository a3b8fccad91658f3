//! What becomes of opened files: a model is shown and the others wait beside it, motions are borrowed from, a joint map is
//! put in force. What does not work leaves everything as it was; what works can be undone.

use std::sync::Arc;

use super::App;
use crate::files::{Contents, ModelFiles, OpenedModel};
use crate::library::{BorrowError, BorrowedClip, Library, Loaded, Model, ModelId, Motion};
use crate::retarget::{JointMap, MapError, propose};
use crate::state::{
    ClipChoice, Command, MapEdit, MotionMap, NumberedMap, Show, ViewerState, active_clip, choice_of_clip,
    maps_in_force, names_checksum, numbered, settled_maps,
};
use crate::ui::{Tab, Toast, short_name};

/// Motions that could not be borrowed from, kept so that the person can say what to do with them.
pub(super) struct Refused {
    motions: Vec<Motion>,
}

/// What is kept of a loaded model besides the model.
#[derive(Default)]
pub(super) struct Shelved {
    /// What it was read from; none for a sample.
    pub files: Option<ModelFiles>,
    /// How it was shown when another was turned to, and what it borrowed then.
    left: Option<(ViewerState, Vec<Motion>)>,
}

/// A borrowed clip, whichever model it is made over for.
struct BorrowedChoice {
    origin: String,
    source: String,
    source_clip: usize,
    time_secs: f64,
}

impl BorrowedChoice {
    fn first_of(motion: &Motion) -> Self {
        Self { origin: motion.origin.clone(), source: motion.source.clone(), source_clip: 0, time_secs: 0.0 }
    }

    fn is_of(&self, motion: &Motion) -> bool {
        self.origin == motion.origin && self.source == motion.source
    }
}

impl App {
    /// Shows what was opened. With a state, that is taken over too (a link) and nothing is chosen anew.
    pub(super) fn show(&mut self, contents: Contents, state: Option<ViewerState>) -> Result<(), String> {
        let Contents { models, motions, map, has_own_map, problems } = contents;
        self.has_own_map |= has_own_map;
        self.refused = None;
        self.panels.error = None;
        self.panels.motion_refused = false;
        let shown = match motions {
            motions if !models.is_empty() => self.show_models(models, motions, map, state),
            Some(motions) => self.borrow_from(motions, map, state),
            None => map.map_or(Ok(()), |map| self.use_map(&map)),
        };
        self.dirty = true;
        self.changed = true;
        self.tell(problems);
        shown
    }

    /// Shows the first of some models, or the one that the state names, and holds the others. The present one is held too, and
    /// stays on the screen when the new one does not fit on the device. Without a state, what is about the old model (clip,
    /// time, camera, …) starts anew and the rest is kept; without motions, those that are there are tried on the new model.
    fn show_models(
        &mut self,
        mut models: Vec<OpenedModel>,
        motions: Option<Vec<Motion>>,
        map: Option<JointMap>,
        state: Option<ViewerState>,
    ) -> Result<(), String> {
        let named = state.as_ref().and_then(|state| state.model.first());
        let at = models.iter().position(|opened| Some(&opened.model.origin) == named).unwrap_or(0);
        models.swap(0, at);
        let mut models = models.into_iter();
        let Some(first) = models.next() else { return Ok(()) };
        let (name, origin) = (short_name(&first.model.source), first.model.origin.clone());
        let lacks_joints = is_obj(&name) && first.model.asset.skins.is_empty();
        let before = self.before_opening();
        let choice = self.borrowed_choice();
        let known = self.library.models().len();
        let id = self.hold(first);
        if let Err(error) = self.upload(&before) {
            self.library.remove(id);
            self.let_go();
            return Err(error);
        }
        let others: Vec<String> = models
            .map(|other| {
                let name = short_name(&other.model.source);
                self.hold(other);
                name
            })
            .collect();
        self.library.show(id);
        self.close_incomplete(id);
        let is_link = state.is_some();
        let was_loaded = before.is_some();
        self.remember(before);
        let gone = self.let_go();
        let keeps_motions = motions.is_none() && !is_link;
        if !keeps_motions {
            self.library.set_motions(motions.unwrap_or_default());
        }
        let motion = Contents::motion_sources(self.library.motions(), Some(&origin));
        self.state = state.unwrap_or_else(|| {
            let old = std::mem::take(&mut self.state);
            let kept = if keeps_motions { old.clone() } else { ViewerState::default() };
            let ViewerState { map, unmapped, root, feet, .. } = kept;
            let model = vec![origin];
            about_model(ViewerState { model, motion, map, unmapped, root, feet, ..ViewerState::default() }, old)
        });
        if is_link {
            self.panels.turn_to_link(&self.state);
            // Space is for the new view, not for a button that was pressed before.
            if let Some(focused) = self.context.memory(|memory| memory.focused()) {
                self.context.memory_mut(|memory| memory.surrender_focus(focused));
            }
        }
        self.panels.turn_to_model(&self.library);
        let has_map = map.is_some();
        self.state.map.extend(map.map(MotionMap::Names));
        let problems = self.refresh_motion();
        let about_motions;
        if keeps_motions {
            about_motions = self.put_unfit_away();
            self.choose_borrowed(choice);
        } else {
            if is_link || !self.library.motions().is_empty() || has_map {
                self.tell(problems);
            }
            if !is_link && let Some(motion) = self.library.motions().first() {
                self.choose_borrowed(Some(BorrowedChoice::first_of(motion)));
            }
            let clips = self.library.active().map_or(0, |model| model.borrowed_clips().count());
            about_motions = (clips > 0).then(|| borrowed_from(clips, self.library.motions()));
        }
        if was_loaded && !is_link {
            let is_new = self.library.models().len() + gone.len() > known;
            let opened = if is_new { "Opened" } else { "Opened again:" };
            let others = match &others[..] {
                [] => String::new(),
                [other] => format!(" {other} is in the list of models."),
                others => format!(" {} others are in the list of models.", others.len()),
            };
            let gone = match &gone[..] {
                [] => String::new(),
                gone => format!(" {} made room.", gone.join(", ")),
            };
            let hint =
                if lacks_joints { " Its joints come with it when its .skel and .attach are opened too." } else { "" };
            let about_motions = about_motions.map(|sentence| format!(" {sentence}")).unwrap_or_default();
            self.toast_undoable(format!("{opened} {name}.{others}{gone}{hint}{about_motions}"));
        }
        Ok(())
    }

    /// A model that has come with its joints takes the place of what its .obj showed without them.
    fn close_incomplete(&mut self, id: ModelId) {
        let Some(whole) = self.library.get(id).filter(|model| !model.asset.skins.is_empty()) else { return };
        let is_part = |known: &&Model| {
            let is_same = known.source == whole.source && known.is_own == whole.is_own;
            is_same && is_obj(&known.source) && known.asset.skins.is_empty()
        };
        if let Some(part) = self.library.models().iter().find(is_part).map(|part| part.id) {
            self.library.close(part);
        }
    }

    /// Brings the shown model to the device; where that does not work, what was there before is shown again.
    fn upload(&mut self, before: &Option<(ViewerState, Loaded)>) -> Result<(), String> {
        let Some(Err(error)) = self.library.active().map(|model| self.scene.upload(model, None)) else { return Ok(()) };
        if let Some((_, loaded)) = before {
            self.library.restore(loaded.clone());
            self.refresh_motion();
        }
        Err(error.to_string())
    }

    /// What a step back leads to; none before there is anything.
    fn before_opening(&self) -> Option<(ViewerState, Loaded)> {
        self.library.active().map(|_| (self.state.clone(), self.library.loaded()))
    }

    /// Makes a step of what was done since, and keeps the view of the model that was shown.
    fn remember(&mut self, before: Option<(ViewerState, Loaded)>) {
        let Some((state, loaded)) = before else { return };
        if loaded.model != self.library.loaded().model
            && let Some(shelved) = self.shelf.get_mut(&loaded.model)
        {
            shelved.left = Some((state.clone(), loaded.motions.clone()));
        }
        self.history.opened(state, loaded);
    }

    /// Puts a model into the library and shows it; the same file again is the model that is there already.
    fn hold(&mut self, opened: OpenedModel) -> ModelId {
        let OpenedModel { model, files } = opened;
        let is_same = |known: &&Model| {
            let same_files = self.shelf.get(&known.id).is_some_and(|shelved| shelved.files == files);
            // What was read from no file is told apart by what it is; a sample is always the same.
            let same_asset =
                files.is_some() || model.source.starts_with("sample:") || Arc::ptr_eq(&known.asset, &model.asset);
            known.source == model.source && known.is_own == model.is_own && same_files && same_asset
        };
        if let Some(id) = self.library.models().iter().find(is_same).map(|known| known.id) {
            self.library.show(id);
            return id;
        }
        let id = self.library.add(model);
        self.shelf.insert(id, Shelved { files, left: None });
        id
    }

    /// Lets go of models for which there is no room, and of what is kept of those that have gone; gives back their names.
    fn let_go(&mut self) -> Vec<String> {
        let gone = self.library.trim();
        let library: &Library = &self.library;
        self.shelf.retain(|id, _| library.get(*id).is_some());
        self.history.forget_gone(library);
        gone.iter().map(|model| short_name(&model.source)).collect()
    }

    /// Whether a view's model is there, shown or not.
    pub fn holds(&self, state: &ViewerState) -> bool {
        state.model == self.state.model || self.held(state).is_some()
    }

    fn held(&self, state: &ViewerState) -> Option<ModelId> {
        let [name] = &state.model[..] else { return None };
        let known = self.library.models().iter().rev().find(|model| model.origin == *name)?;
        Some(known.id)
    }

    /// Shows another of the models that are there, as it was left. Motions that came since are tried on it, and the borrowed
    /// clip that plays goes on.
    pub(super) fn turn_to(&mut self, id: ModelId) {
        let before = self.before_opening();
        let Some((_, loaded)) = before.as_ref().filter(|(_, loaded)| loaded.model != id) else { return };
        let choice = self.borrowed_choice();
        let present = loaded.motions.clone();
        if !self.library.show(id) {
            return;
        }
        if let Err(error) = self.upload(&before) {
            self.tell(vec![error]);
            return;
        }
        self.remember(before);
        let left = self.shelf.get(&id).and_then(|shelved| shelved.left.clone());
        let origin = self.library.active().map(|model| model.origin.clone()).unwrap_or_default();
        let (left, mut motions) =
            left.unwrap_or_else(|| (ViewerState { model: vec![origin.clone()], ..ViewerState::default() }, Vec::new()));
        // What has been read since wins.
        motions.retain(|known| !present.iter().any(|motion| motion.origin == known.origin));
        motions.extend(present);
        motions.truncate(Library::MOST_MOTIONS);
        let motion = Contents::motion_sources(&motions, Some(&origin));
        let old = std::mem::take(&mut self.state);
        self.state = about_model(ViewerState { motion, ..left }, old);
        self.library.set_motions(motions);
        self.refresh_motion();
        if let Some(unfit) = self.put_unfit_away() {
            self.toast(unfit);
        }
        self.choose_borrowed(choice);
        self.dirty = true;
        self.changed = true;
    }

    /// Takes the walker off the list: shown while a link's own files are waited for, it is nothing that anybody asked for.
    #[cfg(target_arch = "wasm32")]
    pub fn close_stand_in(&mut self) {
        let is_walker = |model: &&Model| model.origin.strip_prefix("sample:") == Some(crate::library::sample::WALKER);
        if let Some(walker) = self.library.models().iter().find(is_walker).map(|model| model.id) {
            self.library.close(walker);
            self.context.request_repaint();
        }
    }

    /// Takes a model off the list. When it is the one that is shown, its neighbour is turned to, and the step back to it puts
    /// it on the list again; the only one stays.
    pub(super) fn close_model(&mut self, id: ModelId) {
        let Some(name) = self.library.get(id).map(|model| short_name(&model.source)) else { return };
        if self.library.active().is_some_and(|active| active.id == id) {
            let models = self.library.models();
            let at = models.iter().position(|model| model.id == id).unwrap_or(0);
            let neighbour = models.get(at + 1).or_else(|| models.get(at.checked_sub(1)?)).map(|model| model.id);
            let Some(neighbour) = neighbour else { return };
            self.turn_to(neighbour);
            if self.library.active().is_none_or(|active| active.id != neighbour) {
                return;
            }
        } else {
            self.history.closed(self.library.listed());
        }
        self.library.close(id);
        self.toast_undoable(format!("Closed {name}."));
    }

    /// Borrows from these files too; one that is there already is read anew. Without a state the view stays, and the first
    /// clip that came is chosen; when none did, everything stays as it was.
    fn borrow_from(
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
        let (together, most) = (all.len(), Library::MOST_MOTIONS);
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

    pub(super) fn tell(&mut self, problems: Vec<String>) {
        if !problems.is_empty() {
            let before = self.panels.error.take().into_iter();
            self.panels.error = Some(before.chain(problems).collect::<Vec<_>>().join("\n"));
        }
    }

    fn borrowed_choice(&self) -> Option<BorrowedChoice> {
        let model = self.library.active()?;
        let borrowed = model.borrowed(active_clip(model, &self.state)?)?;
        let choice = BorrowedChoice::first_of(self.library.motions().get(borrowed.motion)?);
        Some(BorrowedChoice { source_clip: borrowed.source_clip, time_secs: self.state.time_secs, ..choice })
    }

    /// Plays this clip, else the first borrowed one; nothing for none.
    fn choose_borrowed(&mut self, choice: Option<BorrowedChoice>) {
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
    fn put_unfit_away(&mut self) -> Option<String> {
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

    /// A toast with a way back.
    fn toast_undoable(&mut self, text: String) {
        self.toast(text);
        if let Some(toast) = &mut self.panels.toast {
            toast.undoable = true;
            toast.until_secs += Toast::UNDOABLE_SECS;
        }
        self.toasted_steps = self.history.steps();
    }

    /// The button of a toast takes back what the toast says: it goes when that is not the last step any more.
    pub(super) fn watch_toast(&mut self) {
        let steps = self.history.steps();
        self.panels.toast.take_if(|toast| toast.undoable && steps != self.toasted_steps);
    }

    /// Whether anything that is shown or borrowed from is a person's own.
    pub fn is_private(&self) -> bool {
        self.has_own_map
            || self.library.active().is_some_and(|model| model.is_own)
            || self.library.motions().iter().any(|motion| motion.is_own)
    }

    pub(super) fn toast(&mut self, text: String) {
        const SECS: f64 = 2.5;
        const SECS_PER_LETTER: f64 = 0.03;
        let secs = SECS + SECS_PER_LETTER * text.len() as f64;
        let until_secs = self.context.input(|input| input.time) + secs;
        self.panels.toast = Some(Toast { text, until_secs, undoable: false });
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

    /// Shows a motion's own skeleton instead of the model; nothing is borrowed then.
    pub(super) fn show_motion_alone(&mut self, motion: &Motion) {
        let images = vec![None; motion.asset.images.len()];
        let mut model = Model::new(motion.source.clone(), motion.asset.clone(), images);
        (model.origin, model.is_own) = (motion.origin.clone(), motion.is_own);
        if let Err(error) = self.show_models(vec![model.into()], Some(Vec::new()), None, None) {
            self.panels.error = Some(error);
        }
        self.dirty = true;
        self.changed = true;
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

/// What `about` says of a model, its motion and the way it is looked at, and of everything else what was set before.
fn about_model(about: ViewerState, before: ViewerState) -> ViewerState {
    ViewerState {
        // Of which joint the weights are shown is about the model, and so is comparing: the next one is first seen whole.
        show: Show { weights: about.show.weights, split: about.show.split, ..before.show },
        model: about.model,
        motion: about.motion,
        map: about.map,
        unmapped: about.unmapped,
        root: about.root,
        feet: about.feet,
        scene: about.scene,
        clip: about.clip,
        time_secs: about.time_secs,
        fade: None,
        range: about.range,
        morph: about.morph,
        pose: about.pose,
        names: about.names,
        vertex: about.vertex,
        joint: about.joint,
        camera: about.camera,
        up: about.up,
        ..before
    }
}

/// Says how many clips came from motions.
fn borrowed_from(clips: usize, motions: &[Motion]) -> String {
    let names: Vec<String> = motions.iter().map(|motion| short_name(&motion.source)).collect();
    let clips = match clips {
        1 => "A clip is".to_owned(),
        clips => format!("{clips} clips are"),
    };
    format!("{clips} borrowed from {}.", names.join(", "))
}

fn is_obj(name: &str) -> bool {
    name.to_lowercase().ends_with(".obj")
}

/// A map without any pair is one that a person has just begun.
fn is_unfinished(error: &BorrowError) -> bool {
    matches!(error, BorrowError::Map { problem: MapError::NothingMapped, .. })
}
