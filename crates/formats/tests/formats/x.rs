//! DirectX .x: the coursework's files move like the GLBs that another program made from them. parts/x tests what a file
//! means.

use std::path::Path;

use gaitway_character::anim::{Clip, SampleCursor, model_from_joint};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{DeformedVertices, Geometry, SkinningMode, deform, palette_entry, write_palette};
use gaitway_formats::{FileSet, Part, load, missing_files, next_preparation, prepare};
use glam::{Affine3A, Vec3};

use crate::build_gltf::one;
use crate::data_folder::data_folder;
use crate::file_set::file_set;

/// Relative to the model's size. The GLBs have six digits.
const TOLERANCE: f32 = 1e-4;
/// Fractions of a clip that rarely coincide with a key.
const MOMENTS: [f32; 6] = [0.0, 0.0137, 0.2911, 0.5177, 0.7313, 0.983];

/// All joints and vertices at one moment.
struct Moment {
    joints: Vec<(String, Affine3A)>,
    primitives: Vec<DeformedVertices>,
}

impl Moment {
    fn of(asset: &Asset, clip: Option<(&Clip, f32)>) -> Moment {
        let mut pose = asset.skeleton.rest().clone();
        if let Some((clip, time_secs)) = clip {
            clip.sample(&asset.skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
        }
        let mut worlds = Vec::new();
        model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut worlds);
        let joints = asset.skeleton.joints().map(|joint| (asset.skeleton.name(joint).to_owned(), worlds[joint.get()]));
        let mut primitives = Vec::new();
        for instance in &asset.instances {
            let mut palette = Vec::new();
            match instance.skin {
                Some(skin) => write_palette(&asset.skins[skin], &worlds, SkinningMode::Linear, &mut palette),
                None => palette.push(palette_entry(&worlds[instance.joint.get()], SkinningMode::Linear)),
            }
            for geometry in &asset.meshes[instance.mesh].primitives {
                let mut deformed = DeformedVertices::default();
                deform(geometry, &[], &palette, SkinningMode::Linear, &mut deformed);
                primitives.push(deformed);
            }
        }
        Moment { joints: joints.collect(), primitives }
    }

    fn size(&self) -> f32 {
        let positions = || self.primitives.iter().flat_map(|vertices| &vertices.positions);
        let (low, high) = (positions().copied().reduce(Vec3::min), positions().copied().reduce(Vec3::max));
        (high.unwrap_or_default() - low.unwrap_or_default()).max_element()
    }
}

/// Compares joints by their names, and the corners of triangles in their order, which says which side is the front.
fn check(what: &str, [found, expected]: [&Moment; 2], [own, other]: [&Asset; 2]) {
    let tolerance = TOLERANCE * expected.size();
    let mut unmatched: Vec<_> = expected.joints.iter().collect();
    for (name, world) in &found.joints {
        // Joints with the same name are matched in order.
        let at = unmatched.iter().position(|(other, _)| other == name).unwrap_or_else(|| panic!("{what}: {name}"));
        let (_, other) = unmatched.remove(at);
        let moved = world.translation.distance(other.translation);
        assert!(moved < tolerance, "{what}: joint {name} is {moved} off");
        assert!(world.matrix3.abs_diff_eq(other.matrix3, TOLERANCE), "{what}: joint {name} is turned");
    }
    assert!(unmatched.is_empty(), "{what}: {unmatched:?}");
    let geometries = |asset: &Asset| -> Vec<Geometry> {
        asset.instances.iter().flat_map(|instance| asset.meshes[instance.mesh].primitives.clone()).collect()
    };
    let (own, other) = (geometries(own), geometries(other));
    assert_eq!(own.len(), other.len(), "{what}");
    for (at, (own, other)) in own.iter().zip(&other).enumerate() {
        check_triangles(what, [own, other], [&found.primitives[at], &expected.primitives[at]], tolerance);
    }
}

