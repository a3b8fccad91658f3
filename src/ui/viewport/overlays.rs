//! What lies over everything for a while: sheets on narrow screens, help, progress, errors, the drop target.

use egui::{Align, Align2, Area, Color32, Context, Id, Layout, Order, Rect, RichText, Stroke, Ui, pos2, vec2};

use crate::editor::Export;
use crate::ui::icons::{Icon, icon_button};
use crate::ui::{
    KEY_TABLE, Output, PathPrompt, PathPurpose, Saved, Sheet, Shown, UiAction, UiState, clips, is_narrow, motion,
    style, tabs,
};

/// Call last; `picture` is the rectangle the picture has.
pub fn overlays(ui: &mut Ui, picture: Rect, shown: Shown<'_>, local: &mut UiState, out: &mut Output) {
    if local.recording {
        return;
    }
    if is_narrow(ui) && !shown.state.page.embed {
        sheet(ui, &shown, local, out);
    } else {
        local.sheet = None;
    }
    notices(ui, picture, &shown, local, out);
    // Shown from the next pass on: the press that opened it would count as one beside it, which closes it.
    if local.help_open && local.help_shown {
        help(ui.ctx(), local);
    } else if local.help_open {
        ui.ctx().request_repaint();
    }
    local.help_shown = local.help_open;
    path_prompt(ui.ctx(), local, out);
    motion::banner(ui.ctx(), picture, &shown, local);
    motion::picker(ui.ctx(), &shown, local, out);
    if ui.input(|input| !input.raw.hovered_files.is_empty()) {
        drop_target(ui);
    }
}

/// How round the upper corners of a sheet are; the picture goes on behind them.
pub const SHEET_CORNER: u8 = 16;

/// The rectangle of a sheet at the bottom of what the panels leave free. It leaves a strip of the picture.
pub fn sheet_rect(free: Rect) -> Rect {
    let height = (free.height() * 0.62).max(240.0).min(free.height() - 56.0).max(0.0);
    Rect::from_min_max(pos2(free.left(), free.bottom() - height), free.right_bottom())
}

fn sheet(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(sheet) = local.sheet else { return };
    // Opened in this very pass, after the room was shared out.
    let Some(rect) = local.sheet_rect else {
        ui.ctx().request_repaint();
        return;
    };
    let palette = style::palette(ui);
    Area::new(Id::unique(("sheet", sheet as u8))).order(Order::Middle).fixed_pos(rect.min).show(ui.ctx(), |ui| {
        let corners = egui::CornerRadius { nw: SHEET_CORNER, ne: SHEET_CORNER, sw: 0, se: 0 };
        ui.painter().rect_filled(rect, corners, palette.panel);
        let line = Stroke::new(1.0, palette.line);
        ui.painter().rect_stroke(rect, corners, line, egui::StrokeKind::Inside);
        let grip = Rect::from_center_size(rect.center_top() + vec2(0.0, 9.0), vec2(36.0, 4.0));
        ui.painter().rect_filled(grip, 2.0, palette.pressed);
        // All of the sheet takes the pointer, so that nothing under it moves.
        ui.allocate_rect(rect, egui::Sense::click_and_drag());
        let handle = Rect::from_min_size(rect.min, vec2(rect.width() - 48.0, 24.0));
        let handle = ui.interact(handle, ui.scope_id().with("handle"), egui::Sense::drag());
        if handle.total_drag_delta().is_some_and(|dragged| dragged.y > 48.0) {
            local.sheet = None;
        }
        let inner = Rect::from_min_max(rect.min + vec2(14.0, 16.0), rect.max - vec2(14.0, 4.0));
        let mut content = ui.new_child(egui::UiBuilder::new().max_rect(inner));
        content.set_clip_rect(inner.expand(4.0).intersect(content.clip_rect()));
        let close = Rect::from_min_size(pos2(rect.right() - 44.0, rect.top() + 10.0), vec2(32.0, 32.0));
        match sheet {
            Sheet::Clips => clips::show(&mut content, shown, local, out),
            Sheet::Inspector => {
                content.add_space(28.0);
                tabs::show(&mut content, shown, local, out);
            }
        }
        let mut corner = ui.new_child(egui::UiBuilder::new().max_rect(close));
        if icon_button(&mut corner, Icon::Close, "Close the sheet", false).clicked() {
            local.sheet = None;
        }
    });
}

