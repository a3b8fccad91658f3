//! The text of a link as far as files go: listing them, making the link to share, and the link while some files are missing.
//! Links are not parsed into a view here, so that parts this version doesn't understand pass through unchanged.

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use serde::{Deserialize, Serialize};

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
            Self::Light => is_light_file(&value),
            Self::Model | Self::Motion => !value.is_empty(),
        };
        is_file.then_some(role)
    }
}

/// A `model=`, `motion=` or `light=` part of a link.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
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

/// Whether a source of a view is a file that the recipient of its link has to supply.
pub fn is_to_bring(source: &str) -> bool {
    source.starts_with(TO_BRING)
}

/// Whether a light is a file, not the name of a set-up: it has an extension or is a URL or a path.
pub fn is_light_file(light: &str) -> bool {
    light.contains(['.', '/', ':'])
}

/// Returns a source with the current separator: a model inside an archive is `ARCHIVE#!/MEMBER`, but an early version wrote
/// `ARCHIVE#/MEMBER`.
pub fn with_current_member(source: &str) -> String {
    match source.split_once("#/").filter(|_| !source.contains(MEMBER_SEPARATOR)) {
        Some((file, member)) if file.contains("://") || file.to_lowercase().ends_with(".zip") => {
            format!("{file}{MEMBER_SEPARATOR}{member}")
        }
        _ => source.to_owned(),
    }
}

/// The part of an address after `#`, read once.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub struct Link {
    text: String,
    files: Vec<LinkedFile>,
}

impl From<String> for Link {
    fn from(text: String) -> Self {
        let files = pairs(&text).filter_map(linked_file).collect();
        Self { text, files }
    }
}

impl From<&str> for Link {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<Link> for String {
    fn from(link: Link) -> Self {
        link.text
    }
}

impl Link {
    /// Returns its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the files that it names, in order.
    pub fn files(&self) -> &[LinkedFile] {
        &self.files
    }

    /// Returns the files with this role, in order.
    pub fn files_of(&self, role: LinkRole) -> impl Iterator<Item = &LinkedFile> {
        self.files.iter().filter(move |file| file.role == role)
    }

    /// Returns the files that the recipient of the link has to supply, in order.
    pub fn files_to_bring(&self) -> impl Iterator<Item = &LinkedFile> {
        self.files.iter().filter(|file| file.is_to_bring)
    }

    /// Returns a key for its files, whatever its view: links with the same key show the same files.
    pub fn shown_files(&self) -> String {
        let mut files: Vec<String> = Vec::new();
        let mut has_model = false;
        for pair in pairs(&self.text) {
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
    pub fn public(&self, local: &[String]) -> Self {
        self.rewritten(&mut |pair| {
            let file = linked_file(pair).filter(|file| !file.is_to_bring && local.contains(&file.name));
            Some(file.map_or(pair.to_owned(), |file| file_pair(file.role, TO_BRING, &value_of(pair))))
        })
    }

    /// Returns the link of a page that is embedded in another one.
    pub fn embedded(&self) -> Self {
        let others = self.rewritten(&mut |pair| (key_of(pair) != "embed").then(|| pair.to_owned()));
        (others.text + "&embed=1").into()
    }

    /// Returns the part of the link that can be shown before its missing files arrive; the whole link if none are missing, or if
    /// its model is: an empty stage stands for it. Without its motion, a camera may look at where nobody is.
    pub fn without_missing(&self) -> Self {
        let is_missing = |role| self.files_to_bring().any(|file| file.role == role);
        if is_missing(LinkRole::Model) || self.files_to_bring().next().is_none() {
            return self.clone();
        }
        let lacks_motion = is_missing(LinkRole::Motion);
        self.rewritten(&mut |pair| {
            // An index counts the clips of all motions.
            let is_index = key_of(pair) == "clip" && value_of(pair).parse::<usize>().is_ok();
            let is_about_motion = is_index || key_of(pair) == "camera";
            let is_kept = linked_file(pair).is_none_or(|file| !file.is_to_bring) && !(is_about_motion && lacks_motion);
            is_kept.then(|| pair.to_owned())
        })
    }

    /// Returns the link with the missing files of the link that asks for them, if it shows what could be shown of that one, and
    /// with what was left out along with them.
    pub fn with_missing(&self, asking: &Self) -> Self {
        let shown = asking.without_missing();
        if self.shown_files() != shown.shown_files() {
            return self.clone();
        }
        let files = asking.rewritten(&mut |pair| LinkRole::of(pair).map(|_| pair.to_owned()));
        let has_key = |pair: &str| pairs(&self.text).any(|other| key_of(other) == key_of(pair));
        // The version says which clip plays if none is named: with the missing motions, what plays is as `asking` means it.
        let version = pairs(&asking.text).find(|pair| key_of(pair) == "v").unwrap_or("v=1");
        let view = self.rewritten(&mut |pair| match key_of(pair) {
            "v" if !has_key("clip") => Some(version.to_owned()),
            _ => LinkRole::of(pair).is_none().then(|| pair.to_owned()),
        });
        let left_out = asking.rewritten(&mut |pair| {
            let is_shown = pairs(&shown.text).any(|other| other == pair);
            (LinkRole::of(pair).is_none() && !is_shown && !has_key(pair)).then(|| pair.to_owned())
        });
        let parts = [files.text, view.text, left_out.text].into_iter().filter(|part| !part.is_empty());
        parts.collect::<Vec<_>>().join("&").into()
    }

    /// Returns the link with its missing files renamed to `names`, in the order of [`Self::files_to_bring`]. An empty name leaves
    /// a file missing. Archive members are kept.
    pub fn with_names(&self, names: &[String]) -> Self {
        let mut names = names.iter();
        self.rewritten(&mut |pair| {
            let file = linked_file(pair).filter(|file| file.is_to_bring);
            let found = file.and_then(|file| Some((file, names.next().filter(|name| !name.is_empty())?)));
            let renamed =
                |(file, name): (LinkedFile, &String)| file_pair(file.role, "", &format!("{name}{}", file.member));
            Some(found.map_or(pair.to_owned(), renamed))
        })
    }

    /// Returns the index of the link in `others` that shows the same files in the most similar view; `None` if none does.
    pub fn most_similar(&self, others: &[Self]) -> Option<usize> {
        let wanted = self.shown_files();
        let shows_same = |other: &Self| {
            let shown = other.shown_files();
            shown.len() == wanted.len() && shown.split('\n').all(|file| wanted.split('\n').any(|other| other == file))
        };
        let mut best = None;
        for (index, other) in others.iter().enumerate().filter(|(_, other)| shows_same(other)) {
            // What the link lacks makes it another view.
            let has = |pair: &str| pairs(&self.text).any(|other| other == pair);
            let score = pairs(&other.text).map(|pair| if has(pair) { 1 } else { -1 }).sum::<i32>();
            if best.is_none_or(|(_, max)| score > max) {
                best = Some((index, score));
            }
        }
        best.map(|(index, _)| index)
    }

    /// Replaces each pair by what `replacement` returns; `None` removes it.
    fn rewritten(&self, replacement: &mut dyn FnMut(&str) -> Option<String>) -> Self {
        pairs(&self.text).filter_map(replacement).collect::<Vec<_>>().join("&").into()
    }
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
