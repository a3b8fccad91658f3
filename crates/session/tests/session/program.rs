//! The model of the program: what it loads, shows and remembers, and what it cancels.

use std::collections::BTreeMap;

use gaitway_session::{EntryState, ErrorCode, Event, Failure, Item, Kind, Link, LinkRole, Role, Shown, TaskId};

/// What is in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A model; the name tells it apart from other files of the same name.
    Model(&'static str),
    /// A .gltf that needs files of these names.
    Gltf(&'static [&'static str]),
    /// A file that a .gltf needs.
    Part,
    Motion,
    Light,
    Map,
    Damaged,
}

/// Something that the program has loaded.
#[derive(Debug, Clone, PartialEq)]
struct Source {
    name: String,
    content: Content,
    is_private: bool,
}

/// What the program shows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct View {
    pub models: Vec<String>,
    pub motions: Vec<String>,
    light: Option<String>,
    /// All other keys.
    rest: String,
}

/// What the program was asked for and hasn't answered.
#[derive(Debug, Clone, PartialEq)]
pub enum Load {
    Items { items: Vec<(Item, Option<Content>)>, role: Role, is_private: bool },
    Link { link: Link, reload: bool },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub view: View,
    /// Is applied in the next frame.
    pub next_view: Option<View>,
    memory: Vec<Source>,
    pub last_load: u32,
}

pub type Server = BTreeMap<&'static str, Content>;

impl View {
    pub fn of(link: &Link) -> Self {
        let names = |role| link.files_of(role).map(|file| marked(file.is_to_bring, &file.name)).collect::<Vec<_>>();
        let is_rest = |pair: &&str| Link::from(*pair).files().is_empty();
        Self {
            models: names(LinkRole::Model),
            motions: names(LinkRole::Motion),
            light: names(LinkRole::Light).pop(),
            rest: link.text().split('&').filter(is_rest).collect::<Vec<_>>().join("&"),
        }
    }

    pub fn link(&self) -> Link {
        let models = self.models.iter().map(|name| format!("model={name}"));
        let motions = self.motions.iter().map(|name| format!("motion={name}"));
        let light = self.light.iter().map(|name| format!("light={name}"));
        let rest = (!self.rest.is_empty()).then(|| self.rest.clone());
        models.chain(motions).chain(light).chain(rest).collect::<Vec<_>>().join("&").into()
    }

    pub fn set(&mut self, pair: &str) {
        self.rest = pair.to_owned();
    }

    fn names(&self) -> impl Iterator<Item = &String> {
        self.models.iter().chain(&self.motions).chain(&self.light)
    }
}

fn marked(is_to_bring: bool, name: &str) -> String {
    if is_to_bring { format!("file:{name}") } else { name.to_owned() }
}

fn failure(code: ErrorCode, message: String) -> Failure {
    Failure { code: Some(code), message }
}

impl Program {
    /// Starts with a link, its files, and what can be loaded of it. Returns what couldn't be.
    pub fn start(
        link: &Link,
        model: Vec<(Item, Option<Content>)>,
        motion: Vec<(Item, Option<Content>)>,
        is_private: bool,
        server: &Server,
    ) -> (Self, Vec<String>) {
        let mut program = Self { view: View::default(), next_view: None, memory: Vec::new(), last_load: 0 };
        for (item, content) in model.into_iter().chain(motion) {
            let content = content.or_else(|| server.get(item.name()).copied());
            program.memory.extend(content.map(|content| Source { name: item.name().to_owned(), content, is_private }));
        }
        let mut problems = Vec::new();
        let wanted = link.without_missing();
        let view = program.loaded(&wanted, false, server, &mut problems, &mut Vec::new());
        // An empty stage stands for its model.
        program.view = view.unwrap_or_else(|| View { motions: Vec::new(), ..View::of(&wanted) });
        (program, problems)
    }

    pub fn shown(&self) -> Shown {
        Shown {
            is_private: self.shows(|source| source.is_private),
            is_empty: !self.view.models.iter().any(|name| self.find(name).is_some()),
            models: self.view.models.clone(),
        }
    }

    fn shows(&self, is: impl Fn(&Source) -> bool) -> bool {
        self.view.names().filter_map(|name| self.find(name)).any(is)
    }

    fn find(&self, name: &str) -> Option<&Source> {
        self.memory.iter().rev().find(|source| source.name == name)
    }

    /// Returns what is in the file that is shown as this.
    pub fn content(&self, name: &str) -> Option<Content> {
        self.find(name).map(|source| source.content)
    }

