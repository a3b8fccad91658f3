//! The character that the page rehearses with: a failure to open it would go unnoticed.

use gaitway_formats::{FileSet, load};
use gaitway_scene::samples::rehearsal_files;

#[test]
fn the_rehearsals_character_has_what_most_characters_have() {
    let mut files = FileSet::default();
    rehearsal_files().into_iter().for_each(|(name, bytes)| files.insert(name, bytes));
    let asset = load(&files).unwrap();
    assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
    assert_eq!(asset.clips.len(), 1);
    let geometry = &asset.meshes[0].primitives[1];
    assert_eq!((geometry.positions.len(), geometry.file_vertices, geometry.tangents.len()), (1024, 1024, 1024));
    assert_eq!(asset.instances.iter().filter(|instance| instance.skin.is_some()).count(), 1);
    let maps = |index: usize| {
        let material = &asset.materials[index];
        (material.base_color_texture.is_some(), material.normal_texture.is_some())
    };
    assert_eq!([maps(0), maps(1)], [(true, false), (true, true)]);
    // A smaller image gets no mip levels, and the pipeline that makes them would be compiled only with the first real image.
    assert!(asset.images[0].width >= 8);
}
