//! Opening, activating and closing models: one is active, the others are in the model list. Operations that fail change
//! nothing; those that succeed can be undone. For motions and maps, see `motions`.
//!
//! Opening is a step like an edit: undo leads back over it to the model, the motions and the whole view that were there. A
//! closed model leaves the list and is kept while there is room.

use std::sync::Arc;

use gaitway_character::asset::Asset;

use super::motions::{Playing, without_still};
use super::names::is_obj;
use super::opened::{Opened, about_images, missing_images};
use super::other_reading::OtherReading;
use super::transact::Change;
use super::{
    AboutLink, Admit, Contents, Editor, Event, ModelFiles, OTHER_FILES, OpenedModel, one_character, short_name,
};
use crate::library::{Environment, Library, Loaded, Model, ModelId, Motion, MotionId};
use crate::state::{
    CharacterView, ClipChoice, Command, Edits, EnvironmentChoice, MotionMap, RetargetEdits, SavedMotion, Sources,
    ViewerState, apply,
};

/// Data kept with a loaded model.
#[derive(Debug, Default)]
pub(super) struct Shelved {
    /// The files it was read from; `None` for generated samples.
    pub files: Option<ModelFiles>,
    /// What was loaded when another model was activated.
    last_view: Option<Snapshot>,
}

/// The loaded files and the state at one moment.
#[derive(Debug, Clone)]
pub(super) struct Snapshot {
    pub state: ViewerState,
    saved_motion: SavedMotion,
    pub loaded: Loaded,
    /// The active clip if it was retargeted.
    pub playing: Option<Playing>,
}

/// What was opened together with models.
struct Companions {
    motions: Option<Vec<Motion>>,
    map: Option<MotionMap>,
    view: Option<ViewerState>,
    is_by_hand: bool,
}

impl Editor {
    /// Adds opened files to the library. A `view` (a link) replaces the state; otherwise as much of the state as fits is kept.
    ///
    /// # Errors
    /// The message for the user if none of the files can be used; nothing has changed then.
    pub fn open(&mut self, mut contents: Contents, view: Option<ViewerState>, admit: Admit<'_>) -> Result<(), String> {
        self.other_reading = None;
        if !contents.is_by_hand || view.is_some() {
            return self.open_contents(contents, view, admit);
        }
        let (models, taken) = one_character::split(std::mem::take(&mut contents.models), self.library.active());
        contents.models = models;
        if !taken.is_empty() {
            contents.motions.get_or_insert_default().extend(one_character::motions(&taken));
        }
        self.open_contents(contents, None, admit)?;
        if !taken.is_empty() {
            // Files that fill an empty stage aren't announced.
            if !self.events.iter().any(|event| matches!(event, Event::Notice { .. })) {
                let added = self.added_from(&one_character::motions(&taken));
                added.into_iter().for_each(|text| self.notify(text));
            }
            self.offer(OtherReading::Models(taken));
        }
        Ok(())
    }

    /// Opens files as they are sorted.
    fn open_contents(&mut self, contents: Contents, view: Option<ViewerState>, admit: Admit<'_>) -> Result<(), String> {
        let Contents {
            models, motions, map, environment, is_map_private, is_by_hand, mut problems, about_link, ..
        } = contents;
        let (is_view, has_models) = (view.is_some(), !models.is_empty());
        let has_step = has_models && self.library.active().is_some();
        let waiting = map.as_ref().map(|opened| MotionMap::of_file(&opened.map));
        self.opened_map = map.as_ref().map(|opened| opened.name.clone());
        self.has_private_map |= is_map_private;
        self.refused.clear();
        self.about_link = about_link;
        let opened = match motions {
            motions if has_models => {
                // A view's motions stay as it names them.
                let motions = match motions {
                    Some(motions) if !is_view && !motions.is_empty() => {
                        let (moving, still) = without_still(motions);
                        problems.extend(still);
                        (!moving.is_empty()).then_some(moving)
                    }
                    motions => motions,
                };
                let opened = self.open_models(models, Companions { motions, map: waiting, view, is_by_hand }, admit);
                if opened.is_ok() {
                    self.suit_automatic_follow();
                }
                opened
            }
            Some(motions) => self.open_motions(motions, waiting, view, is_by_hand, admit),
            None => match (map, view) {
                (Some(opened), _) => self.open_map(&opened.map),
                // The view is of what is loaded.
                (None, Some(view)) => {
                    let before = self.snapshot();
                    self.apply(Command::Replace(Box::new(view)));
                    self.remember(before.filter(|before| !before.state.has_edits_of(&self.state)));
                    Ok(())
                }
                (None, None) => Ok(()),
            },
        };
        self.opened_map = None;
        self.about_link = AboutLink::default();
        if opened.is_ok()
            && let Some(environment) = environment
        {
            self.open_environment(environment, is_view, has_step);
        }
        (self.needs_redraw, self.is_changed) = (true, true);
        self.note_private();
        self.report(problems);
        opened
    }

