//! .obj with .skel and .attach: invalid files first, then behaviour. `exercise.rs` has the real files.

use gaitway_character::anim::{Skeleton, Transform};
use gaitway_character::asset::{Asset, Warning};
use gaitway_character::mesh::AlphaMode;
use gaitway_formats::{FileSet, LoadError, LoadOptions, WriteError, convert, load, missing_files, write_model};
use glam::{Vec2, Vec3};

use crate::skeletons::joint;
use crate::write::json_of;

/// A square of two triangles, bound to two joints.
pub const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
pub const TWO_JOINTS: &str = "0 0 0 -1\n0.5 0 0 0\n";
pub const ROWS: &str = "0\n0.25\n1\n0.5\n";

fn set(files: &[(&str, &str)]) -> FileSet {
    let mut set = FileSet::default();
    for (name, text) in files {
        set.insert(*name, text.as_bytes().to_vec());
    }
    set
}

fn exercise(obj: &str, skel: &str, attach: &str) -> Result<Asset, LoadError> {
    load(&set(&[("m.obj", obj), ("m.skel", skel), ("m.attach", attach)]))
}

fn alone(obj: &str) -> Asset {
    load(&set(&[("m.obj", obj)])).unwrap_or_else(|problem| panic!("{problem}\n{obj}"))
}

fn check_error(found: Result<Asset, LoadError>, wanted: [&str; 4]) {
    let [wanted_file, wanted_place, wanted_expected, wanted_found] = wanted;
    match found {
        Err(LoadError::Invalid { file, place, expected, found }) => {
            assert_eq!((file.as_str(), place.as_str()), (wanted_file, wanted_place), "{expected}; {found}");
            assert!(expected.contains(wanted_expected), "{place}: {expected}");
            assert!(found.contains(wanted_found), "{place}: {found}");
        }
        other => panic!("{wanted:?}: {other:?}"),
    }
}

#[test]
fn an_invalid_obj_is_rejected_with_place_and_reason() {
    let cases = [
        ("v 1 2\n", ["m.obj", "line 1", "3 numbers after “v”", "2"]),
        ("v 1 2 3 4 5\n", ["m.obj", "line 1", "4 with a weight", "5"]),
        ("v 0 0 0\nv 1 x 0\n", ["m.obj", "line 2", "finite number", "“x”"]),
        ("v 0 0 0\nv 1 inf 0\n", ["m.obj", "line 2", "finite number", "“inf”"]),
        ("v 0 0 1e60\n", ["m.obj", "line 1", "finite number", "“1e60”"]),
        ("vt\n", ["m.obj", "line 1", "1 to 3 numbers", "none"]),
        ("vn 0 1\n", ["m.obj", "line 1", "3 numbers", "2"]),
        ("v 0 0 0\nf 1 1\n", ["m.obj", "line 2", "at least 3 corners", "2"]),
        ("v 0 0 0\nv 1 0 0\n\nf 1 2 3\n", ["m.obj", "line 4", "one of the 2 vertices", "3"]),
        ("v 0 0 0\nf 1 1 0\n", ["m.obj", "line 2", "counted from 1", "“0”"]),
        ("v 0 0 0\nf 1 1 -2\n", ["m.obj", "line 2", "backwards from -1", "“-2”"]),
        ("v 0 0 0\nf 1/x 1/1 1/1\n", ["m.obj", "line 2", "1/1/1", "“1/x”"]),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", ["m.obj", "line 2", "1/1/1", "“1/1/1/1”"]),
        ("v 0 0 0\nf one two three\n", ["m.obj", "line 2", "1/1/1", "“one”"]),
        ("v 0 0 0\n", ["m.obj", "", "a face", "none"]),
        ("", ["m.obj", "", "a face", "none"]),
    ];
    for (obj, wanted) in cases {
        check_error(load(&set(&[("m.obj", obj)])), wanted);
    }
}

