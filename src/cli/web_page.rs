//! `gaitway convert --out OUT.html`: a page that shows a scene by itself.

use std::path::{Path, PathBuf};

use gaitway_scene::editor::Editor;
use gaitway_scene::state::{ClipChoice, Command};

use super::failure::{Failure, Outcome};
use super::motion::{MotionArguments, Overrides, apply_link, open_editor};
use super::output::{check_output, write_output};
use super::{ConvertArguments, open, show_clip};
use crate::files::{Backend, Disk, Opened, WebPage, has_ktx2, read_template};

/// File extensions of pages.
pub(super) const EXTENSIONS: &[&str] = &["html", "htm"];

/// Width and height of pictures for previews.
pub(super) const PICTURE_SIZE: [u32; 2] = [1200, 630];

pub(super) fn is_page(out: &Path) -> bool {
    let extension = out.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase);
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

pub(super) fn run(arguments: &ConvertArguments, disk: &Disk) -> Outcome {
    check_output(&arguments.out, EXTENSIONS, disk)?;
    let unused =
        [("--unit", arguments.unit.is_some()), ("its name, changes, layers and pins", !arguments.edits.is_none())];
    if let Some((unused, _)) = unused.into_iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::expected("a link with the changes", unused).at("--view"));
    }
    let page = &arguments.page;
    let template = template(page.renderer.map(Into::into).unwrap_or_default(), page.page.as_deref(), None)?;
    let opened = open(&arguments.input.files, disk)?;
    let view = View { link: arguments.view.as_deref(), clip: arguments.clip.as_deref() };
    let editor = editor_of(opened, &page.motion, view, disk)?;
    let picture = picture_of(&editor);
    let page = written(&editor, &template, page.title.as_deref(), picture.as_deref())?;
    write_output(&arguments.out, page.as_bytes(), EXTENSIONS, disk)
}

/// The view that a page shows.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct View<'a> {
    /// Overridden by the rest.
    pub link: Option<&'a str>,
    /// A clip's name or index; clips of the motion come first.
    pub clip: Option<&'a str>,
}

/// Reads the template from `folder`, otherwise from beside this program and from `more`.
pub(super) fn template(backend: Backend, folder: Option<&Path>, more: Option<&Path>) -> Outcome<String> {
    let own = std::env::current_exe().ok().and_then(|program| program.parent().map(Path::to_owned));
    let near: Vec<PathBuf> = more.map(Path::to_owned).into_iter().chain(own).collect();
    read_template(backend, folder, &near).map_err(Failure::new)
}

/// Opens the scene, which plays unless its link says otherwise.
pub(super) fn editor_of(opened: Opened, motion: &MotionArguments, view: View<'_>, disk: &Disk) -> Outcome<Editor> {
    let has_motion = motion.motion.is_some() || !opened.motions.is_empty();
    let mut editor = open_editor(opened, motion, disk)?;
    match view.link {
        Some(link) => {
            let overrides = Overrides { clip: view.clip.is_some(), ..Overrides::default() };
            apply_link(&mut editor, link, motion, overrides, disk)?;
        }
        None => {
            editor.apply(Command::SetClip(ClipChoice::First));
            editor.apply(Command::SetPlaying(true));
        }
    }
    if view.clip.is_some() || view.link.is_none() {
        show_clip(&mut editor, view.clip, has_motion)?;
    }
    Ok(editor)
}

/// Returns the page.
pub(super) fn written(editor: &Editor, template: &str, title: Option<&str>, picture: Option<&[u8]>) -> Outcome<String> {
    let scene = editor.scene().map_err(Failure::new)?;
    let title = title.unwrap_or(&scene.title);
    let has_ktx2 = editor.library().active().is_some_and(|model| has_ktx2(&model.asset));
    let page = WebPage { title, picture, scene: &scene, has_ktx2 };
    page.write(template).ok_or_else(|| Failure::new("the page's program is of another version than this program"))
}

/// Returns a picture of the view as a JPEG, if there is a graphics driver.
#[cfg(feature = "render")]
pub(super) fn picture_of(editor: &Editor) -> Option<Vec<u8>> {
    let picture = super::render::picture(editor, PICTURE_SIZE);
    picture.inspect_err(|problem| super::output::warn(&format!("the page has no picture: {}", problem.message()))).ok()
}

#[cfg(not(feature = "render"))]
pub(super) fn picture_of(_editor: &Editor) -> Option<Vec<u8>> {
    super::output::warn("the page has no picture: this gaitway was built without `render`");
    None
}
