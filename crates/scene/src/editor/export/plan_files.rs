//! Writes the files of a plan.

use gaitway_character::anim::Clip;
use gaitway_fbx_writer::FbxOptions;
use gaitway_part::{Answer, Output};
use gaitway_retarget::{KeyTolerance, RootTravel, Thinned, fewer_keys};

use super::rooted::{hips, own_root, rooted};
use super::together::Together;
use super::{
    ClipFormat, ExportPlan, ExportedFile, NO_SUCH_CLIP, OneFileFormat, Packaging, PlannedClip, RootBone, write_clip,
};
use crate::editor::Editor;
use crate::editor::names::plain_name;
use crate::library::Model;
use crate::state::written_skeleton;

/// A file of a plan, which may still be the GLB that the FBX writer converts: on the page, that is a part, `fbx-writer`.
#[derive(Debug)]
pub struct PlannedFile {
    file: ExportedFile,
    fbx: Option<FbxOptions>,
}

impl PlannedFile {
    /// Returns the input of the FBX writer; `None` if the file is finished.
    pub fn part_input(&self) -> Option<Vec<u8>> {
        self.fbx.as_ref().map(|options| gaitway_fbx_writer::input(&self.file.bytes, options))
    }

    /// Returns the file, with the FBX writer's answer if it has an input for it.
    ///
    /// # Errors
    /// The FBX writer's message for the user.
    pub fn finish(self, answer: Option<Answer>) -> Result<ExportedFile, String> {
        let Self { mut file, fbx } = self;
        let Some(answer) = answer.filter(|_| fbx.is_some()) else { return Ok(file) };
        let Output { bytes, warnings } = answer?;
        file.bytes = bytes;
        if let Some(stem) = file.name.strip_suffix(".glb") {
            file.name = format!("{stem}.{}", OneFileFormat::Fbx.extension());
        }
        let remarks: Vec<String> = file.remark.into_iter().chain(warnings).collect();
        file.remark = (!remarks.is_empty()).then(|| remarks.join(" "));
        Ok(file)
    }
}

impl Editor {
    /// Writes the files of a plan: the only one, or one for each clip, in the plan's order.
    ///
    /// # Errors
    /// The message for the user if the plan is refused or writing fails.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn export_plan(&self, plan: &ExportPlan) -> Result<Vec<ExportedFile>, String> {
        let finish = |file: PlannedFile| {
            let answer = file.part_input().map(|input| gaitway_fbx_writer::convert(&input));
            file.finish(answer)
        };
        self.plan_files(plan)?.into_iter().map(finish).collect()
    }

    /// Like [`Self::export_plan`], for the page, where the FBX writer is a part.
    ///
    /// # Errors
    /// The message for the user if the plan is refused or writing fails.
    pub fn plan_files(&self, plan: &ExportPlan) -> Result<Vec<PlannedFile>, String> {
        let model = self.model()?;
        plan.check(model)?;
        match plan.packaging {
            Packaging::OneFile(format) => {
                let options = FbxOptions { recipient: plan.recipient.fbx(), clips_only: false };
                let fbx = (format == OneFileFormat::Fbx).then_some(options);
                Ok(vec![PlannedFile { file: self.export_together(plan)?, fbx }])
            }
            Packaging::FilePerClip(format) => {
                let file = |planned: &PlannedClip| -> Result<PlannedFile, String> {
                    let file = self.export_planned(model, planned, format, plan.fewer_keys)?;
                    Ok(PlannedFile { file, fbx: None })
                };
                plan.clips.iter().map(file).collect()
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

/// Drops keys of a clip and says how many are left.
fn thin(model: &Model, clip: &mut Clip, tolerance: KeyTolerance) -> String {
    let Thinned { clip: thinned, keys_before, keys_after, error } = fewer_keys(&model.asset.skeleton, clip, tolerance);
    *clip = thinned;
    let KeyTolerance { degrees, millimetres_per_metre } = error;
    format!("{keys_after} of {keys_before} keys, within {degrees:.4}° and {millimetres_per_metre:.4} mm per metre.")
}
