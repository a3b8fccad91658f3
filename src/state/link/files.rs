//! Text operations on the files that a link names: listing them, making the link to share, and the link while some files are
//! missing. The page's scripts call these through `web::links` and never split a link themselves. Links are not parsed into a
//! view here, so that parts this version doesn't understand pass through unchanged.

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

use super::values::{read_light, with_current_member};
use crate::state::EnvironmentChoice;

/// Separates an archive from the path of one of its models, as in the URL of an entry of a .jar. In a URL it is part of the
/// fragment, which no server sees.
pub const MEMBER_SEPARATOR: &str = "#!/";

/// Precedes the name of a file that the recipient of the link has to supply.
const TO_BRING: &str = "file:";

/// The model of a link that names none.
const DEFAULT_MODEL: &str = "sample:walker";

/// The characters that JavaScript's `encodeURIComponent` escapes.
const COMPONENT: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'_')
    .remove(b'.')
    .remove(b'!')
    .remove(b'~')
    .remove(b'*')
    .remove(b'\'')
    .remove(b'(')
    .remove(b')');

/// What a linked file is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkRole {
    /// A file of the model.
    Model,
    /// A file whose clips are retargeted to the model.
    Motion,
    /// An image that lights the scene.
    Light,
}

impl LinkRole {
    /// The link's key.
    pub fn key(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Motion => "motion",
            Self::Light => "light",
        }
    }

    /// `None` for a pair that names no file, such as a light that is generated.
    fn of(pair: &str) -> Option<Self> {
        let role = [Self::Model, Self::Motion, Self::Light].into_iter().find(|role| role.key() == key_of(pair))?;
        let value = value_of(pair);
        let is_file = match role {
            Self::Light => matches!(read_light(&value), Some(EnvironmentChoice::File(_))),
            _ => !value.is_empty(),
        };
        is_file.then_some(role)
    }
}

/// A `model=`, `motion=` or `light=` part of a link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkedFile {
    /// What it is used for.
    pub role: LinkRole,
    /// URL, `sample:NAME` or the name of a local file; for a model inside an archive, that of the archive. Without `file:`.
    pub name: String,
    /// Path of the model inside its archive, from [`MEMBER_SEPARATOR`] on; empty for anything else.
    pub member: String,
    /// Marked `file:`: the recipient of the link has to supply it.
    pub is_to_bring: bool,
}

/// Returns the files that a link names, in order.
pub fn linked_files(link: &str) -> Vec<LinkedFile> {
    pairs(link).filter_map(linked_file).collect()
}

/// Whether a source of a view is a file that the recipient of its link has to supply.
pub fn is_to_bring(source: &str) -> bool {
    source.starts_with(TO_BRING)
}

/// Returns a key for the files of a link, whatever its view: links with the same key show the same files.
pub fn shown_files(link: &str) -> String {
    let mut files: Vec<String> = Vec::new();
    let mut has_model = false;
    for pair in pairs(link) {
        let Some(role) = LinkRole::of(pair) else { continue };
        has_model |= role == LinkRole::Model;
        files.push(format!("{}={}", role.key(), with_current_member(&value_of(pair))));
    }
    if !has_model {
        files.insert(0, format!("{}={DEFAULT_MODEL}", LinkRole::Model.key()));
    }
    files.join("\n")
}

/// Returns the link to share: files of this computer, whose names are in `local`, are marked for the recipient to supply.
pub fn public_link(link: &str, local: &[String]) -> String {
    rewrite(link, &mut |pair| {
        let file = linked_file(pair).filter(|file| !file.is_to_bring && local.contains(&file.name));
        Some(file.map_or(pair.to_owned(), |file| file_pair(file.role, TO_BRING, &value_of(pair))))
    })
}

/// Returns the link of a page that is embedded in another one.
pub fn embedded_link(link: &str) -> String {
    let others = rewrite(link, &mut |pair| (key_of(pair) != "embed").then(|| pair.to_owned()));
    others + "&embed=1"
}

