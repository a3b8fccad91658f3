//! What the page shows, where that came from and what the user has asked for since: opening files, following links, the browser's
//! history, files that are held or awaited, and what a page around this one must not learn.
//!
//! A [`Session`] knows no browser. The page tells it what happens ([`Event`]) and does what it says ([`Effect`]); it keeps the
//! contents of files, of which the session knows numbers and names.
//!
//! | events | say |
//! | --- | --- |
//! | `Launch`, `Loaded`, `Started`, `Stopped`, `CannotRun` | what becomes of the program, of which one instance may follow another |
//! | `Open`, `Moved`, `TryAgain`, `Later`, `Share`, `Visit` | what the user, a script or the browser wants |
//! | `Hold` | which files came with the page |
//! | `Read`, `Opened`, `Followed`, `Lacking`, `Failed` | how a task has ended |
//! | `Changed`, `Settled`, `Applied`, `ImagesFailed` | what else the program shows |
//!
//! | effects | do |
//! | --- | --- |
//! | `Run`, `Restart`, `LoadImages` | start the program |
//! | `Read`, `Show`, `Follow`, `FindReferences` | tasks: they take time, and one event answers each, in any order |
//! | `Push`, `Replace`, `SettleSoon` | keep the browser's history |
//! | `Ask`, `CloseAsk`, `Report`, `CloseReport`, `Share`, `Visit` | dialogs |
//! | `Notify`, `SayProblem`, `Refuse`, `ForgetProblem`, `Announce`, `HideGallery`, `Focus` | tell the user |
//! | `Reply`, `Reject` | answer scripts |
//! | `Forget`, `Release` | forget what tasks have read and opened, and files |
//!
//! **The latest wins.** What is asked for is numbered, whether it opens or follows, and what has begun later overtakes
//! what began before: that does nothing more, and the program cancels what it is still loading for it. Reading files comes before
//! showing them, since a small file is read sooner than a large one. Only a motion that the user opens waits for what is on its way,
//! since it is for that model.
//!
//! **A session outlives the program**, which may trap at any time and whose memory is lost then. So it is plain data: the page keeps
//! its serialized form, some kilobytes, of which each event makes the next one. A trap within an event leaves the session before it.

mod awaited;
mod companions;
mod completing;
mod effect;
mod event;
mod following;
mod held;
mod history;
mod item;
mod job;
mod link;
mod opening;
mod problems;

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use self::awaited::Awaited;
use self::companions::{Companions, Set};
pub use self::effect::{Effect, EntryUpdate, Facts};
pub use self::event::{By, EntryState, ErrorCode, Event, Failure, Kind, Role, Shown};
use self::held::Held;
use self::history::{Entry, Visit};
pub use self::item::{FileId, Item, NamedFile, RequestId, TaskId};
use self::job::{Ask, Followed, Job};
pub use self::link::{Link, LinkRole, LinkedFile, MEMBER_SEPARATOR, is_light_file, is_to_bring, with_current_member};
use self::problems::Again;

/// Everything about a visit of the page that outlives an instance of the program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// The link of the current view.
    view: Link,
    /// The program has shown a link, as it says, and hasn't changed the view since: a page that is hidden draws no frames.
    awaits_view: bool,
    program: Program,
    /// What the program said last about what it shows.
    shown: Shown,
    /// What the program was started with, as far as it can be shown.
    started_with: Link,
    entry: Entry,
    /// What entries of the history showed, the most recent last.
    visits: Vec<Visit>,
    last_number: u32,
    held: Held,
    companions: Companions,
    /// The link whose files the page asks for.
    awaited: Option<Awaited>,
    /// A link that is no longer asked for, since another model or motion was opened instead. Its files complete it until the next
    /// model is opened.
    passed_over: Option<Awaited>,
    /// The files that the page keeps, and whether they are the user's own.
    files: BTreeMap<FileId, bool>,
    privacy: Privacy,
    /// Where the user has gone while no program could show it.
    asked: Option<Asked>,
    jobs: Vec<Job>,
    last_ask: Ask,
    /// What was asked for last of what has begun to change the view.
    latest: Ask,
    /// The same of what the user has opened.
    latest_by_hand: Ask,
    /// The same of links that were followed.
    latest_followed: Ask,
    last_task: TaskId,
    /// What trying again does.
    again: Option<Again>,
    #[serde(skip)]
    effects: Vec<Effect>,
}

