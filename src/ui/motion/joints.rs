//! The joint table: every joint of the model, its source, how certain it is, and why.

use std::collections::HashSet;
use std::rc::Rc;

use egui::{Align2, Key, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use gaitway_retarget::JointMap;
use gaitway_scene::state::Command;

use super::picker::Picking;
use super::rows::{Filter, Row, State, TableSection};
use super::{Contents, MotionTab, Pairing, detail};
use crate::ui::search::finds;
use crate::ui::widgets::accessible;
use crate::ui::{Output, Shown, controls, style, text};

const ROW_HEIGHT: f32 = 44.0;
/// Tables with more rows than this skip the hidden ones: a rig may have hundreds.
const MANY_ROWS: usize = 120;
/// Hidden rows this close to the visible area are kept, so that the Tab key can reach them.
const NEAR: f32 = 4.0 * ROW_HEIGHT;
const HEADING_HEIGHT: f32 = 32.0;
/// Indentation of a joint relative to its parent.
const INDENT: f32 = 8.0;
const MAX_INDENTS: usize = 7;

/// Order and filter of the table.
#[derive(Debug, Default)]
pub(super) struct TableView {
    pub search: String,
    pub filter: Filter,
    /// Ordered by hierarchy, even if parts of the body are known.
    pub tree: bool,
    /// The first row gets the focus.
    pub takes_focus: bool,
    folded: HashSet<TableSection>,
    lines: Option<Rc<Lines>>,
    /// The joint last scrolled to.
    scrolled_to: Option<usize>,
    /// Number and top of the row that was just pressed: it stays there while the details of another one close above it.
    pressed: Option<(usize, f32)>,
    /// Number of the row whose details scroll into view, and the number of passes until then: the scrolling for `pressed` has to
    /// take effect first.
    revealed: Option<(usize, u8)>,
    /// Number of the row whose details have the focus: it gets it when they close.
    in_details: Option<usize>,
}

/// Whether the table can be ordered by parts of the body.
pub(super) fn has_body(pairing: &Pairing<'_>) -> bool {
    pairing.proposal.is_some_and(|proposal| !proposal.model.parts.is_empty())
}

/// Order and filter controls above the table.
pub(super) fn choices(ui: &mut Ui, pairing: &Pairing<'_>, contents: &Contents, table: &mut TableView) {
    let counted = || Filter::ALL.iter().zip(&contents.filters).map(|((filter, _), text)| (*filter, text));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let half = (ui.available_width() - 6.0) / 2.0;
        if has_body(pairing) {
            ui.scope(|ui| {
                ui.set_max_width(half);
                let orders = [(false, text::BY_BODY), (true, text::BY_TREE)];
                if let Some(tree) = controls::segmented_about(ui, text::ORDER, Some(table.tree), &orders) {
                    table.tree = tree;
                }
            });
        }
        let chosen = counted().find(|(filter, _)| *filter == table.filter).map_or("", |(_, text)| text);
        controls::chooser(ui, "joint filter", text::JOINT_FILTER, chosen, |ui| {
            for (filter, text) in counted() {
                if controls::option(ui, filter == table.filter, text) {
                    table.filter = filter;
                }
            }
        });
    });
}

/// The rows to show and their headings, kept while nothing they depend on changes.
#[derive(Debug)]
struct Lines {
    contents: Rc<Contents>,
    search: String,
    filter: Filter,
    chosen: Option<usize>,
    by_body: bool,
    lines: Vec<Line>,
    /// Shown instead of lines if there are none.
    nothing: String,
    /// Of the chosen joint.
    detail: Option<detail::Texts>,
}

#[derive(Debug)]
enum Line {
    Heading(Heading),
    /// Index into [`Contents::rows`].
    Row(usize),
}

/// Heading of a section.
#[derive(Debug)]
struct Heading {
    section: TableSection,
    /// How many of its joints have a source and how many need review.
    counts: String,
    label: String,
    needs_review: bool,
    has_chosen: bool,
}