#[test]
fn faces_are_read_without_coordinates_and_normals_that_do_not_exist() {
    let points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n";
    let read = |faces: &str| {
        let asset =
            load(&set(&[("m.obj", &format!("{points}{faces}\n"))])).unwrap_or_else(|problem| panic!("{problem}"));
        let warnings: Vec<String> = asset.warnings.iter().map(ToString::to_string).collect();
        let geometry = &asset.meshes[0].primitives[0];
        ((geometry.uvs.clone(), geometry.normals.clone(), geometry.indices.clone()), warnings)
    };
    for (bad, plain, corners) in [
        ("f 1/4 2/5 3/99", "f 1 2 3", 3),
        ("f 1/0/1 2/0/1 3/0/1", "f 1//1 2//1 3//1", 3),
        ("f 1/-4 2/-9 3/-4", "f 1 2 3", 3),
        ("f 1/1/2 2/2/2 3/3/2", "f 1/1 2/2 3/3", 3),
        ("f 1/1/1 2/2/1 3/3/4294967295", "f 1/1/1 2/2/1 3/3", 1),
        ("f 1/1 2/2 3/4294967296", "f 1/1 2/2 3", 1),
    ] {
        let (found, warnings) = read(bad);
        assert_eq!(found, read(plain).0, "{bad}");
        assert!(warnings.len() == 1 && warnings[0].starts_with(&format!("line 8: {corners} corners")), "{warnings:?}");
    }
    // Coordinates may come after the face.
    assert_eq!(read("f 1/4 2/4 3/4\nvt 0.5 0.5").1, [""; 0]);
}

