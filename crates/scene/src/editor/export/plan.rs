//! Export plans: which clips are written, under which names, in which files. The page, the command line and Python write an
//! [`ExportPlan`] with the same code, so that a bad plan is refused in the same words, before anything is written.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, Keys, PropertyTarget};
use gaitway_fbx_writer::FbxRecipient;
use gaitway_retarget::KeyTolerance;

use super::ClipFormat;
use super::in_file::is_in_file;
use super::rooted::{hips, own_root};
use crate::editor::names::plain_name;
use crate::library::{ClipId, Model, ModelClip};
use crate::state::ViewerState;

/// Whom an export is for, which decides what suits them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Recipient {
    /// The Unity editor.
    Unity,
    /// Unreal Engine.
    Unreal,
    /// Godot, which imports glTF.
    Godot,
    /// Blender, which imports glTF.
    Blender,
    /// A web page: three.js, Babylon.js, `<model-viewer>`.
    Web,
    /// A VRM avatar.
    Vrm,
    /// The file as it is, with the chosen clips.
    #[default]
    AsIs,
}

impl Recipient {
    /// Returns the tolerance for dropping keys that suits them; a web page gets fewer keys, since it is downloaded.
    pub fn fewer_keys(self) -> Option<KeyTolerance> {
        (self == Self::Web).then(KeyTolerance::default)
    }

    /// Returns why files of this kind don't suit them; `None` if they do.
    fn refusal(self, packaging: Packaging) -> Option<&'static str> {
        let is_fbx = packaging == Packaging::OneFile(OneFileFormat::Fbx);
        match self {
            Self::Unity if !is_fbx => Some("Unity imports FBX; choose an .fbx, or “as is” for a .glb"),
            Self::Unreal if !is_fbx => Some("Unreal imports FBX; choose an .fbx, or “as is” for a .glb"),
            Self::Vrm => Some("Gaitway can't make a VRM avatar yet; choose “as is”, which keeps a model that is one"),
            _ => None,
        }
    }

    /// Returns the axes, unit and scales that suit them in an FBX file.
    pub fn fbx(self) -> FbxRecipient {
        match self {
            Self::Unity => FbxRecipient::Unity,
            Self::Unreal => FbxRecipient::Unreal,
            Self::Blender => FbxRecipient::Blender,
            Self::Godot | Self::Web | Self::Vrm | Self::AsIs => FbxRecipient::AsIs,
        }
    }
}

/// Format of one file with the model and its clips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OneFileFormat {
    /// The model's own glTF with the clips.
    #[default]
    Glb,
    /// Binary FBX with the same content.
    Fbx,
}

impl OneFileFormat {
    /// The file extension, in lower case.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Fbx => "fbx",
        }
    }
}

/// How clips are divided among files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packaging {
    /// A file with the model and all clips.
    OneFile(OneFileFormat),
    /// A file for each clip, with the skeleton and without meshes.
    FilePerClip(ClipFormat),
}

/// A clip that is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedClip {
    /// One of the active model's.
    pub clip: ClipId,
    /// What it is called in the file; with a file per clip, what that is called.
    pub name: String,
    /// With a root bone, whether the travel is dropped, because the engine moves the body.
    pub in_place: bool,
}

/// A bone above the hips that carries the body: its way over the ground and its turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RootBone {
    /// Whether it carries the height of the hips, too.
    pub vertical: bool,
}

/// What to write of the active model.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportPlan {
    /// The clips, each at most once. Those that the model's file has as they play come first in one file, in its order.
    pub clips: Vec<PlannedClip>,
    /// How they are divided among files.
    pub packaging: Packaging,
    /// Whom it is for.
    pub recipient: Recipient,
    /// The root bone to insert. A rig that has one keeps it, and its clips.
    pub root_bone: Option<RootBone>,
    /// Drops keys that interpolation restores.
    pub fewer_keys: Option<KeyTolerance>,
}

impl PlannedClip {
    /// A clip under the name that lists show.
    pub fn of(clip: &ModelClip) -> Self {
        Self { clip: clip.id().clone(), name: clip.title().to_owned(), in_place: false }
    }
}

impl ExportPlan {
    /// All clips of a model in one file, under the names that lists show.
    pub fn all_clips(model: &Model) -> Self {
        let clips = model.clips().listed().map(PlannedClip::of).collect();
        Self {
            clips,
            packaging: Packaging::OneFile(OneFileFormat::Glb),
            recipient: Recipient::AsIs,
            root_bone: None,
            fewer_keys: None,
        }
    }

