//! The names of the tabs.

/// A tab of the inspector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tab {
    /// The node tree, and the selected joint and vertex.
    Scene,
    /// Skinning method, overlays, expressions and morph targets.
    Display,
    /// Contents, licence, parts, extensions and warnings of the file.
    Info,
    /// Camera, light, background, up axis, images and videos.
    Camera,
    /// Edits of the clip and layers; with a motion, its joint map and retargeting options. Hidden if the model has no clips.
    Motion,
}

impl Tab {
    /// Returns the text on the tab.
    pub fn label(self) -> &'static str {
        match self {
            Self::Scene => "Scene",
            Self::Display => "Display",
            Self::Info => "Info",
            Self::Camera => "Camera",
            Self::Motion => "Motion",
        }
    }
}
