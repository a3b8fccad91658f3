//! What an embedding page can read of the state never depends on the user's local files, neither on those that are shown nor on
//! those that were.
//!
//! The same calls and clicks run beside two versions of the user's files. As long as nothing is private, both states are equal, and
//! both are private at the same times.

use gaitway_character::asset::Panorama;
use gaitway_formats::{FileSet, load};
use gaitway_retarget::ClipLayer;
use gaitway_scene::editor::{Contents, Editor, OpenedModel};
use gaitway_scene::library::{ClipId, Environment, LayeredClip, Model, Motion};
use gaitway_scene::state::{
    ClipChoice, ClipEdit, Command, EnvironmentChoice, Hidden, from_link, from_object, to_link, to_object,
};
use glam::Vec3;
use serde_json::{Value, json};

use super::{any, contents, motion};
use crate::random::Random;
use crate::walk_bvh::BVH;

/// An editor that opens one of the two versions of the user's files.
struct World {
    editor: Editor,
    /// In all names of files, joints and clips.
    word: &'static str,
    /// In all numbers.
    number: f32,
}

impl World {
    fn new(word: &'static str, number: f32) -> Self {
        let mut world = Self { editor: Editor::default(), word, number };
        world.open(contents(&["sample:walker"]));
        world
    }

    fn open(&mut self, contents: Contents) {
        // What can't be opened leaves everything as it was.
        let _ = self.editor.open(contents, None, &mut any);
    }

    /// Returns a walk whose joint names and bone lengths are the user's.
    fn own_walk(&self) -> Motion {
        let text = BVH.replace("JOINT ", &format!("JOINT {}:", self.word));
        let text = text.replace("OFFSET 0 45 0", &format!("OFFSET 0 {} 0", 40.0 + self.number));
        let name = format!("{}.bvh", self.word);
        let mut set = FileSet::default();
        set.insert(name.clone(), text.as_bytes());
        Motion::new(name, load(&set).expect("a motion").into())
    }

    fn own_sky(&self) -> Environment {
        let panorama = Panorama::new(2, 1, vec![Vec3::splat(self.number); 2]).expect("the right size");
        let origin = format!("{}.hdr", self.word);
        Environment { origin, panorama: panorama.into(), file: Default::default(), is_own: false }
    }

    /// Opens a file of the user's.
    fn drop_file(&mut self, choice: usize, is_by_hand: bool) {
        let walk = self.own_walk();
        let dropped = match choice {
            0 => Contents { motions: Some(vec![walk]), ..Contents::default() },
            1 => {
                let model = OpenedModel::from(Model::new(walk.source.clone(), walk.asset, Vec::new()));
                Contents { models: vec![model], ..Contents::default() }
            }
            _ => Contents { environment: Some(self.own_sky()), ..Contents::default() },
        };
        self.open(Contents { is_by_hand, ..dropped.into_private() });
    }

    /// Edits what is shown in a way that reveals something about it.
    fn edit(&mut self, choice: usize, joint: usize) {
        let clip = ClipId::Own(0);
        let first =
            self.editor.library().active().and_then(|model| Some(model.clips().borrowed().next()?.0.id().clone()));
        let over = first.clone().unwrap_or_else(|| clip.clone());
        let command = match choice {
            0 => Command::SetPose { joint, degrees: Some([self.number, 0.0, 0.0]) },
            1 => Command::RenameJoint { joint, name: format!("{} {joint}", self.word) },
            2 => Command::EditClip { clip: over, edit: ClipEdit::Rename(format!("{} clip", self.word)) },
            3 => Command::EditClip { clip: over, edit: ClipEdit::Copy(Box::default()) },
            4 => Command::SetLayers(vec![LayeredClip { clip: over, layer: ClipLayer::default() }]),
            5 => {
                let nodes = [joint + usize::from(self.number > 3.0)].into();
                Command::SetHidden(Hidden { nodes, ..Hidden::default() })
            }
            6 => Command::SetClip(ClipChoice::Clip(over)),
            7 => Command::Orbit { yaw_radians: self.number, pitch_radians: 0.1 },
            _ => Command::SetLight(EnvironmentChoice::File(format!("{}.hdr", self.word))),
        };
        self.editor.apply(command);
    }

    /// Sets some keys on behalf of an embedding page, as `web::calls::apply` does.
    fn apply(&mut self, partial: &Value) {
        let before = self.editor.shared_state();
        let (state, errors) = from_object(&before, self.editor.library(), partial);
        let (new, old) = (&state.character.sources, &before.character.sources);
        if !errors.is_empty() || (&new.model, &new.motion) == (&old.model, &old.motion) {
            let _ = self.editor.apply_partial(partial);
            return;
        }
        let models: Vec<&str> = new.model.iter().map(String::as_str).collect();
        let is_known = |name: &&str| name.starts_with("sample:");
        let mut opened = Contents::default();
        if !self.editor.holds(&state) {
            if !models.iter().all(is_known) {
                return;
            }
            opened = contents(&models);
        }
        let held = self.editor.library().motions();
        let of_name = |name: &String| held.iter().find(|motion| motion.origin == *name).cloned();
        let motions = new.motion.iter().filter_map(|name| of_name(name).or_else(|| public_motion(name)));
        opened.motions = Some(motions.collect());
        let _ = self.editor.open(opened, Some(state), &mut any);
    }

