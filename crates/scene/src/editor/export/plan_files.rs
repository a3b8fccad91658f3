//! Writes the files of a plan.

use gaitway_character::anim::Clip;
use gaitway_fbx_writer::{FbxOptions, Written, fbx};
use gaitway_retarget::{KeyTolerance, RootTravel, Thinned, fewer_keys};

use super::rooted::{hips, own_root, rooted};
use super::together::Together;
use super::{
    ClipFormat, ExportPlan, ExportedFile, NO_SUCH_CLIP, OneFileFormat, Packaging, PlannedClip, RootBone, write_clip,
};
use crate::editor::Editor;
use crate::editor::names::{plain_name, stem};
use crate::library::Model;
use crate::state::written_skeleton;

impl Editor {
    /// Writes the files of a plan: the only one, or one for each clip, in the plan's order.
    ///
    /// # Errors
    /// The message for the user if the plan is refused or writing fails.
    pub fn export_plan(&self, plan: &ExportPlan) -> Result<Vec<ExportedFile>, String> {
        let model = self.model()?;
        plan.check(model)?;
        match plan.packaging {
            Packaging::OneFile(OneFileFormat::Glb) => Ok(vec![self.export_together(plan)?]),
            Packaging::OneFile(OneFileFormat::Fbx) => Ok(vec![as_fbx(self.export_together(plan)?, plan)?]),
            Packaging::FilePerClip(format) => {
                plan.clips.iter().map(|planned| self.export_planned(model, planned, format, plan.fewer_keys)).collect()
            }
        }
    }

    /// What the files of a plan lack of its clips, by name.
    pub fn plan_losses(&self, plan: &ExportPlan) -> Vec<String> {
        self.library.active().map_or(Vec::new(), |model| plan.losses(model, &self.state))
    }

    /// Writes one clip of a plan with its skeleton.
    fn export_planned(
        &self,
        model: &Model,
        PlannedClip { clip, name, .. }: &PlannedClip,
        format: ClipFormat,
        fewer: Option<KeyTolerance>,
    ) -> Result<ExportedFile, String> {
        let source = model.clip(clip).ok_or(NO_SUCH_CLIP)?;
        let mut baked = self.merged_or_baked_clip(model, source);
        if let Some(tolerance) = fewer {
            baked.remarks.push(thin(model, &mut baked.clip, tolerance).into());
        }
        let (clip, skeleton) = (baked.clip.with_name(name.clone()), written_skeleton(model, &self.state, None));
        let bytes = write_clip(model, &skeleton, &clip, source.frames_per_sec(), format);
        let name = format!("{}.{}", plain_name(name), format.extension());
        Ok(ExportedFile::new(name, bytes.map_err(|error| error.to_string())?).with_remarks(&baked.remarks))
    }

    /// Writes the model's own file with the clips of a plan and no others; without a file, only skeleton and clips.
    fn export_together(&self, plan: &ExportPlan) -> Result<ExportedFile, String> {
        let model = self.complete_model()?;
        let Together { own, mut added, mut remarks } = self.gather(model, &plan.clips, !plan.changes_own(model))?;
        if let Some(tolerance) = plan.fewer_keys {
            for (place, clip) in &mut added {
                let remark = thin(model, clip, tolerance);
                remarks.push(format!("{}: {remark}", plan.clips[*place].name).into());
            }
        }
        let skeleton = written_skeleton(model, &self.state, None);
        let bytes = match (plan.root_bone.filter(|_| plan.has_new_root(model)), hips(model)) {
            (Some(RootBone { vertical }), Some(hips)) => {
                let bare = self.write_together(model, &own, &[])?;
                let travel = |place: usize| RootTravel { vertical, in_place: plan.clips[place].in_place };
                let clips: Vec<(Clip, RootTravel)> =
                    added.into_iter().map(|(place, clip)| (clip, travel(place))).collect();
                rooted(&bare, skeleton.source_index(hips), &skeleton, &clips)?
            }
            _ => self.write_together(model, &own, &added.iter().map(|(_, clip)| clip).collect::<Vec<_>>())?,
        };
        if let Some(root) = own_root(model).filter(|_| plan.root_bone.is_some()) {
            let root = skeleton.label(root);
            remarks.push(format!("“{root}” is the root bone of this rig; clips keep their travel where it is.").into());
        }
        Ok(self.together_file(model, bytes, remarks))
    }
}

/// Converts the .glb of a plan.
fn as_fbx(glb: ExportedFile, plan: &ExportPlan) -> Result<ExportedFile, String> {
    let options = FbxOptions { recipient: plan.recipient.fbx(), clips_only: false };
    let Written { bytes, warnings, .. } = fbx(&glb.bytes, &options).map_err(|error| error.to_string())?;
    let name = format!("{}.{}", stem(&glb.name), OneFileFormat::Fbx.extension());
    let remarks: Vec<_> = glb.remark.into_iter().chain(warnings).map(Into::into).collect();
    Ok(ExportedFile::new(name, bytes).with_remarks(&remarks))
}

/// Drops keys of a clip and says how many are left.
fn thin(model: &Model, clip: &mut Clip, tolerance: KeyTolerance) -> String {
    let Thinned { clip: thinned, keys_before, keys_after, error } = fewer_keys(&model.asset.skeleton, clip, tolerance);
    *clip = thinned;
    let KeyTolerance { degrees, millimetres_per_metre } = error;
    format!("{keys_after} of {keys_before} keys, within {degrees:.4}° and {millimetres_per_metre:.4} mm per metre.")
}
