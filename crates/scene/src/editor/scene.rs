//! The scene as files and a link that shows them, for pages that contain both.

use std::collections::BTreeSet;

use gaitway_character::asset::SharedBytes;
use gaitway_formats::with_references;

use super::{Editor, short_name};
use crate::library::ModelFiles;
use crate::state::{Embed, EnvironmentChoice, to_link};

/// Everything that shows a view again without a network. Files are in the form that was loaded: compressed geometry is
/// decompressed, and what isn't glTF, BVH or OBJ is a .glb under its original name.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Its name, for people.
    pub title: String,
    /// The part of a link after `#`. It names the main files of the model and the motions, and embeds the view.
    pub link: String,
    /// Names and contents of the model's files.
    pub model: Vec<(String, SharedBytes)>,
    /// Names and contents of the motions' files, and of the image that lights the scene.
    pub motion: Vec<(String, SharedBytes)>,
}

/// The names taken by a scene's files: those of several places may have the same.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Names {
    /// Places files, in a folder of their own if one of their names is taken. Returns the name of the main one, and all of them.
    fn place(&mut self, ModelFiles { set, name: main }: &ModelFiles) -> (String, Vec<(String, SharedBytes)>) {
        let files = with_references(set, main);
        let folder = self.free_folder(|| files.names());
        let placed: Vec<_> = files.iter().map(|(name, bytes)| (format!("{folder}{name}"), bytes.clone())).collect();
        self.0.extend(placed.iter().map(|(name, _)| name.clone()));
        (format!("{folder}{main}"), placed)
    }

    /// Returns a name for one more file.
    fn free(&self, name: &str) -> String {
        format!("{}{name}", self.free_folder(|| [name].into_iter()))
    }

    /// Returns the first folder in which none of these names is taken, with a slash at its end.
    fn free_folder<'a, N: Iterator<Item = &'a str>>(&self, names: impl Fn() -> N) -> String {
        let mut folders = (1..).map(|number| if number == 1 { String::new() } else { format!("{number}/") });
        let is_free = |folder: &String| names().all(|name| !self.0.contains(&format!("{folder}{name}")));
        folders.find(is_free).unwrap_or_default()
    }
}

impl Editor {
    /// Returns the view of the active model with its motions, as files and a link.
    ///
    /// # Errors
    /// The message for the user if there is no model, or something of it is not a file.
    pub fn scene(&self) -> Result<Scene, String> {
        let model = self.complete_model()?;
        if model.is_placeholder() {
            return Err("there is no model".to_owned());
        }
        let mut state = self.shared_state();
        state.page.embed = Embed::Page;
        let mut names = Names::default();
        let (main, model_files) = place(&mut names, &model.origin, self.files_of(model))?;
        state.character.sources.model = vec![main];
        state.character.sources.motion.clear();
        let mut others = Vec::new();
        for motion in self.library.motions() {
            let (main, files) = place(&mut names, &motion.origin, motion.files.as_ref())?;
            state.character.sources.motion.push(main);
            others.extend(files);
        }
        if matches!(state.lighting.environment, EnvironmentChoice::File(_)) {
            state.lighting.environment = EnvironmentChoice::default();
        }
        if let Some(environment) = self.environment() {
            let name = names.free("light/environment.hdr");
            others.push((name.clone(), environment.file.clone()));
            state.lighting.environment = EnvironmentChoice::File(name);
        }
        let (title, link) = (short_name(&model.source), to_link(&state, &self.library));
        Ok(Scene { title, link, model: model_files, motion: others })
    }
}

/// Returns a link's name for a model or motion, and its files; generated samples have none.
fn place(
    names: &mut Names,
    origin: &str,
    files: Option<&ModelFiles>,
) -> Result<(String, Vec<(String, SharedBytes)>), String> {
    match files {
        Some(files) => Ok(names.place(files)),
        None if origin.starts_with("sample:") => Ok((origin.to_owned(), Vec::new())),
        None => Err(format!(
            "{}: this was opened from another model and has no file; open its own file",
            short_name(origin)
        )),
    }
}
