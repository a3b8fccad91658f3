//! Opening files and addresses, from the user or a script to what the program shows.

use crate::companions::{Join, Set};
use crate::completing::Completion;
use crate::item::{file_name, has_files, names_of};
use crate::job::{Job, Load, Opening, Stage};
use crate::{By, Effect, ErrorCode, Failure, Item, Kind, Program, RequestId, Role, Session, TaskId};

impl Session {
    pub(crate) fn open(&mut self, request: Option<RequestId>, by: By, set: Set) {
        for id in set.items.iter().filter_map(Item::id) {
            self.files.entry(id).or_insert(false);
        }
        let waits = by == By::Hand && (set.role == Role::Motion || set.items.iter().all(Item::is_motion));
        let opening = Opening { request, by, set, is_in_entry: false, shown: None };
        let job = Job { ask: self.next_ask(), opening: Some(opening), stage: Stage::Turn };
        let last = self.jobs.len();
        if waits { self.jobs.push(job) } else { self.begin(job, last) }
    }

    /// Takes the next step of everything that waits for nothing any more.
    pub(crate) fn advance(&mut self) {
        while self.give_turn() || self.join_next() || self.begin_loading() {}
    }

    /// Lets a motion begin that has waited. It is for the model that was on its way; one motion waits for the other.
    fn give_turn(&mut self) -> bool {
        let is_busy = self.jobs.iter().any(|job| job.stage != Stage::Turn);
        if is_busy || self.jobs.is_empty() {
            return false;
        }
        let mut job = self.jobs.remove(0);
        // Others may have been opened meanwhile.
        job.ask = self.next_ask();
        self.begin(job, 0);
        true
    }

    fn begin(&mut self, job: Job, at: usize) {
        let Job { ask, opening: Some(opening), .. } = job else { return };
        let set = opening.set.clone();
        if opening.by == By::Hand {
            self.latest_by_hand = ask;
        }
        // The page around this one completes none of the user's models.
        let stage = if opening.by == By::Frame { Stage::Program(set) } else { Stage::Join(set) };
        self.jobs.insert(at, Job { ask, opening: Some(opening), stage });
    }

    /// Joins the first set that hasn't been, which those behind it wait for.
    fn join_next(&mut self) -> bool {
        let is_waiting = |job: &Job| matches!(job.stage, Stage::Join(_) | Stage::Joining(..));
        let Some(at) = self.jobs.iter().position(is_waiting) else { return false };
        let Stage::Join(set) = &self.jobs[at].stage else { return false };
        if self.program == Program::Starting {
            return false;
        }
        let set = self.named_as_awaited(set.clone());
        if self.kept_for_model(at, &set.items) {
            return true;
        }
        self.jobs[at].stage = match self.companions.join(set.clone(), &self.held) {
            Join::Done(set) => Stage::Program(set),
            Join::Ask(_) if self.program != Program::Running => Stage::Program(set),
            Join::Ask(question) => {
                let task = self.next_task();
                self.effects.push(Effect::FindReferences { task, items: question.main.items.clone() });
                Stage::Joining(task, question)
            }
        };
        true
    }

    /// Gives copies of files the names that a link knows them by. Which link that is, is known once the program has started.
    fn named_as_awaited(&self, mut set: Set) -> Set {
        if let Some(waiting) = self.completable() {
            waiting.rename_copies(&mut set.items);
        }
        set
    }

    /// Keeps what a link needs besides its model, if the user has opened it: nothing can be shown of it before the model arrives.
    /// Returns whether that is so.
    fn kept_for_model(&mut self, at: usize, items: &[Item]) -> bool {
        let is_by_hand = self.jobs[at].opening.as_ref().is_some_and(|opening| opening.by == By::Hand);
        let Some(need) = self.need_of_model_beside(items).filter(|_| is_by_hand) else { return false };
        let job = self.jobs.remove(at);
        self.keep(items);
        self.complete_link(items, None);
        self.effects.extend([Effect::HideGallery, Effect::Focus]);
        let request = job.opening.and_then(|opening| opening.request);
        let failure = Failure::new(ErrorCode::NotFound, need);
        self.effects.extend(request.map(|request| Effect::Reject { request, failure }));
        true
    }

    pub(crate) fn lacking(&mut self, task: TaskId, names: &[String]) {
        let Some(job) = self.jobs.iter_mut().find(|job| job.stage.task() == Some(task)) else { return };
        if let Stage::Joining(_, question) = &job.stage {
            job.stage = Stage::Program(self.companions.found(question.clone(), names));
        }
    }

