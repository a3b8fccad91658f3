//! The one colour that glyphs are drawn in.

use std::marker::PhantomData;

/// The sRGB colour space.
#[derive(Debug, Clone, Copy)]
pub enum Srgb {}

/// A colour without transparency. Only white is supported.
#[derive(Debug, Clone, Copy)]
pub struct OpaqueColor<Space>(PhantomData<Space>);

impl OpaqueColor<Srgb> {
    /// White.
    pub const WHITE: Self = Self(PhantomData);
}
