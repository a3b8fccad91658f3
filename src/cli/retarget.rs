//! `gaitway retarget`: appends a retargeted clip to a model, and reports how well it fits.

use std::path::{Path, PathBuf};

use gaitway_character::anim::{Clip, ClipQuery, JointIndex, Skeleton, find_clip};
use gaitway_character::asset::Asset;
use gaitway_formats::write_model;
use gaitway_retarget::{
    ChangedClip, ClipOverLayers, ClipRef, Figures, FitWarning, JointMap, MapError, ResolvedMap, Retargeted,
    Retargeting, Unmapped, has_expressions_alone, layer_clips,
};
use gaitway_scene::editor::{ClipFormat, ModelFiles, OpenedMap, write_clip};
use gaitway_scene::library::{Model, Motion, Take, clip_file_name, map_for, warning_documents, with_expressions};
use gaitway_scene::state::{NameKind, UnknownName};
use serde_json::{Value, json};

use super::convert::{fbx, is_fbx};
use super::edit::baked;
use super::failure::{Failure, Outcome};
use super::motion::{DOUBTFUL_REST, DOUBTFUL_UP, doubtful_rest, doubtful_up, open_map, open_motion, rest_document};
use super::output::{extension_of, is_standard_output, print_error, print_json, print_lines, warn, write_output};
use super::{RetargetArguments, RetargetChoices, RetargetOptions, batch, change, open};
use crate::files::{Disk, Opened};

pub(super) fn run(arguments: &RetargetArguments, disk: &Disk) -> Outcome {
    let out = match (&arguments.out, &arguments.out_dir) {
        (_, Some(folder)) => return batch::run(arguments, folder, disk),
        (Some(out), None) => out,
        (None, None) => return Err(Failure::new("neither --out nor --out-dir was given")),
    };
    only("model", &arguments.model)?;
    let motion = only("motion", &arguments.motion)?;
    let opened = open(&arguments.model, disk)?;
    let motion = open_motion(motion, disk)?;
    let map = arguments.map.as_deref().map(|path| open_map(path, disk)).transpose()?;
    let made = make(&arguments.choices, &opened.model, &motion, map.as_ref())?;
    write(arguments, out, &opened, &made, disk)?;
    made.warnings.iter().for_each(|(_, message)| warn(message));
    if arguments.json {
        return print_json(&made.document);
    }
    if is_standard_output(out) {
        made.text.lines().for_each(print_error);
        return Ok(());
    }
    print_lines(made.text.lines())
}

/// Returns the only file of an argument, which also has other uses for several.
fn only<'a>(name: &str, files: &'a [PathBuf]) -> Outcome<&'a Path> {
    let [file] = files else {
        let failure = Failure::expected(format!("one {name}"), files.len().to_string()).at(&format!("--{name}"));
        return Err(failure.with_hint("--out-dir takes any number"));
    };
    Ok(file)
}

