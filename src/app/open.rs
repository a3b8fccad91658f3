//! What becomes of opened files: a model is shown and the others wait beside it. What does not work leaves everything as it
//! was; what works can be undone. Motions and maps that came with it: see `borrow`.

use std::sync::Arc;

use super::App;
use super::borrow::{BorrowedChoice, borrowed_from};
use crate::files::{Contents, ModelFiles, OpenedModel};
use crate::library::{Library, Loaded, Model, ModelId, Motion};
use crate::retarget::JointMap;
use crate::state::{MotionMap, Show, ViewerState};
use crate::ui::short_name;

/// What is kept of a loaded model besides the model.
#[derive(Default)]
pub(super) struct Shelved {
    /// What it was read from; none for a sample.
    pub files: Option<ModelFiles>,
    /// How it was shown when another was turned to, and what it borrowed then.
    left: Option<(ViewerState, Vec<Motion>)>,
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
    pub(super) fn upload(&mut self, before: &Option<(ViewerState, Loaded)>) -> Result<(), String> {
        let Some(Err(error)) = self.library.active().map(|model| self.scene.upload(model, None)) else { return Ok(()) };
        if let Some((_, loaded)) = before {
            self.library.restore(loaded.clone());
            self.refresh_motion();
        }
        Err(error.to_string())
    }

    /// What a step back leads to; none before there is anything.
    pub(super) fn before_opening(&self) -> Option<(ViewerState, Loaded)> {
        self.library.active().map(|_| (self.state.clone(), self.library.loaded()))
    }

    /// Makes a step of what was done since, and keeps the view of the model that was shown.
    pub(super) fn remember(&mut self, before: Option<(ViewerState, Loaded)>) {
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

    pub(super) fn held(&self, state: &ViewerState) -> Option<ModelId> {
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
        motions.truncate(Library::MAX_MOTIONS);
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
        let is_walker = |model: &&Model| model.origin.strip_prefix("sample:") == Some(crate::samples::WALKER);
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

    /// Whether anything that is shown or borrowed from is a person's own.
    pub fn is_private(&self) -> bool {
        self.has_own_map
            || self.library.active().is_some_and(|model| model.is_own)
            || self.library.motions().iter().any(|motion| motion.is_own)
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

fn is_obj(name: &str) -> bool {
    name.to_lowercase().ends_with(".obj")
}