impl Lines {
    fn new(
        contents: &Rc<Contents>,
        pairing: &Pairing<'_>,
        table: &TableView,
        chosen: Option<usize>,
        by_body: bool,
    ) -> Self {
        let (search, filter) = (table.search.clone(), table.filter);
        let is_shown = |row: &Row| {
            let names = [&*row.target, &*row.source_text, &*row.what];
            let found = names.into_iter().any(|name| finds(&search, name));
            found && (filter.lets_through(row) || Some(row.number) == chosen)
        };
        let rows = &contents.rows;
        let shown: Vec<usize> = (0..rows.len()).filter(|&row| is_shown(&rows[row])).collect();
        let mut lines = Vec::new();
        if by_body {
            for section in TableSection::ALL {
                let of_section = || shown.iter().copied().filter(|&row| rows[row].section == section);
                if of_section().next().is_some() {
                    lines.push(Line::Heading(Heading::new(section, of_section().map(|row| &rows[row]), chosen)));
                    lines.extend(of_section().map(Line::Row));
                }
            }
        } else {
            lines.extend(shown.into_iter().map(Line::Row));
        }
        let nothing = match search.is_empty() {
            true if filter == Filter::NeedsReview => text::NOTHING_TO_REVIEW.to_owned(),
            true => text::NO_SUCH_JOINTS.to_owned(),
            false => format!("No joint matches “{search}”."),
        };
        let detail = rows.iter().find(|row| Some(row.number) == chosen).map(|row| detail::Texts::new(pairing, row));
        Self { contents: contents.clone(), search, filter, chosen, by_body, lines, nothing, detail }
    }

    fn is_current(&self, contents: &Rc<Contents>, table: &TableView, chosen: Option<usize>, by_body: bool) -> bool {
        Rc::ptr_eq(&self.contents, contents)
            && self.search == table.search
            && (self.filter, self.chosen, self.by_body) == (table.filter, chosen, by_body)
    }
}

impl Heading {
    fn new<'a>(section: TableSection, rows: impl Iterator<Item = &'a Row> + Clone, chosen: Option<usize>) -> Self {
        let follow = rows.clone().filter(|row| row.source.is_some()).count();
        let to_review = rows.clone().filter(|row| row.needs_review).count();
        let has_chosen = rows.clone().any(|row| Some(row.number) == chosen);
        let mut counts = format!("{follow} of {}", rows.count());
        if to_review > 0 {
            let need = if to_review == 1 { "needs" } else { "need" };
            counts = format!("{to_review} {need} review · {counts}");
        }
        let label = format!("{}, {counts}", section.title());
        Self { section, counts, label, needs_review: to_review > 0, has_chosen }
    }
}

pub(super) fn show(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    map: &JointMap,
    contents: &Rc<Contents>,
    tab: &mut MotionTab,
    out: &mut Output,
) {
    let chosen = shown.state.selection.joint;
    let by_body = !tab.table.tree && has_body(pairing);
    let kept = tab.table.lines.take().filter(|lines| lines.is_current(contents, &tab.table, chosen, by_body));
    let left = if chosen.is_none() { tab.table.in_details.take() } else { None };
    let lines = kept.unwrap_or_else(|| Rc::new(Lines::new(contents, pairing, &tab.table, chosen, by_body)));
    tab.table.lines = Some(lines.clone());
    if lines.lines.is_empty() {
        controls::hint(ui, &lines.nothing);
        return;
    }
    let scroll = tab.table.scrolled_to != chosen;
    tab.table.scrolled_to = chosen;
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut table = Table { shown, pairing, map, lines: &lines, scroll, left, out };
    let mut is_open = true;
    for line in &lines.lines {
        match line {
            Line::Heading(heading) => is_open = table.heading(ui, heading, tab),
            Line::Row(row) if is_open => table.row(ui, &contents.rows[*row], tab),
            Line::Row(_) => {}
        }
    }
}

/// The table while it is drawn.
struct Table<'a, 'b> {
    shown: &'b Shown<'a>,
    pairing: &'b Pairing<'a>,
    map: &'b JointMap,
    lines: &'b Lines,
    /// Another joint was selected elsewhere: scroll to it.
    scroll: bool,
    /// Number of the row whose details were closed while they had the focus.
    left: Option<usize>,
    out: &'b mut Output,
}

impl Table<'_, '_> {
    /// Returns whether the rows below are shown.
    fn heading(&mut self, ui: &mut Ui, heading: &Heading, tab: &mut MotionTab) -> bool {
        let folded = &mut tab.table.folded;
        let section = heading.section;
        let has_to_open = (heading.has_chosen && self.scroll) || !self.lines.search.is_empty();
        if has_to_open {
            folded.remove(&section);
        }
        let open = !folded.contains(&section);
        if show_heading(ui, heading, open) {
            if open {
                folded.insert(section)
            } else {
                folded.remove(&section)
            };
        }
        open
    }

