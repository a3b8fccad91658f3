//! Animation of everything but joints: materials, lights, cameras, visibility, expressions, gaze and single morph weights. Key
//! times are stored apart from those of the joints, so that clips without such channels pay nothing for them.
//!
//! What a file's pointer (`KHR_animation_pointer`) animates of a node's transform or weights is an ordinary channel instead.
//! Retargeting never sees properties; the library adds expressions to retargeted clips by name.

use glam::Vec4;

use super::sampler::{Segment, find_segment};
use super::{Interpolation, JointIndex};

/// What a [`PropertyChannel`] animates. Materials, lights and cameras are given by their index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PropertyTarget {
    /// A factor or texture transform of a material.
    Material(usize, MaterialProperty),
    /// A property of a light, on all nodes that have it.
    Light(usize, LightProperty),
    /// A property of a camera, on all nodes that have it.
    Camera(usize, CameraProperty),
    /// Whether a joint and its descendants are shown: 0 hides them.
    Visibility(JointIndex),
    /// The weight of an expression, by its index in [`Avatar::expressions`](crate::avatar::Avatar::expressions).
    Expression(usize),
    /// The gaze direction of an avatar in degrees: yaw, positive to its left, and pitch, positive down.
    LookAt,
    /// The weight of one morph target of the mesh on a joint.
    MorphWeight(JointIndex, usize),
}

/// An animated property of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MaterialProperty {
    /// Linear RGBA.
    BaseColor,
    /// Metallic factor.
    Metallic,
    /// Roughness factor.
    Roughness,
    /// Linear RGB, without the strength.
    Emissive,
    /// Factor on the emissive colour.
    EmissiveStrength,
    /// Masked materials only.
    AlphaCutoff,
    /// Factor on X and Y of the normal texture.
    NormalScale,
    /// How much the occlusion texture darkens.
    OcclusionStrength,
    /// U and V.
    UvOffset(TextureSlot),
    /// Radians, counter-clockwise.
    UvRotation(TextureSlot),
    /// U and V.
    UvScale(TextureSlot),
    /// A factor of a material's lobes, if it has any.
    Lobe(LobeFactor),
    /// Linear RGB, if it is an MToon material.
    Toon(ToonColor),
}

/// A colour of an MToon material, which `mesh::Toon` describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "named like the fields of `mesh::Toon`")]
pub enum ToonColor {
    ShadeColor,
    MatcapColor,
    RimColor,
    OutlineColor,
}

/// An animated factor of a material's lobes, which `mesh::Lobes` describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "named like the fields of `mesh::Lobes`")]
pub enum LobeFactor {
    Ior,
    Specular,
    SpecularColor,
    Clearcoat,
    ClearcoatRoughness,
    ClearcoatNormalScale,
    SheenColor,
    SheenRoughness,
    Iridescence,
    IridescenceIor,
    IridescenceThicknessMin,
    IridescenceThicknessMax,
    Anisotropy,
    AnisotropyRotation,
    Transmission,
    Thickness,
    AttenuationDistance,
    AttenuationColor,
    Dispersion,
    DiffuseTransmission,
    DiffuseTransmissionColor,
}

impl LobeFactor {
    /// Number of components: 3 for colours, otherwise 1.
    pub fn width(self) -> usize {
        match self {
            Self::SpecularColor | Self::SheenColor | Self::AttenuationColor | Self::DiffuseTransmissionColor => 3,
            _ => 1,
        }
    }
}

