//! What joints without a source do: an option that every form of a joint map shares.

use gaitway_character::anim::ClipQuery;
use serde::{Deserialize, Serialize};

/// A clip of the model by its index or by its name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a clip's name or its index (0, 1, …)")]
pub enum ClipRef {
    /// Index among the model's own clips.
    Index(usize),
    /// The first of the model's own clips with this name.
    Name(String),
}

impl ClipRef {
    /// Returns the query that finds this clip.
    pub fn query(&self) -> ClipQuery<'_> {
        match self {
            Self::Index(index) => ClipQuery::Index(*index),
            Self::Name(name) => ClipQuery::Name(name),
        }
    }
}

/// What joints without a source do: the word `"rest"`, or one of the model's own clips.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UnmappedForm", into = "UnmappedForm")]
pub enum Unmapped {
    /// Stays in the rest pose.
    #[default]
    Rest,
    /// Plays one of the model's own clips, looping with its own duration.
    Clip {
        /// The clip to play.
        clip: ClipRef,
        /// Holds the clip's first key.
        frozen: bool,
    },
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"rest\" or {\"clip\": NAME or INDEX}, with \"hold\": \"first-key\" to freeze it"
)]
enum UnmappedForm {
    Word(String),
    Clip(ClipForm),
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClipForm {
    clip: ClipRef,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hold: Option<String>,
}

impl TryFrom<UnmappedForm> for Unmapped {
    type Error = String;

    fn try_from(form: UnmappedForm) -> Result<Self, String> {
        match form {
            UnmappedForm::Word(word) if word == "rest" => Ok(Self::Rest),
            UnmappedForm::Word(word) => Err(format!("expected \"rest\" or {{\"clip\": …}}, found “{word}”")),
            UnmappedForm::Clip(ClipForm { clip, hold }) => match hold.as_deref() {
                None => Ok(Self::Clip { clip, frozen: false }),
                Some("first-key") => Ok(Self::Clip { clip, frozen: true }),
                Some(other) => Err(format!("expected \"hold\": \"first-key\", found “{other}”")),
            },
        }
    }
}

impl From<Unmapped> for UnmappedForm {
    fn from(unmapped: Unmapped) -> Self {
        match unmapped {
            Unmapped::Rest => Self::Word("rest".to_owned()),
            Unmapped::Clip { clip, frozen } => {
                Self::Clip(ClipForm { clip, hold: frozen.then(|| "first-key".to_owned()) })
            }
        }
    }
}