/// A retargeted clip and what is reported about it.
pub struct Made {
    /// For the model's skeleton.
    pub clip: Clip,
    /// The rate of its source, for formats that need one.
    pub frames_per_sec: f64,
    warnings: Vec<(&'static str, String)>,
    /// What `--json` prints.
    pub document: Value,
    /// For people.
    text: String,
}

/// Retargets a clip of a motion, changes it, and measures how well it fits.
pub(super) fn make(
    choices: &RetargetChoices,
    model: &Model,
    motion: &Motion,
    map: Option<&OpenedMap>,
) -> Outcome<Made> {
    let resolved = resolve_map(choices, model, motion, map)?;
    let source_clip = choose_clip(&motion.source, &motion.asset, choices.clip.as_deref())?;
    let pair = Retargeting::new(model.body(), motion.body(), source_clip, &resolved)?;
    let retargeted = pair.bake()?;
    let figures = pair.figures(&retargeted);
    let mut warnings = Vec::new();
    if retargeted.nowhere_to_extract {
        let message = "no joint above the hips is free for the extracted root motion; it stays on the hips".to_owned();
        warnings.push(("nowhere-to-extract", message));
    }
    warnings.extend(FitWarning::of(&figures).iter().map(|warning| (warning.code(), warning.to_string())));
    warnings.extend(doubtful_rest(pair.motion_rest()).map(|message| (DOUBTFUL_REST, message)));
    warnings.extend(doubtful_up(pair.motion_rest()).map(|message| (DOUBTFUL_UP, message)));
    let clip = with_expressions(retargeted.clip.clone(), &model.asset, &motion.asset, source_clip)?;
    let name = clip_file_name(&motion.source, source_clip, &motion.asset);
    let clip = clip.with_name(name.unwrap_or_default());
    let layers = layer_clips(&model.asset, &resolved);
    let take = Take::of_clip(model, Some(ClipOverLayers { clip: &clip, below: &layers }));
    let loops = choices.loops.map(usize::from);
    let clip = baked(&take, loops, "; try another number with --loops", &mut warnings);
    let ChangedClip { clip, seam } = choices.edits.bake(model, clip, loops.is_some(), &mut warnings)?;
    let mut document = document(&model.asset, motion, &resolved, &retargeted, &clip, &figures, &warnings);
    document["motion_rest"] = rest_document(pair.motion_rest());
    document["planting"] = json!(retargeted.planting);
    document["changed"] = change::document(&choices.edits.changes, seam.as_ref());
    let mut text = text(&resolved, &retargeted, &figures);
    if let Some(seam) = seam {
        text += &format!("seam              {seam}; blended\n");
    }
    let frames_per_sec = motion.asset.clips[source_clip].frames_per_sec();
    Ok(Made { clip, frames_per_sec, warnings, document, text })
}

/// Returns the given map or else the proposed one, with the command line's options.
fn resolve_map(
    choices: &RetargetChoices,
    model: &Model,
    motion: &Motion,
    given: Option<&OpenedMap>,
) -> Outcome<ResolvedMap> {
    let in_map = |problem: MapError| match given {
        Some(opened) => Failure::from(problem).in_file(&opened.name),
        None => problem.into(),
    };
    let looked_up = given.map(|opened| opened.map.look_up_joints(&model.asset, &motion.asset));
    let (mut map, proposal) = map_for(model, motion, looked_up.transpose().map_err(in_map)?.as_ref());
    let is_empty = proposal.is_some_and(|proposal| proposal.pairs.is_empty()) && !has_expressions_alone(&motion.asset);
    if is_empty && !model.has_skeleton() {
        return Err(Failure::new(format!("{} {}", model.source, Model::NO_SKELETON)).in_file(&motion.source));
    }
    if is_empty {
        return Err(Failure::new(format!(
            "no joint in common with {}, neither by name nor by body part; write a map manually and pass it with --map \
             (docs/joint-maps.md)",
            model.source
        ))
        .in_file(&motion.source));
    }
    apply_options(&mut map, &choices.options);
    map.resolve(&model.asset, &motion.asset).map_err(|problem| match &choices.options.unmapped {
        Some(_) if problem.path() == Some("unmapped.clip") => Failure::from(problem).at("--unmapped"),
        _ => in_map(problem),
    })
}

/// Writes the model with the clip, or the clip alone: on request, and in formats that hold nothing else.
fn write(arguments: &RetargetArguments, out: &Path, opened: &Opened, made: &Made, disk: &Disk) -> Outcome {
    let format = clip_format_of(out).unwrap_or(ClipFormat::Glb);
    let extensions = if arguments.clip_only {
        ClipFormat::ALL.map(ClipFormat::extension).to_vec()
    } else {
        model_extensions(&opened.model.asset)
    };
    let bytes = clip_file(opened, made, arguments.clip_only, format)?;
    if is_fbx(out) {
        return write_output(out, &fbx(&bytes)?, &["fbx"], disk);
    }
    write_output(out, &bytes, &extensions, disk)
}

/// The content of the file. `clip_only` matters for a .glb; other formats hold nothing else.
pub(super) fn clip_file(opened: &Opened, made: &Made, clip_only: bool, format: ClipFormat) -> Outcome<Vec<u8>> {
    if clip_only || format != ClipFormat::Glb {
        let model = &opened.model;
        return Ok(write_clip(model, &model.asset.skeleton, &made.clip, made.frames_per_sec, format)?);
    }
    model_file(opened, &[&made.clip], "use --clip-only to write skeleton and clip")
}

/// The model's file with more clips. `hint` says what to do if it has none.
pub(super) fn model_file(opened: &Opened, clips: &[&Clip], hint: &str) -> Outcome<Vec<u8>> {
    let Opened { model, model_files, .. } = opened;
    let Some(ModelFiles { set, name }) = model_files else {
        let failure = Failure::new("this sample is generated and has no file to add a clip to").with_hint(hint);
        return Err(failure.in_file(&model.source));
    };
    Ok(write_model(set, name, &model.asset.skeleton, clips)?)
}

/// The extensions that fit a model as GLB: a VRM file is a GLB, and stays VRM when it is written. Clips alone can be other files.
pub(super) fn model_extensions(asset: &Asset) -> Vec<&'static str> {
    let own = (asset.format == "vrm").then_some("vrm");
    own.into_iter().chain(ClipFormat::ALL.map(ClipFormat::extension)).collect()
}

