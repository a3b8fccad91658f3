//! `gaitway retarget`: a model with a borrowed clip behind its own, and how well it fits.

use anyhow::{Context, bail};
use serde_json::{Value, json};

use super::borrow::{joint_name, open_map, open_motion};
use super::{RetargetArguments, open, print_bytes, print_json};
use crate::anim::{Clip, ClipQuery, JointIndex, find_clip};
use crate::asset::Asset;
use crate::files::read_set;
use crate::formats::{main_files, write_model, write_motion};
use crate::library::{Motion, map_for, warning_documents};
use crate::retarget::{
    ClipRef, Figures, JointMap, ResolvedMap, Retargeted, Retargeting, Unmapped, bake_layers, baking, layer_clips,
};

pub(super) fn run(arguments: &RetargetArguments) -> anyhow::Result<()> {
    let files = std::slice::from_ref(&arguments.model);
    let model = open(files)?.model;
    let motion = open_motion(&arguments.motion)?;
    let given = arguments.map.as_deref().map(open_map).transpose()?;
    let given = given.map(|file| file.look_up_joints(&model.asset, &motion.asset)).transpose()?;
    let (mut map, proposal) = map_for(&model.asset, &motion.asset, given.as_ref());
    if proposal.is_some_and(|proposal| proposal.pairs.is_empty()) {
        bail!(
            "{}: no joint in common with {}: neither names nor body parts agree. Write a map by hand and pass it with --map \
             (docs/joint-maps.md)",
            motion.source,
            model.source
        );
    }
    set_options(&mut map, arguments);
    let resolved = map.resolve(&model.asset, &motion.asset)?;
    let source_clip = choose_clip(&motion, arguments.clip.as_deref())?;
    let pair = Retargeting::new(model.body(), motion.body(), source_clip, &resolved)?;
    let made = pair.bake()?;
    let figures = pair.figures(&made);
    let mut warnings = Vec::new();
    if made.nowhere_to_extract {
        let message = "no joint above the hips is free to carry the travel; it stays with the hips".to_owned();
        warnings.push(("nowhere-to-extract", message));
    }
    let clip = with_layers(&model.asset, &resolved, &made, arguments.loops.map(usize::from), &mut warnings);

    let bytes = if arguments.clip_only {
        write_motion(&model.asset, &model.asset.skeleton, &[&clip])?
    } else {
        let set = read_set(files)?;
        if set.is_empty() {
            bail!(
                "{}: a sample is made in code and has no file to add a clip to; --clip-only writes skeleton and clip",
                model.source
            );
        }
        let names = main_files(&set);
        let [name] = names.as_slice() else {
            bail!("{}: expected one model to write, found {}", arguments.model.display(), names.len());
        };
        write_model(&set, name, &model.asset.skeleton, &[&clip])?
    };
    std::fs::write(&arguments.out, bytes).with_context(|| format!("{}", arguments.out.display()))?;
    for (_, message) in &warnings {
        eprintln!("warning: {message}");
    }
    if arguments.json {
        return print_json(&document(&model.asset, &motion, &resolved, &made, &clip, &figures, &warnings));
    }
    print_bytes(text(&resolved, &made, &figures).as_bytes())
}

/// What the command line says wins over the map.
fn set_options(map: &mut JointMap, arguments: &RetargetArguments) {
    let options = &arguments.options;
    let set = |slot: &mut crate::retarget::RootPart, part: Option<super::RootPartArgument>| {
        *slot = part.map_or(*slot, Into::into);
    };
    set(&mut map.root.horizontal, options.horizontal);
    set(&mut map.root.vertical, options.vertical);
    set(&mut map.root.yaw, options.yaw);
    map.root.extract |= options.extract_root;
    map.feet = options.feet.map_or(map.feet, Into::into);
    map.translations = options.translations.map_or(map.translations, Into::into);
    map.scales = options.scales.map_or(map.scales, Into::into);
    map.rest.model = options.rest_model.map_or(map.rest.model, Into::into);
    map.rest.motion = options.rest_motion.map_or(map.rest.motion, Into::into);
    if let Some(unmapped) = &options.unmapped {
        map.unmapped = match (unmapped.as_str(), unmapped.parse()) {
            ("rest", _) => Unmapped::Rest,
            (_, Ok(index)) => Unmapped::Clip { clip: ClipRef::Index(index), frozen: false },
            (name, Err(_)) => Unmapped::Clip { clip: ClipRef::Name(name.to_owned()), frozen: false },
        };
    }
}

