//! What a notice says about an opened model.

use gaitway_character::asset::{Asset, Warning};

use super::short_name;

/// The contents of the notice about an opened model.
pub(super) struct Opened {
    pub name: String,
    pub is_new: bool,
    pub others: Vec<String>,
    pub evicted: Vec<String>,
    pub lacks_joints: bool,
    pub about_images: String,
    pub about_view: Option<&'static str>,
    pub about_motions: Option<String>,
    pub about_feet: Option<&'static str>,
}

impl Opened {
    pub fn text(&self) -> String {
        let mut text = if self.is_new { format!("Opened {}.", self.name) } else { format!("Reopened {}.", self.name) };
        match &self.others[..] {
            [] => {}
            [other] => text += &format!(" {other} is in the model list."),
            others => text += &format!(" {} more are in the model list.", others.len()),
        }
        if !self.evicted.is_empty() {
            text += &format!(" Closed {} to make room, which undo doesn't take back.", self.evicted.join(", "));
        }
        if self.lacks_joints {
            text += " Open its .skel and .attach as well to add its joints.";
        }
        text += &self.about_images;
        for sentence in self.about_view.into_iter().chain(self.about_motions.as_deref()).chain(self.about_feet) {
            text += &format!(" {sentence}");
        }
        text
    }
}

pub(super) fn missing_images(asset: &Asset) -> Vec<String> {
    let missing = |warning: &Warning| match warning {
        Warning::ImageMissing { uri } => Some(short_name(uri)),
        _ => None,
    };
    asset.warnings.iter().filter_map(missing).collect()
}

/// Returns sentences about the images that can't be shown.
pub(super) fn about_images(asset: &Asset) -> String {
    let unreadable = |warning: &Warning| match warning {
        Warning::ImageUnreadable { image, .. } => Some(short_name(image)),
        _ => None,
    };
    let unreadable: Vec<String> = asset.warnings.iter().filter_map(unreadable).collect();
    // Not how many: warnings of one kind have a limit.
    let missing = match &missing_images(asset)[..] {
        [] => String::new(),
        [image] => format!(" Its image {image} is missing; open it as well."),
        _ => " Some of its images are missing; open them as well.".to_owned(),
    };
    let unreadable = match &unreadable[..] {
        [] => String::new(),
        [image] => format!(" Its image {image} can't be read; the Info tab says why."),
        _ => " Some of its images can't be read; the Info tab says why.".to_owned(),
    };
    missing + &unreadable
}
