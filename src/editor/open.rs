//! What becomes of opened models: one is active, the others wait in the list. What fails leaves everything as it was; what
//! works can be undone. Motions and maps that came along: see `motions`.

use std::sync::Arc;

use super::motions::{ClipIdentity, added_from};
use super::names::is_obj;
use super::{Admit, Contents, Editor, Event, ModelFiles, OTHER_FILES, OpenedModel, short_name};
use crate::library::{Library, Loaded, Model, ModelId, Motion};
use crate::retarget::JointMapFile;
use crate::state::{Command, MotionMap, RetargetEdits, Sources, ViewerState, apply};

/// What is kept of a loaded model besides the model.
#[derive(Debug, Default)]
pub(super) struct Shelved {
    /// What it was read from; none for a sample made in code.
    pub files: Option<ModelFiles>,
    /// How it was shown when another was activated, and its motions at that time.
    left: Option<(ViewerState, Vec<Motion>)>,
}

/// What came along with opened models.
struct Companions {
    motions: Option<Vec<Motion>>,
    map: Option<JointMapFile>,
    view: Option<ViewerState>,
}

/// What the notice about an opened model says.
struct Opened {
    name: String,
    is_new: bool,
    others: Vec<String>,
    evicted: Vec<String>,
    lacks_joints: bool,
    about_motions: Option<String>,
}

impl Editor {
    /// Takes in opened files. With `view`, a whole view of them (a link), that replaces the state; otherwise the state is kept
    /// as far as it fits.
    ///
    /// # Errors
    /// What the user sees when nothing could be done with the files; everything is then as it was.
    pub fn open(&mut self, contents: Contents, view: Option<ViewerState>, admit: Admit<'_>) -> Result<(), String> {
        let Contents { models, motions, map, has_own_map, problems } = contents;
        self.has_own_map |= has_own_map;
        self.refused.clear();
        let opened = match motions {
            motions if !models.is_empty() => self.open_models(models, Companions { motions, map, view }, admit),
            Some(motions) => self.open_motions(motions, map, view, admit),
            None => map.map_or(Ok(()), |map| self.apply_map_file(&map)),
        };
        (self.needs_redraw, self.is_changed) = (true, true);
        self.report(problems);
        opened
    }

    /// Activates the first of some models, or the one that the view names, and lists the others. The current one is listed too,
    /// and stays active when the new one is not admitted. Without motions, those that are loaded are tried on the new model.
    fn open_models(
        &mut self,
        mut models: Vec<OpenedModel>,
        companions: Companions,
        admit: Admit<'_>,
    ) -> Result<(), String> {
        let Companions { motions, map, view } = companions;
        let named = view.as_ref().and_then(|view| view.sources.model.first());
        let at = models.iter().position(|opened| Some(&opened.model.origin) == named).unwrap_or(0);
        models.swap(0, at);
        let mut models = models.into_iter();
        let Some(first) = models.next() else { return Ok(()) };
        let (name, origin) = (short_name(&first.model.source), first.model.origin.clone());
        let lacks_joints = is_obj(&name) && first.model.asset.skins.is_empty();
        let before = self.snapshot();
        let playing = self.retargeted_clip();
        let known = self.library.models().len();
        let id = self.add(first);
        if let Err(error) = self.admit(&before, admit) {
            self.library.remove(id);
            self.evict();
            return Err(error);
        }
        let others = models.map(|other| (short_name(&other.model.source), self.add(other)));
        let others: Vec<String> = others.map(|(name, _)| name).collect();
        self.library.show(id);
        self.close_incomplete(id);
        let (is_view, was_loaded) = (view.is_some(), before.is_some());
        self.remember(before);
        let evicted = self.evict();
        let keeps_motions = motions.is_none() && !is_view;
        if !keeps_motions {
            self.library.set_motions(motions.unwrap_or_default());
        }
        match view {
            Some(view) => self.set_view(view),
            None => self.state = self.view_of_new_model(origin, keeps_motions),
        }
        if is_view {
            self.events.push(Event::ViewOpened);
        }
        self.events.push(Event::ModelOpened);
        let has_map = map.is_some();
        self.state.retarget.map.extend(map.map(MotionMap::Names));
        let problems = self.retarget();
        let about_motions = if keeps_motions {
            let dropped = self.drop_incompatible_motions();
            self.choose_retargeted(playing);
            dropped
        } else {
            if is_view || !self.library.motions().is_empty() || has_map {
                self.report(problems);
            }
            self.choose_first_motion(is_view)
        };
        if was_loaded && !is_view {
            let is_new = self.library.models().len() + evicted.len() > known;
            self.notify_undoable(Opened { name, is_new, others, evicted, lacks_joints, about_motions }.text());
        }
        Ok(())
    }