/// Finds a clip by name, else by index; without either, the first.
fn choose_clip(motion: &Motion, wanted: Option<&str>) -> anyhow::Result<usize> {
    let clips = &motion.asset.clips;
    if clips.is_empty() {
        bail!("{}: it has no clip to borrow", motion.source);
    }
    let Some(wanted) = wanted else { return Ok(0) };
    find_clip(clips.iter(), ClipQuery::NameOrIndex(wanted)).with_context(|| {
        let names: Vec<&str> = clips.iter().map(Clip::name).collect();
        format!("{}: there is no clip “{wanted}”; the clips are: {}", motion.source, names.join(", "))
    })
}

/// The clip as it is written: with what the model's own clips do on joints without a source.
fn with_layers(
    model: &Asset,
    map: &ResolvedMap,
    made: &Retargeted,
    loops: Option<usize>,
    warnings: &mut Vec<(&'static str, String)>,
) -> Clip {
    let layers = layer_clips(model, map);
    if layers.is_empty() && loops.is_none_or(|loops| loops == 1) {
        return made.clip.clone();
    }
    let baking = baking(&made.clip, &layers, loops);
    if !baking.seamless {
        let message = format!(
            "the model's own clip on unmapped joints does not come out even with {} rounds of the borrowed one: the loop shows \
             a seam (--loops chooses another number)",
            baking.loops
        );
        warnings.push(("loop-seam", message));
    }
    bake_layers(model, &made.clip, &layers, &baking)
}

fn document(
    model: &Asset,
    motion: &Motion,
    map: &ResolvedMap,
    made: &Retargeted,
    clip: &Clip,
    figures: &Figures,
    warnings: &[(&'static str, String)],
) -> Value {
    let (target, source) = (&model.skeleton, &motion.asset.skeleton);
    let mapped: Vec<Value> = map
        .pairs
        .iter()
        .map(|pair| json!({ "target": joint_name(target, pair.target), "source": joint_name(source, pair.source) }))
        .collect();
    let in_skin = |joint: &JointIndex| model.skins.iter().any(|skin| skin.joints().contains(joint));
    let has_skins = !model.skins.is_empty();
    let unmapped: Vec<String> = target
        .joints()
        .filter(|joint| (!has_skins || in_skin(joint)) && map.source_of(*joint).is_none())
        .map(|joint| joint_name(target, joint))
        .collect();
    let moved =
        |joint: &JointIndex| motion.asset.clips.iter().flat_map(Clip::channels).any(|channel| channel.joint == *joint);
    let unused: Vec<String> = source
        .joints()
        .filter(|joint| moved(joint) && !map.pairs.iter().any(|pair| pair.source == *joint))
        .map(|joint| joint_name(source, joint))
        .collect();
    let resampled: Vec<String> = made.resampled.iter().map(|&joint| joint_name(target, joint)).collect();
    let of_clip =
        warnings.iter().map(|(code, message)| json!({ "code": code, "message": message, "where": clip.name() }));
    let of_files = [model, &motion.asset].map(|asset| warning_documents(&asset.warnings));
    let warnings: Vec<Value> =
        of_files.into_iter().filter_map(|list| list.as_array().cloned()).flatten().chain(of_clip).collect();
    json!({
        "clip": clip.name(),
        "mapped": mapped,
        "unmapped_targets": unmapped,
        "unused_sources": unused,
        "hips_scale": made.hips_scale,
        "duration_secs": clip.duration_secs(),
        "keys_in": made.keys_in,
        "keys_out": made.keys_out,
        "resampled": !made.resampled.is_empty(),
        "resampled_joints": resampled,
        "figures": figures,
        "warnings": warnings,
    })
}

/// For people; scripts read the JSON.
fn text(map: &ResolvedMap, made: &Retargeted, figures: &Figures) -> String {
    let number = |value: Option<f64>, unit: &str| value.map_or("–".to_owned(), |value| format!("{value:.3}{unit}"));
    let kept = match made.resampled.len() {
        0 => "every key is the source's own".to_owned(),
        joints => format!("keys of {joints} joints were put anew"),
    };
    format!(
        "joints            {} mapped, {} of what both have\n\
         keys              {} → {}: {kept}\n\
         hips              × {}\n\
         orientation       {} off on average, {} at most\n\
         limb directions   {} off on average, {} at most\n\
         feet slide        {} (the source's: {})\n\
         below the ground  {}\n",
        map.pairs.len(),
        figures.coverage.map_or("–".to_owned(), |coverage| format!("{:.0} %", 100.0 * coverage)),
        made.keys_in,
        made.keys_out,
        number(made.hips_scale, ""),
        number(figures.orientation_error_degrees_mean, "°"),
        number(figures.orientation_error_degrees_max, "°"),
        number(figures.limb_direction_error_degrees_mean, "°"),
        number(figures.limb_direction_error_degrees_max, "°"),
        number(figures.foot_slide_metres_per_sec, " m/s"),
        number(figures.foot_slide_source_metres_per_sec, " m/s"),
        number(figures.ground_penetration_metres_max, " m"),
    )
}