fn check_triangles(what: &str, geometries: [&Geometry; 2], vertices: [&DeformedVertices; 2], tolerance: f32) {
    let triangles = geometries.map(|geometry| geometry.indices.as_chunks::<3>().0);
    assert_eq!(triangles[0].len(), triangles[1].len(), "{what}");
    let uv = |side: usize, vertex: u32| geometries[side].uvs[0][vertex as usize];
    for (number, (own, other)) in triangles[0].iter().zip(triangles[1]).enumerate() {
        let off = |rotated: [u32; 3]| -> f32 {
            let corners = rotated.iter().zip(other).map(|(&a, &b)| {
                let normals = vertices[0].normals[a as usize].distance(vertices[1].normals[b as usize]);
                let uvs = uv(0, a).distance(uv(1, b));
                let positions = vertices[0].positions[a as usize].distance(vertices[1].positions[b as usize]);
                positions.max((normals / 10.0).max(uvs) * tolerance / TOLERANCE)
            });
            corners.fold(0.0, f32::max)
        };
        let [a, b, c] = *own;
        let best = [[a, b, c], [b, c, a], [c, a, b]].map(off).into_iter().fold(f32::INFINITY, f32::min);
        assert!(best < tolerance, "{what}: triangle {number} is {best} off");
    }
}

/// A .x file with the images beside it.
fn read(path: &Path) -> (FileSet, Asset) {
    let mut files = file_set(path);
    // Its references are known only once it is converted.
    for name in missing_files(&files) {
        if let Ok(bytes) = std::fs::read(path.with_file_name(&name)) {
            files.insert(name, bytes);
        }
    }
    let asset = load(&files).unwrap_or_else(|problem| panic!("{}: {problem}", path.display()));
    (files, asset)
}

fn check_real(original: &str, converted: &str, clips: usize, images: &[&str], missing: &[&str]) {
    let Some(data) = data_folder() else { return };
    let (files, own) = read(&data.join(original));
    let other = load(&file_set(&data.join(converted))).unwrap();
    assert_eq!((own.format, own.clips.len(), other.clips.len()), ("x", clips, clips));
    let (rest, other_rest) = (Moment::of(&own, None), Moment::of(&other, None));
    check("the rest pose", [&rest, &other_rest], [&own, &other]);
    for (clip, other_clip) in own.clips.iter().zip(&other.clips) {
        assert_eq!(clip.name(), other_clip.name());
        assert!((clip.duration_secs() - other_clip.duration_secs()).abs() < 1e-5, "{}", clip.name());
        for moment in MOMENTS {
            let time_secs = moment * clip.duration_secs();
            let [found, expected] =
                [(&own, clip), (&other, other_clip)].map(|(asset, clip)| Moment::of(asset, Some((clip, time_secs))));
            check(&format!("{} at {time_secs} s", clip.name()), [&found, &expected], [&own, &other]);
        }
    }
    let found: Vec<&str> = files.names().filter(|name| !name.ends_with(".x")).collect();
    assert_eq!(found, images, "textures are found by their base names");
    assert_eq!(missing_files(&files), missing);
}

#[test]
fn the_pilot_moves_like_its_converted_model() {
    let images = ["body01.png", "head01.png", "m4tex.png"];
    check_real("cosc422/original/ArmyPilot/ArmyPilot.x", "cosc422/ArmyPilot.glb", 20, &images, &[]);
}

#[test]
fn the_dwarf_moves_like_its_converted_model() {
    let images = ["axe.jpg", "dwarf.jpg"];
    check_real("cosc422/original/Dwarf/dwarf.x", "cosc422/dwarf.glb", 1, &images, &["dwarf2.jpg"]);
}

#[test]
fn a_file_is_known_by_its_content_or_its_extension() {
    for (name, bytes) in [("download", &b"xof 0303txt 0032"[..]), ("A.X", b"anything")] {
        let files = one(name, bytes.to_vec());
        assert_eq!(next_preparation(&files).unwrap().unwrap().part, Part::X, "{name}");
        let problem = load(&files).unwrap_err().to_string();
        assert!(problem.contains("`prepare`"), "{problem}");
    }
}

#[test]
fn only_a_gltf_has_an_original() {
    let mut files = one("a.x", b"xof 0303txt 0032 Frame root { }".to_vec());
    prepare(&mut files).unwrap();
    assert!(files.get("a.x").unwrap().starts_with(b"glTF"));
    assert_eq!(files.original("a.x"), None);
}