/// The format that the extension of an output asks for.
pub(super) fn clip_format_of(out: &Path) -> Option<ClipFormat> {
    ClipFormat::of_extension(&extension_of(out)?)
}

/// Applies the command line's options, which override the map.
fn apply_options(map: &mut JointMap, options: &RetargetOptions) {
    let set = |slot: &mut gaitway_retarget::RootPart, part: Option<super::RootPartArgument>| {
        *slot = part.map_or(*slot, Into::into);
    };
    set(&mut map.root.horizontal, options.horizontal);
    set(&mut map.root.vertical, options.vertical);
    set(&mut map.root.yaw, options.yaw);
    map.root.extract |= options.extract_root;
    map.root.origin = options.origin.map_or(map.root.origin, Into::into);
    map.feet = options.feet.map_or(map.feet, Into::into);
    map.contacts = options.contacts.map_or(map.contacts, Into::into);
    map.translations = options.translations.map_or(map.translations, Into::into);
    map.scales = options.scales.map_or(map.scales, Into::into);
    map.rest.model = options.rest_model.map_or(map.rest.model, Into::into);
    map.rest.motion = options.rest_motion.map_or(map.rest.motion, Into::into);
    map.rest.up = options.up.map_or(map.rest.up, Into::into);
    if let Some(unmapped) = &options.unmapped {
        map.unmapped = match (unmapped.as_str(), unmapped.parse()) {
            ("rest", _) => Unmapped::Rest,
            (_, Ok(index)) => Unmapped::Clip { clip: ClipRef::Index(index), frozen: false },
            (name, Err(_)) => Unmapped::Clip { clip: ClipRef::Name(name.to_owned()), frozen: false },
        };
    }
}

/// Finds a clip by name or index; the first if none was requested.
pub(super) fn choose_clip(source: &str, asset: &Asset, requested: Option<&str>) -> Outcome<usize> {
    if asset.clips.is_empty() {
        return Err(Failure::expected("a clip", "none").in_file(source));
    }
    let Some(requested) = requested else { return Ok(0) };
    clip_named(asset, requested).map_err(|unknown| Failure::from(unknown).in_file(source))
}

/// Finds a clip by name or index.
pub(super) fn clip_named(asset: &Asset, requested: &str) -> Result<usize, UnknownName> {
    find_clip(asset.clips.iter(), ClipQuery::NameOrIndex(requested)).ok_or_else(|| {
        let names = asset.clips.iter().map(|clip| clip.name().to_owned()).collect();
        UnknownName { kind: NameKind::Clip, name: requested.to_owned(), names }
    })
}

