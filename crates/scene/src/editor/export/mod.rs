//! Exports: the active joint map, the model with a retargeted clip, a clip alone. Images are up to the shell, which has the
//! graphics device.

mod clip_file;
mod in_file;
mod plan;
mod plan_files;
mod rooted;
mod together;

pub use clip_file::{ClipFormat, write_clip};
pub use in_file::derived_clip;
pub use plan::{ExportPlan, OneFileFormat, Packaging, PlannedClip, Recipient, RootBone};

use std::borrow::Cow;

use gaitway_character::anim::Clip;
use gaitway_formats::{write_edited_model, write_model, write_motion};
use gaitway_retarget::merged_clip;
use glam::Vec3;

use self::in_file::{is_derived, is_in_file};
use super::names::{plain_name, stem};
use super::{Editor, ModelFiles};
use crate::frame::{Frame, evaluate};
use crate::library::{BakedTake, ClipId, Model, ModelClip, MotionId};
use crate::state::{active_clip, active_map, take_of, written_skeleton};

/// Why a model without its images isn't written or recorded.
pub const AWAITS_IMAGES: &str =
    "the model's images have not arrived; wait until they have, or reload the page if you cancelled them";

/// What to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Export {
    /// The joint map of a motion.
    Map {
        /// One of the library's.
        motion: MotionId,
    },
    /// The model with one of its clips that isn't in its file as it plays: [`derived_clip`].
    Model {
        /// One of the active model's; an unedited one of its own is an error.
        clip: ClipId,
    },
    /// One of the clips with its skeleton, without meshes.
    Clip {
        /// One of the active model's.
        clip: ClipId,
        /// The kind of file.
        format: ClipFormat,
    },
    /// The whole model as a .glb, in its current pose or in its rest pose.
    FullModel {
        /// Makes the current pose the rest pose of the file.
        posed: bool,
    },
    /// The whole model with all clips as they are shown, in one file.
    AllClips,
}

/// An exported file, with a remark for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportedFile {
    /// File name with extension, without a folder.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// A message for the user, such as a seam in the loop. `None` if there is nothing to say.
    pub remark: Option<String>,
}

impl ExportedFile {
    fn new(name: String, bytes: Vec<u8>) -> Self {
        Self { name, bytes, remark: None }
    }

    fn with_remarks(self, remarks: &[Cow<'static, str>]) -> Self {
        Self { remark: (!remarks.is_empty()).then(|| remarks.join(" ")), ..self }
    }
}

/// Says what a glTF file written by Gaitway lacks of a clip.
fn about_properties(clip: &Clip) -> Option<&'static str> {
    let lost = "Only joints and morph weights are animated in the file, not the clip's materials, lights, visibility or expressions.";
    (!clip.properties().is_empty()).then_some(lost)
}

const NO_SUCH_CLIP: &str = "there is no such clip";

const NO_FILE: &str = "Skeleton and clip only: this model has no file to add a clip to.";

/// A clip with its layers, what is set manually, and its pins baked in.
struct BakedClip {
    pub clip: Clip,
    pub remarks: Vec<Cow<'static, str>>,
}

impl Editor {
    /// Writes a file.
    ///
    /// # Errors
    /// The message for the user if there is nothing to write or writing fails.
    pub fn export(&self, what: &Export) -> Result<ExportedFile, String> {
        match what {
            Export::Map { motion } => self.export_map(motion),
            Export::Model { clip } => self.export_model(clip),
            Export::Clip { clip, format } => self.export_clip(clip, *format),
            Export::FullModel { posed } => self.export_whole(*posed),
            Export::AllClips => self.export_all_clips(),
        }
    }

    /// Returns a file name for the current view, without extension: the model's and, if one is active, the clip's.
    pub fn file_stem(&self) -> String {
        self.stem_with_clip(self.library.active().and_then(|model| active_clip(model, &self.state)))
    }

    fn stem_with_clip(&self, clip: Option<&ModelClip>) -> String {
        let model = self.library.active().map(|model| stem(&model.source));
        let parts = [model, clip.map(|clip| clip.title().to_owned())];
        plain_name(&parts.into_iter().flatten().collect::<Vec<_>>().join("-"))
    }

    fn model(&self) -> Result<&Model, String> {
        self.library.active().ok_or_else(|| "there is no model".to_owned())
    }

    /// Returns the active model if its file can be written.
    pub(super) fn complete_model(&self) -> Result<&Model, String> {
        match self.model()? {
            model if model.awaits_images() => Err(AWAITS_IMAGES.to_owned()),
            model => Ok(model),
        }
    }

    /// Writes joint names instead of numbers, for people to read.
    fn export_map(&self, motion: &MotionId) -> Result<ExportedFile, String> {
        let model = self.model()?;
        let about = self.library.motion(motion).ok_or("this motion was removed")?;
        let map = active_map(&self.library, &self.state, motion).unwrap_or_default();
        let json = map.to_file(&model.asset, &about.asset).to_json().map_err(|error| error.to_string())?;
        Ok(ExportedFile::new(format!("{}-{}.json", stem(&model.source), stem(&about.source)), json.into_bytes()))
    }

    pub(super) fn files_of(&self, model: &Model) -> Option<&ModelFiles> {
        self.shelf.get(&model.id)?.files.as_ref()
    }

