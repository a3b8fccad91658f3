//! The model's file with several clips and no others.

use std::borrow::Cow;

use gaitway_character::anim::Clip;
use gaitway_formats::{OwnClips, write_edited_model, write_motion};

use super::in_file::is_in_file;
use super::{ExportPlan, ExportedFile, NO_FILE, NO_SUCH_CLIP, PlannedClip};
use crate::editor::names::{plain_name, stem};
use crate::editor::{Editor, ModelFiles};
use crate::library::{ClipId, Model};
use crate::state::written_skeleton;

/// The clips of a file.
pub(super) struct Together {
    /// What becomes of those that the model's file has.
    pub own: OwnClips,
    /// The others, with their places in the plan.
    pub added: Vec<(usize, Clip)>,
    pub remarks: Vec<Cow<'static, str>>,
}

impl Editor {
    /// Writes the model with all its clips, as [`ExportPlan::all_clips`] has them. The page calls this instead of
    /// [`Editor::export_plan`], which keeps the code for a plan's options out of its program.
    pub(super) fn export_all_clips(&self) -> Result<ExportedFile, String> {
        let model = self.complete_model()?;
        let plan = ExportPlan::all_clips(model);
        let Together { own, added, mut remarks } = self.gather(model, &plan.clips, true)?;
        let losses = plan.losses(model, &self.state).into_iter();
        remarks.extend(losses.map(|loss| format!("Not in the file: {loss}.").into()));
        let bytes = self.write_together(model, &own, &added.iter().map(|(_, clip)| clip).collect::<Vec<_>>())?;
        Ok(self.together_file(model, bytes, remarks))
    }

    /// Collects clips. With `stay`, those that the model's file has as they play stay there.
    pub(super) fn gather(&self, model: &Model, clips: &[PlannedClip], stay: bool) -> Result<Together, String> {
        let own = OwnClips { left_out: (0..model.asset.clips.len()).collect(), ..OwnClips::default() };
        let mut together = Together { own, added: Vec::new(), remarks: Vec::new() };
        let stay = stay && self.files_of(model).is_some();
        for (place, PlannedClip { clip, name, .. }) in clips.iter().enumerate() {
            let source = model.clip(clip).ok_or(NO_SUCH_CLIP)?;
            match source.id() {
                ClipId::Own(index) if stay && is_in_file(model, &self.state, source) => {
                    together.own.left_out.remove(index);
                    if model.asset.clips[*index].name() != name {
                        together.own.names.insert(*index, name.clone());
                    }
                }
                _ => {
                    let baked = self.merged_or_baked_clip(model, source);
                    let remarks = baked.remarks.into_iter();
                    together.remarks.extend(remarks.map(|remark| format!("{name}: {remark}").into()));
                    together.added.push((place, baked.clip.with_name(name.clone())));
                }
            }
        }
        Ok(together)
    }

    /// Writes the model's own file; without one, only its skeleton.
    pub(super) fn write_together(&self, model: &Model, own: &OwnClips, added: &[&Clip]) -> Result<Vec<u8>, String> {
        let skeleton = written_skeleton(model, &self.state, None);
        let bytes = match self.files_of(model) {
            Some(ModelFiles { set, name }) => write_edited_model(set, name, &skeleton, own, added),
            None => write_motion(&model.asset, &skeleton, added),
        };
        bytes.map_err(|error| error.to_string())
    }

    pub(super) fn together_file(
        &self,
        model: &Model,
        bytes: Vec<u8>,
        mut remarks: Vec<Cow<'static, str>>,
    ) -> ExportedFile {
        remarks.extend(self.files_of(model).is_none().then_some(NO_FILE.into()));
        ExportedFile::new(format!("{}.glb", plain_name(&stem(&model.source))), bytes).with_remarks(&remarks)
    }
}
