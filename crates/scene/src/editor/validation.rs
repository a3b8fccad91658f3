//! Validation of a model's file: the input and the report of the Khronos validator, which the host runs.
//!
//! It checks what was opened, so a `FileSet` keeps a compressed glTF beside what it was converted into.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::SharedBytes;
use gaitway_formats::{GLTF_EXTENSIONS, referred_file};
use serde_json::Value;

use super::{Editor, ModelFiles};
use crate::library::{Model, ModelId, joint_of_place};

/// What the Khronos validator says about a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ValidatorReport {
    /// Numbers of errors, warnings, infos and hints.
    pub counts: [u64; 4],
    /// The validator stopped at its limit, so there may be more.
    pub is_truncated: bool,
    /// Errors first.
    pub groups: Vec<ValidatorGroup>,
}

/// All findings with one code.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ValidatorGroup {
    /// Index into [`ValidatorReport::counts`].
    pub severity: usize,
    /// The validator's name for what is wrong.
    pub code: String,
    /// The same in plain words; empty for a rare code.
    pub meaning: String,
    /// Number of findings.
    pub count: u64,
    /// The first ones: the text, and the node that it is about.
    pub findings: Vec<(String, Option<JointIndex>)>,
}

impl ValidatorReport {
    /// Reads the report that `web/validator/report.js` writes. Anything missing is empty.
    ///
    /// # Errors
    /// If the text is not JSON.
    pub fn from_json(model: &Model, json: &str) -> Result<Self, serde_json::Error> {
        let report: Value = serde_json::from_str(json)?;
        let number = |value: &Value| value.as_u64().unwrap_or_default();
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let finding = |finding: &Value| {
            let place = finding["place"].as_str().unwrap_or_default();
            (text(&finding["text"]), joint_of_place(&model.asset, place))
        };
        let group = |group: &Value| ValidatorGroup {
            severity: number(&group["severity"]).min(3) as usize,
            code: text(&group["code"]),
            meaning: text(&group["meaning"]),
            count: number(&group["count"]),
            findings: list(&group["findings"]).iter().map(finding).collect(),
        };
        Ok(Self {
            counts: std::array::from_fn(|severity| number(&report["counts"][severity])),
            is_truncated: report["isTruncated"] == true,
            groups: list(&report["groups"]).iter().map(group).collect(),
        })
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

impl Editor {
    /// Whether the active model was read from a glTF.
    pub fn has_gltf(&self) -> bool {
        let is_gltf = |model: &&Model| GLTF_EXTENSIONS.contains(&model.asset.format);
        self.library.active().filter(is_gltf).is_some_and(|model| self.files_of(model).is_some())
    }

    /// Returns the glTF that a model was read from as it was opened, or the file that it refers to by a URI.
    pub fn gltf_file(&self, model: ModelId, uri: Option<&str>) -> Option<&SharedBytes> {
        let ModelFiles { set, name } = self.files_of(self.library.get(model)?)?;
        uri.map_or_else(|| set.original(name), |uri| referred_file(set, name, uri))
    }
}
