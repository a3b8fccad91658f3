//! `gaitway card`: a page that redirects to a link and has a title and a picture of its own, for previews.

use std::path::PathBuf;

use clap::Args;
use gaitway_scene::editor::short_name;
use gaitway_scene::state::{Sources, from_link};

use super::failure::{Failure, Outcome};
use super::motion::{MotionArguments, Overrides, apply_link, open_editor};
use super::open;
use super::output::{check_output, is_standard_output, save_output, warn};
use super::web_page::{EXTENSIONS, PICTURE_SIZE, picture_of};
use crate::files::{Disk, escaped};

/// xtask/site/cards.mjs fills it for the page's own scenes.
const TEMPLATE: &str = include_str!("card.html");
const TEXT: &str = "Watch it move in the browser.";

#[derive(Debug, Args)]
pub(super) struct CardArguments {
    /// A link of the page.
    link: String,
    /// Copies of the link's model, for the picture [default: the link's own, if that is a sample].
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The page to write. Its picture goes beside it.
    #[arg(long, value_name = "OUT.html")]
    out: PathBuf,
    #[command(flatten)]
    motion: MotionArguments,
    /// The title [default: the model's name].
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// The text below the title.
    #[arg(long, value_name = "TEXT")]
    text: Option<String>,
    /// The URL that the card will have: many sites need it to show the picture.
    #[arg(long, value_name = "URL")]
    url: Option<String>,
}

pub(super) fn run(arguments: &CardArguments, disk: &Disk) -> Outcome {
    let CardArguments { link, out, .. } = arguments;
    if !link.starts_with("https://") && !link.starts_with("http://") {
        let failure = Failure::expected("a link such as https://example.org/gaitway/#model=sample:pilot", link);
        return Err(failure.at("LINK"));
    }
    if is_standard_output(out) {
        return Err(Failure::expected("a file ending in .html, since its picture goes beside it", "-").at("--out"));
    }
    check_output(out, EXTENSIONS, disk)?;
    let (view, _) = from_link(link.split_once('#').map_or("", |(_, fragment)| fragment));
    let sources = view.character.sources;
    let picture = picture(arguments, &sources, disk)?;
    let model = sources.model.first().map_or_else(|| "Gaitway".to_owned(), |source| short_name(source));
    let picture_path = out.with_extension("jpg");
    let picture_name = picture_path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let [width, height] = PICTURE_SIZE.map(|side| side.to_string());
    let values = [
        ("title", arguments.title.clone().unwrap_or(model)),
        ("text", arguments.text.clone().unwrap_or_else(|| TEXT.to_owned())),
        ("link", link.clone()),
        ("picture-url", beside(arguments.url.as_deref(), &picture_name)),
        ("picture", picture_name),
        ("width", width),
        ("height", height),
    ];
    let inputs = disk.files_read();
    if let Some(picture) = &picture {
        save_output(&picture_path, picture, &["jpg"], &inputs)?;
        if arguments.url.is_none() {
            warn("many sites show a picture only by its absolute URL; name the card's own with --url");
        }
    }
    save_output(out, filled(&values, picture.is_some()).as_bytes(), EXTENSIONS, &inputs)
}

/// Renders the link's view of the given files, otherwise of its samples. Nothing else that the link names is read.
fn picture(arguments: &CardArguments, sources: &Sources, disk: &Disk) -> Outcome<Option<Vec<u8>>> {
    let is_sample = |source: &String| source.starts_with("sample:");
    let files: Vec<PathBuf> = match arguments.files.as_slice() {
        [] if sources.model.is_empty() || !sources.model.iter().all(is_sample) => {
            warn("the card has no picture: name a copy of the link's model after the link");
            return Ok(None);
        }
        [] => sources.model.iter().map(PathBuf::from).collect(),
        given => given.to_vec(),
    };
    let mut editor = open_editor(open(&files, disk)?, &arguments.motion, disk)?;
    apply_link(&mut editor, &arguments.link, &arguments.motion, Overrides::default(), disk)?;
    Ok(picture_of(&editor))
}

/// Returns the URL of a file in the folder of another one.
fn beside(url: Option<&str>, name: &str) -> String {
    let folder = url.and_then(|url| Some(url.rsplit_once('/')?.0));
    folder.map_or_else(|| name.to_owned(), |folder| format!("{folder}/{name}"))
}

/// Returns the template with `{key}` replaced by the values. Without a picture, lines that mention it are left out.
fn filled(values: &[(&str, String)], has_picture: bool) -> String {
    let mut page = String::new();
    for line in TEMPLATE.lines().filter(|line| has_picture || !line.contains("{picture")) {
        let mut rest = line;
        while let Some((before, after)) = rest.split_once('{') {
            let Some((key, after)) = after.split_once('}') else { break };
            let value = values.iter().find(|(name, _)| *name == key).map_or("", |(_, value)| value.as_str());
            page.extend([before, &*escaped(value)]);
            rest = after;
        }
        page.extend([rest, "\n"]);
    }
    page
}