#[test]
fn material_libraries_may_have_paths_of_windows() {
    let obj = format!("mtllib mat\\my win.mtl\nusemtl red\n{SQUARE}");
    let files = set(&[("m.obj", &obj)]);
    assert!(missing_files(&files).contains(&"mat/my win.mtl".to_owned()), "{:?}", missing_files(&files));
    let asset = load(&set(&[("m.obj", &obj), ("mat/my win.mtl", "newmtl red\nKd 1 0 0\n")])).expect("readable");
    assert_eq!(asset.materials[0].base_color, glam::Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(asset.warnings.len(), 0);
}

#[test]
fn a_query_is_not_part_of_the_name() {
    let obj = "https://example.org/m.obj?path=a/b.c";
    let files = set(&[(obj, SQUARE)]);
    assert_eq!(missing_files(&files), ["m.skel", "m.attach"]);
    let asset = load(&files).unwrap_or_else(|problem| panic!("{problem}"));
    assert_eq!(asset.meshes[0].name, "m");
    let rig = [(&*obj.replace("m.obj", "m.skel"), TWO_JOINTS), (&*obj.replace("m.obj", "m.attach"), ROWS)];
    assert_eq!(missing_files(&set(&[&[(obj, SQUARE)], &rig[..]].concat())), [""; 0]);
    // In a path, folders may be named like this.
    assert_eq!(missing_files(&set(&[("a#1/m.obj", SQUARE)])), ["m.skel", "m.attach"]);
}

#[test]
fn a_model_of_another_hierarchy_cannot_be_written() {
    let files =
        set(&[("m.obj", SQUARE), ("m.skel", "0 0 0 -1\n1 0 0 0\n1 0 0 1\n"), ("m.attach", "0 0\n0 0\n0 0\n0 0\n")]);
    let other = Skeleton::new(vec![
        joint("hips", None, Transform::IDENTITY),
        joint("left", Some(0), Transform::IDENTITY),
        joint("right", Some(0), Transform::IDENTITY),
    ])
    .unwrap();
    let error = write_model(&files, "m.obj", &other, &[]).unwrap_err();
    assert_eq!(error, WriteError::OtherParent { file: "m.obj".to_owned(), joint: "right".to_owned() });
}

#[test]
fn an_invalid_skeleton_is_rejected_with_place_and_reason() {
    let cases = [
        ("", ["m.skel", "line 1", "x y z -1", "the end of the file"]),
        ("0 0 0\n", ["m.skel", "line 1", "4 numbers", "3"]),
        ("0 0 0 -1 7\n", ["m.skel", "line 1", "4 numbers", "more"]),
        ("0 zero 0 -1\n", ["m.skel", "line 1", "finite number", "“zero”"]),
        ("0 nan 0 -1\n", ["m.skel", "line 1", "finite number", "“nan”"]),
        ("0 0 0 0\n", ["m.skel", "line 1", "the first joint has no parent", "“0”"]),
        ("0 0 0 -1\n1 0 0 2\n1 0 0 1\n", ["m.skel", "line 2", "comes before it: 0 to 0", "“2”"]),
        ("0 0 0 -1\n1 0 0 1\n", ["m.skel", "line 2", "comes before it", "“1”"]),
        ("0 0 0 -1\n1 0 0 -2\n", ["m.skel", "line 2", "comes before it", "“-2”"]),
        ("0 0 0 -1\n1 0 0 0.5\n", ["m.skel", "line 2", "the parent of joint 1", "“0.5”"]),
        ("3e38 0 0 -1\n3e38 0 0 0\n", ["m.skel", "joints", "fit into 32 bits", "joint 1"]),
    ];
    for (skel, wanted) in cases {
        check_error(exercise(SQUARE, skel, ROWS), wanted);
    }
}

#[test]
fn invalid_weights_are_rejected_with_place_and_reason() {
    let cases = [
        ("0\n0.25\n1\n", ["m.attach", "line 4", "4 rows", "3 and the end of the file"]),
        ("0\n0.25\n1\n0.5\n0.5\n", ["m.attach", "line 5", "4 rows", "more"]),
        ("0\n0.25 0.5\n1\n0.5\n", ["m.attach", "line 2", "1 weights, one for each joint", "more"]),
        ("0\n0.25\nall\n0.5\n", ["m.attach", "line 3, number 1", "a weight", "“all”"]),
        ("0\n-0.25\n1\n0.5\n", ["m.attach", "line 2, number 1", "0 or more", "“-0.25”"]),
        ("0\n0.25\n1e400\n0.5\n", ["m.attach", "line 3, number 1", "a weight", "“1e400”"]),
    ];
    for (attach, wanted) in cases {
        check_error(exercise(SQUARE, TWO_JOINTS, attach), wanted);
    }
    let three = "0 0 0 -1\n1 0 0 0\n1 0 0 1\n";
    check_error(exercise(SQUARE, three, ROWS), ["m.attach", "line 1", "2 weights", "1"]);
}

#[test]
fn an_incomplete_set_says_what_to_drop() {
    let check = |files: &[(&str, &str)], wanted: &str, missing: &[&str]| {
        let problem = load(&set(files)).expect_err("not complete").to_string();
        assert!(problem.contains(wanted) && problem.contains("open them together"), "{problem}");
        assert_eq!(missing_files(&set(files)), missing);
    };
    check(&[("m.obj", SQUARE), ("m.skel", TWO_JOINTS)], "“m.attach”", &["m.attach"]);
    check(&[("m.obj", SQUARE), ("m.attach", ROWS)], "“m.skel”", &["m.skel"]);
    check(&[("m.skel", TWO_JOINTS), ("m.attach", ROWS)], "“m.obj”", &["m.obj"]);
    let several = load(&set(&[("a.obj", SQUARE), ("b.obj", SQUARE)]));
    assert!(matches!(several, Err(LoadError::SeveralModels { .. })));
}

#[test]
fn companions_are_found_by_stem_or_as_the_only_ones() {
    let joints =
        |files: &[(&str, &str)]| load(&set(files)).map(|asset| asset.skins.first().map(|skin| skin.joints().len()));
    assert_eq!(joints(&[("f/m.obj", SQUARE), ("f/m.skel", TWO_JOINTS), ("f/m.attach", ROWS)]), Ok(Some(2)));
    assert_eq!(joints(&[("M.OBJ", SQUARE), ("m.Skel", TWO_JOINTS), ("M.attach", ROWS)]), Ok(Some(2)));
    assert_eq!(joints(&[("mesh.obj", SQUARE), ("bones.skel", TWO_JOINTS), ("w.attach", ROWS)]), Ok(Some(2)));
    assert_eq!(joints(&[("m.obj", SQUARE)]), Ok(None), "a static model");
    let asset = load(&set(&[("f/m.obj", SQUARE), ("f/M.skel", TWO_JOINTS), ("f/w.attach", ROWS)])).unwrap();
    let told: Vec<String> =
        asset.warnings.iter().map(ToString::to_string).filter(|told| told.contains("differs")).collect();
    assert_eq!(told, ["f/w.attach: used for m.obj, though its name differs: it is the only file of its kind"]);
    // Between two candidates, it doesn't guess.
    assert_eq!(joints(&[("m.obj", SQUARE), ("a.skel", TWO_JOINTS), ("b.skel", "0 0 0 -1")]), Ok(None));
    assert_eq!(missing_files(&set(&[("m.obj", SQUARE)])), ["m.skel", "m.attach"]);
}

#[test]
fn weights_are_normalized_and_unusual_rows_are_reported() {
    let asset = exercise(SQUARE, "0 0 0 -1\n1 0 0 0\n1 0 0 0\n", "0 0\r\n1 3\r\n0.5 0.4999\r\n0.25 0.75").unwrap();
    let of = |vertex| {
        let influences = &asset.meshes[0].primitives[0].influences;
        influences.of_vertex(vertex).filter(|pair| pair.1 > 0.0).collect::<Vec<_>>()
    };
    assert_eq!(of(0), [(0, 1.0)], "a row of zeros follows the first joint");
    assert_eq!(of(1), [(2, 0.75), (1, 0.25)]);
    assert!((of(2).iter().map(|pair| pair.1).sum::<f32>() - 1.0).abs() < 1e-7);
    let warnings: Vec<&Warning> = asset.warnings.iter().collect();
    let mesh = || "m.attach".to_owned();
    // 0.9999 is within a thousandth of 1.
    let wanted = [
        &Warning::WeightsMissing { mesh: mesh(), vertices: 1 },
        &Warning::WeightsNormalized { mesh: mesh(), vertices: 1 },
    ];
    assert_eq!(warnings, wanted);
}

#[test]
fn sixteen_weights_are_kept_and_more_are_reported() {
    let joints = |count: usize| {
        (0..count)
            .map(|joint| if joint == 0 { "0 0 0 -1\n".to_owned() } else { "1 0 0 0\n".to_owned() })
            .collect::<String>()
    };
    let rows = |count: usize| (0..4).map(|_| "1 ".repeat(count) + "\n").collect::<String>();
    let asset = exercise(SQUARE, &joints(17), &rows(16)).unwrap();
    assert_eq!((asset.meshes[0].primitives[0].influences.stride, asset.warnings.len()), (16, 1), "sums are 16, not 1");
    let asset = exercise(SQUARE, &joints(21), &rows(20)).unwrap();
    let dropped = asset.warnings.iter().find(|warning| warning.code() == "influences-dropped");
    assert!(matches!(dropped, Some(Warning::InfluencesDropped { found: 20, kept: 16, .. })));
    let total: f32 = asset.meshes[0].primitives[0].influences.of_vertex(0).map(|pair| pair.1).sum();
    assert!((total - 1.0).abs() < 1e-6);
}

#[test]
fn a_single_joint_needs_no_columns() {
    let asset = exercise(SQUARE, "1 2 3 -1\n", "").unwrap();
    assert_eq!(asset.meshes[0].primitives[0].influences.weights, [1.0, 0.0, 0.0, 0.0].repeat(4));
    check_error(exercise(SQUARE, "1 2 3 -1\n", "1\n"), ["m.attach", "line 1", "0 weights", "more"]);
}

#[test]
fn all_forms_of_a_face_are_equivalent() {
    let head = "# a comment\r\nv 0 0 0\r\nv 1 0 0 1.0\r\nv 1 1 0\r\nvt 0 0\r\nvt 1\r\nvt 1 1 0\r\nvn 0 0 2\r\n";
    for face in [
        "f 1 2 3",
        "f 1/1 2/2 3/3",
        "f 1//1 2//1 3//1",
        "f 1/1/1 2/2/1 3/3/1",
        "f -3/-3/-1 -2/-2/-1 -1/-1/-1 # end",
        "f 1 2 \\\r\n 3",
    ] {
        let asset = alone(&format!("{head}{face}\r\n"));
        let geometry = &asset.meshes[0].primitives[0];
        assert_eq!(geometry.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)], "{face}");
        assert_eq!(geometry.indices, [0, 1, 2], "{face}");
        assert_eq!(asset.warnings.len(), 0, "{face}");
        let slashes = face.matches('/').count();
        assert_eq!(geometry.normals.is_empty(), slashes < 6, "{face}");
        if !geometry.normals.is_empty() {
            assert_eq!(geometry.normals[0], Vec3::Z, "unit length: {face}");
        }
        if face.contains("/1/") || slashes == 3 {
            assert_eq!(
                geometry.uvs[0],
                [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0)],
                "rows from the top"
            );
        }
    }
    // Only negative numbers require the vertices to come first.
    let asset = alone("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n");
    assert_eq!(asset.meshes[0].primitives[0].indices, [0, 1, 2]);
}