    /// Adds an environment and lights the scene with it, unless a view says what lights it. With `has_step`, that is part of the
    /// step of the models opened with it.
    fn open_environment(&mut self, environment: Environment, is_view: bool, has_step: bool) {
        let origin = environment.origin.clone();
        self.library.add_environment(environment);
        if is_view {
            return;
        }
        let (notice, light) = (format!("Lit by {}.", short_name(&origin)), EnvironmentChoice::File(origin));
        // A newer file of the same name takes the place of the old one.
        if self.state.lighting.environment == light {
            return self.notify(notice);
        }
        if has_step {
            self.state.lighting.environment = light;
        } else {
            self.record(Command::SetLight(light));
        }
        self.notify_undoable(notice);
    }

    /// Activates the first model, or the one that the view names, and lists the others. The current one stays in the list, and
    /// stays active if the new one is not admitted. The loaded motions are retargeted to the new model, unless a view or
    /// an empty list of motions replaces them. If the new model is the current one with files that it lacked, its view is kept.
    fn open_models(
        &mut self,
        mut models: Vec<OpenedModel>,
        companions: Companions,
        admit: Admit<'_>,
    ) -> Result<(), String> {
        let Companions { motions, map, view, is_by_hand } = companions;
        let (is_view, has_map) = (view.is_some(), map.is_some());
        let keeps_motions = !is_view && motions.as_ref().is_none_or(|motions| !motions.is_empty());
        let motions = motions.unwrap_or_default();
        let count = motions.len();
        let borrows = is_by_hand && !is_view && count > 0;
        if keeps_motions {
            self.check_room(&motions)?;
        }
        let named = view.as_ref().and_then(|view| view.character.sources.model.first());
        let at = models.iter().position(|opened| Some(&opened.model.origin) == named).unwrap_or(0);
        models.swap(0, at);
        let mut models = models.into_iter();
        let Some(first) = models.next() else { return Ok(()) };
        let (name, origin) = (short_name(&first.model.source), first.model.origin.clone());
        let lacks_joints = is_jointless_obj(&name, &first.model.asset);
        let about_images = about_images(&first.model.asset);
        let before = self.snapshot();
        let playing = before.as_ref().and_then(|before| before.playing.clone());
        let (id, is_new) = self.add(first);
        if let Err(error) = self.admit(&before, admit) {
            self.library.remove(id);
            self.evict();
            return Err(error);
        }
        let mut others = Vec::new();
        for other in models {
            others.push(short_name(&other.model.source));
            self.add(other);
        }
        self.library.show(id);
        let completed = self.close_incomplete(id);
        let older = if is_by_hand && !is_view { self.close_older_version(before.as_ref(), id) } else { None };
        let completes = before.as_ref().is_some_and(|before| completed.contains(&before.loaded.model));
        let keeps_view = completes || older.is_some();
        if !keeps_view {
            self.suits_follow = is_by_hand;
        }
        let (was_loaded, before) = (before.is_some(), self.close_placeholders(before));
        let before = if is_by_hand { self.shelve_untouched_sample(before) } else { before };
        let has_step = before.is_some();
        self.remember(before);
        let evicted = self.evict();
        self.events.extend(is_view.then_some(Event::ViewOpened));
        self.events.push(Event::ModelOpened);
        let about_view = older.and_then(|older| self.fit_view_to_version(older));
        let about_motions = if keeps_motions {
            self.state = self.view_of_opened_model(origin, keeps_motions, keeps_view);
            self.carry_motions_over(playing, motions, map, is_by_hand && !keeps_view)
        } else {
            self.show_with(motions, map, view, origin, keeps_view);
            None
        };
        self.events.extend((borrows && self.retargeted_clip().is_some()).then_some(Event::MotionsAdded));
        let about_feet = if borrows && !has_map { self.suit_feet(count) } else { None };
        let opened =
            Opened { name, is_new, others, evicted, lacks_joints, about_images, about_view, about_motions, about_feet };
        self.announce(&opened, was_loaded && !is_view, has_step);
        older.into_iter().for_each(|older| self.offer(OtherReading::Both(older)));
        Ok(())
    }