    /// Replaces the state, each value checked as if it had been set alone. Opening is the step of the history, not this.
    fn set_view(&mut self, view: ViewerState) {
        apply(&mut self.state, &self.library, Command::Replace(Box::new(view)));
    }

    /// The default view of a new model, with what a new model does not reset.
    fn view_of_new_model(&mut self, origin: String, keeps_motions: bool) -> ViewerState {
        let old = std::mem::take(&mut self.state);
        let retarget = if keeps_motions { old.retarget.clone() } else { RetargetEdits::default() };
        let motion = Contents::motion_sources(self.library.motions(), Some(&origin));
        let sources = Sources { model: vec![origin], motion, scene: None };
        old.for_model(ViewerState { sources, retarget, ..ViewerState::default() })
    }

    /// Plays the first clip of motions that came with the model, unless a view says what plays; returns what to say about them.
    fn choose_first_motion(&mut self, is_view: bool) -> Option<String> {
        if let Some(motion) = self.library.motions().first().filter(|_| !is_view) {
            let first = ClipIdentity::first_of(motion);
            self.choose_retargeted(Some(first));
        }
        let clips = self.library.active().map_or(0, |model| model.borrowed_clips().count());
        (clips > 0).then(|| added_from(clips, self.library.motions()))
    }

    /// A model that has come with its joints replaces the one that its .obj alone was.
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

    /// Asks whether the active model can be shown; if not, activates what was active before.
    pub(super) fn admit(&mut self, before: &Option<(ViewerState, Loaded)>, admit: Admit<'_>) -> Result<(), String> {
        let Some(Err(error)) = self.library.active().map(admit) else { return Ok(()) };
        if let Some((_, loaded)) = before {
            self.library.restore(loaded.clone());
            self.retarget();
        }
        Err(error)
    }

    /// What undo leads back to; none before anything is loaded.
    pub(super) fn snapshot(&self) -> Option<(ViewerState, Loaded)> {
        self.library.active().map(|_| (self.state.clone(), self.library.loaded()))
    }

    /// Makes a step of what was done since the snapshot, and keeps the view of the model that was active.
    pub(super) fn remember(&mut self, before: Option<(ViewerState, Loaded)>) {
        let Some((state, loaded)) = before else { return };
        if loaded.model != self.library.loaded().model
            && let Some(shelved) = self.shelf.get_mut(&loaded.model)
        {
            shelved.left = Some((state.clone(), loaded.motions.clone()));
        }
        self.history.opened(state, loaded);
    }