/// Twice the signed area of all triangles.
fn area(asset: &Asset) -> Vec3 {
    let geometry = &asset.meshes[0].primitives[0];
    let corners = geometry.indices.as_chunks::<3>().0;
    let at = |index: u32| geometry.positions[index as usize];
    corners.iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a))).sum()
}

#[test]
fn polygons_are_triangulated_without_overlap() {
    // An arrowhead, an L, a star and a comb, in both windings: the triangles' areas have one sign and add up.
    let shapes: [(&[[f32; 2]], f32); 5] = [
        (&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]], 2.0),
        (&[[0., 0.], [2., 0.], [2., 2.], [1.9, 0.1]], 0.4),
        (&[[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]], 6.0),
        (&[[0., 3.], [-0.5, 0.5], [-3., 0.], [-0.5, -0.5], [0., -3.], [0.5, -0.5], [3., 0.], [0.5, 0.5]], 12.0),
        (
            &[
                [0., 0.],
                [5., 0.],
                [5., 3.],
                [4., 3.],
                [4., 1.],
                [3., 1.],
                [3., 3.],
                [2., 3.],
                [2., 1.],
                [1., 1.],
                [1., 3.],
                [0., 3.],
            ],
            22.0,
        ),
    ];
    for (shape, wanted) in shapes {
        for backwards in [false, true] {
            for start in 0..shape.len() {
                let mut corners: Vec<[f32; 2]> = shape.iter().cycle().skip(start).take(shape.len()).copied().collect();
                if backwards {
                    corners.reverse();
                }
                let mut obj: String = corners.iter().map(|[x, y]| format!("v {x} 0 {y}\n")).collect();
                obj.push('f');
                obj.extend((1..=corners.len()).map(|corner| format!(" {corner}")));
                let asset = alone(&obj);
                let geometry = &asset.meshes[0].primitives[0];
                assert_eq!(geometry.triangles(), shape.len() - 2);
                let absolute: f32 = geometry
                    .indices
                    .as_chunks::<3>()
                    .0
                    .iter()
                    .map(|triangle| {
                        let [a, b, c] = triangle.map(|index| geometry.positions[index as usize]);
                        (b - a).cross(c - a).length()
                    })
                    .sum();
                let signed = area(&asset);
                assert!((absolute - signed.length()).abs() < 1e-4, "{shape:?} from {start}: overlaps");
                assert!((signed.length() - wanted).abs() < 1e-4, "{shape:?}: {signed}");
            }
        }
    }
    // Degenerate and self-intersecting polygons yield the same number of triangles.
    assert_eq!(alone("v 0 0 0\nf 1 1 1 1 1\n").meshes[0].primitives[0].triangles(), 3);
    assert_eq!(alone("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n").meshes[0].primitives[0].triangles(), 2);
}

