//! The address bar and the browser's history: opening other files adds an entry, everything else changes the current one. What
//! entries with local files showed is kept as long as the page lives.

use serde::{Deserialize, Serialize};

use crate::effect::EntryUpdate;
use crate::held::Files;
use crate::{Effect, EntryState, Link, Program, Session};

const MAX_VISITS: usize = 16;

/// The current entry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Entry {
    pub number: u32,
    /// What the browser has of it.
    pub state: EntryState,
    /// A key of the files that it shows; `None` before anything of it has been shown.
    pub files: Option<String>,
    /// The view when its address was typed: the address stays until something is set.
    typed: Option<Link>,
    /// The part of its address after `#`, or the first screen's.
    address: Link,
}

impl Entry {
    pub fn new(number: u32, state: EntryState, address: Link) -> Self {
        Self { number, state, files: None, typed: None, address }
    }
}

/// What an entry showed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Visit {
    pub number: u32,
    /// The link, with the names of local files. The entry's address lags behind the latest changes.
    pub link: Link,
    pub files: Files,
}

impl Session {
    /// Writes the current view to the address bar.
    pub(crate) fn record(&mut self) {
        if self.program != Program::Running || self.is_following() {
            return;
        }
        if self.entry.files.is_none() {
            self.keep_address();
        }
        if self.entry.typed.as_ref() == Some(&self.view) {
            if let Some(asking) = self.asking_link().cloned() {
                self.remember(asking);
            }
            return;
        }
        self.entry.typed = None;
        let files = self.view.shown_files();
        if self.awaits_view && self.entry.files.as_ref() != Some(&files) {
            return;
        }
        let link = self.with_missing(&self.view);
        let address = self.held.shareable(&link);
        if self.entry.files.as_ref() == Some(&files) {
            // Files that were open before a reload are still the user's own when they are asked for.
            let own = self.is_private() || self.awaited.as_ref().is_some_and(|awaited| awaited.is_own);
            self.replace(own, Some(address));
        } else {
            self.last_number += 1;
            let (number, own) = (self.last_number, self.is_private());
            self.entry = Entry::new(number, EntryState { number: Some(number), own }, address.clone());
            self.entry.files = Some(files);
            self.effects.push(Effect::Push { state: EntryUpdate { number, own }, link: address });
        }
        self.remember(link);
    }

    fn replace(&mut self, own: bool, link: Option<Link>) {
        let number = self.entry.number;
        let state = EntryState { number: Some(number), own };
        // Browsers limit how often an entry changes.
        if self.entry.state == state && link.as_ref().is_none_or(|link| *link == self.entry.address) {
            return;
        }
        self.entry.state = state;
        if let Some(link) = &link {
            self.entry.address.clone_from(link);
        }
        self.effects.push(Effect::Replace { state: EntryUpdate { number, own }, link });
    }

    /// Keeps what the current entry shows, if some of it is local.
    fn remember(&mut self, link: Link) {
        let number = self.entry.number;
        self.visits.retain(|visit| visit.number != number);
        let files = self.held.of_link(&link);
        if files.is_empty() {
            return;
        }
        // A typed address has no number yet.
        self.replace(self.entry.state.own, None);
        self.visits.push(Visit { number, link, files });
        if self.visits.len() > MAX_VISITS {
            self.visits.remove(0);
        }
    }

    /// Returns the link of the current entry if files are asked for that it needs.
    fn asking_link(&self) -> Option<&Link> {
        let asking = self.awaited.as_ref().filter(|awaited| !awaited.missing.is_empty())?;
        (self.entry.files.as_ref() == Some(&self.view.shown_files())).then_some(&asking.link)
    }

    /// Returns a link of the current view with the files that its entry asks for.
    pub(crate) fn with_missing(&self, link: &Link) -> Link {
        self.asking_link().map_or_else(|| link.clone(), |asking| link.with_missing(asking))
    }

    /// Keeps the address as it is until something is set.
    pub(crate) fn keep_address(&mut self) {
        self.entry.files = Some(self.view.shown_files());
        self.entry.typed = Some(self.view.clone());
        self.awaits_view = false;
    }

    /// What is shown gets an entry of its own if an address that was kept names other files, even if the view is called as before:
    /// something was opened instead of them, or they can't come any more.
    pub(crate) fn leave_kept_address(&mut self) {
        let named = self.entry.address.shown_files();
        let shown = self.held.shareable(&self.with_missing(&self.view)).shown_files();
        if self.entry.typed.is_some() && named != shown {
            (self.entry.files, self.entry.typed) = (Some(named), None);
        }
    }

    /// Makes the current entry show the files of a link.
    pub(crate) fn show_in_entry(&mut self, link: &Link) {
        (self.entry.files, self.entry.typed) = (Some(link.shown_files()), None);
    }

    /// Takes over a view of the program's.
    pub(crate) fn changed(&mut self, link: Link) {
        self.view = link;
        if self.entry.files.is_none() {
            self.keep_address();
        }
        // What a link shows on its way is not what it was followed for.
        self.awaits_view &= self.is_following();
        self.effects.push(Effect::SettleSoon);
    }

    /// Moves to the entry that the browser shows now and returns what it showed, if some of that was local.
    pub(crate) fn move_to_entry(&mut self, address: Link, state: EntryState) -> Option<Visit> {
        self.leave_entry();
        let number = state.number.unwrap_or(self.last_number + 1);
        self.last_number = self.last_number.max(number);
        self.entry = Entry::new(number, state, address);
        // An address that was typed gets a number.
        self.replace(state.own, None);
        self.visits.iter().find(|visit| visit.number == number).cloned()
    }

    /// Takes over what has been set since the entry was written.
    fn leave_entry(&mut self) {
        let is_kept = self.entry.typed.as_ref() == Some(&self.view);
        let shows_other = self.entry.files.as_ref() != Some(&self.view.shown_files());
        if is_kept || shows_other || self.is_following() {
            return;
        }
        let link = self.with_missing(&self.view);
        let files = self.held.of_link(&link);
        if let Some(left) = self.visits.iter_mut().find(|visit| visit.number == self.entry.number) {
            (left.link, left.files) = (link, files);
        }
    }
}