/// Whether something can be shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Program {
    Starting,
    Running,
    /// Nothing will be shown unless it is started again.
    Ended(Failure),
}

/// What a page around this one must not learn, besides what the program shows.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Privacy {
    /// The user's own files couldn't be shown; what is said about them is on the screen.
    rejected: bool,
    /// An entry of the history has shown the user's own files.
    visited: bool,
    /// How often the user's own files were opened.
    seen: u32,
}

/// An entry of the history that was gone to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Asked {
    ask: Ask,
    /// The link in the address.
    link: Link,
    /// What the entry showed.
    visit: Option<Visit>,
    was_private: bool,
}

impl Session {
    /// Returns the session of a page that was opened with this link and state of its entry in the history.
    pub fn new(link: Link, state: EntryState) -> Self {
        let number = state.number.unwrap_or(0);
        Self {
            view: link.clone(),
            awaits_view: false,
            program: Program::Starting,
            shown: Shown::default(),
            started_with: Link::default(),
            entry: Entry::new(number, state, link),
            visits: Vec::new(),
            last_number: number,
            held: Held::default(),
            companions: Companions::default(),
            awaited: None,
            passed_over: None,
            files: BTreeMap::new(),
            privacy: Privacy { visited: state.own, ..Privacy::default() },
            asked: None,
            jobs: Vec::new(),
            last_ask: Ask(0),
            latest: Ask(0),
            latest_by_hand: Ask(0),
            latest_followed: Ask(0),
            last_task: TaskId(0),
            again: None,
            effects: Vec::new(),
        }
    }

    /// Returns what to do about an event. `shown` is what the program shows now, if it can be asked.
    pub fn handle(&mut self, event: Event, shown: Option<Shown>) -> Vec<Effect> {
        self.take_shown(shown, &event);
        match event {
            Event::Launch => self.launch(),
            Event::Loaded => self.run(),
            Event::Started { problems } => self.started(&problems),
            Event::Stopped { reason } => self.end(stopped(&reason)),
            Event::CannotRun { failure } => self.end(failure),
            Event::Hold { items } => self.hold(&items),
            Event::Open { request, by, items, role } => self.open(request, by, Set { items, role }),
            Event::Moved { link, state } => self.moved(link, state),
            Event::Changed { link } => self.changed(link),
            Event::Settled => self.record(),
            Event::Read { task } => self.read(task),
            Event::Opened { task, kind } => self.opened(task, kind),
            Event::Followed { task, read, problems } => self.followed(task, &read, &problems),
            Event::Failed { task, failure } => self.failed(task, failure),
            Event::Lacking { task, names } => self.lacking(task, &names),
            Event::Applied { read } => self.take_news(&read),
            Event::ImagesFailed { problem } => self.images_failed(problem),
            Event::TryAgain => self.try_again(),
            Event::Later => self.later(),
            Event::Share { link } => self.share(&link),
            Event::Visit { link } => self.effects.push(Effect::Visit { link: self.held.shareable(&link) }),
        }
        self.advance();
        self.release_files();
        std::mem::take(&mut self.effects)
    }

    fn take_shown(&mut self, shown: Option<Shown>, event: &Event) {
        // Until it has started, it shows what it was told to.
        let has_started = self.program == Program::Running || matches!(event, Event::Started { .. });
        let has_ended = matches!(event, Event::Stopped { .. });
        match shown {
            Some(shown) if has_started => self.shown = shown,
            // It may have shown anything since. What ends has shown what it said last.
            None if has_started && !has_ended => self.shown.is_private = true,
            _ => {}
        }
    }