#[test]
fn copies_of_a_vertex_count_as_one_vertex_of_the_file() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 9 9 9\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/2 5/2\n";
    let asset = load(&set(&[("m.obj", obj), ("m.skel", TWO_JOINTS), ("m.attach", "0\n0\n0.5\n1\n1\n")])).unwrap();
    let geometry = &asset.meshes[0].primitives[0];
    assert_eq!((geometry.file_vertices, geometry.positions.len()), (5, 7), "two are copied");
    assert_eq!(geometry.positions[3], Vec3::splat(9.0), "a vertex of no face is kept");
    assert_eq!(geometry.positions[5..], [geometry.positions[0], geometry.positions[2]]);
    assert_eq!(
        geometry.influences.of_vertex(6).collect::<Vec<_>>(),
        geometry.influences.of_vertex(2).collect::<Vec<_>>()
    );
    let numbers: Vec<usize> = (0..7).map(|vertex| geometry.number_in_file(vertex)).collect();
    assert_eq!(numbers, [0, 1, 2, 3, 4, 0, 2]);
    geometry.validate(Some(2)).unwrap();
}

#[test]
fn groups_and_materials_become_primitives_in_file_order() {
    let obj = "mtllib some where.mtl other.mtl\no Body\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\n\
               g front\nusemtl red\nf 1 2 3\ng back\nf 1 3 4\ng front\nf 3 4 1\nusemtl \nf 4 1 2\n";
    let mtl =
        "newmtl red\nKd 1 0 0\nd 0.5\nNs 98\nKs 1 1 1\nmap_Kd -s 1 1 1 -clamp on skin a.png\nnewmtl dull\nKs 0 0 0\n";
    let files = set(&[("m.obj", obj), ("some where.mtl", mtl)]);
    assert_eq!(missing_files(&files), ["m.skel", "m.attach", "other.mtl", "skin a.png"]);
    let asset = load(&files).unwrap();
    let mesh = &asset.meshes[0];
    assert_eq!(mesh.part_names, ["Body / front / red", "Body / back / red", "Body / front"]);
    assert_eq!(mesh.primitives.iter().map(|part| part.triangles()).collect::<Vec<_>>(), [2, 1, 1]);
    assert_eq!(mesh.file_vertex_count(), 5);
    let wanted = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y, Vec3::splat(5.0)];
    let mut seen = [0; 5];
    for part in &mesh.primitives {
        for (vertex, at) in part.positions.iter().enumerate() {
            assert_eq!(*at, wanted[part.number_in_file(vertex)]);
            seen[part.number_in_file(vertex)] += 1;
        }
    }
    assert_eq!(seen, [3, 2, 2, 3, 1], "a copy in each part that has it");
    let red = &asset.materials[mesh.primitives[0].material.unwrap()];
    assert_eq!((red.name.as_str(), red.base_color.to_array()), ("red", [1.0, 0.0, 0.0, 0.5]));
    assert_eq!(red.alpha_mode, AlphaMode::Blend);
    assert!((red.roughness - 0.02_f32.sqrt()).abs() < 1e-6);
    let codes: Vec<&str> = asset.warnings.iter().map(Warning::code).collect();
    assert_eq!(codes, ["materials-missing", "image-missing"]);
}

