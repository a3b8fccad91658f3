//! `gaitway convert --out OUT.html`: a self-contained page that shows a scene.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use gaitway_scene::editor::Editor;
use gaitway_scene::state::{ClipChoice, Command};

use super::failure::{Failure, Outcome};
use super::moment::show_clip;
use super::motion::{MotionArguments, Overrides, apply_link, open_editor};
use super::output::{check_output, extension_of, write_output};
use super::{ConvertArguments, open};
use crate::files::{Backend, Disk, Opened, WebPage, has_ktx2, read_template};

/// File extensions of pages.
pub(super) const EXTENSIONS: &[&str] = &["html", "htm"];

/// Width and height of pictures for previews.
pub(super) const PICTURE_SIZE: [u32; 2] = [1200, 630];

/// Options that only a page has.
#[derive(Debug, Args)]
pub(super) struct PageArguments {
    #[command(flatten)]
    motion: MotionArguments,
    /// Of an .html: its title [default: the model's name].
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Of an .html: what it draws with. With WebGPU it is smaller, but not every browser opens it [default: webgl2].
    #[arg(long, value_enum)]
    renderer: Option<RendererArgument>,
    /// Of an .html: the folder with the page's program, such as dist of `cargo xtask build` [default: $GAITWAY_PAGE, or beside
    /// this program].
    #[arg(long, value_name = "FOLDER")]
    page: Option<PathBuf>,
}

impl PageArguments {
    pub(super) fn is_none(&self) -> bool {
        let MotionArguments { motion, map } = &self.motion;
        motion.is_none() && map.is_none() && self.title.is_none() && self.renderer.is_none() && self.page.is_none()
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum RendererArgument {
    Webgl2,
    Webgpu,
}

impl From<RendererArgument> for Backend {
    fn from(argument: RendererArgument) -> Self {
        match argument {
            RendererArgument::Webgl2 => Self::WebGl2,
            RendererArgument::Webgpu => Self::WebGpu,
        }
    }
}

pub(super) fn is_page(out: &Path) -> bool {
    extension_of(out).is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
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
    let page = page_of(&editor, &template, page.title.as_deref(), picture.as_deref())?;
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

/// Reads the template; see [`read_template`]. Without a folder, it is looked for near `prefix` and this program.
pub(super) fn template(backend: Backend, folder: Option<&Path>, prefix: Option<&Path>) -> Outcome<String> {
    let own = std::env::current_exe().ok().and_then(|program| program.parent().map(Path::to_owned));
    let near: Vec<PathBuf> = prefix.map(Path::to_owned).into_iter().chain(own).collect();
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

/// Returns the page that shows what the editor shows.
pub(super) fn page_of(editor: &Editor, template: &str, title: Option<&str>, picture: Option<&[u8]>) -> Outcome<String> {
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