    /// Returns what the page reads at any time.
    pub fn facts(&self) -> Facts {
        let asking = self.awaited.as_ref().filter(|awaited| !awaited.missing.is_empty());
        // The link that the user has gone to is shown next.
        let link = self.asked.as_ref().map_or(&self.view, Asked::shown_link);
        Facts {
            link: link.clone(),
            is_local: self.held.local_files(link).next().is_some(),
            need: asking.map(Awaited::need),
            is_private: self.is_private(),
            seen_private: self.privacy.seen,
        }
    }

    /// Holds files that came with the page, which aren't private.
    fn hold(&mut self, items: &[Item]) {
        self.files.extend(items.iter().filter_map(Item::id).map(|id| (id, false)));
        self.held.hold_last(items);
        // The address asks for them if it was shared or reloaded.
        if let Some(known) = self.held.with_names(&self.view) {
            self.view = known;
        }
    }

    fn next_ask(&mut self) -> Ask {
        self.last_ask.0 += 1;
        self.last_ask
    }

    fn next_task(&mut self) -> TaskId {
        self.last_task.0 += 1;
        self.last_task
    }

    /// Takes the job that waits for a task, and where it was.
    fn take_job(&mut self, task: TaskId) -> Option<(usize, Job)> {
        let at = self.jobs.iter().position(|job| job.stage.task() == Some(task))?;
        Some((at, self.jobs.remove(at)))
    }

    fn launch(&mut self) {
        // What waits for a program gets this one.
        let (begun, waiting) = self.jobs.drain(..).partition(|job| job.stage.task().is_some());
        self.jobs = waiting;
        self.fail_all(begun, &stopped("it was restarted"));
        self.program = Program::Starting;
    }

    fn run(&mut self) {
        self.view = match self.asked.take() {
            Some(asked) => {
                self.privacy.visited |= asked.was_private;
                asked.followed(&self.held).held_link
            }
            None => self.link_to_restore(),
        };
        let link = self.view.clone();
        self.await_files(&link, self.entry.state.own);
        self.started_with = link.without_missing();
        let files = self.held.of_link(&link);
        let is_private = files.iter().any(|item| self.is_own(item));
        self.shown = Shown { is_private, ..Shown::default() };
        self.effects.push(Effect::Run { link, model: files.model, motion: files.motion, is_private });
    }

    /// Returns the link that the next instance shows: of the current view, with the files that it lacks, or, if something stands in
    /// for them, the link that asked for them.
    fn link_to_restore(&self) -> Link {
        let whole = self.with_missing(&self.view);
        match &self.awaited {
            Some(awaited) if whole == self.view => awaited.link.clone(),
            _ => whole,
        }
    }

    fn started(&mut self, problems: &[String]) {
        self.program = Program::Running;
        self.record();
        let link = self.awaited.as_ref().map_or_else(|| self.started_with.clone(), |awaited| awaited.link.clone());
        self.report(problems, &link, false);
        self.ask(None);
        self.follow_asked();
    }

    /// Everything that isn't done fails.
    fn end(&mut self, failure: Failure) {
        let jobs = std::mem::take(&mut self.jobs);
        self.fail_all(jobs, &failure);
        self.program = Program::Ended(failure);
    }

    fn fail_all(&mut self, jobs: Vec<Job>, failure: &Failure) {
        self.awaits_view = false;
        if jobs.iter().any(|job| job.stage.has_begun()) {
            self.leave_kept_address();
        }
        for job in jobs {
            if let Some(load) = job.stage.load() {
                self.load_failed(load);
            }
            self.refuse(job, failure.clone(), true);
        }
    }

