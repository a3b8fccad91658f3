//! The user's actions in the mirror of the panels (web/shell/mirror.js).

use egui::Modifiers;
use egui::accesskit::ActionData;
use wasm_bindgen::prelude::*;

use super::page::page;
use crate::app::mirror::Mirror;

/// Passes on a user's action on an entry; see [`Mirror::act`]. `value` is a number, a string or undefined.
#[wasm_bindgen]
pub fn mirror_act(id: &str, action: &str, value: JsValue) {
    let number = value.as_f64().map(ActionData::NumericValue);
    let data = number.or_else(|| Some(ActionData::Value(value.as_string()?.into())));
    with_mirror(|mirror| mirror.act(id, action, data));
}

/// Passes on a key that the mirror doesn't handle itself.
#[wasm_bindgen]
pub fn mirror_key(name: &str, code: &str, pressed: bool, alt: bool, ctrl: bool, shift: bool, meta: bool) {
    let modifiers = Modifiers { alt, ctrl, shift, mac_cmd: meta, command: ctrl || meta };
    with_mirror(|mirror| mirror.key(name, code, pressed, modifiers));
}

/// Reports whether the mirror has the focus. When it loses the focus, so do the panels.
#[wasm_bindgen]
pub fn mirror_focus(has_focus: bool) {
    with_mirror(|mirror| mirror.has_focus = has_focus);
    if let Ok(page) = page()
        && !has_focus
    {
        page.context.memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        });
    }
}

/// Closes the menu that is open, as a click in the canvas would; false if none is. For what the user does elsewhere on the page.
#[wasm_bindgen]
pub fn close_menu() -> bool {
    let Ok(page) = page() else { return false };
    let is_open = egui::Popup::is_any_open(&page.context);
    if is_open {
        egui::Popup::close_all(&page.context);
        page.inbox.wake();
    }
    is_open
}

fn with_mirror(change: impl FnOnce(&mut Mirror)) {
    let Ok(page) = page() else { return };
    page.context.with_plugin(change);
    page.inbox.wake();
}
