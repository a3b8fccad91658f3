//! Showing a link with the files that it has waited for.

use crate::awaited::{Awaited, has_model};
use crate::item::names_of;
use crate::job::Followed;
use crate::{Effect, Item, Kind, Link, LinkRole, LinkedFile, Session};

/// What becomes of a link that waits for files.
pub(crate) enum Completion {
    /// It waits on, or nothing did. Holds what to tell the user who opened another model instead.
    Done(Option<String>),
    /// It can be shown.
    Follow(Box<Followed>),
}

impl Session {
    /// Returns the link that files complete, if any.
    pub(crate) fn completable(&self) -> Option<&Awaited> {
        self.awaited.as_ref().or(self.passed_over.as_ref())
    }

    /// Waits for the files that a link asks for, if it does.
    pub(crate) fn await_files(&mut self, link: &Link, is_own: bool) {
        self.effects.push(Effect::CloseAsk);
        (self.awaited, self.passed_over) = (Awaited::of(link, is_own), None);
    }

    /// Also waits for copies of a link's files that couldn't be loaded.
    pub(crate) fn await_copies(&mut self, link: &Link, names: &[String]) {
        let marked = link.public(names);
        let missing = self.awaited.take().map(|awaited| awaited.missing).unwrap_or_default();
        let wanted = marked.files_to_bring().cloned().collect();
        let is_own = self.entry.state.own;
        self.awaited = Some(Awaited { link: link.clone(), marked, wanted, missing, is_own });
    }

    /// Asks for the files that are missing. `others` are names of files that couldn't be opened.
    pub(crate) fn ask(&mut self, others: Option<String>) {
        self.effects.extend(self.awaited.as_ref().and_then(|awaited| awaited.ask(others)));
    }

    pub(crate) fn later(&mut self) {
        // The empty stage says what it waits for.
        let told = self.awaited.as_ref().filter(|awaited| !awaited.missing.is_empty() && !awaited.lacks_model());
        self.effects.extend(told.map(|awaited| Effect::Notify { text: awaited.need() }));
    }

    /// Tells what a link needs if its model hasn't arrived with items that it needs, too.
    pub(crate) fn need_of_model_beside(&self, items: &[Item]) -> Option<String> {
        let awaited = self.awaited.as_ref().filter(|awaited| awaited.lacks_model())?;
        let asked = Awaited { wanted: awaited.missing.clone(), ..awaited.clone() };
        let models = |files: &[LinkedFile]| files.iter().filter(|file| file.role == LinkRole::Model).count();
        let arrivals = asked.arrivals(items)?;
        (models(&arrivals.rest) == models(&asked.missing)).then(|| awaited.need())
    }

    /// Completes a link with files that it waits for among these, as far as that is possible without the rest, which the page goes on
    /// asking for. `shown` is what the items were, unless they couldn't be opened.
    pub(crate) fn complete_link(&mut self, items: &[Item], shown: Option<Kind>) -> Completion {
        const NOTHING: Completion = Completion::Done(None);
        let Some(waiting) = self.completable().cloned() else { return NOTHING };
        let Some(arrivals) = waiting.arrivals(items) else {
            if shown == Some(Kind::Model) || (shown == Some(Kind::Motion) && self.asks_for_motion_alone()) {
                return Completion::Done(self.pass_over());
            }
            self.ask(shown.is_none().then(|| names_of(items)));
            return NOTHING;
        };
        if has_model(&arrivals.rest) {
            self.awaited = Some(waiting.for_rest(arrivals));
            self.ask(None);
            return NOTHING;
        }
        if shown.is_none() {
            // They are still awaited: one of them is damaged.
            self.ask(Some(names_of(items)));
            return NOTHING;
        }
        (self.awaited, self.passed_over) = (None, None);
        let (files, is_own) = (self.held.of_link(&arrivals.link), Some(waiting.is_own));
        Completion::Follow(Box::new(Followed { files, is_own, ..Followed::of(arrivals.link) }))
    }

    /// Whether the link's model is there, and the page asks for its motion.
    fn asks_for_motion_alone(&self) -> bool {
        let asking = self.awaited.as_ref().filter(|awaited| !awaited.lacks_model());
        asking.is_some_and(|awaited| awaited.missing.iter().any(|file| file.role == LinkRole::Motion))
    }

    /// Stops asking, since another model or motion was opened. Returns what to tell the user: it may have been the wrong file.
    fn pass_over(&mut self) -> Option<String> {
        self.effects.push(Effect::CloseAsk);
        // Copies of files that couldn't be loaded are accepted, not asked for.
        self.passed_over = self.awaited.take().filter(|awaited| !awaited.missing.is_empty());
        self.passed_over.as_ref().map(Awaited::need)
    }
}
