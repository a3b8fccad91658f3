//! What couldn't be loaded: the list that the user sees, and what trying again does.

use serde::{Deserialize, Serialize};

use crate::item::file_name;
use crate::job::Followed;
use crate::{Effect, Link, LinkRole, Program, Session};

/// What trying again does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Again {
    /// Follows a link.
    Link(Link),
    /// Loads the images of the model that is shown.
    Images,
}

impl Session {
    /// Lists the parts of a link that couldn't be loaded, and offers to try again. `is_unchanged`: nothing of the link is shown.
    pub(crate) fn report(&mut self, problems: &[String], link: &Link, is_unchanged: bool) {
        if problems.is_empty() {
            return;
        }
        // A problem may name the absolute URL of a relative one, or only the file. On an empty stage, one is about the model.
        let failed: Vec<String> =
            problems.iter().map(|problem| file_name(problem.split(": ").next().unwrap_or(problem))).collect();
        let is_empty = self.program == Program::Running && self.shown.is_empty;
        let models = link.files_of(LinkRole::Model).map(|file| file.name.clone());
        let models: Vec<String> = models.filter(|name| is_empty || failed.contains(&file_name(name))).collect();
        let has_failed = !models.is_empty();
        let is_awaited = has_failed && (is_empty || (!is_unchanged && self.shows_other(&models)));
        if is_awaited {
            self.await_copies(link, &models);
        }
        // Not one of several, of which another is shown.
        let is_model = is_awaited || (has_failed && is_unchanged);
        let title = format!("{} this link couldn't be loaded", if is_model { "The model in" } else { "Part of" });
        let rest = match (is_unchanged, is_model) {
            (true, _) => "The current view stays as it was.",
            (false, true) => "“Try again” reloads the whole link.",
            (false, false) => "Everything else is shown.",
        };
        self.again = Some(Again::Link(link.clone()));
        self.show_problems(problems.to_vec(), title, rest, "it");
    }

    /// Whether something else is shown than one of the models, such as a motion's skeleton.
    fn shows_other(&self, models: &[String]) -> bool {
        let is_shown = |source: &String| models.iter().any(|name| source.starts_with(name));
        self.program == Program::Running && !self.shown.models.iter().any(is_shown)
    }

    /// The model's images couldn't be loaded. A copy of its file also completes the view.
    pub(crate) fn images_failed(&mut self, problem: String) {
        let link = self.view.clone();
        let names: Vec<String> = link.files_of(LinkRole::Model).map(|file| file.name.clone()).collect();
        self.await_copies(&link, &names);
        self.again = Some(Again::Images);
        let title = "The images of this model couldn't be loaded".to_owned();
        self.show_problems(vec![problem], title, "It is shown without them.", "them");
    }

    fn show_problems(&mut self, problems: Vec<String>, title: String, rest: &str, without: &str) {
        let without = format!("Continue without {without}");
        self.effects.push(Effect::Report { problems, title, rest: rest.to_owned(), without });
    }

    pub(crate) fn try_again(&mut self) {
        match self.again.take() {
            Some(Again::Link(link)) if self.held.of_link(&self.view).is_empty() => {
                let ask = self.next_ask();
                self.follow(ask, Followed { reload: true, ..Followed::of(link) });
            }
            Some(Again::Link(link)) => {
                // An address has the marks of files to bring, which are here.
                self.view = self.held.with_names(&link).unwrap_or(link);
                self.effects.push(Effect::Restart);
            }
            Some(Again::Images) => {
                (self.awaited, self.passed_over) = (None, None);
                self.effects.push(Effect::LoadImages);
            }
            None => {}
        }
    }
}