    /// Shows an opened model with these motions alone, in `view` if there is one.
    fn show_with(
        &mut self,
        motions: Vec<Motion>,
        map: Option<MotionMap>,
        view: Option<ViewerState>,
        origin: String,
        keeps_view: bool,
    ) {
        let problems = self.transact(Change::View, |editor| {
            editor.library.set_motions(motions);
            match view.clone() {
                Some(view) => editor.set_view(view),
                None => editor.state = editor.view_of_opened_model(origin, false, keeps_view),
            }
            editor.state.character.retarget.map.extend(map);
        });
        match view {
            Some(view) => self.settle_view(&view, problems),
            None => self.report(problems),
        }
    }

    /// Tells what was opened, if it took the place of another model or of an empty stage, and what was done to its feet.
    /// `has_step`: undo takes it back.
    fn announce(&mut self, opened: &Opened, is_replacement: bool, has_step: bool) {
        if is_replacement {
            let undoable = has_step || opened.about_feet.is_some();
            self.events.push(Event::Notice { text: opened.text(), undoable });
        } else if let Some(about_feet) = opened.about_feet {
            self.notify_undoable(about_feet.to_owned());
        }
    }

    /// Replaces the state, checking each value as if it had been set alone. Adds no step to the history: opening is the step.
    pub(super) fn set_view(&mut self, view: ViewerState) {
        let mut view = self.view_with_reduced_motion(view);
        view.character.retarget.feet_are_automatic = false;
        (self.held_camera, self.suits_follow) = (None, false);
        apply(&mut self.state, &self.library, Command::Replace(Box::new(view)));
    }

    /// Returns the view of an opened model: the default one, with the settings that a new model keeps, or the whole view as it was.
    fn view_of_opened_model(&mut self, origin: String, keeps_motions: bool, keeps_view: bool) -> ViewerState {
        let old = std::mem::take(&mut self.state);
        // Without motions, a map is what is left of a link whose files never came.
        let keeps_maps = keeps_motions && (keeps_view || !self.library.motions().is_empty());
        let retarget = if keeps_maps { old.character.retarget.clone() } else { RetargetEdits::default() };
        let motion = Contents::motion_sources(self.library.motions(), Some(&origin));
        let sources = Sources { model: vec![origin], motion, scene: None };
        if keeps_view {
            let sources = Sources { scene: old.character.sources.scene, ..sources };
            return ViewerState { character: CharacterView { sources, retarget, ..old.character }, ..old };
        }
        let is_private = old.is_private && retarget != RetargetEdits::default();
        old.for_model(ViewerState {
            character: CharacterView { sources, retarget, ..CharacterView::default() },
            is_private,
            ..ViewerState::default()
        })
    }

    /// Keeps the loaded motions that fit the new model and adds the new ones. Plays the first new clip, otherwise the one that the
    /// model was written for, if `plays_added`, otherwise the one that was playing. Returns the notice about added and dropped
    /// motions.
    fn carry_motions_over(
        &mut self,
        playing: Option<Playing>,
        new: Vec<Motion>,
        mut map: Option<MotionMap>,
        plays_added: bool,
    ) -> Option<String> {
        let has_map_for_loaded = new.is_empty() && map.is_some();
        if has_map_for_loaded {
            self.state.character.retarget.map.extend(map.take());
        }
        let problems = self.retarget();
        if has_map_for_loaded {
            self.report(problems);
        }
        let dropped = self.drop_incompatible_motions();
        let about_clip = if new.is_empty() {
            let added = plays_added.then(|| self.choose_added("It")).flatten();
            added.or_else(|| self.continue_retargeted(playing, "It"))
        } else {
            let problems = self.add_motions(new.clone(), map);
            self.report(problems);
            self.choose_retargeted(self.first_of(&new));
            self.added_from(&new)
        };
        let sentences: Vec<String> = [about_clip, dropped].into_iter().flatten().collect();
        (!sentences.is_empty()).then(|| sentences.join(" "))
    }