/// A texture of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TextureSlot {
    /// Multiplied with the base colour.
    BaseColor,
    /// Multiplied with roughness and metallic.
    MetallicRoughness,
    /// Tangent-space normals.
    Normal,
    /// Ambient occlusion.
    Occlusion,
    /// Multiplied with the emissive colour.
    Emissive,
    /// Weight of the dielectric reflection, in alpha.
    Specular,
    /// Colour of the dielectric reflection.
    SpecularColor,
    /// Weight of the clearcoat, in red.
    Clearcoat,
    /// Roughness of the clearcoat, in green.
    ClearcoatRoughness,
    /// Tangent-space normals of the clearcoat.
    ClearcoatNormal,
    /// Multiplied with the sheen colour.
    SheenColor,
    /// Roughness of the sheen, in alpha.
    SheenRoughness,
    /// Weight of the iridescence, in red.
    Iridescence,
    /// Interpolates the thickness of the thin film from its minimum to its maximum, in green.
    IridescenceThickness,
    /// Direction in red and green, strength in blue.
    Anisotropy,
    /// Transmitted fraction, in red.
    Transmission,
    /// Thickness of the volume, in green.
    Thickness,
    /// Diffusely transmitted fraction, in alpha.
    DiffuseTransmission,
    /// Colour of the diffuse transmission.
    DiffuseTransmissionColor,
    /// Multiplied with MToon's shade colour.
    ShadeMultiply,
    /// Added to MToon's shading shift, in red.
    ShadingShift,
    /// Added to MToon's colour; looked up by the normal in view space.
    Matcap,
    /// Multiplied with MToon's rim and matcap.
    RimMultiply,
    /// Multiplied with the width of MToon's outline, in green.
    OutlineWidth,
    /// Multiplied with the time of MToon's UV animation, in blue.
    UvAnimationMask,
}

impl TextureSlot {
    /// All slots in declaration order: core glTF, then lobes from [`Self::Specular`] on, then MToon from
    /// [`Self::ShadeMultiply`] on.
    pub const ALL: [Self; 25] = [
        Self::BaseColor,
        Self::MetallicRoughness,
        Self::Normal,
        Self::Occlusion,
        Self::Emissive,
        Self::Specular,
        Self::SpecularColor,
        Self::Clearcoat,
        Self::ClearcoatRoughness,
        Self::ClearcoatNormal,
        Self::SheenColor,
        Self::SheenRoughness,
        Self::Iridescence,
        Self::IridescenceThickness,
        Self::Anisotropy,
        Self::Transmission,
        Self::Thickness,
        Self::DiffuseTransmission,
        Self::DiffuseTransmissionColor,
        Self::ShadeMultiply,
        Self::ShadingShift,
        Self::Matcap,
        Self::RimMultiply,
        Self::OutlineWidth,
        Self::UvAnimationMask,
    ];

    /// Whether the texture holds sRGB colours rather than linear data.
    pub fn is_color(self) -> bool {
        matches!(
            self,
            Self::BaseColor
                | Self::Emissive
                | Self::SpecularColor
                | Self::SheenColor
                | Self::DiffuseTransmissionColor
                | Self::ShadeMultiply
                | Self::Matcap
                | Self::RimMultiply
        )
    }
}

/// An animated property of a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LightProperty {
    /// Linear RGB.
    Color,
    /// Lux or candela.
    Intensity,
    /// Metres.
    Range,
    /// Radians; spot lights only.
    InnerCone,
    /// Radians; spot lights only.
    OuterCone,
}

/// An animated property of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CameraProperty {
    /// Vertical field of view of a perspective camera, radians.
    YFov,
    /// Half the height of an orthographic camera's view, metres.
    YMag,
    /// Distance to the near plane, metres.
    Near,
    /// Distance to the far plane, metres.
    Far,
}

impl PropertyTarget {
    /// Number of components of a value, at most four.
    pub fn width(self) -> usize {
        use MaterialProperty::{BaseColor, Emissive, Lobe, Toon, UvOffset, UvScale};
        match self {
            Self::Material(_, Lobe(factor)) => factor.width(),
            Self::Material(_, BaseColor) => 4,
            Self::Material(_, Emissive | Toon(_)) | Self::Light(_, LightProperty::Color) => 3,
            Self::Material(_, UvOffset(_) | UvScale(_)) | Self::LookAt => 2,
            _ => 1,
        }
    }
}

/// The keys of one property, added by [`ClipBuilder::property`](super::ClipBuilder::property).
#[derive(Debug, Clone, PartialEq)]
pub struct PropertyChannel {
    /// What is animated.
    pub target: PropertyTarget,
    /// How values between the keys are computed. Visibility is always STEP.
    pub interpolation: Interpolation,
    /// Index into [`Clip::property_timelines`](super::Clip::property_timelines).
    pub timeline: u32,
    /// [`PropertyTarget::width`] numbers per entry; three entries per key for CUBICSPLINE.
    pub values: Vec<f32>,
}

/// Values of animated properties at one time, in the order of their targets. Reused between frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PropertyValues(Vec<(PropertyTarget, Vec4)>);

