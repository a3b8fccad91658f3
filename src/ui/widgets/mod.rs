//! The building blocks of the panels: buttons, switches, sliders, icons, the scrub bar, and the style they share.

pub mod accessible;
pub mod controls;
pub mod icons;
pub mod modal;
pub mod scrub;
pub mod style;
