//! Converts between the file form of a joint map and the numbered map.

use std::collections::BTreeMap;

use gaitway_character::anim::Skeleton;
use gaitway_character::asset::Asset;
use gaitway_character::sort::collect_map;

use super::error::MapError;
use super::file::{JointMapFile, SourceRef};
use super::joint_map::{JointMap, MapEntry, MutedChannel};
use super::names::Names;
use super::resolve::{check_crossfade, normalize_correction, resolve_layer};
use super::resolved::ResolvedMap;

impl JointMapFile {
    /// Converts a map that fits both files. One without joints is a starting point and is not checked further.
    ///
    /// # Errors
    /// As [`JointMapFile::resolve`], except that no joint needs a source.
    pub fn to_joint_map(&self, model: &Asset, motion: &Asset) -> Result<JointMap, MapError> {
        let map = self.look_up_joints(model, motion)?;
        if map.joints.is_empty() {
            return Ok(map);
        }
        match map.resolve(model, motion) {
            Ok(_) | Err(MapError::NothingMapped) => Ok(map),
            Err(problem) => Err(problem),
        }
    }

    /// Looks up every joint and clip of the file.
    ///
    /// # Errors
    /// If a name is missing or ambiguous, an option is out of range, or no joint has a source.
    pub fn resolve(&self, model: &Asset, motion: &Asset) -> Result<ResolvedMap, MapError> {
        self.look_up_joints(model, motion)?.resolve(model, motion)
    }

    /// Converts a map without checking the options that apply to all joints, so that they can be overridden first. Targets
    /// are looked up in `model`, sources in `motion`.
    ///
    /// # Errors
    /// If a name is missing or ambiguous, or an entry's own options are out of range.
    pub fn look_up_joints(&self, model: &Asset, motion: &Asset) -> Result<JointMap, MapError> {
        if self.gaitway_map != 1 {
            return Err(MapError::Version { found: self.gaitway_map.to_string() });
        }
        if !self.joints.is_empty() {
            check_crossfade(self.crossfade_secs)?;
        }
        let (targets, sources) = (Names::new(model), Names::new(motion));
        let mut name_of_target: BTreeMap<usize, &str> = BTreeMap::new();
        let mut joints = BTreeMap::new();
        for (name, entry) in &self.joints {
            let path = format!("joints.{name}");
            let target = targets.find_target(name, &path)?;
            if let Some(first) = name_of_target.insert(target, name) {
                return Err(MapError::SameTarget { path, first: first.to_owned(), second: name.clone() });
            }
            // Checked here, since resolving knows only numbers and could not name the place in the file.
            normalize_correction(entry.correction, &path)?;
            let source = entry.source.as_ref().map(|source| sources.find_source(source, &format!("{path}.source")));
            let source = source.transpose()?;
            if let Some(unmapped) = &entry.unmapped {
                resolve_layer(model, unmapped, &format!("{path}.unmapped"))?;
            }
            joints.insert(target, MapEntry { source, correction: entry.correction, unmapped: entry.unmapped.clone() });
        }
        let muted = self.muted_channels.iter().enumerate().map(|(index, channel)| {
            let source = sources.find_source(&channel.source, &format!("muted_channels[{index}].source"))?;
            Ok(MutedChannel { source, property: channel.property })
        });
        let muted = muted.collect::<Result<_, _>>()?;
        Ok(self.with_joints(joints, muted))
    }

    /// Reads a file that has numbers only, as [`JointMap::to_numbered_file`] writes it; None for any other.
    pub fn as_numbers(&self) -> Option<JointMap> {
        let number = |source: &SourceRef| match source {
            SourceRef::Number(number) => Some(*number),
            SourceRef::Name(_) => None,
        };
        let mut joints = BTreeMap::new();
        for (key, entry) in &self.joints {
            let target: usize = key.strip_prefix('#')?.parse().ok()?;
            let source = match &entry.source {
                Some(source) => Some(number(source)?),
                None => None,
            };
            let entry = MapEntry { source, correction: entry.correction, unmapped: entry.unmapped.clone() };
            if joints.insert(target, entry).is_some() {
                return None;
            }
        }
        let muted = self.muted_channels.iter();
        let muted =
            muted.map(|channel| Some(MutedChannel { source: number(&channel.source)?, property: channel.property }));
        Some(self.with_joints(joints, muted.collect::<Option<_>>()?))
    }

    fn with_joints(&self, joints: BTreeMap<usize, MapEntry>, muted_channels: Vec<MutedChannel>) -> JointMap {
        JointMap {
            joints,
            unmapped: self.unmapped.clone(),
            rest: self.rest,
            root: self.root,
            translations: self.translations,
            scales: self.scales,
            muted_channels,
            feet: self.feet,
            contacts: self.contacts,
            chains: self.chains,
            crossfade_secs: self.crossfade_secs,
        }
    }
}

impl JointMap {
    /// Returns the file form of the map, with names instead of numbers wherever a name is unique.
    pub fn to_file(&self, model: &Asset, motion: &Asset) -> JointMapFile {
        let (targets, sources) = (unique_names(&model.skeleton), unique_names(&motion.skeleton));
        self.to_file_with(|number| targets.get(&number).copied(), |number| sources.get(&number).copied())
    }

    /// Returns the file form of the map with numbers only.
    pub fn to_numbered_file(&self) -> JointMapFile {
        self.to_file_with(|_| None, |_| None)
    }

    fn to_file_with<'a>(
        &self,
        target_name: impl Fn(usize) -> Option<&'a str>,
        source_name: impl Fn(usize) -> Option<&'a str>,
    ) -> JointMapFile {
        let source = |number: usize| {
            source_name(number).map_or(SourceRef::Number(number), |name| SourceRef::Name(name.to_owned()))
        };
        let joint = |(&target, entry): (&usize, &MapEntry)| {
            let key = target_name(target).map_or_else(|| format!("#{target}"), str::to_owned);
            let (correction, unmapped) = (entry.correction, entry.unmapped.clone());
            (key, MapEntry { source: entry.source.map(source), correction, unmapped })
        };
        let muted = self.muted_channels.iter();
        let muted = muted.map(|channel| MutedChannel { source: source(channel.source), property: channel.property });
        JointMapFile {
            gaitway_map: 1,
            joints: collect_map(self.joints.iter().map(joint)),
            unmapped: self.unmapped.clone(),
            rest: self.rest,
            root: self.root,
            translations: self.translations,
            scales: self.scales,
            muted_channels: muted.collect(),
            feet: self.feet,
            contacts: self.contacts,
            chains: self.chains,
            crossfade_secs: self.crossfade_secs,
        }
    }
}

/// Unique names by joint number, without those that look like a number.
fn unique_names(skeleton: &Skeleton) -> BTreeMap<usize, &str> {
    let mut joints: BTreeMap<&str, Option<usize>> = BTreeMap::new();
    for joint in skeleton.joints() {
        let number = skeleton.source_index(joint);
        joints.entry(skeleton.name(joint)).and_modify(|shared| *shared = None).or_insert(Some(number));
    }
    let is_name = |name: &str| !name.is_empty() && !name.starts_with('#');
    let named = joints.into_iter().filter(|(name, _)| is_name(name));
    collect_map(named.filter_map(|(name, number)| Some((number?, name))))
}