fn document(
    model: &Asset,
    motion: &Motion,
    map: &ResolvedMap,
    retargeted: &Retargeted,
    clip: &Clip,
    figures: &Figures,
    warnings: &[(&'static str, String)],
) -> Value {
    let (target, source) = (&model.skeleton, &motion.asset.skeleton);
    let mapped: Vec<Value> = map
        .pairs
        .iter()
        .map(|pair| json!({ "target": target.label(pair.target), "source": source.label(pair.source) }))
        .collect();
    let flags = |skeleton: &Skeleton, joints: &mut dyn Iterator<Item = JointIndex>| {
        let mut flags = vec![false; skeleton.len()];
        joints.for_each(|joint| flags[joint.get()] = true);
        flags
    };
    let in_skin = flags(target, &mut model.skins.iter().flat_map(|skin| skin.joints()).copied());
    let has_skins = !model.skins.is_empty();
    let unmapped: Vec<String> = target
        .joints()
        .filter(|joint| (!has_skins || in_skin[joint.get()]) && map.source_of(*joint).is_none())
        .map(|joint| target.label(joint))
        .collect();
    let channels = motion.asset.clips.iter().flat_map(Clip::channels);
    let is_animated = flags(source, &mut channels.map(|channel| channel.joint));
    let is_followed = flags(source, &mut map.pairs.iter().map(|pair| pair.source));
    let unused: Vec<String> = source
        .joints()
        .filter(|joint| is_animated[joint.get()] && !is_followed[joint.get()])
        .map(|joint| source.label(joint))
        .collect();
    let resampled: Vec<String> = retargeted.resampled.iter().map(|&joint| target.label(joint)).collect();
    let clip_warnings =
        warnings.iter().map(|(code, message)| json!({ "code": code, "message": message, "where": clip.name() }));
    let file_warnings = [model, &motion.asset].map(|asset| warning_documents(&asset.warnings));
    let warnings: Vec<Value> =
        file_warnings.into_iter().filter_map(|list| list.as_array().cloned()).flatten().chain(clip_warnings).collect();
    json!({
        "clip": clip.name(),
        "mapped": mapped,
        "unmapped_targets": unmapped,
        "unused_sources": unused,
        "hips_scale": retargeted.hips_scale,
        "duration_secs": clip.duration_secs(),
        "keys_in": retargeted.keys_in,
        "keys_out": retargeted.keys_out,
        "resampled": !retargeted.resampled.is_empty(),
        "resampled_joints": resampled,
        "figures": figures,
        "warnings": warnings,
    })
}

/// Formats the result for people; scripts read the JSON.
fn text(map: &ResolvedMap, retargeted: &Retargeted, figures: &Figures) -> String {
    let number = |value: Option<f64>, unit: &str| value.map_or("–".to_owned(), |value| format!("{value:.3}{unit}"));
    let kept = match retargeted.resampled.len() {
        0 => "all keys are the source's".to_owned(),
        1 => "1 joint resampled".to_owned(),
        joints => format!("{joints} joints resampled"),
    };
    format!(
        "joints            {} mapped, {} of the limbs, trunk and head that both have\n\
         keys              {} → {}: {kept}\n\
         hips              × {}\n\
         limb directions   mean error {}, max. {}\n\
         facing            mean error {}, max. {}; along the path {}\n\
         rotations         mean error {}, max. {}\n\
         largest turn      {} in 1/60 s\n\
         jerk              {}\n\
         foot slide        {} (source: {})\n\
         hover             {}\n\
         sole penetration  {}\n\
         joint penetration {}\n\
         self-penetration  {}\n\
         contact error     {}\n\
         skin stretch      mean {}, max. {}{}\n\
         idle limbs        {}\n\
         planted feet      {}\n",
        map.pairs.len(),
        figures.coverage.map_or("–".to_owned(), |coverage| format!("{:.0} %", 100.0 * coverage)),
        retargeted.keys_in,
        retargeted.keys_out,
        number(retargeted.hips_scale, ""),
        number(figures.limb_direction_error_degrees_mean, "°"),
        number(figures.limb_direction_error_degrees_max, "°"),
        number(figures.facing_error_degrees_mean, "°"),
        number(figures.facing_error_degrees_max, "°"),
        number(figures.facing_path_error_degrees_mean, "°"),
        number(figures.orientation_error_degrees_mean, "°"),
        number(figures.orientation_error_degrees_max, "°"),
        number(figures.largest_turn_degrees_per_frame, "°"),
        number(figures.jerk_metres_per_sec3_mean, " m/s³"),
        number(figures.foot_slide_metres_per_sec, " m/s"),
        number(figures.foot_slide_source_metres_per_sec, " m/s"),
        number(figures.foot_hover_metres_mean, " m"),
        number(figures.sole_penetration_metres_max, " m"),
        number(figures.ground_penetration_metres_max, " m"),
        number(figures.self_penetration_share.map(|share| 100.0 * share), " %"),
        number(figures.contact_error_metres_mean, " m"),
        number(figures.skin_stretch_mean, ""),
        number(figures.skin_stretch_max, ""),
        figures.skin_stretch_max_joint.as_ref().map_or(String::new(), |joint| format!(" at {joint}")),
        if figures.idle_chains.is_empty() { "none".to_owned() } else { figures.idle_chains.join(", ") },
        retargeted.planting.map_or("–".to_owned(), |planting| planting.to_string()),
    )
}