    /// Closes the models that lacked files of this one, and returns them.
    fn close_incomplete(&mut self, id: ModelId) -> Vec<ModelId> {
        let Some(complete) = self.library.get(id) else { return Vec::new() };
        let main_file = |model: &Model| self.files_of(model).and_then(|files| files.set.original(&files.name));
        let (main, lacks) = (main_file(complete), lacking(complete));
        // Many models are called “scene.gltf”. One that awaits its images has no file to compare, but its whole URL as a name.
        let is_incomplete = |known: &&Model| {
            known.source == complete.source
                && known.is_own == complete.is_own
                && lacking(known) > lacks
                && main.is_some()
                && (known.awaits_images() || main_file(known) == main)
        };
        let closed: Vec<ModelId> = self.library.models().iter().filter(is_incomplete).map(|known| known.id).collect();
        closed.iter().for_each(|&id| self.library.close(id));
        closed
    }

    /// Closes the empty stages that have waited for a model, once something else is active. Returns the snapshot unless it is of
    /// one of them: nobody wants that back.
    fn close_placeholders(&mut self, before: Option<Snapshot>) -> Option<Snapshot> {
        let placeholders = self.library.models().iter().filter(|model| model.is_placeholder());
        let placeholders: Vec<ModelId> = placeholders.map(|model| model.id).collect();
        placeholders.iter().for_each(|&id| self.library.close(id));
        before.filter(|before| !placeholders.contains(&before.loaded.model))
    }

    /// Checks that the active model can be shown; if not, restores what was active before.
    pub(super) fn admit(&mut self, before: &Option<Snapshot>, admit: Admit<'_>) -> Result<(), String> {
        let Some(Err(error)) = self.library.active().map(admit) else { return Ok(()) };
        if let Some(before) = before {
            self.library.restore(before.loaded.clone());
            self.retarget();
        }
        Err(error)
    }

    /// Returns what undo restores; `None` before anything is loaded.
    pub(super) fn snapshot(&self) -> Option<Snapshot> {
        self.library.active()?;
        let (state, loaded) = (self.state.clone(), self.library.loaded());
        Some(Snapshot { state, saved_motion: self.reduced_motion.saved, loaded, playing: self.retargeted_clip() })
    }

    /// Adds the changes since the snapshot to the history as a step, and shelves the view of the previously active model.
    pub(super) fn remember(&mut self, before: Option<Snapshot>) {
        let Some(before) = before else { return };
        self.shelve(&before);
        self.history.opened(before.state, before.saved_motion, before.loaded);
    }

    fn shelve(&mut self, before: &Snapshot) {
        if before.loaded.model != self.library.loaded().model
            && let Some(shelved) = self.shelf.get_mut(&before.loaded.model)
        {
            shelved.last_view = Some(before.clone());
        }
    }

    /// Shelves the view of the sample that was there before the user did anything. To undo the user's first file would only bring that
    /// back, so opening it is no step. Returns any other snapshot.
    fn shelve_untouched_sample(&mut self, before: Option<Snapshot>) -> Option<Snapshot> {
        let is_sample = |before: &Snapshot| {
            self.library.get(before.loaded.model).is_some_and(|model| model.source.starts_with("sample:"))
        };
        if self.history.can_undo() || !before.as_ref().is_some_and(is_sample) {
            return before;
        }
        before.iter().for_each(|before| self.shelve(before));
        None
    }