    /// Refuses a plan that can't be carried out, or whose files would not have what it says.
    ///
    /// # Errors
    /// The message for the user.
    pub fn check(&self, model: &Model) -> Result<(), String> {
        if let Some(refusal) = self.recipient.refusal(self.packaging) {
            return Err(refusal.to_owned());
        }
        if self.clips.is_empty() {
            return Err("no clip is chosen; choose at least one".to_owned());
        }
        if let Packaging::FilePerClip(format) = self.packaging
            && !format.fits(model)
        {
            return Err(format!("a .{} holds a human body, and this model has none with hips", format.extension()));
        }
        let has_in_place = self.clips.iter().any(|clip| clip.in_place);
        let refusal = match self.root_bone {
            None if has_in_place => Some("clips in place need a root bone; choose one"),
            None => None,
            Some(_) if matches!(self.packaging, Packaging::FilePerClip(_)) => {
                Some("a root bone is inserted in the model; choose one file")
            }
            Some(_) if hips(model).is_none() => Some("a root bone goes above the hips, and this model has none"),
            Some(_) if has_in_place && own_root(model).is_some() => {
                Some("this rig has a root bone, and its clips keep their travel; choose no clip in place")
            }
            Some(_) => None,
        };
        if let Some(refusal) = refusal {
            return Err(refusal.to_owned());
        }
        let mut chosen: BTreeMap<&ClipId, &str> = BTreeMap::new();
        let mut taken: BTreeMap<String, &str> = BTreeMap::new();
        for PlannedClip { clip, name, .. } in &self.clips {
            let title = model.clip(clip).ok_or("there is no such clip")?.title();
            if chosen.insert(clip, name).is_some() {
                return Err(format!("clip “{title}” is chosen twice; make a copy of it"));
            }
            if name.trim().is_empty() {
                return Err(format!("clip “{title}” has no name; give it one"));
            }
            // Some file systems don't tell capitals apart.
            let key = match self.packaging {
                Packaging::OneFile(OneFileFormat::Glb) => name.clone(),
                Packaging::OneFile(OneFileFormat::Fbx) => name.to_lowercase(),
                Packaging::FilePerClip(_) => plain_name(name).to_lowercase(),
            };
            if let Some(other) = taken.insert(key, title) {
                return Err(format!("clips “{other}” and “{title}” would both be called “{name}”; rename one of them"));
            }
        }
        Ok(())
    }

    /// Whether a bone is inserted.
    pub(super) fn has_new_root(&self, model: &Model) -> bool {
        self.root_bone.is_some() && own_root(model).is_none()
    }

    /// Whether clips that the file has as they play are written again.
    pub(super) fn changes_own(&self, model: &Model) -> bool {
        self.has_new_root(model) || self.fewer_keys.is_some()
    }

    /// Returns what the files can't hold of the clips, by name, such as `scale of “Wave”, “Run”`.
    pub fn losses(&self, model: &Model, state: &ViewerState) -> Vec<String> {
        let mut lost: BTreeMap<&'static str, Vec<&str>> = BTreeMap::new();
        for PlannedClip { clip, name, .. } in &self.clips {
            let Some(clip) = model.clip(clip) else { continue };
            // The model's own file keeps all of it.
            let is_one_file = matches!(self.packaging, Packaging::OneFile(_));
            let is_kept = is_one_file && !self.changes_own(model) && is_in_file(model, state, clip);
            if is_kept && self.packaging == Packaging::OneFile(OneFileFormat::Glb) {
                continue;
            }
            let mut kinds = lost_kinds(clip.clip(), self.packaging);
            // An FBX file is made of the model's own.
            kinds.retain(|kind| !is_kept || *kind != SINGLE_WEIGHTS);
            for kind in kinds {
                let names = lost.entry(kind).or_default();
                if names.last() != Some(&name.as_str()) {
                    names.push(name);
                }
            }
        }
        let sentence = |(kind, names): (&str, Vec<&str>)| format!("{kind} of “{}”", names.join("”, “"));
        lost.into_iter().map(sentence).collect()
    }
}

const SINGLE_WEIGHTS: &str = "single morph weights";

/// What a clip animates that these files can't hold.
fn lost_kinds(clip: &Clip, packaging: Packaging) -> Vec<&'static str> {
    let format = match packaging {
        Packaging::OneFile(_) => None,
        Packaging::FilePerClip(format) => Some(format),
    };
    let mut kinds = Vec::new();
    for channel in clip.channels() {
        match channel.keys {
            Keys::MorphWeights { .. } if format.is_some() => kinds.push("morph weights"),
            Keys::Scale(_) if matches!(format, Some(ClipFormat::Bvh | ClipFormat::Vrma)) => kinds.push("scale"),
            _ => {}
        }
    }
    kinds.extend(clip.properties().iter().filter_map(|property| match property.target {
        PropertyTarget::Expression(_) | PropertyTarget::LookAt if format == Some(ClipFormat::Vrma) => None,
        PropertyTarget::Expression(_) => Some("expressions"),
        PropertyTarget::LookAt => Some("gaze"),
        PropertyTarget::MorphWeight(..) => Some(SINGLE_WEIGHTS),
        PropertyTarget::Material(..) => Some("materials"),
        PropertyTarget::Light(..) => Some("lights"),
        PropertyTarget::Camera(..) => Some("cameras"),
        PropertyTarget::Visibility(_) => Some("visibility"),
    }));
    kinds.sort_unstable();
    kinds.dedup();
    kinds
}
