//! What everything in the viewport is drawn with.

use egui::{Painter, Response, Ui};

use crate::ui::Shown;

/// The viewport as one control: what its handles are drawn with and react to.
#[derive(Clone, Copy)]
pub(in crate::ui) struct Canvas<'a> {
    pub ui: &'a Ui,
    pub painter: &'a Painter,
    pub response: &'a Response,
    pub shown: &'a Shown<'a>,
}
