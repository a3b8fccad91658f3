//! Sizes and locations in the design space of a variable font, of which there is only one.

/// The size to which glyphs are scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size(Option<f32>);

impl Size {
    /// Pixels per em.
    pub fn new(pixels_per_em: f32) -> Self {
        Self(Some(pixels_per_em))
    }

    /// Font units.
    pub fn unscaled() -> Self {
        Self(None)
    }

    /// Pixels (or font units) in a font unit.
    pub(crate) fn scale(self, units_per_em: u16) -> f32 {
        self.0.map_or(1.0, |pixels| pixels / f32::from(units_per_em.max(1)))
    }
}

/// A location in the design space.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Location;

impl Location {
    /// Its coordinates: none.
    pub fn coords(&self) -> &[i16] {
        &[]
    }
}

/// A borrowed [`Location`].
#[derive(Debug, Clone, Copy, Default)]
pub struct LocationRef<'a>(std::marker::PhantomData<&'a ()>);

impl<'a> LocationRef<'a> {
    /// Its coordinates: none.
    pub fn coords(&self) -> &'a [i16] {
        &[]
    }
}

impl<'a> From<&'a Location> for LocationRef<'a> {
    fn from(_location: &'a Location) -> Self {
        Self::default()
    }
}