    fn follow(&mut self, link: &str) {
        let (state, _) = from_link(link);
        let models: Vec<&str> = state.character.sources.model.iter().map(String::as_str).collect();
        let motions = state.character.sources.motion.iter().filter_map(public_motion).collect();
        let opened = Contents { motions: Some(motions), ..contents(&models) };
        let _ = self.editor.open(opened, Some(state), &mut any);
    }

    /// Does one of sixteen things; the other arguments choose the details.
    fn act(&mut self, action: usize, choice: usize, joint: usize, is_by_hand: bool) {
        const LINKS: [&str; 2] = ["v=2&model=sample:walker", "v=2&model=sample:pilot&motion=dance.glb"];
        let models = self.editor.library().models();
        let id = models[choice % models.len()].id;
        match action {
            0 => self.drop_file(choice % 3, is_by_hand),
            1 => self.open(contents(&["sample:pilot"])),
            2 => self.open(contents(&["sample:walker"])),
            3 => self.open(Contents { motions: Some(vec![motion("dance.glb")]), ..Contents::default() }),
            4 => self.follow(LINKS[choice % 2]),
            5 => _ = self.editor.undo(),
            6 => _ = self.editor.redo(),
            7 => _ = self.editor.activate(id, &mut any),
            8 => _ = self.editor.close(id, &mut any),
            9 | 10 if self.editor.is_private() => self.edit(choice % 9, joint),
            9 | 10 => {}
            _ => self.apply(&partials()[choice]),
        }
    }

    /// Returns what `state` and `toLink` return to an embedding page; `None` if they refuse.
    fn read(&self) -> Option<[String; 2]> {
        let (state, library) = (self.editor.state(), self.editor.library());
        (!self.editor.is_private()).then(|| [to_object(state, library).to_string(), to_link(state, library)])
    }
}

fn public_motion(name: &String) -> Option<Motion> {
    (name == "dance.glb").then(|| motion(name))
}

/// States that an embedding page sets.
fn partials() -> [Value; 12] {
    [
        json!({ "motion": [] }),
        json!({ "motion": ["dance.glb"] }),
        json!({ "model": ["sample:pilot"] }),
        json!({ "model": ["sample:walker"], "motion": [] }),
        json!({ "clip": "Walk", "t": 0.5 }),
        json!({ "clip": null, "layers": null }),
        json!({ "pose": null, "names": null }),
        json!({ "map": null, "change": null, "copy": null }),
        json!({ "light": "white" }),
        json!({ "camera": "auto", "hidden": null }),
        json!({ "play": 0, "exposure": 1 }),
        json!({ "model": ["c.bvh"], "motion": ["d.bvh"] }),
    ]
}

#[test]
fn what_can_be_read_never_depends_on_private_files() {
    let (mut read, mut withheld) = (0, 0);
    for seed in 0..30 {
        let mut random = Random(seed);
        let mut worlds = [World::new("a", 2.5), World::new("b", 7.25)];
        let mut said: Vec<String> = Vec::new();
        for _ in 0..40 {
            let (action, choice, joint) = (random.below(16), random.below(12), random.below(8));
            let is_by_hand = random.below(2) == 0;
            said.push(format!("{action}.{choice}.{joint}"));
            for world in &mut worlds {
                world.act(action, choice, joint, is_by_hand);
            }
            let [one, other] = worlds.each_ref().map(World::read);
            assert_eq!(one, other, "seed {seed} after {said:?}");
            *if one.is_some() { &mut read } else { &mut withheld } += 1;
        }
    }
    assert!(read > 200 && withheld > 200, "{read} states were read, {withheld} withheld");
}

/// The state outlives the files that it was made with.
#[test]
fn what_was_set_beside_private_files_stays_private() {
    for choice in 0..9 {
        let mut world = World::new("a", 2.5);
        world.drop_file(0, true);
        world.edit(choice, 3);
        world.apply(&json!({ "motion": [] }));
        assert!(world.editor.library().motions().is_empty());
        assert!(world.editor.is_private(), "edit {choice}");
        world.apply(&json!({ "model": ["sample:pilot"] }));
        assert!(world.editor.is_private(), "edit {choice}, another model");
        world.open(contents(&["sample:pilot"]));
        world.follow("v=2&model=sample:walker");
        assert!(!world.editor.is_private(), "nothing is left of edit {choice}");
    }
}
