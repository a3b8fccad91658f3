//! One loaded file with its decoded images.

use std::sync::Arc;

use super::ImageData;
use crate::asset::Asset;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct ModelId(pub u64);

#[derive(Debug)]
pub struct Model {
    /// Given by the library.
    pub id: ModelId,
    /// File name, URL or `sample:NAME`, as the link writes it.
    pub source: String,
    pub asset: Arc<Asset>,
    /// One per image of the asset; none where it could not be decoded (a warning says why).
    pub images: Vec<Option<ImageData>>,
}

impl Model {
    pub fn new(source: String, asset: Asset, images: Vec<Option<ImageData>>) -> Self {
        Self { id: ModelId::default(), source, asset: Arc::new(asset), images }
    }
}