    /// Writes a model of another format as glTF.
    fn export_whole(&self, posed: bool) -> Result<ExportedFile, String> {
        let model = self.complete_model()?;
        let ModelFiles { set, name } = self.files_of(model).ok_or("this model has no file")?;
        let mut frame = Frame::default();
        evaluate(&self.library, &self.state, 1.0, &mut frame);
        let skeleton = written_skeleton(model, &self.state, posed.then_some(frame.pose()));
        let bytes = write_model(set, name, &skeleton, &[]).map_err(|error| error.to_string())?;
        Ok(ExportedFile::new(format!("{}.glb", stem(&model.source)), bytes))
    }

    /// Writes one clip with its skeleton.
    fn export_clip(&self, clip: &ClipId, format: ClipFormat) -> Result<ExportedFile, String> {
        let model = self.model()?;
        let clip = model.clip(clip).ok_or(NO_SUCH_CLIP)?;
        let stem = self.stem_with_clip(Some(clip));
        // Of these, only a GLB could be mistaken for the model.
        let suffix = if format == ClipFormat::Glb { "-clip" } else { "" };
        let name = format!("{stem}{suffix}.{}", format.extension());
        let mut baked = self.baked_clip(model, clip);
        let frames_per_sec = clip.frames_per_sec();
        let clip = &baked.clip;
        if format == ClipFormat::Glb {
            baked.remarks.extend(about_properties(clip).map(Cow::from));
        }
        let skeleton = written_skeleton(model, &self.state, None);
        let bytes = write_clip(model, &skeleton, clip, frames_per_sec, format).map_err(|error| error.to_string())?;
        Ok(ExportedFile::new(name, bytes).with_remarks(&baked.remarks))
    }

    /// Writes the model's own file, with the clip appended if it isn't there except for its name; without a file, only skeleton and
    /// clip.
    fn export_model(&self, clip: &ClipId) -> Result<ExportedFile, String> {
        let model = self.complete_model()?;
        let clip = model.clip(clip).ok_or(NO_SUCH_CLIP)?;
        if !is_derived(model, &self.state, clip) {
            return Err("the model's file already contains this clip".to_owned());
        }
        let skeleton = written_skeleton(model, &self.state, None);
        let files = self.files_of(model);
        let mut remarks = Vec::new();
        let bytes = match files {
            Some(ModelFiles { set, name }) if is_in_file(model, &self.state, clip) => {
                write_edited_model(set, name, &skeleton, &model.clips().saved_names(None).own, &[])
            }
            _ => {
                let names = model.clips().saved_names(Some(clip.id()));
                let baked = self.baked_clip(model, clip);
                let added = baked.clip.with_name(names.added);
                remarks = baked.remarks;
                remarks.extend(about_properties(&added).map(Cow::from));
                match files {
                    Some(ModelFiles { set, name }) => write_edited_model(set, name, &skeleton, &names.own, &[&added]),
                    None => {
                        remarks.push(NO_FILE.into());
                        write_motion(&model.asset, &skeleton, &[&added])
                    }
                }
            }
        };
        let name = format!("{}.glb", self.stem_with_clip(Some(clip)));
        let bytes = bytes.map_err(|error| error.to_string())?;
        Ok(ExportedFile::new(name, bytes).with_remarks(&remarks))
    }

    fn baked_clip(&self, model: &Model, source: &ModelClip) -> BakedClip {
        let mut remarks = Vec::new();
        let is_active = active_clip(model, &self.state).is_some_and(|active| active.id() == source.id());
        let has_range = self.state.character.playhead.range.is_some() && is_active;
        remarks.extend(has_range.then_some("The file has the whole clip; “Trim to range” cuts it.".into()));
        let take = take_of(model, Some(source), &self.state);
        let eye = take.has_gaze_at_camera().then(|| self.eye());
        let BakedTake { clip, baking, is_posed } = take.bake(None, eye);
        let seam = baking.and_then(|baking| baking.seam());
        remarks.extend(seam.map(|why| format!("The loop has a seam: {why}.").into()));
        remarks.extend(is_posed.then_some("Manually posed joints hold their pose in it.".into()));
        BakedClip { clip: clip.into_owned().with_name(source.file_name().to_owned()), remarks }
    }

    /// The same with the keys of a borrowed clip's motion, bit for bit, if that is what it shows.
    fn merged_or_baked_clip(&self, model: &Model, source: &ModelClip) -> BakedClip {
        let mut baked = self.baked_clip(model, source);
        if !take_of(model, Some(source), &self.state).is_more_than_clip() {
            baked.clip = self.merged_clip(model, source).unwrap_or(baked.clip);
        }
        baked
    }

    fn merged_clip(&self, model: &Model, source: &ModelClip) -> Option<Clip> {
        let borrowed = source.borrowed().filter(|borrowed| source.changed().is_none() && borrowed.layers.is_empty())?;
        let motion = &self.library.motion(&borrowed.motion)?.asset;
        let clip = motion.clips.get(borrowed.source_clip)?;
        merged_clip(&model.asset.skeleton, &motion.skeleton, clip, &borrowed.clip)
    }

    /// The camera's position in the current view.
    fn eye(&self) -> Vec3 {
        let mut frame = Frame::default();
        evaluate(&self.library, &self.state, self.aspect, &mut frame);
        frame.view.eye
    }
}
