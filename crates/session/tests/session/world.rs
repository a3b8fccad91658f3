//! The model of the page and its browser: everything outside a session. It performs the session's effects, and whatever takes time
//! becomes something that is due, in an order that a test chooses.

use std::collections::{BTreeMap, BTreeSet};

use gaitway_session::{
    By, Effect, EntryState, ErrorCode, Event, Failure, FileId, Item, Link, NamedFile, RequestId, Role, Session, TaskId,
};

use crate::program::{Content, Load, Program, Server, View, Visited};

/// What the user, a script or the browser does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Act {
    /// The user drops files.
    Drop(&'static [(&'static str, Content)]),
    /// The user drops files to borrow their motion.
    Lend(&'static [(&'static str, Content)]),
    /// The user opens a URL.
    Url(&'static str),
    /// A script opens a URL.
    Script(&'static str),
    /// The page around this one opens a file.
    Frame(&'static [(&'static str, Content)]),
    /// The address is edited.
    Type(&'static str),
    /// The browser goes back.
    Back,
    Forward,
    /// Another key of the link is set.
    Set(&'static str),
    /// The user cancels what the program loads.
    Cancel,
    /// The program traps.
    Crash,
    /// The user starts it again.
    Launch,
    TryAgain,
}

/// Something that will happen.
#[derive(Debug, Clone, PartialEq)]
pub enum Due {
    /// A program has been downloaded.
    Loaded,
    /// It has what it shows first.
    Started { link: Link, model: Vec<Item>, motion: Vec<Item>, is_private: bool },
    /// It shows its first image.
    Drawn { problems: Vec<String> },
    /// Files have been read.
    Read(TaskId),
    /// The program has what it loads.
    Load { number: u32, task: TaskId, load: Load },
    /// A promise is settled.
    Answer(Event),
    /// The program draws a frame with another view.
    Frame,
    /// The timer has run out.
    Settle,
    /// The browser has gone to another entry.
    Traverse(isize),
}

#[derive(Debug, Clone, PartialEq)]
pub struct World {
    pub session: Session,
    pub server: Server,
    pub entries: Vec<Visited>,
    pub at: usize,
    pub program: Option<Program>,
    pub due: Vec<Due>,
    pub files: BTreeMap<FileId, Content>,
    /// Files that the user's disk doesn't give any more.
    pub moved_files: Vec<&'static str>,
    pub answers: BTreeMap<RequestId, Vec<Result<TaskId, Failure>>>,
    /// What the user was told, in order.
    pub told: Vec<Effect>,
    /// The dialog that asks for files is open.
    pub asks: Option<Vec<String>>,
    /// The dialog with what couldn't be loaded is open.
    pub report: Option<Vec<String>>,
    read: BTreeMap<TaskId, Vec<(Item, Option<Content>)>>,
    /// Tasks that have opened something, of which the page keeps a description.
    documents: BTreeSet<TaskId>,
    last_file: u32,
    last_request: u32,
}

impl World {
    /// Returns a page that was opened with a link, whose program hasn't been loaded.
    pub fn new(link: &str, server: &[(&'static str, Content)]) -> Self {
        Self::reopened(Visited { state: EntryState::default(), link: link.into() }, server)
    }

    /// Returns a page that was reloaded in an entry of the history.
    pub fn reopened(entry: Visited, server: &[(&'static str, Content)]) -> Self {
        let mut world = Self {
            session: Session::new(entry.link.clone(), entry.state),
            server: server.iter().copied().collect(),
            entries: vec![entry],
            at: 0,
            program: None,
            due: Vec::new(),
            files: BTreeMap::new(),
            moved_files: Vec::new(),
            answers: BTreeMap::new(),
            told: Vec::new(),
            asks: None,
            report: None,
            read: BTreeMap::new(),
            documents: BTreeSet::new(),
            last_file: 0,
            last_request: 0,
        };
        world.act(Act::Launch);
        world
    }

    /// Returns a page that shows a link and waits for nothing.
    pub fn at_rest(link: &str, server: &[(&'static str, Content)]) -> Self {
        let mut world = Self::new(link, server);
        world.rest();
        world
    }

    /// Lets everything happen that is due, in its order.
    #[track_caller]
    pub fn rest(&mut self) {
        for _ in 0..1000 {
            if self.due.is_empty() {
                return;
            }
            // The timer is the slowest.
            let at = self.due.iter().position(|due| *due != Due::Settle).unwrap_or(0);
            self.happen(at);
        }
        panic!("it never rests: {:?}", self.due);
    }

    /// Does something and waits for all that follows.
    #[track_caller]
    pub fn then(&mut self, act: Act) -> &mut Self {
        self.act(act);
        self.rest();
        self
    }

    /// Lets the first that is due of some kind happen.
    #[track_caller]
    pub fn first(&mut self, is: impl Fn(&Due) -> bool) {
        let at = self.due.iter().position(is).expect("it is due");
        self.happen(at);
    }

    pub fn view(&self) -> View {
        self.program.as_ref().map(|program| program.view.clone()).unwrap_or_default()
    }

    /// Returns the names of the models that are shown.
    pub fn models(&self) -> Vec<String> {
        self.view().models
    }

    /// Returns what is in the file of the model that is shown.
    pub fn content(&self) -> Option<Content> {
        let program = self.program.as_ref()?;
        program.content(program.view.models.first()?)
    }

    pub fn address(&self) -> &str {
        self.entries[self.at].link.text()
    }

    pub fn addresses(&self) -> Vec<&str> {
        self.entries.iter().map(|entry| entry.link.text()).collect()
    }

    /// Whether a page around this one must not learn what is shown.
    pub fn is_private(&self) -> bool {
        self.session.facts().is_private
    }

    /// Whether the page keeps nothing for tasks.
    pub fn has_forgotten_tasks(&self) -> bool {
        self.read.is_empty() && self.documents.is_empty()
    }

    pub fn act(&mut self, act: Act) {
        match act {
            Act::Drop(files) => self.open(By::Hand, files, Role::Any),
            Act::Lend(files) => self.open(By::Hand, files, Role::Motion),
            Act::Frame(files) => self.open(By::Frame, files, Role::Any),
            Act::Url(url) => self.open_items(By::Hand, vec![Item::Address(url.to_owned())], Role::Any),
            Act::Script(url) => self.open_items(By::Script, vec![Item::Address(url.to_owned())], Role::Any),
            Act::Type(link) => {
                self.entries.truncate(self.at + 1);
                self.entries.push(Visited { state: EntryState::default(), link: link.into() });
                self.at += 1;
                self.moved();
            }
            Act::Back => self.due.push(Due::Traverse(-1)),
            Act::Forward => self.due.push(Due::Traverse(1)),
            Act::Set(pair) => {
                if let Some(program) = &mut self.program {
                    program.view.set(pair);
                    let link = program.view.link();
                    self.tell(Event::Changed { link });
                }
            }
            Act::Cancel => {
                let last = self.program.as_ref().map(|program| program.last_load);
                let task_of = |due: &Due| match due {
                    Due::Load { number, task, .. } if Some(*number) == last => Some(*task),
                    _ => None,
                };
                if let Some((at, task)) = self.due.iter().enumerate().find_map(|(at, due)| Some((at, task_of(due)?))) {
                    self.due.remove(at);
                    self.refuse_load(task, "Opening was cancelled.");
                }
            }
            Act::Crash => {
                self.stop();
                self.tell(Event::Stopped { reason: "an error".to_owned() });
            }
            Act::Launch => {
                self.stop();
                self.due.push(Due::Loaded);
                self.tell(Event::Launch);
            }
            Act::TryAgain => {
                self.report = None;
                self.tell(Event::TryAgain);
            }
        }
    }

    fn open(&mut self, by: By, files: &[(&str, Content)], role: Role) {
        let mut keep = |&(name, content): &(&str, Content)| {
            self.last_file += 1;
            let id = FileId(self.last_file);
            self.files.insert(id, content);
            Item::File(NamedFile { id, name: name.to_owned() })
        };
        let items = files.iter().map(&mut keep).collect();
        self.open_items(by, items, role);
    }

    fn open_items(&mut self, by: By, items: Vec<Item>, role: Role) {
        self.last_request += 1;
        let request = RequestId(self.last_request);
        self.answers.insert(request, Vec::new());
        self.tell(Event::Open { request: Some(request), by, items, role });
    }

    /// The program ends, and what it was doing with it.
    fn stop(&mut self) {
        self.program = None;
        (self.asks, self.report) = (None, None);
        self.due.retain(|due| matches!(due, Due::Settle | Due::Traverse(_)));
        self.read.clear();
    }

    fn moved(&mut self) {
        let Visited { state, link } = self.entries[self.at].clone();
        self.tell(Event::Moved { link, state });
    }

    /// Returns which of what is due may happen next: the browser goes through its history in order.
    pub fn choices(&self) -> Vec<usize> {
        let traverses = |due: &Due| matches!(due, Due::Traverse(_));
        let first = self.due.iter().position(traverses);
        (0..self.due.len()).filter(|&at| first == Some(at) || !traverses(&self.due[at])).collect()
    }

    /// Lets something happen that is due.
    pub fn happen(&mut self, at: usize) {
        match self.due.remove(at) {
            Due::Loaded => self.tell(Event::Loaded),
            Due::Started { link, model, motion, is_private } => {
                let (model, motion) = (self.contents(&model), self.contents(&motion));
                let (program, problems) = Program::start(&link, model, motion, is_private, &self.server);
                let link = program.view.link();
                self.program = Some(program);
                self.tell(Event::Changed { link });
                self.due.push(Due::Drawn { problems });
            }
            Due::Drawn { problems } => self.tell(Event::Started { problems }),
            Due::Read(task) => {
                let gone = |(item, _): &(Item, Option<Content>)| self.moved_files.contains(&item.name());
                match self.read[&task].iter().find(|item| gone(item)) {
                    Some((item, _)) => {
                        let message = format!("{}: the browser can't read it", item.name());
                        self.read.remove(&task);
                        let failure = Failure { code: Some(ErrorCode::NotFound), message };
                        self.tell(Event::Failed { task, failure });
                    }
                    None => self.tell(Event::Read { task }),
                }
            }
            Due::Load { number, task, load } => {
                self.draw();
                let Some(program) = &mut self.program else { return };
                if number != program.last_load {
                    return self.refuse_load(task, "something else was opened in the meantime");
                }
                let before = program.view.clone();
                let answer = program.finish(task, load, &self.server);
                let view = program.view.clone();
                self.due.push(Due::Answer(answer));
                if view != before {
                    self.tell(Event::Changed { link: view.link() });
                }
            }
            Due::Answer(event) => {
                if let Event::Opened { task, .. } = event {
                    self.documents.insert(task);
                }
                self.tell(event);
            }
            Due::Frame => self.draw(),
            Due::Settle => self.tell(Event::Settled),
            Due::Traverse(delta) => {
                if let Some(at) = self.at.checked_add_signed(delta).filter(|at| *at < self.entries.len()) {
                    self.at = at;
                    self.moved();
                }
            }
        }
    }

    fn refuse_load(&mut self, task: TaskId, message: &str) {
        let failure = Failure { code: Some(ErrorCode::Cancelled), message: message.to_owned() };
        self.due.push(Due::Answer(Event::Failed { task, failure }));
    }

    /// Draws a frame, in which a view is applied that needs no files.
    fn draw(&mut self) {
        self.due.retain(|due| *due != Due::Frame);
        let Some(program) = &mut self.program else { return };
        if let Some(view) = program.next_view.take().filter(|view| *view != program.view) {
            program.view = view;
            let link = program.view.link();
            self.tell(Event::Changed { link });
        }
    }

    fn contents(&self, items: &[Item]) -> Vec<(Item, Option<Content>)> {
        let content = |item: &Item| {
            let content = item.id().map(|id| *self.files.get(&id).unwrap_or_else(|| panic!("{item:?} was released")));
            (item.clone(), content)
        };
        items.iter().map(content).collect()
    }

    /// Tells the session of an event, as its serialized form that outlives the program does, and does what it says.
    pub fn tell(&mut self, event: Event) {
        let shown = self.program.as_ref().map(Program::shown);
        let event: Event = serde_json::from_str(&serde_json::to_string(&event).unwrap()).unwrap();
        let effects = self.session.handle(event, shown);
        let text = serde_json::to_string(&self.session).unwrap();
        let restored: Session = serde_json::from_str(&text).unwrap();
        assert_eq!(restored, self.session);
        for effect in effects {
            self.perform(effect);
        }
    }

    fn perform(&mut self, effect: Effect) {
        match effect {
            Effect::Run { link, model, motion, is_private } => {
                self.due.push(Due::Started { link, model, motion, is_private });
            }
            Effect::Restart => self.act(Act::Launch),
            Effect::Read { task, items } => {
                let contents = self.contents(&items);
                self.read.insert(task, contents);
                self.due.push(Due::Read(task));
            }
            Effect::Show { task, items, role, is_private, .. } => {
                let items = match self.read.remove(&task) {
                    Some(read) => read,
                    None => self.contents(&items),
                };
                self.load(task, Load::Items { items, role, is_private });
            }
            Effect::Forget { task } => self.forget(task),
            Effect::Follow { task, link, reload } => self.follow(task, link, reload),
            Effect::FindReferences { task, items } => self.find_references(task, &items),
            Effect::Push { state, link } => {
                self.entries.truncate(self.at + 1);
                let state = EntryState { number: Some(state.number), own: state.own };
                self.entries.push(Visited { state, link });
                self.at += 1;
            }
            Effect::Replace { state, link } => {
                let entry = &mut self.entries[self.at];
                entry.state = EntryState { number: Some(state.number), own: state.own };
                entry.link = link.unwrap_or_else(|| entry.link.clone());
            }
            Effect::Ask { files, .. } => self.asks = Some(files),
            Effect::CloseAsk => self.asks = None,
            Effect::Report { ref problems, .. } => {
                self.report = Some(problems.clone());
                self.told.push(effect);
            }
            Effect::CloseReport => self.report = None,
            Effect::SettleSoon => {
                self.due.retain(|due| *due != Due::Settle);
                self.due.push(Due::Settle);
            }
            Effect::Reply { request, task } => self.answer(request, Ok(task)),
            Effect::Reject { request, failure } => self.answer(request, Err(failure)),
            Effect::Release { files } => {
                for file in files {
                    self.files.remove(&file).expect("a file that the page keeps");
                }
            }
            other => {
                if let Effect::Announce { task, .. } = other {
                    assert!(self.documents.contains(&task), "it is known what was opened");
                }
                self.told.push(other);
            }
        }
    }

    fn answer(&mut self, request: RequestId, answer: Result<TaskId, Failure>) {
        if let Ok(task) = &answer {
            assert!(self.documents.contains(task), "it is known what was opened");
        }
        self.answers.get_mut(&request).expect("a request").push(answer);
    }

    fn forget(&mut self, task: TaskId) {
        let is_known = self.read.remove(&task).is_some() | self.documents.remove(&task);
        assert!(is_known, "the task has read or opened something");
    }

    fn load(&mut self, task: TaskId, load: Load) {
        let program = self.program.as_mut().expect("the program runs");
        program.last_load += 1;
        let number = program.last_load;
        self.due.push(Due::Load { number, task, load });
    }

    fn follow(&mut self, task: TaskId, link: Link, reload: bool) {
        let program = self.program.as_mut().expect("the program runs");
        if reload || !program.holds(&link) {
            return self.load(task, Load::Link { link, reload });
        }
        // It needs no files, and is shown in the next frame.
        program.last_load += 1;
        program.next_view = Some(View::of(&link.without_missing()));
        self.due.push(Due::Frame);
        self.due.push(Due::Answer(Event::Followed { task, read: Vec::new(), problems: Vec::new() }));
    }

    fn find_references(&mut self, task: TaskId, items: &[Item]) {
        let names = self.contents(items).into_iter().flat_map(|(_, content)| match content {
            Some(Content::Gltf(needed)) => needed,
            _ => &[],
        });
        let is_there = |name: &&&str| items.iter().any(|item| item.name() == **name);
        let names = names.filter(|name| !is_there(name)).map(|&name| name.to_owned()).collect();
        self.due.push(Due::Answer(Event::Lacking { task, names }));
    }
}
