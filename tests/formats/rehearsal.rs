//! The character that the page rehearses with: a failure to open it would go unnoticed.

use gaitway::formats::{FileSet, load};

#[test]
fn the_rehearsals_character_has_what_most_characters_have() {
    let mut files = FileSet::default();
    files.insert("rehearsal.gltf", include_bytes!("../../src/web/rehearsal.gltf").to_vec());
    let asset = load(&files).unwrap();
    assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
    assert_eq!(asset.clips.len(), 1);
    assert_eq!(asset.instances.iter().filter(|instance| instance.skin.is_some()).count(), 1);
    let maps = |index: usize| {
        let material = &asset.materials[index];
        (material.base_color_texture.is_some(), material.normal_texture.is_some())
    };
    assert_eq!([maps(0), maps(1)], [(true, false), (true, true)]);
}
