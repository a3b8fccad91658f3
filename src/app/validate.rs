//! Validates a model's file. The host runs the validator without blocking the frame loop.

use gaitway_scene::editor::ValidatorReport;
use gaitway_scene::library::ModelId;

use super::App;
use crate::ui::{Validation, text};

impl App {
    pub(super) fn start_validation(&mut self) {
        let Some(model) = self.editor.library().active() else { return };
        let running = Some((model.id, Validation::Running));
        if self.panels.host.validation != running {
            self.host.validate(model.id, &self.inbox);
            self.panels.host.validation = running;
        }
    }

    /// Shows the report, unless another model's was requested since.
    pub(super) fn end_validation(&mut self, id: ModelId, report: Result<String, String>) {
        let Some(model) = self.editor.library().get(id) else { return };
        let is_shown = self.editor.library().active().is_some_and(|active| active.id == id);
        let Some((_, validation)) = self.panels.host.validation.as_mut().filter(|(of, _)| *of == id) else { return };
        let report =
            report.and_then(|json| ValidatorReport::from_json(model, &json).map_err(|error| error.to_string()));
        let (summary, ended) = match report {
            Ok(report) => (text::validator_summary(&report), Validation::Done(report)),
            Err(error) => (text::validator_failed(&error), Validation::Failed(error)),
        };
        *validation = ended;
        if is_shown {
            self.toast(text::labelled(text::KHRONOS_VALIDATOR, &summary));
        }
    }
}
