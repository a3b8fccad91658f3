//! The viewport: what the pointer does there, what is painted over the scene, and what floats above the panels.

pub mod gizmo;
pub mod overlays;
pub mod picture;