    /// Loads the first set that waits for the program, if that runs.
    fn begin_loading(&mut self) -> bool {
        let waiting = |job: &Job| matches!(job.stage, Stage::Program(_));
        let Some(at) = self.jobs.iter().position(waiting).filter(|_| self.program != Program::Starting) else {
            return false;
        };
        let job = self.jobs.remove(at);
        match self.program.clone() {
            Program::Ended(failure) => self.refuse(job, failure, true),
            _ if job.ask < self.latest => self.cancel(job),
            _ => self.load_set(job, at),
        }
        true
    }

    fn load_set(&mut self, job: Job, at: usize) {
        let Job { ask, opening: Some(mut opening), stage: Stage::Program(set) } = job else { return };
        let set = self.named_as_awaited(set);
        let is_awaited = self.completable().is_some_and(|waiting| waiting.arrivals(&set.items).is_some());
        opening.is_in_entry = is_awaited && self.awaited.is_some();
        if !opening.is_in_entry && self.is_following() {
            // The address has what the screen will lack.
            self.keep_address();
        }
        self.latest = ask;
        let given = set.items.clone();
        let (motions, others) = match self.completable() {
            Some(waiting) => waiting.split(set),
            None => (None, Some(set)),
        };
        let set = match (motions, others) {
            (Some(motions), Some(others)) => {
                // They follow once the link's model is there.
                match opening.by {
                    By::Frame => self.held.hold_last(&motions.items),
                    By::Hand | By::Script => self.keep(&motions.items),
                }
                others
            }
            (motions, others) => motions.or(others).unwrap_or_default(),
        };
        let (are_own, is_by_hand) = (opening.by != By::Frame, opening.by == By::Hand && !is_awaited);
        let load = self.load(set, are_own, is_by_hand);
        self.jobs.insert(at, Job { ask, opening: Some(opening), stage: Stage::Loading(load, given) });
    }

    /// Reads and shows items, and holds on to local ones. `are_own`: the local files among them are the user's own. Files that were
    /// so once always are.
    pub(crate) fn load(&mut self, set: Set, are_own: bool, is_by_hand: bool) -> Load {
        let has_files = has_files(&set.items);
        let is_private = has_files && (are_own || set.items.iter().any(|item| self.is_own(item)));
        if is_private {
            self.begin_private(&set.items);
        }
        self.held.hold(&set.items);
        let load = Load { task: self.next_task(), set, is_private, is_by_hand, is_read: !has_files };
        if has_files {
            // Their order may be another one than that of what was asked for.
            self.effects.push(Effect::Read { task: load.task, items: load.set.items.clone() });
        } else {
            self.show(&load);
        }
        load
    }

    fn show(&mut self, load: &Load) {
        let &Load { task, is_private, is_by_hand, .. } = load;
        let Set { items, role } = load.set.clone();
        self.effects.push(Effect::Show { task, items, role, is_private, is_by_hand });
    }

    /// Shows what has been read, unless something else was asked for since.
    pub(crate) fn read(&mut self, task: TaskId) {
        let Some(job) = self.jobs.iter_mut().find(|job| job.stage.task() == Some(task)) else { return };
        let ask = job.ask;
        let Some(load) = job.stage.load_mut().filter(|load| !load.is_read) else { return };
        load.is_read = true;
        let load = load.clone();
        if ask < self.latest {
            self.effects.push(Effect::Forget { task });
            self.failed(task, overtaken(&load.set.items));
        } else {
            self.show(&load);
        }
    }

    pub(crate) fn load_failed(&mut self, load: &Load) {
        // Undo or a link's missing files may still show it.
        self.held.hold_last(&load.set.items);
        self.privacy.rejected |= load.is_private;
    }

    /// Holds on to files of the user's that can't be shown before others arrive.
    pub(crate) fn keep(&mut self, items: &[Item]) {
        if has_files(items) {
            self.begin_private(items);
            self.held.hold_last(items);
            self.privacy.rejected = true;
        }
    }