/// Progress, errors and short messages, in the lower left corner of the picture: the character is in its middle.
fn notices(ui: &mut Ui, picture: Rect, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let now_secs = ui.input(|input| input.time);
    if let Some(toast) = &local.toast {
        let left_secs = toast.until_secs - now_secs;
        if left_secs <= 0.0 {
            local.toast = None;
        } else {
            ui.ctx().request_repaint_after_secs(left_secs as f32);
        }
    }
    if local.toast.is_none() && local.error.is_none() && local.progress.is_none() {
        return;
    }
    let palette = style::palette(ui);
    let width = (picture.width() - 28.0).min(520.0);
    // Above the names of what is compared.
    let bottom = picture.bottom() - if shown.state.inspect.split { 38.0 } else { 14.0 };
    let area = Area::new(Id::unique("notices"))
        .order(Order::Foreground)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(pos2(picture.left() + 14.0, bottom));
    area.show(ui.ctx(), |ui| {
        ui.set_max_width(width);
        if let Some(progress) = &local.progress {
            notice(ui, palette.line, |ui| {
                ui.set_width(width.min(360.0) - 32.0);
                ui.add(egui::Label::new(format!("Opening {}", progress.name)).truncate());
                let bar = match progress.fraction {
                    Some(fraction) => egui::ProgressBar::new(fraction),
                    None => egui::ProgressBar::new(1.0).animate(true),
                };
                ui.add(bar.desired_height(6.0).fill(palette.accent));
            });
        }
        if let Some(error) = local.error.clone() {
            notice(ui, palette.error, |ui| {
                ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
                    if icon_button(ui, Icon::Close, "Dismiss the error", false).clicked() {
                        local.error = None;
                        local.motion_refused = false;
                    }
                    ui.with_layout(Layout::top_down(Align::Min), |ui| {
                        ui.label(RichText::new("That did not work").strong().color(palette.error));
                        egui::ScrollArea::vertical().max_height(180.0).show(ui, |ui| {
                            ui.add(egui::Label::new(error).wrap().selectable(true));
                        });
                        if local.motion_refused {
                            refused_offers(ui, local, out);
                        }
                    });
                });
            });
        }
        if let Some(toast) = &local.toast {
            let pressed = notice(ui, palette.line, |ui| {
                if !toast.undoable {
                    ui.label(&toast.text);
                    return false;
                }
                let button = 70.0;
                ui.horizontal(|ui| {
                    ui.scope(|ui| {
                        ui.set_max_width(width - 32.0 - button);
                        ui.add(egui::Label::new(&toast.text).wrap());
                    });
                    ui.button("Undo").on_hover_text("Back to what was there before (Ctrl+Z)").clicked()
                })
                .inner
            });
            if pressed {
                out.actions.push(UiAction::Undo);
                local.toast = None;
            }
        }
    });
}

/// What else can be done with motions that do not fit.
fn refused_offers(ui: &mut Ui, local: &mut UiState, out: &mut Output) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let offers = [
            ("Show its own skeleton", UiAction::ShowRefusedAlone),
            ("Choose joints by hand", UiAction::MapRefusedByHand),
        ];
        for (label, action) in offers {
            if ui.button(label).clicked() {
                out.actions.push(action);
                local.error = None;
                local.motion_refused = false;
            }
        }
    });
}

fn notice<R>(ui: &mut Ui, line: Color32, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let palette = style::palette(ui);
    egui::Frame::new()
        .fill(palette.panel)
        .stroke(Stroke::new(1.0, line))
        .corner_radius(10)
        .shadow(ui.visuals().popup_shadow)
        .inner_margin(egui::Margin::symmetric(16, 12))
        .show(ui, contents)
        .inner
}

pub fn modal(name: &str, context: &Context) -> egui::Modal {
    let frame = egui::Frame::window(&context.global_style()).inner_margin(egui::Margin::same(18));
    egui::Modal::new(Id::unique(name)).frame(frame)
}