    /// Adds a model to the library and activates it, or the same file's if it is already loaded. Returns whether it is new.
    pub(super) fn add(&mut self, opened: OpenedModel) -> (ModelId, bool) {
        let OpenedModel { model, files } = opened;
        let is_same = |known: &&Model| {
            // Models not read from a file are identified by their asset; a sample is always the same.
            let same_asset =
                files.is_some() || model.source.starts_with("sample:") || Arc::ptr_eq(&known.asset, &model.asset);
            // Byte by byte, so only where everything else is the same.
            let same_files = || self.shelf.get(&known.id).is_some_and(|shelved| shelved.files == files);
            known.source == model.source && known.is_own == model.is_own && same_asset && same_files()
        };
        if let Some(id) = self.library.models().iter().find(is_same).map(|known| known.id) {
            self.library.show(id);
            return (id, false);
        }
        let id = self.library.add(model);
        self.shelf.insert(id, Shelved { files, last_view: None });
        (id, true)
    }

    /// Evicts models to make room, with everything kept about them, those that the user has edited last; returns their names.
    pub(super) fn evict(&mut self) -> Vec<String> {
        let is_edited = |id| {
            let view = self.shelf.get(&id).and_then(|shelved: &Shelved| shelved.last_view.as_ref());
            view.is_some_and(|view| {
                view.state.character.edits != Edits::default() || !view.state.character.retarget.map.is_empty()
            })
        };
        let evicted = self.library.trim(is_edited);
        let library: &Library = &self.library;
        self.shelf.retain(|id, _| library.get(*id).is_some());
        self.history.forget_gone(library);
        evicted.iter().map(|model| short_name(&model.source)).collect()
    }

    /// Whether a view's models are loaded, active or not.
    pub fn holds(&self, view: &ViewerState) -> bool {
        view.character.sources.model == self.state.character.sources.model || self.find_loaded(view).is_some()
    }

    /// Returns the model that a view shows if all that it lists are loaded.
    fn find_loaded(&self, view: &ViewerState) -> Option<ModelId> {
        let mut known = view.character.sources.model.iter().map(|name| {
            let known = self.library.models().iter().rev().find(|model| model.origin == *name)?;
            Some(known.id)
        });
        let first = known.next()??;
        known.all(|other| other.is_some()).then_some(first)
    }

    /// Replaces the state by a view of a loaded model.
    pub(super) fn open_view(
        &mut self,
        view: ViewerState,
        motions: Vec<Motion>,
        map: Option<MotionMap>,
        admit: Admit<'_>,
    ) -> Result<(), String> {
        let before = self.snapshot();
        if view.character.sources.model != self.state.character.sources.model {
            let id = self.find_loaded(&view).ok_or(OTHER_FILES)?;
            self.library.show(id);
            self.admit(&before, admit)?;
            self.events.extend([Event::ViewOpened, Event::ModelOpened]);
        }
        self.remember(before);
        let problems = self.transact(Change::View, |editor| {
            editor.set_view(view.clone());
            editor.state.character.retarget.map.extend(map);
            editor.library.set_motions(motions);
        });
        self.settle_view(&view, problems);
        Ok(())
    }

    /// Completes a model that was opened before its images had arrived, if it is still loaded. Neither the view nor the history
    /// changes.
    ///
    /// # Errors
    /// The message for the user if the model, now active, cannot be shown with them.
    pub fn complete(&mut self, id: ModelId, opened: OpenedModel, admit: Admit<'_>) -> Result<(), String> {
        let OpenedModel { model, files } = opened;
        self.library.complete(id, model);
        if let Some(shelved) = self.shelf.get_mut(&id) {
            shelved.files = files;
        }
        self.needs_redraw = true;
        self.library.active().filter(|model| model.id == id).map_or(Ok(()), admit)
    }