/// Returns the part of a link that can be shown before its missing files arrive; the whole link if none are missing, or if its
/// model is: an empty stage stands for it. Without its motion, a camera may look at where nobody is.
pub fn link_without_missing(link: &str) -> String {
    let files = linked_files(link);
    let is_missing = |role| files.iter().any(|file| file.is_to_bring && file.role == role);
    if is_missing(LinkRole::Model) || !files.iter().any(|file| file.is_to_bring) {
        return link.to_owned();
    }
    let lacks_motion = is_missing(LinkRole::Motion);
    rewrite(link, &mut |pair| {
        // An index counts the clips of all motions.
        let is_index = key_of(pair) == "clip" && value_of(pair).parse::<usize>().is_ok();
        let is_about_motion = is_index || key_of(pair) == "camera";
        let is_kept = linked_file(pair).is_none_or(|file| !file.is_to_bring) && !(is_about_motion && lacks_motion);
        is_kept.then(|| pair.to_owned())
    })
}

/// Returns a link with the missing files of the link that asks for them, if it shows what could be shown of that one, and with what
/// was left out along with them.
pub fn link_with_missing(link: &str, asking: &str) -> String {
    let shown = link_without_missing(asking);
    if shown_files(link) != shown_files(&shown) {
        return link.to_owned();
    }
    let files = rewrite(asking, &mut |pair| LinkRole::of(pair).map(|_| pair.to_owned()));
    let view = rewrite(link, &mut |pair| LinkRole::of(pair).is_none().then(|| pair.to_owned()));
    let has_key = |pair: &str| pairs(link).any(|other| key_of(other) == key_of(pair));
    let left_out = rewrite(asking, &mut |pair| {
        let is_left_out = LinkRole::of(pair).is_none() && !pairs(&shown).any(|other| other == pair) && !has_key(pair);
        is_left_out.then(|| pair.to_owned())
    });
    [files, view, left_out].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("&")
}

/// Returns the link with its missing files renamed to `names`, in the order of [`linked_files`]. An empty name leaves a file
/// missing. Archive members are kept.
pub fn link_with_files(link: &str, names: &[String]) -> String {
    let mut names = names.iter();
    rewrite(link, &mut |pair| {
        let file = linked_file(pair).filter(|file| file.is_to_bring);
        let found = file.and_then(|file| Some((file, names.next().filter(|name| !name.is_empty())?)));
        Some(found.map_or(pair.to_owned(), |(file, name)| file_pair(file.role, "", &format!("{name}{}", file.member))))
    })
}

/// Returns the index of the link in `others` that shows the same files in the most similar view; `None` if none does.
pub fn most_similar_link(link: &str, others: &[String]) -> Option<usize> {
    let wanted = shown_files(link);
    let shows_same = |other: &str| {
        let shown = shown_files(other);
        shown.len() == wanted.len() && shown.split('\n').all(|file| wanted.split('\n').any(|other| other == file))
    };
    let mut best = None;
    for (index, other) in others.iter().enumerate().filter(|(_, other)| shows_same(other)) {
        // What the link lacks makes it another view.
        let score = pairs(other).map(|pair| if pairs(link).any(|other| other == pair) { 1 } else { -1 }).sum::<i32>();
        if best.is_none_or(|(_, max)| score > max) {
            best = Some((index, score));
        }
    }
    best.map(|(index, _)| index)
}

fn pairs(link: &str) -> impl Iterator<Item = &str> {
    link.split('&').filter(|pair| !pair.is_empty())
}

fn key_of(pair: &str) -> &str {
    pair.split_once('=').map_or(pair, |(key, _)| key)
}

fn value_of(pair: &str) -> String {
    let value = pair.split_once('=').map_or("", |(_, value)| value);
    percent_decode_str(value).decode_utf8_lossy().into_owned()
}

fn linked_file(pair: &str) -> Option<LinkedFile> {
    let role = LinkRole::of(pair)?;
    let value = value_of(pair);
    let (value, is_to_bring) = value.strip_prefix(TO_BRING).map_or((value.as_str(), false), |value| (value, true));
    let value = with_current_member(value);
    let (name, member) = value.split_at(value.find(MEMBER_SEPARATOR).unwrap_or(value.len()));
    Some(LinkedFile { role, name: name.to_owned(), member: member.to_owned(), is_to_bring })
}

fn file_pair(role: LinkRole, mark: &str, value: &str) -> String {
    format!("{}={mark}{}", role.key(), utf8_percent_encode(value, COMPONENT))
}

/// Replaces each pair by what `replacement` returns; `None` removes it.
fn rewrite(link: &str, replacement: &mut dyn FnMut(&str) -> Option<String>) -> String {
    let mut text = String::new();
    for pair in pairs(link).filter_map(replacement) {
        if !text.is_empty() {
            text.push('&');
        }
        text += &pair;
    }
    text
}