    /// Whether a link can be shown without loading anything.
    pub fn holds(&self, link: &Link) -> bool {
        View::of(&link.without_missing()).names().all(|name| name.starts_with("file:") || self.find(name).is_some())
    }

    /// Loads and shows what was asked for; returns the answer.
    pub fn finish(&mut self, task: TaskId, load: Load, server: &Server) -> Event {
        let answer = match load {
            Load::Items { items, role, is_private } => {
                self.show_items(&items, role, is_private, server).map(|kind| Event::Opened { task, kind })
            }
            Load::Link { link, reload } => {
                self.show_link(&link, reload, server).map(|(read, problems)| Event::Followed { task, read, problems })
            }
        };
        answer.unwrap_or_else(|failure| Event::Failed { task, failure })
    }

    fn show_items(
        &mut self,
        items: &[(Item, Option<Content>)],
        role: Role,
        is_private: bool,
        server: &Server,
    ) -> Result<Kind, Failure> {
        let mut sources = Vec::new();
        for (item, read) in items {
            let name = item.name().to_owned();
            let lacks = |name: &str| failure(ErrorCode::NotFound, format!("{name}: no such file"));
            let content = read.or_else(|| server.get(&*name).copied()).ok_or_else(|| lacks(&name))?;
            match content {
                Content::Damaged => return Err(failure(ErrorCode::Malformed, format!("{name}: damaged"))),
                Content::Gltf(needed) => {
                    let is_there = |needed: &&str| items.iter().any(|(item, _)| item.name() == *needed);
                    if let Some(missing) = needed.iter().find(|needed| !is_there(needed)) {
                        return Err(lacks(missing));
                    }
                }
                _ => {}
            }
            sources.push(Source { name, content, is_private: is_private && read.is_some() });
        }
        let of = |is: fn(&Content) -> bool| {
            let names = sources.iter().filter(|source| is(&source.content)).map(|source| source.name.clone());
            names.collect::<Vec<_>>()
        };
        let models = of(|content| matches!(content, Content::Model(_) | Content::Gltf(_)));
        let motions = of(|content| matches!(content, Content::Motion));
        let lights = of(|content| matches!(content, Content::Light));
        let has_map = !of(|content| matches!(content, Content::Map)).is_empty();
        let lent = if role == Role::Motion { [motions, models.clone()].concat() } else { motions };
        let kind = match (models.first().filter(|_| role == Role::Any), lent.first()) {
            (Some(model), _) => {
                self.view.models = vec![model.clone()];
                Kind::Model
            }
            (None, Some(_)) => Kind::Motion,
            (None, None) if !lights.is_empty() => Kind::Light,
            (None, None) if has_map => Kind::Map,
            (None, None) => return Err(failure(ErrorCode::Unsupported, "nothing can be shown of this".to_owned())),
        };
        self.view.motions.retain(|name| !lent.contains(name));
        self.view.motions.extend(lent);
        self.view.light = lights.into_iter().next_back().or(self.view.light.take());
        self.memory.extend(sources);
        Ok(kind)
    }

    fn show_link(&mut self, link: &Link, reload: bool, server: &Server) -> Result<(Vec<String>, Vec<String>), Failure> {
        let (mut problems, mut read) = (Vec::new(), Vec::new());
        let wanted = link.without_missing();
        match self.loaded(&wanted, reload, server, &mut problems, &mut read) {
            Some(view) => self.view = view,
            None => return Err(failure(ErrorCode::NotFound, problems.join(" "))),
        }
        Ok((read, problems))
    }

    /// Loads what a link names. `None` if there is no model, nor the skeleton of a motion.
    fn loaded(
        &mut self,
        link: &Link,
        reload: bool,
        server: &Server,
        problems: &mut Vec<String>,
        read: &mut Vec<String>,
    ) -> Option<View> {
        let mut view = View::of(link);
        let mut loads = |name: &String| {
            if name.starts_with("file:") || (!reload && self.find(name).is_some()) {
                return true;
            }
            match server.get(&**name) {
                Some(&content) if content != Content::Damaged => {
                    self.memory.push(Source { name: name.clone(), content, is_private: false });
                    read.push(name.clone());
                    true
                }
                _ => {
                    problems.push(format!("{name}: no such file"));
                    false
                }
            }
        };
        view.models.retain(&mut loads);
        view.motions.retain(&mut loads);
        view.light = view.light.filter(&mut loads);
        if view.models.is_empty() {
            view.models = vec![view.motions.first()?.clone()];
        }
        Some(view)
    }
}

/// An entry of the browser's history.
#[derive(Debug, Clone, PartialEq)]
pub struct Visited {
    pub state: EntryState,
    pub link: Link,
}