#[test]
fn vertex_colours_are_read_and_unread_statements_reported() {
    let asset = alone("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0.5 0.5 0.5\nf 1 2 3\nl 1 2\ncurv 1 2\ns off\n");
    let colors = &asset.meshes[0].primitives[0].colors;
    assert_eq!(colors[0].to_array(), [1.0, 0.0, 0.0, 1.0]);
    assert!((colors[2].x - 0.21404).abs() < 1e-4, "sRGB: {}", colors[2].x);
    let codes: Vec<&str> = asset.warnings.iter().map(Warning::code).collect();
    assert_eq!(codes, ["obj-statement", "obj-statement"]);
    assert!(alone("v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n").meshes[0].primitives[0].colors.is_empty());
}

/// Each primitive has its own copy of a name, so long ones must not be kept.
#[test]
fn long_names_are_truncated() {
    let long = "ä".repeat(1 << 19);
    let mut obj = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\no {long}\nusemtl {long}\n");
    obj.extend((0..4096).map(|part| format!("g {part}\nf 1 2 3\n")));
    let asset = load(&set(&[("m.obj", &obj), ("m.mtl", &format!("newmtl {long}\nKd 1 0 0\n"))])).unwrap();
    let names = &asset.meshes[0].part_names;
    assert_eq!((names.len(), names[4095].len()), (4096, 256 + 256 + 10));
    assert!(names.iter().all(|name| name.starts_with(&"ä".repeat(128))));
    assert_eq!(
        (asset.materials.len(), asset.materials[0].base_color.x),
        (1, 1.0),
        "found by the same part of its name"
    );
    let codes: Vec<&str> = asset.warnings.iter().map(Warning::code).collect();
    assert_eq!(codes, ["obj-name", "obj-name"]);
}