fn help(context: &Context, local: &mut UiState) {
    let modal = modal("help", context).show(context, |ui| {
        let palette = style::palette(ui);
        let width = (ui.ctx().content_rect().width() - 64.0).min(400.0);
        ui.set_width(width);
        ui.horizontal(|ui| {
            ui.heading("Keys and gestures");
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if icon_button(ui, Icon::Close, "Close the help", false).clicked() {
                    local.help_open = false;
                }
            });
        });
        let pointer = [
            ("Drop files", "Open a model, borrow motions for it, put a joint map in force"),
            ("Drag", "Look around"),
            ("Right drag, shift drag", "Move the picture"),
            ("Wheel, pinch", "Nearer, farther, towards the pointer"),
            ("Two fingers", "Move the picture"),
            ("Drag a ring", "Turn the chosen joint, with “Turn by hand” in the tab Scene"),
            ("Click a joint", "Choose it; in the tab Motion, mend what it follows"),
            ("Double click", "Fit everything into the picture"),
        ];
        let lines = KEY_TABLE.iter().map(|line| (line.keys, line.does)).chain(pointer);
        let most = (ui.ctx().content_rect().height() - 160.0).max(120.0);
        // Its bar is there all the time: whole lines fit, and nothing else says that there are more.
        ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
        egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most).show(ui, |ui| {
            // Small screens have no room for the longest keys and the longest words side by side.
            let columns = [0.37 * width, 0.63 * width - 18.0];
            egui::Grid::new("keys").num_columns(2).min_row_height(18.0).spacing([18.0, 7.0]).show(ui, |ui| {
                for (keys, does) in lines {
                    for (text, width) in
                        [RichText::new(keys).color(palette.accent), does.into()].into_iter().zip(columns)
                    {
                        ui.vertical(|ui| {
                            ui.set_width(width);
                            ui.add(egui::Label::new(text).wrap());
                        });
                    }
                    ui.end_row();
                }
            });
        });
    });
    if modal.should_close() {
        local.help_open = false;
    }
}

fn path_prompt(context: &Context, local: &mut UiState, out: &mut Output) {
    let Some(PathPrompt { purpose, path }) = &mut local.path_prompt else { return };
    let (title, hint, button) = match purpose {
        PathPurpose::Open => ("Open a file", "Path of a .glb, .gltf, .bvh, .obj, .zip or folder", "Open"),
        PathPurpose::OpenMotion => ("Borrow motion", "Path of a .bvh, .glb, .vrma or joint map .json", "Open"),
        PathPurpose::Save(Saved::File(Export::Map { .. })) => {
            ("Save the joint map", "Path of the file to write", "Save")
        }
        PathPurpose::Save(Saved::File(Export::Model { .. } | Export::Whole { .. })) => {
            ("Save the model", "Path of the .glb to write", "Save")
        }
        PathPurpose::Save(Saved::File(Export::Clip { .. })) => ("Save the clip", "Path of the .glb to write", "Save"),
        PathPurpose::Save(Saved::Picture { .. }) => ("Save the picture", "Path of the .png to write", "Save"),
    };
    let mut done = false;
    let modal = modal("path prompt", context).show(context, |ui| {
        ui.set_width((ui.ctx().content_rect().width() - 64.0).min(460.0));
        ui.heading(title);
        ui.add_space(4.0);
        let field = egui::TextEdit::singleline(path)
            .hint_text(hint)
            .margin(egui::Margin::symmetric(10, 6))
            .desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name("Path");
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if !field.has_focus() && !entered {
            field.request_focus();
        }
        if !matches!(purpose, PathPurpose::Save(_)) {
            crate::ui::controls::hint(ui, "Files can also be dropped anywhere on the window.");
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let filled = !path.trim().is_empty();
            let go = ui.add_enabled(filled, egui::Button::new(button));
            if filled && (go.clicked() || entered) {
                out.actions.push(UiAction::UsePath(*purpose, path.trim().to_owned()));
                done = true;
            }
            done |= ui.button("Cancel").clicked();
        });
    });
    if done || modal.should_close() {
        local.path_prompt = None;
    }
}

fn drop_target(ui: &Ui) {
    let palette = style::palette(ui);
    let painter = ui.ctx().layer_painter(egui::LayerId::new(Order::Tooltip, Id::unique("drop target")));
    let whole = ui.ctx().content_rect();
    painter.rect_filled(whole, 0.0, palette.panel.gamma_multiply(0.82));
    let inner = whole.shrink(24.0);
    let corners = [inner.left_top(), inner.right_top(), inner.right_bottom(), inner.left_bottom(), inner.left_top()];
    painter.extend(egui::Shape::dashed_line(&corners, Stroke::new(2.0, palette.accent), 10.0, 8.0));
    let center = whole.center();
    painter.text(center, Align2::CENTER_BOTTOM, "Drop to open", egui::FontId::proportional(28.0), palette.text);
    let below = "A model with its files, motions for it, a folder or a .zip";
    let at = center + vec2(0.0, 10.0);
    painter.text(at, Align2::CENTER_TOP, below, egui::FontId::proportional(15.0), palette.weak_text);
}
