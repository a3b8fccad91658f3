//! The space that a take needs.

use std::sync::Mutex;

use gaitway_character::anim::{JointIndex, model_from_joint};
use gaitway_character::asset::SceneJoints;
use gaitway_character::mesh::Bounds;
use gaitway_character::sort::{sort_by, sort_floats};
use glam::Vec3;

use super::fingerprint::Fingerprint;
use super::{LookTarget, Moment, Take, TakeSampler};

impl Take<'_> {
    /// Poses per second that the bounds are made from, besides those of keys.
    const SAMPLES_PER_SEC: f64 = 60.0;
    const MIN_SAMPLES: f64 = 24.0;
    /// Of a long clip, or of layers that need many loops to end together, not every movement is seen.
    const MAX_SAMPLES: f64 = 240.0;

    /// World-space bounds of the whole take in a scene, without springs and gazes: all that its layers do to it, in as many loops
    /// as they need to end together. `in_place` removes the root's ground-plane travel, and `hidden` the meshes on these joints and
    /// their descendants.
    pub fn bounds(&self, scene: Option<usize>, in_place: bool, hidden: &[JointIndex]) -> Bounds {
        let (take, model, skeleton) = (self.without_play(), self.model, &self.model.asset.skeleton);
        let scene = model.scene(scene);
        if take.is_rest_pose() && scene == model.asset.default_scene && hidden.is_empty() {
            return model.rest_bounds().transformed(&take.world_from_model);
        }
        let mut visible = SceneJoints::new(&model.asset, scene);
        visible.hide(hidden.iter().copied());
        let mut sampler = TakeSampler::default();
        let mut world_from_joint = Vec::with_capacity(skeleton.len());
        let (mut bounds, mut start) = (Bounds::EMPTY, None);
        for elapsed_secs in take.bounds_times() {
            sampler.sample(&take, Moment { elapsed_secs, from: None }, None);
            model_from_joint(skeleton, &sampler.pose, take.world_from_model, &mut world_from_joint);
            visible.show(&model.asset, &sampler.properties);
            let mut at_time = model.pose_bounds(&world_from_joint, &sampler.pose.morph_weights, &visible);
            if let Some(root) = self.root.filter(|_| in_place) {
                let position = Vec3::from(world_from_joint[root.get()].translation);
                let travel = (position - *start.get_or_insert(position)) * Vec3::new(1.0, 0.0, 1.0);
                if travel.is_finite() && !at_time.is_empty() {
                    at_time = Bounds { min: at_time.min - travel, max: at_time.max - travel };
                }
            }
            bounds = bounds.union(at_time);
        }
        bounds
    }

    /// Times at which the bounds are looked at: regular ones, and those of the clip's keys, where the fastest movements turn.
    fn bounds_times(&self) -> Vec<f64> {
        let over = self.stacked();
        let periods = over.iter().filter_map(|over| over.layer.period_secs(over.source.clip));
        let duration_secs = match self.clip {
            Some(_) => self.range.length_secs() * self.baking(&over, None).loops as f64,
            // Layers play over the rest pose, too.
            None => periods.fold(0.0, f64::max),
        };
        let samples = (Self::SAMPLES_PER_SEC * duration_secs).clamp(Self::MIN_SAMPLES, Self::MAX_SAMPLES);
        let timelines = self.clip.map_or(&[][..], |over| over.clip.timelines());
        let mut keys: Vec<f32> = timelines.iter().flatten().copied().collect();
        sort_floats(&mut keys);
        keys.dedup();
        if keys.len() > Self::MAX_SAMPLES as usize {
            keys.clear();
        }
        let regular = (0..=samples as usize).map(|sample| duration_secs * sample as f64 / samples);
        let mut times: Vec<f64> = regular.chain(keys.into_iter().map(f64::from)).collect();
        sort_by(&mut times, f64::total_cmp);
        times.dedup();
        times
    }

    /// The take without what its bounds don't depend on.
    fn without_play(&self) -> Self {
        Self { springs: false, look_at: LookTarget::Off, ..self.whole() }
    }

    fn is_rest_pose(&self) -> bool {
        self.clip.is_none() && !self.is_more_than_clip()
    }
}

/// The bounds of the takes that were asked for last: every frame asks for those of what it shows.
#[derive(Debug, Default)]
pub(in crate::library) struct BoundsCache(Mutex<Vec<KnownBounds>>);

#[derive(Debug)]
struct KnownBounds {
    take: Fingerprint,
    scene: Option<usize>,
    in_place: bool,
    bounds: Bounds,
}

impl BoundsCache {
    /// A character and a source beside it, with and without travel, before and after an edit.
    const CAPACITY: usize = 8;

    /// Returns [`Take::bounds`] with nothing hidden.
    pub fn get(&self, take: &Take<'_>, scene: Option<usize>, in_place: bool) -> Bounds {
        let (scene, whole) = (take.model.scene(scene), take.without_play());
        // A poisoned cache is still one of bounds: they are complete when they are added.
        let mut known = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let is_known =
            |known: &KnownBounds| (known.scene, known.in_place) == (scene, in_place) && known.take.matches(&whole);
        if let Some(at) = known.iter().position(is_known) {
            known[at..].rotate_left(1);
        } else {
            let bounds = take.bounds(scene, in_place, &[]);
            if known.len() == Self::CAPACITY {
                known.remove(0);
            }
            known.push(KnownBounds { take: Fingerprint::of(&whole), scene, in_place, bounds });
        }
        known.last().map_or(Bounds::EMPTY, |known| known.bounds)
    }
}