impl PropertyValues {
    /// Removes all values.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// All values; components beyond the target's width are 0.
    pub fn iter(&self) -> impl Iterator<Item = (PropertyTarget, Vec4)> + '_ {
        self.0.iter().copied()
    }

    /// Returns the value of a target; `None` if it is not animated.
    pub fn get(&self, target: PropertyTarget) -> Option<Vec4> {
        let at = self.0.binary_search_by_key(&target, |&(target, _)| target).ok()?;
        Some(self.0[at].1)
    }

    /// Adds `delta` to the value of a target, or to `rest` if the target has no value yet.
    pub fn add(&mut self, target: PropertyTarget, rest: Vec4, delta: Vec4) {
        match self.0.binary_search_by_key(&target, |&(target, _)| target) {
            Ok(at) => self.0[at].1 += delta,
            Err(at) => self.0.insert(at, (target, rest + delta)),
        }
    }

    /// Whether any joint's visibility is animated.
    pub fn has_visibility(&self) -> bool {
        self.0.iter().any(|(target, _)| matches!(target, PropertyTarget::Visibility(_)))
    }
}

/// The property channels of a clip.
#[derive(Debug, Clone, Default)]
pub(super) struct Properties {
    pub timelines: Vec<Vec<f32>>,
    /// One per target, sorted: single morph weights come last.
    pub channels: Vec<PropertyChannel>,
    /// Index of the first channel of a morph weight.
    first_weight: usize,
}

impl Properties {
    /// Of several channels for one target, the last is kept.
    pub fn new(timelines: Vec<Vec<f32>>, mut channels: Vec<PropertyChannel>) -> Self {
        // The sort is stable.
        channels.reverse();
        channels.sort_by_key(|channel| channel.target);
        channels.dedup_by_key(|channel| channel.target);
        let is_weight = |channel: &PropertyChannel| matches!(channel.target, PropertyTarget::MorphWeight(..));
        let first_weight = channels.iter().position(is_weight).unwrap_or(channels.len());
        Self { timelines, channels, first_weight }
    }

    /// Adds the channels of another clip for which `map` returns a target.
    pub fn add_mapped(&mut self, other: &Self, map: &dyn Fn(PropertyTarget) -> Option<PropertyTarget>) {
        let start = self.timelines.len() as u32;
        let mut channels = std::mem::take(&mut self.channels);
        channels.extend(other.channels.iter().filter_map(|channel| {
            let timeline = start + channel.timeline;
            Some(PropertyChannel { target: map(channel.target)?, timeline, ..channel.clone() })
        }));
        let mut timelines = std::mem::take(&mut self.timelines);
        timelines.extend(other.timelines.iter().cloned());
        *self = Self::new(timelines, channels);
    }

    /// Replaces the values in `out` with those of all channels except morph weights.
    pub fn sample(&self, time_secs: f32, segments: &mut Vec<u32>, out: &mut PropertyValues) {
        out.clear();
        let put = |target, value| out.0.push((target, value));
        self.sample_some(&self.channels[..self.first_weight], time_secs, segments, put);
    }

    /// Calls `put` with the joint, target and value of each animated morph weight.
    pub fn sample_weights(&self, time_secs: f32, segments: &mut Vec<u32>, mut put: impl FnMut(JointIndex, usize, f32)) {
        self.sample_some(&self.channels[self.first_weight..], time_secs, segments, |target, value| {
            if let PropertyTarget::MorphWeight(joint, target) = target {
                put(joint, target, value.x);
            }
        });
    }

    fn sample_some(
        &self,
        channels: &[PropertyChannel],
        time_secs: f32,
        segments: &mut Vec<u32>,
        mut put: impl FnMut(PropertyTarget, Vec4),
    ) {
        if channels.is_empty() {
            return;
        }
        segments.resize(self.timelines.len(), 0);
        for channel in channels {
            let (times, segment) =
                (&self.timelines[channel.timeline as usize], &mut segments[channel.timeline as usize]);
            *segment = find_segment(times, time_secs, *segment as usize) as u32;
            let at = Segment::new(times, *segment as usize, time_secs);
            let (width, mut value) = (channel.target.width(), [0.0; 4]);
            at.numbers(&channel.values, width, channel.interpolation, &mut value[..width]);
            put(channel.target, Vec4::from(value));
        }
    }
}
