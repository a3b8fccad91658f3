//! The header, its menus, and the box about the program.

use gaitway_scene::state::Edited;

/// The program's name.
pub const NAME: &str = "Gaitway";
/// What the program does.
pub const TAGLINE: &str = "Watch a 3D character move, and give it the motion of another.";
/// Button that opens files.
pub const OPEN: &str = "Open…";
/// Button that borrows motion from another file, or loads a joint map.
pub const BORROW_MOTION: &str = "Borrow motion…";
/// Why [`BORROW_MOTION`] is disabled.
pub const NOTHING_TO_MOVE: &str = "This model has no skeleton to move";
/// Button that opens the gallery of samples.
pub const SAMPLES: &str = "Samples";
/// Menu of what can be saved.
pub const EXPORT: &str = "Export";
/// Entry of the export menu that shows the settings of images and videos.
pub const PICTURE_SETTINGS: &str = "Image and video settings…";
/// Entry of the export menu that saves a self-contained page that shows the scene.
pub const SAVE_PAGE: &str = "Save web page (HTML)…";
/// Button that shares a link to the view.
pub const SHARE: &str = "Share…";
/// Menu of everything else.
pub const MENU: &str = "Menu";
/// Entry of the menu that enters and leaves full screen.
pub const FULL_SCREEN: &str = "Full screen";
/// The choice of the panels' theme.
pub const THEME: &str = "Theme";
/// Entry of the menu that opens the help, with its key.
pub const HELP: &str = "Keys and gestures (?)";
/// The same on screens for fingers, and the title of the help there.
pub const GESTURES: &str = "Gestures";
/// Entry of the menu that opens the box about the program.
pub const ABOUT: &str = "About Gaitway";
/// The version, in that box.
pub const VERSION: &str = concat!("Version ", env!("CARGO_PKG_VERSION"));
/// What the page says in that box if it was built without optimization.
pub const QUICK_BUILD: &str = "A quick build, to try a change: larger and slower than the page that is published.";
/// The licence, in that box.
pub const LICENCE: &str = "Free and open source: MIT or Apache 2.0, at your option. Your files stay on your computer.";
/// What is private, in that box.
pub const PRIVACY: &str = "Gaitway asks nothing and tracks nothing: no account, no cookies, no analytics.";
/// Link in that box.
pub const DOCUMENTATION: &str = "Documentation";
/// Link in that box.
pub const SOURCE_CODE: &str = "Source code";
/// Link in that box.
pub const LICENCES: &str = "Licences";
/// Button that closes that box.
pub const CLOSE_ABOUT: &str = "Close";
/// Button that undoes the last step, whatever it was, with its key.
pub const UNDO_STEP: &str = "Undo last step (Ctrl+Z)";
/// Button that redoes the last undone step, with its key.
pub const REDO_STEP: &str = "Redo step (Ctrl+Y)";
/// Button of an embedded view.
pub const OPEN_PAGE: &str = "Open in Gaitway";

/// Button that borrows the clips of an open model.
pub const BORROW: &str = "Borrow";

/// Returns the accessible name and tooltip of that button.
pub fn borrow_from(model: &str) -> String {
    format!("Borrow the motion of {model}")
}

/// Tells screen readers what was undone or redone, and how many steps can be undone now.
pub fn stepped(is_undo: bool, edited: Option<Edited>, undo_steps: usize) -> String {
    let done = if is_undo { "Undone" } else { "Redone" };
    let what = edited.map_or_else(String::new, |edited| format!(": {}", name_of(edited)));
    format!("{done}{what}. Steps left to undo: {undo_steps}.")
}

fn name_of(edited: Edited) -> &'static str {
    match edited {
        Edited::JointMap => "joint map",
        Edited::Retargeting => "retargeting",
        Edited::MorphWeights => "morph targets",
        Edited::Expressions => "expressions",
        Edited::Pose => "manual pose",
        Edited::Pins => "pins",
        Edited::JointNames => "joint names",
        Edited::Clips => "changes to clips",
        Edited::Layers => "layers",
        Edited::Variant => "material variant",
        Edited::Hidden => "what is hidden",
        Edited::UpAxis => "up axis",
        Edited::Lighting => "lighting",
        Edited::Display => "display",
    }
}