#[test]
fn the_number_of_referenced_files_is_bounded() {
    let mut obj: String = (0..50_000).map(|library| format!("mtllib {library}.mtl\n")).collect();
    obj.push_str(SQUARE);
    let asset = alone(&obj);
    let count = |code: &str| asset.warnings.iter().filter(|warning| warning.code() == code).count();
    assert_eq!((count("materials-missing"), count("obj-libraries") > 0), (64, true));
    let missing = missing_files(&set(&[("m.obj", &obj)]));
    assert_eq!((missing.len(), missing[2].as_str()), (2 + 64, "0.mtl"));
    let pictures: String = (0..50_000).map(|name| format!("newmtl {name}\nmap_Kd {name}.png\n")).collect();
    let missing = missing_files(&set(&[("m.obj", "mtllib m.mtl\n"), ("m.mtl", &pictures)]));
    assert_eq!(missing.len(), 2 + 512);
    // With more models than any real scene, companions are not looked up.
    let mut many = FileSet::default();
    for model in 0..5000 {
        many.insert(format!("{model}.obj"), SQUARE.as_bytes().to_vec());
    }
    assert_eq!(missing_files(&many), [""; 0]);
}

#[test]
fn webp_images_are_written_with_their_extension() {
    // One pixel.
    let webp = b"RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07\0";
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl skin\nf 1/1 2/1 3/1\n";
    let mut files = set(&[("m.obj", obj), ("m.mtl", "newmtl skin\nmap_Kd skin.webp\n")]);
    files.insert("skin.webp", webp.to_vec());
    let written = convert(&files, &LoadOptions::default()).unwrap();
    let json = json_of(&written);
    assert_eq!(json["images"][0]["mimeType"], "image/webp");
    assert_eq!(json["textures"], serde_json::json!([{ "extensions": { "EXT_texture_webp": { "source": 0 } } }]));
    for key in ["extensionsUsed", "extensionsRequired"] {
        assert_eq!(json[key], serde_json::json!(["EXT_texture_webp"]), "{key}");
    }
    files = FileSet::default();
    files.insert("written.glb", written);
    let asset = load(&files).unwrap();
    assert_eq!((asset.warnings.len(), asset.textures[0].image, asset.images[0].width), (0, Some(0), 1));
    let other = set(&[("m.obj", SQUARE)]);
    assert!(json_of(&convert(&other, &LoadOptions::default()).unwrap())["extensionsUsed"].is_null());
}