    fn row(&mut self, ui: &mut Ui, row: &Row, tab: &mut MotionTab) {
        let Lines { contents, chosen, by_body, search, lines, detail, .. } = self.lines;
        let is_chosen = *chosen == Some(row.number);
        let indents = if *by_body || !search.is_empty() { 0 } else { row.depth.min(MAX_INDENTS) };
        let many = lines.len() > MANY_ROWS;
        let top = ui.cursor().top();
        let revealed = tab.table.revealed.take_if(|(number, _)| *number == row.number && is_chosen);
        if let Some((number, passes @ 1..)) = revealed {
            tab.table.revealed = Some((number, passes - 1));
            ui.ctx().request_repaint();
        }
        if let Some((_, pressed_top)) = tab.table.pressed.take_if(|(number, _)| *number == row.number && is_chosen) {
            ui.scroll_with_delta_animation(vec2(0.0, pressed_top - top), egui::style::ScrollAnimation::none());
            ui.ctx().request_repaint();
            tab.table.revealed = Some((row.number, 1));
        }
        if std::mem::take(&mut tab.table.takes_focus) || self.left == Some(row.number) {
            ui.memory_mut(|memory| memory.request_focus(target_id(ui, row)));
        }
        match show_row(ui, row, &contents.namespace, is_chosen, indents as f32 * INDENT, self.scroll, many) {
            Some(Pressed::Target) => {
                let joint = (!is_chosen).then_some(row.number);
                // Already visible: it was just pressed.
                tab.table.scrolled_to = joint;
                tab.table.pressed = joint.map(|joint| (joint, top));
                self.out.commands.push(Command::SelectJoint(joint));
            }
            Some(Pressed::Source) => tab.picking = Some(Picking::new(self.pairing.id(), row.number)),
            None => {}
        }
        if let Some(texts) = detail.as_ref().filter(|_| is_chosen) {
            let about = detail::About { shown: self.shown, pairing: self.pairing, map: self.map, row, texts };
            let details = ui.scope(|ui| detail::show(ui, &about, tab, self.out)).response.rect;
            // The key that closes them takes the focus away a pass earlier.
            if !ui.input(|input| input.key_pressed(Key::Escape)) {
                let has_focus = controls::focused(ui).is_some_and(|focused| details.contains_rect(focused.rect));
                tab.table.in_details = has_focus.then_some(row.number);
            }
            if revealed.is_some_and(|(_, passes)| passes == 0) {
                // If not all of it fits, the row itself stays in view.
                let whole = details.with_min_y(top);
                let is_too_high = whole.height() > ui.clip_rect().height();
                ui.scroll_to_rect(whole, is_too_high.then_some(egui::Align::TOP));
            }
        }
    }
}

/// Returns whether the heading was pressed.
fn show_heading(ui: &mut Ui, heading: &Heading, open: bool) -> bool {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), controls::row_height(ui, HEADING_HEIGHT)), Sense::click());
    let role = egui::accesskit::Role::Button;
    response.widget_info(|| WidgetInfo::labeled(role, true, &heading.label));
    // A row of the table, so that headings don't divide it. No joint has a number as large.
    accessible::cell(&response, u32::MAX as usize - heading.section as usize);
    accessible::set_expanded(&response, open);
    if ui.is_rect_visible(rect) {
        let palette = style::palette(ui);
        lit(ui, rect, &response);
        let middle = rect.left() + 10.0;
        let turn = if open { vec2(0.0, 1.0) } else { vec2(1.0, 0.0) };
        let side = vec2(-turn.y, turn.x) * 3.5;
        let tip = pos2(middle, rect.center().y) + turn * 2.0;
        for end in [side, -side] {
            ui.painter().line_segment([tip - turn * 4.0 + end, tip], Stroke::new(1.4, palette.weak_text));
        }
        let color = if heading.needs_review { palette.warning } else { palette.weak_text };
        let at = rect.right_center() - vec2(8.0, 0.0);
        let drawn = ui.painter().text(at, Align2::RIGHT_CENTER, &heading.counts, style::SMALL, color);
        let left = Rect::from_min_max(pos2(rect.left() + 22.0, rect.top()), pos2(drawn.left() - 6.0, rect.bottom()));
        controls::elided(ui, left, heading.section.title(), palette.text);
    }
    response.clicked()
}

fn lit(ui: &Ui, rect: Rect, response: &egui::Response) {
    let palette = style::palette(ui);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), style::CORNER, palette.hover);
    }
    if response.has_focus() {
        let stroke = Stroke::new(1.0, palette.accent);
        ui.painter().rect_stroke(rect.shrink(1.0), style::CORNER, stroke, StrokeKind::Inside);
    }
}

enum Pressed {
    Target,
    Source,
}

fn target_id(ui: &Ui, row: &Row) -> egui::Id {
    ui.scope_id().with(("map row", row.number))
}