    /// Adds a model to the library and activates it; the same file again is the model that is there already.
    fn add(&mut self, opened: OpenedModel) -> ModelId {
        let OpenedModel { model, files } = opened;
        let is_same = |known: &&Model| {
            let same_files = self.shelf.get(&known.id).is_some_and(|shelved| shelved.files == files);
            // Models that were not read from a file are told apart by their asset; a sample is always the same.
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

    /// Evicts models for which there is no room, with what is kept of them; returns their names.
    fn evict(&mut self) -> Vec<String> {
        let evicted = self.library.trim();
        let library: &Library = &self.library;
        self.shelf.retain(|id, _| library.get(*id).is_some());
        self.history.forget_gone(library);
        evicted.iter().map(|model| short_name(&model.source)).collect()
    }

    /// Whether a view's model is loaded, active or not.
    pub fn holds(&self, view: &ViewerState) -> bool {
        view.sources.model == self.state.sources.model || self.held(view).is_some()
    }

    fn held(&self, view: &ViewerState) -> Option<ModelId> {
        let [name] = &view.sources.model[..] else { return None };
        let known = self.library.models().iter().rev().find(|model| model.origin == *name)?;
        Some(known.id)
    }

    /// Replaces the state by a view of a loaded model.
    pub(super) fn open_view(
        &mut self,
        view: ViewerState,
        motions: Vec<Motion>,
        map: Option<JointMapFile>,
        admit: Admit<'_>,
    ) -> Result<(), String> {
        let before = self.snapshot();
        if view.sources.model != self.state.sources.model {
            let held = self.held(&view).ok_or(OTHER_FILES)?;
            self.library.show(held);
            self.admit(&before, admit)?;
        }
        self.remember(before);
        self.set_view(view);
        self.state.retarget.map.extend(map.map(MotionMap::Names));
        self.library.set_motions(motions);
        let problems = self.retarget();
        self.report(problems);
        Ok(())
    }

    /// Activates another loaded model, as it was left. Motions that came since are tried on it, and the retargeted clip that
    /// plays goes on.
    ///
    /// # Errors
    /// Why it cannot be shown; what was active stays.
    pub fn activate(&mut self, id: ModelId, admit: Admit<'_>) -> Result<(), String> {
        let before = self.snapshot();
        let Some((_, loaded)) = before.as_ref().filter(|(_, loaded)| loaded.model != id) else { return Ok(()) };
        let playing = self.retargeted_clip();
        let current = loaded.motions.clone();
        if !self.library.show(id) {
            return Ok(());
        }
        self.admit(&before, admit)?;
        self.remember(before);
        let left = self.shelf.get(&id).and_then(|shelved| shelved.left.clone());
        let origin = self.library.active().map(|model| model.origin.clone()).unwrap_or_default();
        let (left, mut motions) = left.unwrap_or_else(|| (ViewerState::of_model(origin.clone()), Vec::new()));
        // What has been read since wins.
        motions.retain(|known| !current.iter().any(|motion| motion.origin == known.origin));
        motions.extend(current);
        motions.truncate(Library::MAX_MOTIONS);
        let motion = Contents::motion_sources(&motions, Some(&origin));
        let old = std::mem::take(&mut self.state);
        self.state = old.for_model(ViewerState { sources: Sources { motion, ..left.sources }, ..left });
        self.library.set_motions(motions);
        self.retarget();
        if let Some(dropped) = self.drop_incompatible_motions() {
            self.notify(dropped);
        }
        self.choose_retargeted(playing);
        (self.needs_redraw, self.is_changed) = (true, true);
        Ok(())
    }

    /// Closes the placeholder that stood in for a link's missing files, once those are there.
    pub fn close_placeholder(&mut self, origin: &str) {
        let placeholder = self.library.models().iter().find(|model| model.origin == origin).map(|model| model.id);
        if let Some(id) = placeholder {
            self.library.close(id);
        }
    }

    /// Takes a model off the list. When it is the active one, its neighbour is activated, and undo puts it back on the list;
    /// the only one stays.
    ///
    /// # Errors
    /// Why the neighbour cannot be shown; nothing is closed then.
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
    /// Why it cannot be shown.
    pub fn open_motion_alone(&mut self, index: usize, admit: Admit<'_>) -> Result<(), String> {
        match self.library.motions().get(index).cloned() {
            Some(motion) => self.open_alone(&motion, admit),
            None => Ok(()),
        }
    }

    pub(super) fn open_alone(&mut self, motion: &Motion, admit: Admit<'_>) -> Result<(), String> {
        let images = vec![None; motion.asset.images.len()];
        let mut model = Model::new(motion.source.clone(), motion.asset.clone(), images);
        (model.origin, model.is_own) = (motion.origin.clone(), motion.is_own);
        let companions = Companions { motions: Some(Vec::new()), map: None, view: None };
        (self.needs_redraw, self.is_changed) = (true, true);
        self.open_models(vec![model.into()], companions, admit)
    }
}

impl Opened {
    fn text(&self) -> String {
        let mut text = if self.is_new { format!("Opened {}.", self.name) } else { format!("Reopened {}.", self.name) };
        match &self.others[..] {
            [] => {}
            [other] => text += &format!(" {other} is in the model list."),
            others => text += &format!(" {} more are in the model list.", others.len()),
        }
        if !self.evicted.is_empty() {
            text += &format!(" Closed {} to make room.", self.evicted.join(", "));
        }
        if self.lacks_joints {
            text += " Open its .skel and .attach as well to add its joints.";
        }
        if let Some(sentence) = &self.about_motions {
            text += &format!(" {sentence}");
        }
        text
    }
}