    fn moved(&mut self, link: Link, state: EntryState) {
        self.companions = Companions::default();
        // What hasn't begun was for what was shown before.
        let (begun, waiting): (_, Vec<Job>) = self.jobs.drain(..).partition(|job| job.stage.has_begun());
        self.jobs = begun;
        for job in waiting {
            self.cancel(job);
        }
        let visit = self.move_to_entry(link.clone(), state);
        let ask = self.next_ask();
        // The view stays what it is: an instance that is starting shows something else until it has started.
        self.asked = Some(Asked { ask, link, visit, was_private: state.own });
        if self.program == Program::Running {
            self.follow_asked();
        }
    }

    fn follow_asked(&mut self) {
        if let Some(asked) = self.asked.take() {
            self.follow(asked.ask, asked.followed(&self.held));
        }
    }

    /// Sources that were read from their addresses replace files of the same names.
    fn take_news(&mut self, read: &[String]) {
        read.iter().for_each(|name| self.held.release_named(name));
        if !read.is_empty() {
            self.privacy.rejected = false;
        }
    }

    fn share(&mut self, link: &Link) {
        let link = self.with_missing(link);
        let local = self.held.local_files(&link).map(|file| self.held.described(file));
        // Others need them, too, although what they are sent looks complete here.
        let missing = link.files_to_bring().map(|file| format!("{}, missing here", self.held.described(file)));
        let files = local.chain(missing).collect();
        let embedded = self.held.shareable(&link.embedded());
        self.effects.push(Effect::Share { link: self.held.shareable(&link), embedded, files });
    }

    /// Whether an item is one of the user's own files.
    fn is_own(&self, item: &Item) -> bool {
        item.id().is_some_and(|id| self.files.get(&id).copied().unwrap_or_default())
    }

    /// Whether a page around this one must not learn what is shown.
    fn is_private(&self) -> bool {
        let is_opening = || self.jobs.iter().any(|job| job.stage.load().is_some_and(|load| load.is_private));
        self.shown.is_private || self.privacy.rejected || self.privacy.visited || is_opening()
    }

    /// The user's own files are opened: they are private from now on.
    fn begin_private(&mut self, items: &[Item]) {
        self.privacy.seen += 1;
        for id in items.iter().filter_map(Item::id) {
            self.files.insert(id, true);
        }
    }

    /// Has the page forget the files that nothing refers to.
    fn release_files(&mut self) {
        let asked = self.asked.iter().filter_map(|asked| asked.visit.as_ref());
        let visits = self.visits.iter().chain(asked).flat_map(|visit| visit.files.iter());
        let jobs = self.jobs.iter().flat_map(Job::items);
        let items = self.held.iter().chain(self.companions.iter()).chain(visits).chain(jobs);
        let mut referred = BTreeSet::new();
        referred.extend(items.filter_map(Item::id));
        let files: Vec<FileId> = self.files.keys().filter(|id| !referred.contains(id)).copied().collect();
        if !files.is_empty() {
            files.iter().for_each(|id| _ = self.files.remove(id));
            self.effects.push(Effect::Release { files });
        }
    }
}

impl Asked {
    /// Returns the link of what its entry shows, with the names of local files.
    fn shown_link(&self) -> &Link {
        self.visit.as_ref().map_or(&self.link, |visit| &visit.link)
    }

    /// Returns the link to follow, with the files that its entry showed.
    fn followed(self, held: &Held) -> Followed {
        let Self { link, visit, was_private, .. } = self;
        // The address may have been edited: files that are there aren't asked for.
        let known = |link: &Link| held.with_names(link).map(|known| (held.of_link(&known), known));
        let shown = visit.map(|Visit { link, files, .. }| (files, link)).or_else(|| known(&link));
        let (files, held_link) = shown.unwrap_or_else(|| (held::Files::default(), link.clone()));
        Followed { link, held_link, files, was_private, is_own: None, reload: false }
    }
}

fn stopped(reason: &str) -> Failure {
    Failure::new(ErrorCode::LostDevice, format!("Gaitway has stopped: {reason}"))
}
