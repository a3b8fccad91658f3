//! The active material variant.

use super::{NameKind, UnknownName, ViewerState};
use crate::library::Model;

/// Returns the index of the active material variant; `None` for the file's own materials or an unknown name.
pub fn active_variant(model: &Model, state: &ViewerState) -> Option<usize> {
    let name = state.character.edits.variant.as_ref()?;
    model.asset.variants.iter().position(|known| known == name)
}

/// Returns the variant that the state names and the model lacks.
pub(super) fn unknown_variant(model: &Model, state: &ViewerState) -> Option<UnknownName> {
    let name = state.character.edits.variant.clone().filter(|_| active_variant(model, state).is_none())?;
    Some(UnknownName { kind: NameKind::Variant, name, names: model.asset.variants.clone() })
}
