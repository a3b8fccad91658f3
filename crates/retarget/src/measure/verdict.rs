//! Whether a quality figure is good: the limits, in one place. docs/retargeting.md lists them with their reasons.

use super::figures::Figures;
use crate::map::Contacts;

/// What a figure says about a retargeted clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// As close to the source as the two builds allow.
    Good,
    /// Visible next to the source, if at all.
    Acceptable,
    /// Visible by itself, or a sign of a wrong map or rest pose.
    NeedsReview,
}

/// The largest values that are good and acceptable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    good: f64,
    acceptable: f64,
}

const fn limits(good: f64, acceptable: f64) -> Limits {
    Limits { good, acceptable }
}

// Degrees.
const LIMB_DIRECTION_MEAN: Limits = limits(2.0, 5.0);
const LIMB_DIRECTION_MAX: Limits = limits(15.0, 30.0);
/// Where contacts are kept, arms turn away from their source's, by up to 50°.
const KEPT_LIMB_DIRECTION_MEAN: Limits = limits(5.0, 10.0);
const KEPT_LIMB_DIRECTION_MAX: Limits = limits(65.0, 80.0);
const FACING_MEAN: Limits = limits(10.0, 20.0);
const FACING_MAX: Limits = limits(25.0, 40.0);
const ORIENTATION_MEAN: Limits = limits(0.1, 1.0);
const ORIENTATION_MAX: Limits = limits(0.5, 5.0);
/// Slide beyond the source's, in sizes of the model per second.
const FOOT_SLIDE: Limits = limits(0.02, 0.06);
/// Sizes of the model, above the ground or below it.
const FOOT_HOVER: Limits = limits(0.01, 0.025);
const SOLE_PENETRATION: Limits = limits(0.01, 0.04);
const GROUND_PENETRATION: Limits = limits(0.02, 0.05);
/// Sizes of the model.
const CONTACT_ERROR: Limits = limits(0.02, 0.06);
/// Share of the points on limbs.
const SELF_PENETRATION: Limits = limits(0.01, 0.04);
/// Degrees.
pub(super) const FACING_PATH: Limits = limits(20.0, 45.0);
/// Ratios to the lengths as bound.
const SKIN_STRETCH_MAX: Limits = limits(2.5, 5.0);
const SKIN_STRETCH_MEAN: Limits = limits(1.15, 1.3);
/// Share of the chains' lengths that is not mapped.
const UNMAPPED: Limits = limits(0.1, 0.25);

impl Limits {
    pub fn verdict(self, value: f64) -> Verdict {
        match value {
            _ if value <= self.good => Verdict::Good,
            _ if value <= self.acceptable => Verdict::Acceptable,
            _ => Verdict::NeedsReview,
        }
    }
}

/// The verdicts on [`Figures`]; `None` for what cannot be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "named like the members of `Figures`")]
pub struct Verdicts {
    pub limb_direction_error_mean: Option<Verdict>,
    pub limb_direction_error_max: Option<Verdict>,
    pub facing_error_mean: Option<Verdict>,
    pub facing_error_max: Option<Verdict>,
    pub orientation_error_mean: Option<Verdict>,
    pub orientation_error_max: Option<Verdict>,
    pub foot_slide: Option<Verdict>,
    pub ground_penetration: Option<Verdict>,
    pub foot_hover: Option<Verdict>,
    pub sole_penetration: Option<Verdict>,
    pub contact_error: Option<Verdict>,
    pub self_penetration: Option<Verdict>,
    pub facing_path_error: Option<Verdict>,
    pub skin_stretch_max: Option<Verdict>,
    pub skin_stretch_mean: Option<Verdict>,
    pub idle_chains: Option<Verdict>,
    pub coverage: Option<Verdict>,
}

impl Verdicts {
    /// Judges the figures of a model whose largest dimension is this; `contacts` is what was done about them.
    pub fn new(figures: &Figures, size_metres: f64, contacts: Contacts) -> Self {
        let judged = |value: Option<f64>, limits: Limits| value.map(|value| limits.verdict(value));
        let size_metres = size_metres.max(f64::MIN_POSITIVE);
        let sizes = |value: Option<f64>| value.map(|metres| metres.abs() / size_metres);
        let slide = figures.foot_slide_metres_per_sec;
        let source_slide = figures.foot_slide_source_metres_per_sec.unwrap_or_default();
        let (limb_mean, limb_max) = match contacts {
            Contacts::Off => (LIMB_DIRECTION_MEAN, LIMB_DIRECTION_MAX),
            Contacts::Keep => (KEPT_LIMB_DIRECTION_MEAN, KEPT_LIMB_DIRECTION_MAX),
        };
        Self {
            limb_direction_error_mean: judged(figures.limb_direction_error_degrees_mean, limb_mean),
            limb_direction_error_max: judged(figures.limb_direction_error_degrees_max, limb_max),
            facing_error_mean: judged(figures.facing_error_degrees_mean, FACING_MEAN),
            facing_error_max: judged(figures.facing_error_degrees_max, FACING_MAX),
            orientation_error_mean: judged(figures.orientation_error_degrees_mean, ORIENTATION_MEAN),
            orientation_error_max: judged(figures.orientation_error_degrees_max, ORIENTATION_MAX),
            foot_slide: judged(slide.map(|slide| (slide - source_slide) / size_metres), FOOT_SLIDE),
            ground_penetration: judged(sizes(figures.ground_penetration_metres_max), GROUND_PENETRATION),
            foot_hover: judged(sizes(figures.foot_hover_metres_mean), FOOT_HOVER),
            sole_penetration: judged(sizes(figures.sole_penetration_metres_max), SOLE_PENETRATION),
            contact_error: judged(sizes(figures.contact_error_metres_mean), CONTACT_ERROR),
            self_penetration: judged(figures.self_penetration_share, SELF_PENETRATION),
            facing_path_error: judged(figures.facing_path_error_degrees_mean, FACING_PATH),
            skin_stretch_max: judged(figures.skin_stretch_max, SKIN_STRETCH_MAX),
            skin_stretch_mean: judged(figures.skin_stretch_mean, SKIN_STRETCH_MEAN),
            idle_chains: figures.coverage.map(|_| match figures.idle_chains.as_slice() {
                [] => Verdict::Good,
                _ => Verdict::NeedsReview,
            }),
            coverage: judged(figures.coverage.map(|coverage| 1.0 - coverage), UNMAPPED),
        }
    }

    /// Returns the worst of all.
    pub fn worst(&self) -> Option<Verdict> {
        let all = [
            self.limb_direction_error_mean,
            self.limb_direction_error_max,
            self.facing_error_mean,
            self.facing_error_max,
            self.orientation_error_mean,
            self.orientation_error_max,
            self.foot_slide,
            self.ground_penetration,
            self.foot_hover,
            self.sole_penetration,
            self.contact_error,
            self.self_penetration,
            self.facing_path_error,
            self.skin_stretch_max,
            self.skin_stretch_mean,
            self.idle_chains,
            self.coverage,
        ];
        all.into_iter().flatten().max()
    }
}
