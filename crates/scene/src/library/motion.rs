//! Files that clips are borrowed from.

use std::sync::{Arc, OnceLock};

use gaitway_character::asset::{Asset, Humanoid};
use gaitway_retarget::{Body, Recognized, recognize};

use super::{Model, ModelFiles, ModelId, MotionId};

/// A loaded file whose clips a model can borrow.
#[derive(Debug, Clone)]
pub struct Motion {
    /// See [`Model::source`].
    pub source: String,
    /// See [`Model::origin`].
    pub origin: String,
    /// See [`Model::is_own`].
    pub is_own: bool,
    /// The file's content.
    pub asset: Arc<Asset>,
    /// The files it was read from. `None` for generated samples.
    pub files: Option<ModelFiles>,
    /// Humanoid slots recognized in `asset`; empty if it is not a human body.
    pub slots: Humanoid,
    recognized: Arc<Recognized>,
    /// Assigned by the library.
    pub(super) id: MotionId,
    /// Assigned by the library.
    pub(super) stage_id: ModelId,
    stage: Arc<OnceLock<Model>>,
}

impl Motion {
    /// Wraps an asset and recognizes its humanoid slots. The origin is the source until the caller sets another.
    pub fn new(source: String, asset: Arc<Asset>) -> Self {
        let recognized = recognize(&asset);
        Self {
            origin: source.clone(),
            is_own: false,
            source,
            asset,
            files: None,
            slots: recognized.humanoid(),
            recognized: Arc::new(recognized),
            id: MotionId::default(),
            stage_id: ModelId::default(),
            stage: Arc::default(),
        }
    }

    /// A model's file, to borrow its clips.
    pub fn of_model(model: &Model, files: Option<ModelFiles>) -> Self {
        let motion = Self::new(model.source.clone(), model.asset.clone());
        Self { origin: model.origin.clone(), is_own: model.is_own, files, ..motion }
    }

    /// The file as a model without images, to show beside the target; built on first use.
    pub fn stage(&self) -> &Model {
        self.stage.get_or_init(|| {
            let images = vec![None; self.asset.images.len()];
            let mut model = Model::new(self.source.clone(), self.asset.clone(), images);
            model.id = self.stage_id;
            model
        })
    }

    /// Identifies [`Self::stage`]. Unique among all motions that the library has ever held, so also among those with the same
    /// identity.
    pub fn stage_id(&self) -> ModelId {
        self.stage_id
    }

    /// What was recognized in the asset.
    pub fn recognition(&self) -> &Recognized {
        &self.recognized
    }

    /// Its identity among the motions of a library, which a motion opened again takes over. Unspecified until it is in a library.
    pub fn id(&self) -> &MotionId {
        &self.id
    }

    /// Returns the asset with its humanoid slots, as the source of a retarget.
    pub fn body(&self) -> Body<'_> {
        Body { asset: &self.asset, slots: &self.slots }
    }
}

/// Hashes the joint names of two skeletons in the order of their files (FNV-1a), to tell pairs of skeletons apart.
pub fn names_checksum(model: &Asset, motion: &Asset) -> u32 {
    let mut hash = 0x811c_9dc5_u32;
    let mut take = |byte: u8| hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    for skeleton in [&model.skeleton, &motion.skeleton] {
        for joint in (0..skeleton.len()).filter_map(|source| skeleton.joint_of_source(source)) {
            skeleton.name(joint).bytes().for_each(&mut take);
            take(0);
        }
        take(1);
    }
    hash
}
