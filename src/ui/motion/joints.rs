//! The channel table: every joint of the model, what it follows, and why that was proposed.

use egui::{Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};

use super::picker::Picking;
use super::{MotionTab, Pairing, joint_text};
use crate::anim::JointIndex;
use crate::asset::Slot;
use crate::retarget::JointMap;
use crate::ui::{controls, scene_tree, style};

const ROW_HEIGHT: f32 = 44.0;

/// Below this a proposal is marked: look at it.
const UNSURE: f32 = 0.6;

pub(super) fn show(ui: &mut Ui, pairing: &Pairing<'_>, map: &JointMap, tab: &mut MotionTab) {
    let prefix = common_prefix(pairing);
    let wanted = tab.search.to_lowercase();
    let rows: Vec<Row> = rows(pairing, map)
        .into_iter()
        .filter(|row| {
            wanted.is_empty()
                || row.target.to_lowercase().contains(&wanted)
                || row.source.to_lowercase().contains(&wanted)
        })
        .collect();
    if rows.is_empty() {
        controls::hint(ui, format!("No joint's name contains “{}”.", tab.search));
        return;
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    for row in &rows {
        if show_row(ui, row, prefix) {
            tab.picking = Some(Picking::new(pairing.index, row.number));
        }
    }
}

/// What the names of all skinned joints begin with, such as `mixamorig:`: left out where there is little room.
fn common_prefix<'a>(pairing: &Pairing<'a>) -> &'a str {
    let asset = &pairing.model.asset;
    let mut names = asset.skins.iter().flat_map(|skin| skin.joints()).map(|&joint| asset.skeleton.name(joint));
    let Some(first) = names.next() else { return "" };
    let Some((namespace, _)) = first.rsplit_once(':') else { return "" };
    let prefix = &first[..=namespace.len()];
    if names.all(|name| name.starts_with(prefix)) { prefix } else { "" }
}

struct Row {
    /// The target's number in its file.
    number: usize,
    target: String,
    source: String,
    follows: bool,
    why: String,
    unsure: bool,
}

/// Joints that follow something first by the file's order, as all; only those that could matter: what the map or the
/// proposal speaks of, and joints of skins.
fn rows(pairing: &Pairing<'_>, map: &JointMap) -> Vec<Row> {
    let asset = &pairing.model.asset;
    let mut in_skin = vec![false; asset.skeleton.len()];
    for joint in asset.skins.iter().flat_map(|skin| skin.joints()) {
        in_skin[joint.get()] = true;
    }
    let has_skins = !asset.skins.is_empty();
    let rows = asset.skeleton.joints().filter_map(|joint| {
        let number = asset.skeleton.source_index(joint);
        let given = pairing.source_in(map, number);
        let matters = given.is_some() || !has_skins || in_skin[joint.get()];
        matters.then(|| row(pairing, map, joint, number, given))
    });
    rows.collect()
}

fn row(
    pairing: &Pairing<'_>,
    map: &JointMap,
    joint: JointIndex,
    number: usize,
    given: Option<Option<JointIndex>>,
) -> Row {
    let proposed = pairing.proposal.and_then(|proposal| proposal.pairs.iter().find(|pair| pair.target == joint));
    let slot = proposed.and_then(|pair| pair.slot);
    let slot = slot.or_else(|| pairing.proposal.and_then(|proposal| proposal.model.slot(joint)));
    let source = given.flatten();
    let as_proposed = proposed.filter(|pair| Some(pair.source) == source);
    let mut why: Vec<String> = slot.map(slot_text).into_iter().collect();
    why.push(match (source, given, as_proposed) {
        (_, _, Some(pair)) => pair.reason.to_string(),
        (Some(_), _, None) => "chosen by hand".to_owned(),
        (None, Some(None), None) => "deliberately none".to_owned(),
        _ => "follows nothing".to_owned(),
    });
    if source.is_none() {
        let own = map.joints.get(&format!("#{number}")).and_then(|entry| entry.unmapped.as_ref());
        match pairing.own_clip(own.unwrap_or(&map.unmapped)) {
            Some((clip, true)) => why.push(format!("first key of {}", pairing.clip_title(clip))),
            Some((clip, false)) => why.push(format!("plays {}", pairing.clip_title(clip))),
            None => {}
        }
    }
    let unsure = as_proposed.is_some_and(|pair| pair.confidence < UNSURE);
    if unsure {
        why.push("unsure, look at it".to_owned());
    }
    Row {
        number,
        target: scene_tree::title(&pairing.model.asset, joint),
        source: source.map_or_else(|| "none".to_owned(), |source| joint_text(&pairing.motion.asset, source)),
        follows: source.is_some(),
        why: why.join(" · "),
        unsure,
    }
}

/// `leftUpperArm` as “left upper arm”.
fn slot_text(slot: Slot) -> String {
    let mut text = String::new();
    for letter in slot.name().chars() {
        if letter.is_uppercase() {
            text.push(' ');
        }
        text.extend(letter.to_lowercase());
    }
    text
}

/// The target at the left, a button with its source at the right, the reason under both; true when pressed.
fn show_row(ui: &mut Ui, row: &Row, prefix: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
    let label = format!("{} follows {} ({})", row.target, row.source, row.why);
    let role = egui::accesskit::Role::Button;
    response.widget_info(|| WidgetInfo::labeled(role, true, &label));
    if !ui.is_rect_visible(rect) {
        return response.clicked();
    }
    let palette = style::palette(ui);
    let lit = response.hovered() || response.has_focus();
    if lit {
        ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), style::CORNER, palette.hover);
    }
    if response.has_focus() {
        let stroke = Stroke::new(1.0, palette.accent);
        ui.painter().rect_stroke(rect.shrink(1.0), style::CORNER, stroke, StrokeKind::Inside);
    }
    let inner = rect.shrink2(vec2(8.0, 4.0));
    let right = inner.right();
    let middle = inner.left() + 0.5 * (right - inner.left());
    let top = |from: f32, to: f32| Rect::from_min_max(pos2(from, inner.top()), pos2(to, inner.top() + 20.0));
    let bright = if row.follows { palette.text } else { palette.weak_text };
    let target = row.target.strip_prefix(prefix).unwrap_or(&row.target);
    controls::elided(ui, top(inner.left(), middle - 14.0), target, bright);
    let arrow = pos2(middle + 1.0, inner.top() + 10.0);
    ui.painter().arrow(arrow, vec2(-12.0, 0.0), Stroke::new(1.2, palette.weak_text));
    let source = if row.follows { palette.accent } else { palette.weak_text };
    controls::elided(ui, top(middle + 6.0, right), &row.source, source);
    let below = Rect::from_min_max(pos2(inner.left(), inner.top() + 20.0), pos2(right, inner.bottom()));
    let color = if row.unsure { palette.warning } else { palette.weak_text };
    controls::elided_small(ui, below, &row.why, color);
    response.on_hover_text(format!("{label}. Click to choose another.")).clicked()
}
