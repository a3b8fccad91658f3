//! Following links: back and forward, another link typed into the address bar, and a link whose files have arrived.

use crate::companions::Set;
use crate::held::Files;
use crate::job::{Ask, Followed, Following, Job, Opening, Stage, Step};
use crate::{Effect, ErrorCode, Failure, Item, Link, LinkRole, Program, Role, Session, TaskId};

impl Session {
    /// Shows what a link says, with the local files that its entry of the history held.
    pub(crate) fn follow(&mut self, ask: Ask, followed: Followed) {
        self.begin_following(ask, None, followed, self.jobs.len());
    }

    /// Whether a link is being followed: what the program shows on the way is no entry.
    pub(crate) fn is_following(&self) -> bool {
        let follows = |job: &Job| match (&job.stage, &job.opening) {
            (Stage::Following(_), _) => true,
            (Stage::Loading(..), Some(opening)) => opening.is_in_entry,
            _ => false,
        };
        // What was overtaken may take as long as its site.
        self.jobs.iter().any(|job| job.ask >= self.latest && follows(job))
    }

    pub(crate) fn begin_following(&mut self, ask: Ask, opening: Option<Opening>, followed: Followed, at: usize) {
        if self.program != Program::Running {
            return self.end_following(opening);
        }
        let is_in_entry = opening.as_ref().is_some_and(|opening| opening.is_in_entry);
        let overtakes = self.awaits_view || is_in_entry || self.jobs.iter().any(|job| job.stage.has_begun());
        (self.latest, self.latest_followed) = (ask, ask);
        self.effects.push(Effect::CloseReport);
        self.privacy.visited |= followed.was_private;
        self.await_files(&followed.held_link, followed.is_own.unwrap_or(self.entry.state.own));
        let link_for_now = followed.held_link.without_missing();
        let (before, shown_before) = (self.held.of_link(&self.view), self.view.shown_files());
        self.show_in_entry(&link_for_now);
        let following = Following { followed, link_for_now, before, shown_before, overtakes, step: Step::Begun };
        self.continue_following(ask, opening, following, at);
    }

    /// Takes the next step, unless something else was asked for since.
    pub(crate) fn continue_following(
        &mut self,
        ask: Ask,
        opening: Option<Opening>,
        mut following: Following,
        at: usize,
    ) {
        if ask < self.latest {
            self.leave_address(ask, &following);
            return self.end_following(opening);
        }
        let Some(step) = self.next_step(&following) else {
            self.ask(None);
            return self.end_following(opening);
        };
        self.awaits_view = true;
        following.step = step;
        let job = Job { ask, opening, stage: Stage::Following(Box::new(following)) };
        self.jobs.insert(at.min(self.jobs.len()), job);
    }

    fn next_step(&mut self, following: &Following) -> Option<Step> {
        let Following { followed, before, step, .. } = following;
        let Files { model, motion } = &followed.files;
        let of = |items: &[Item], role| Set { items: items.to_vec(), role };
        if matches!(step, Step::Begun) && !model.is_empty() && *model != before.model {
            return Some(Step::Model(self.load(of(model, Role::Any), false, false)));
        }
        let has_motion = !motion.is_empty() && *motion != before.motion;
        if has_motion && matches!(step, Step::Begun | Step::Model(_)) {
            // The link's own model borrows them, not the one that is shown now.
            if model.is_empty() && models_of(&followed.held_link) != models_of(&self.view) {
                let link = self.held.shareable(&followed.held_link).without_missing();
                return Some(Step::Base(self.show_link(link, false)));
            }
        }
        if has_motion && matches!(step, Step::Begun | Step::Model(_) | Step::Base(_)) {
            return Some(Step::Motion(self.load(of(motion, Role::Motion), false, false)));
        }
        if matches!(step, Step::Link(_)) {
            return None;
        }
        // The same names now mean other files.
        let means_others = |now: &[Item], before: &[Item]| now.is_empty() && !before.is_empty();
        let means_others = means_others(model, &before.model) || means_others(motion, &before.motion);
        let differs = following.overtakes || following.link_for_now != self.view;
        let reload = followed.reload || (means_others && followed.files.is_empty());
        let has_to_be_told = followed.reload || means_others || differs;
        has_to_be_told.then(|| Step::Link(self.show_link(followed.held_link.clone(), reload)))
    }

    fn show_link(&mut self, link: Link, reload: bool) -> TaskId {
        let task = self.next_task();
        self.effects.push(Effect::Follow { task, link, reload });
        task
    }

    pub(crate) fn followed(&mut self, task: TaskId, read: &[String], problems: &[String]) {
        let Some((at, Job { ask, opening, stage })) = self.take_job(task) else { return };
        let Stage::Following(following) = stage else { return };
        self.take_news(read);
        self.report_following(ask, &following, problems, false);
        // Without their model, nothing borrows the motions.
        if matches!(following.step, Step::Base(_)) && !problems.is_empty() {
            return self.end_following(opening);
        }
        self.continue_following(ask, opening, *following, at);
    }

    pub(crate) fn following_failed(&mut self, ask: Ask, following: &Following, failure: &Failure) {
        if !failure.is(ErrorCode::Cancelled) {
            return self.report_following(ask, following, std::slice::from_ref(&failure.message), true);
        }
        if ask == self.latest_followed {
            self.effects.push(Effect::Notify { text: failure.sentence() });
        }
        self.leave_address(ask, following);
    }

    /// What was opened meanwhile gets an entry of its own; after “Cancel”, the address has what the screen lacks.
    fn leave_address(&mut self, ask: Ask, following: &Following) {
        if ask == self.latest_followed && self.view.shown_files() == following.shown_before {
            self.keep_address();
        }
    }

    fn report_following(&mut self, ask: Ask, following: &Following, problems: &[String], is_unchanged: bool) {
        if ask == self.latest_followed && !problems.is_empty() {
            // The address still has what the screen lacks.
            self.keep_address();
            self.report(problems, &following.followed.link, is_unchanged);
        }
    }

    /// Ends a link that was followed, and the opening that it belongs to.
    pub(crate) fn end_following(&mut self, opening: Option<Opening>) {
        self.effects.push(Effect::SettleSoon);
        if let Some(opening) = opening {
            self.finish(opening, None);
        }
    }
}

/// Returns the same for links with the same models.
fn models_of(link: &Link) -> Vec<String> {
    link.files_of(LinkRole::Model).map(|file| format!("{}{}", file.name, file.member)).collect()
}