    pub(crate) fn opened(&mut self, task: TaskId, kind: Kind) {
        let Some((at, Job { ask, opening, stage })) = self.take_job(task) else { return };
        self.privacy.rejected = false;
        match (stage, opening) {
            (Stage::Loading(_, given), Some(mut opening)) => {
                opening.shown = Some((task, kind));
                self.effects.push(Effect::ForgetProblem);
                match self.complete_link(&given, Some(kind)) {
                    // Something else was asked for since.
                    Completion::Follow(_) if ask < self.latest => self.finish(opening, None),
                    Completion::Follow(followed) => self.begin_following(ask, Some(opening), *followed, at),
                    Completion::Done(hint) => self.finish(opening, hint),
                }
            }
            (Stage::Following(following), opening) => {
                self.effects.push(Effect::Forget { task });
                self.continue_following(ask, opening, *following, at);
            }
            _ => {}
        }
    }

    /// Ends an opening that has shown something. `hint` is what to tell the user besides.
    pub(crate) fn finish(&mut self, opening: Opening, hint: Option<String>) {
        let Some((task, kind)) = opening.shown else { return };
        self.effects.push(Effect::Announce { task, kind });
        // An entry is written once its link has been followed.
        if opening.is_in_entry {
            self.effects.push(Effect::SettleSoon);
        } else {
            self.leave_kept_address();
            self.record();
        }
        self.effects.extend(opening.request.map(|request| Effect::Reply { request, task }));
        self.effects.push(Effect::Forget { task });
        if opening.by == By::Hand {
            self.effects.extend(hint.map(|text| Effect::Notify { text }));
            self.effects.extend([Effect::HideGallery, Effect::Focus]);
        }
    }

    pub(crate) fn failed(&mut self, task: TaskId, failure: Failure) {
        let Some((at, job)) = self.take_job(task) else { return };
        // The program shows its errors itself.
        let is_shown = job.stage.load().is_none_or(|load| load.is_read);
        if let Some(load) = job.stage.load() {
            self.load_failed(load);
        }
        match job {
            // Opening them reports what is wrong.
            Job { ask, opening, stage: Stage::Joining(_, question) } => {
                let stage = Stage::Program(self.companions.found(question, &[]));
                self.jobs.insert(at, Job { ask, opening, stage });
            }
            Job { ask, opening, stage: Stage::Following(following) } => {
                self.following_failed(ask, &following, &failure);
                self.end_following(opening);
            }
            Job { stage: Stage::Loading(_, ref given), .. } => {
                match failure.code {
                    Some(ErrorCode::Cancelled) => {}
                    // Without all of its files, nothing completes a link.
                    Some(ErrorCode::NotFound) => self.ask(Some(names_of(given))),
                    // A motion may have arrived before its model.
                    _ => _ = self.complete_link(given, None),
                }
                self.refuse(job, failure, is_shown);
            }
            _ => {}
        }
    }

    /// Ends something that was overtaken before the program was told of it.
    pub(crate) fn cancel(&mut self, job: Job) {
        let failure = job.opening.as_ref().map(|opening| overtaken(&opening.set.items));
        if let Some(failure) = failure {
            self.refuse(job, failure, true);
        }
    }

    /// Ends an opening that has failed. `is_shown`: the program shows the error itself.
    pub(crate) fn refuse(&mut self, job: Job, failure: Failure, is_shown: bool) {
        let Job { ask, opening: Some(opening), .. } = job else { return };
        if opening.is_in_entry {
            self.effects.push(Effect::SettleSoon);
        }
        if opening.by == By::Hand {
            let message = failure.message.clone();
            // What was opened since has its own result; that this wasn't opened is told as well.
            let is_overtaken = ask < self.latest_by_hand;
            match (is_overtaken, failure.is(ErrorCode::Cancelled)) {
                (false, _) if is_shown => self.effects.push(Effect::SayProblem { message }),
                (false, _) => self.effects.push(Effect::Refuse { message }),
                (true, true) => self.effects.push(Effect::Notify { text: failure.sentence() }),
                (true, false) => {}
            }
            self.effects.push(Effect::Focus);
        }
        self.effects.extend(opening.request.map(|request| match opening.shown {
            Some((task, _)) => Effect::Reply { request, task },
            None => Effect::Reject { request, failure },
        }));
        self.effects.extend(opening.shown.map(|(task, _)| Effect::Forget { task }));
    }
}

/// Something else was asked for before these items were shown.
fn overtaken(items: &[Item]) -> Failure {
    let name = items.last().map(|item| format!("{}: ", file_name(item.name()))).unwrap_or_default();
    Failure::new(ErrorCode::Cancelled, format!("{name}something else was opened in the meantime"))
}