/// State and target on the left, source on the right, the reason below. Either half is a button.
fn show_row(
    ui: &mut Ui,
    row: &Row,
    namespace: &str,
    chosen: bool,
    indent: f32,
    scroll: bool,
    many: bool,
) -> Option<Pressed> {
    let (rect, whole) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::hover());
    if chosen && scroll {
        // To the top, since its details open below.
        whole.scroll_to_me(Some(egui::Align::TOP));
    }
    if many && !chosen && !ui.is_rect_visible(rect.expand2(vec2(0.0, NEAR))) {
        return None;
    }
    // Indented names keep their width.
    let middle = rect.center().x + 0.5 * indent;
    let id = target_id(ui, row);
    let target = ui.interact(rect.with_max_x(middle), id, Sense::click());
    let source = ui.interact(rect.with_min_x(middle), id.with("source"), Sense::click());
    let role = egui::accesskit::Role::Button;
    target.widget_info(|| WidgetInfo::selected(role, true, chosen, text::edit_joint(&row.target)));
    source.widget_info(|| WidgetInfo::labeled(role, true, &row.follows));
    [&target, &source].into_iter().for_each(|half| accessible::cell(half, row.number));
    if ui.is_rect_visible(rect) {
        let palette = style::palette(ui);
        if chosen {
            ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), style::CORNER, palette.chosen);
        }
        lit(ui, target.rect, &target);
        lit(ui, source.rect, &source);
        let inner = rect.shrink2(vec2(6.0, 4.0)).with_min_x(rect.left() + 6.0 + indent);
        let right = inner.right();
        let top = |from: f32, to: f32| Rect::from_min_max(pos2(from, inner.top()), pos2(to, inner.top() + 20.0));
        badge(ui, pos2(inner.left() + 7.0, inner.top() + 10.0), row.state);
        let bright = if row.source.is_some() { palette.text } else { palette.weak_text };
        let name = row.target.strip_prefix(namespace).unwrap_or(&row.target);
        controls::elided(ui, top(inner.left() + 20.0, middle - 16.0), name, bright);
        let arrow = pos2(middle + 1.0, inner.top() + 10.0);
        ui.painter().arrow(arrow, vec2(-12.0, 0.0), Stroke::new(1.2, palette.weak_text));
        let color = if row.source.is_some() { palette.accent } else { palette.weak_text };
        controls::elided(ui, top(middle + 6.0, right), &row.short_source, color);
        let below = Rect::from_min_max(pos2(inner.left() + 20.0, inner.top() + 20.0), pos2(right, inner.bottom()));
        let color = if row.needs_review { palette.warning } else { palette.weak_text };
        controls::elided_small(ui, below, &row.why, color);
    }
    let told = |ui: &mut Ui, click: &str| match row.source {
        Some(_) => drop(ui.label(format!("{}. {click}", row.follows))),
        None => drop(ui.label(format!("{}: {}. {click}", row.target, row.why))),
    };
    let target = target.on_hover_ui(|ui| told(ui, "Click for more."));
    let source = source.on_hover_ui(|ui| told(ui, "Click to choose another."));
    if target.clicked() { Some(Pressed::Target) } else { source.clicked().then_some(Pressed::Source) }
}

/// A symbol for each state, so that color is not the only cue.
pub(super) fn badge(ui: &Ui, center: egui::Pos2, state: State) {
    let palette = style::palette(ui);
    let painter = ui.painter();
    // Segments instead of a path, which is a vector of points in every frame.
    let line = |points: &[(f32, f32)], color| {
        for ends in points.windows(2) {
            let [from, to] = [ends[0], ends[1]].map(|(x, y)| center + vec2(x, y));
            painter.line_segment([from, to], Stroke::new(1.6, color));
        }
    };
    let letter = |letter: &str, color| {
        painter.circle_stroke(center, 7.0, Stroke::new(1.2, color));
        painter.text(center, Align2::CENTER_CENTER, letter, style::SMALL, color);
    };
    match state {
        State::Sure => line(&[(-5.0, 0.5), (-1.5, 4.0), (5.0, -4.0)], palette.accent),
        State::Guess => letter("?", palette.warning),
        State::Conflict => letter("!", palette.error),
        State::None => line(&[(-5.0, 0.0), (5.0, 0.0)], palette.weak_text),
        State::Muted => {
            painter.circle_stroke(center, 6.0, Stroke::new(1.4, palette.weak_text));
            line(&[(-4.2, 4.2), (4.2, -4.2)], palette.weak_text);
        }
    }
}