    /// Activates another loaded model with the view it had: its clip, time, range and camera. Motions added since then are
    /// retargeted to it. A model that was never active plays the clip that it was written for, otherwise the retargeted clip that
    /// is active.
    ///
    /// # Errors
    /// The message for the user if it cannot be shown; nothing changes then.
    pub fn activate(&mut self, id: ModelId, admit: Admit<'_>) -> Result<(), String> {
        let before = self.snapshot();
        let Some(current) = before.clone().filter(|before| before.loaded.model != id) else { return Ok(()) };
        if !self.library.show(id) {
            return Ok(());
        }
        self.admit(&before, admit)?;
        self.remember(before);
        let last = self.shelf.get(&id).and_then(|shelved| shelved.last_view.clone());
        let origin = self.library.active().map(|model| model.origin.clone()).unwrap_or_default();
        let is_first_time = last.is_none();
        let (view, mut motions, playing) = match last {
            Some(last) => (last.state, last.loaded.motions, last.playing),
            None => (ViewerState::of_model(origin.clone()), Vec::new(), current.playing),
        };
        // Motions loaded since then take precedence.
        motions.retain(|known| !current.loaded.motions.iter().any(|motion| motion.origin == known.origin));
        motions.extend(current.loaded.motions);
        motions.truncate(Library::MAX_MOTIONS);
        let motion = Contents::motion_sources(&motions, Some(&origin));
        let old = std::mem::take(&mut self.state);
        // Where an orbit camera's target is depends on it.
        let follow = if is_first_time { &old } else { &view }.camera_options.follow;
        self.transact(Change::View, |editor| {
            editor.state = old.for_model(ViewerState {
                character: CharacterView { sources: Sources { motion, ..view.character.sources }, ..view.character },
                ..view
            });
            editor.state.camera_options.follow = follow;
            editor.library.set_motions(motions);
        });
        let dropped = self.drop_incompatible_motions();
        let mut about_clip = None;
        match playing {
            playing if is_first_time => {
                let name = self.library.active().map(|model| short_name(&model.source)).unwrap_or_default();
                about_clip = self.choose_added(&name).or_else(|| self.continue_retargeted(playing, &name));
            }
            Some(clip) if !self.keep_retargeted(&clip) => self.apply(Command::SetClip(ClipChoice::First)),
            _ => {}
        }
        let sentences: Vec<String> = [about_clip, dropped].into_iter().flatten().collect();
        if !sentences.is_empty() {
            self.notify(sentences.join(" "));
        }
        self.suit_automatic_follow();
        Ok(())
    }

    /// Removes a model from the list. If it is active, its neighbour is activated; the only model cannot be closed. Undo brings
    /// it back.
    ///
    /// # Errors
    /// The message for the user if the neighbour cannot be shown; nothing is closed then.
    pub fn close(&mut self, id: ModelId, admit: Admit<'_>) -> Result<(), String> {
        let Some(name) = self.library.get(id).map(|model| short_name(&model.source)) else { return Ok(()) };
        if self.library.active().is_some_and(|active| active.id == id) {
            let models = self.library.models();
            let at = models.iter().position(|model| model.id == id).unwrap_or(0);
            let neighbour = models.get(at + 1).or_else(|| models.get(at.checked_sub(1)?)).map(|model| model.id);
            let Some(neighbour) = neighbour else { return Ok(()) };
            self.activate(neighbour, admit)?;
        } else {
            self.history.closed(self.library.listed());
        }
        self.library.close(id);
        self.notify_undoable(format!("Closed {name}."));
        Ok(())
    }

    /// Opens a motion's own skeleton as the model, without motions.
    ///
    /// # Errors
    /// The message for the user if it cannot be shown.
    pub fn open_motion_alone(&mut self, motion: &MotionId, admit: Admit<'_>) -> Result<(), String> {
        match self.library.motion(motion).cloned() {
            Some(motion) => self.open_alone(&motion, admit),
            None => Ok(()),
        }
    }

    pub(super) fn open_alone(&mut self, motion: &Motion, admit: Admit<'_>) -> Result<(), String> {
        let images = vec![None; motion.asset.images.len()];
        let mut model = Model::new(motion.source.clone(), motion.asset.clone(), images);
        (model.origin, model.is_own) = (motion.origin.clone(), motion.is_own);
        let companions = Companions { motions: Some(Vec::new()), map: None, view: None, is_by_hand: true };
        self.open_models(vec![model.into()], companions, admit)
    }
}

/// Number of images that a model lacks; the joints of an .obj count as one more.
fn lacking(model: &Model) -> usize {
    let images = if model.awaits_images() { model.asset.images.len() } else { missing_images(&model.asset).len() };
    images + usize::from(is_jointless_obj(&model.source, &model.asset))
}

fn is_jointless_obj(source: &str, asset: &Asset) -> bool {
    is_obj(source) && asset.skins.is_empty()
}
