//! Runs what is asked for against a world in which everything else happens in any order.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::program::{Load, View};
use crate::world::{Act, Due, World};

/// Orders beyond this many would take too long; none of the tests has as many.
const MAX_WORLDS: usize = 400_000;

/// Lets `acts` happen in their order, and whatever follows from them in every order, between them as well. Calls `check` with each
/// world in which nothing is left to happen.
#[track_caller]
pub fn in_every_order(start: &World, acts: &[Act], check: impl Fn(&World)) {
    let mut seen = HashSet::new();
    let mut open = vec![(start.clone(), 0, Vec::new())];
    let mut ends = 0;
    while let Some((world, done, path)) = open.pop() {
        let mut hasher = DefaultHasher::new();
        (format!("{world:?}"), done).hash(&mut hasher);
        if !seen.insert(hasher.finish()) {
            continue;
        }
        assert!(seen.len() < MAX_WORLDS, "too many orders");
        checked(&path, &world, always);
        if done == acts.len() && world.due.is_empty() {
            ends += 1;
            checked(&path, &world, |world| {
                finally(world);
                check(world);
            });
        }
        if let Some(&act) = acts.get(done) {
            let mut next = world.clone();
            next.act(act);
            open.push((next, done + 1, with(&path, format!("{act:?}"))));
        }
        for at in world.choices() {
            let mut next = world.clone();
            let step = format!("{:?}", next.due[at]);
            next.happen(at);
            open.push((next, done, with(&path, step)));
        }
    }
    assert!(ends > 0, "no order comes to an end");
}

/// Does the same for some of the orders, chosen by seeds, of acts that are too many for all orders.
#[track_caller]
pub fn in_some_orders(start: &World, acts: impl Fn(&mut Random) -> Vec<Act>, seeds: u64, check: impl Fn(&World)) {
    for seed in 0..seeds {
        let mut random = Random::new(seed);
        let acts = acts(&mut random);
        let (mut world, mut done, mut path) = (start.clone(), 0, vec![format!("seed {seed}")]);
        while done < acts.len() || !world.due.is_empty() {
            let choices = world.choices();
            match choices.get(random.below(choices.len() + usize::from(done < acts.len()))) {
                Some(&at) => {
                    path.push(format!("{:?}", world.due[at]));
                    world.happen(at);
                }
                None => {
                    path.push(format!("{:?}", acts[done]));
                    world.act(acts[done]);
                    done += 1;
                }
            }
            checked(&path, &world, always);
        }
        checked(&path, &world, |world| {
            finally(world);
            check(world);
        });
    }
}

/// A small generator of the same numbers on every machine (xorshift64*).
pub struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % count
    }

    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}

fn with(path: &[String], step: String) -> Vec<String> {
    path.iter().cloned().chain([step]).collect()
}

/// Prints the way to a world that doesn't hold what it should.
#[track_caller]
fn checked(path: &[String], world: &World, check: impl Fn(&World)) {
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| check(world)));
    if let Err(problem) = result {
        eprintln!("after\n  {}\nin {world:#?}", path.join("\n  "));
        std::panic::resume_unwind(problem);
    }
}

/// What holds at any time.
fn always(world: &World) {
    for answers in world.answers.values() {
        assert!(answers.len() <= 1, "a request is answered once");
    }
    let loads_private = |due: &Due| matches!(due, Due::Load { load: Load::Items { is_private: true, .. }, .. });
    if world.due.iter().any(loads_private) {
        assert!(world.session.facts().is_private, "the user's own files are private while they are opened");
    }
}

/// What holds once nothing is left to happen.
fn finally(world: &World) {
    for (request, answers) in &world.answers {
        assert_eq!(answers.len(), 1, "{request:?} is answered");
    }
    assert!(
        world.has_forgotten_tasks(),
        "what was read is shown or forgotten, and what was opened is told and forgotten"
    );
    let numbers: Vec<u32> = world.entries.iter().filter_map(|entry| entry.state.number).collect();
    let distinct: HashSet<u32> = numbers.iter().copied().collect();
    assert_eq!(distinct.len(), numbers.len(), "each entry has a number of its own");
    let mut again = world.clone();
    again.tell(gaitway_session::Event::Settled);
    assert_eq!(again.entries, world.entries, "the history is written");
}

/// Asserts that the address names what is shown, and what it lacks.
#[track_caller]
pub fn assert_address_shows_view(world: &World) {
    let bare = |names: &[String]| -> Vec<String> {
        names.iter().map(|name| name.strip_prefix("file:").unwrap_or(name).to_owned()).collect()
    };
    let (named, shown) = (View::of(&world.entries[world.at].link), world.view());
    assert_eq!(bare(&named.models), bare(&shown.models), "models of {}", world.address());
    if world.session.facts().need.is_none() {
        assert_eq!(bare(&named.motions), bare(&shown.motions), "motions of {}", world.address());
    }
}
