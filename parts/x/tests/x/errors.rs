//! Files that can't be read: each error says where, what was expected and what was found.

use crate::encode::{binary, container, packed, text};
use crate::meaning::CHARACTER;

#[track_caller]
fn check(file: &[u8], expected: &[&str]) {
    let problem = gaitway_x::convert(file).unwrap_err();
    for part in expected {
        assert!(problem.contains(part), "“{part}” is not in: {problem}");
    }
    assert!(problem.contains("expected ") && problem.contains("found ") && problem.ends_with('.'), "{problem}");
}

#[test]
fn headers() {
    check(b"", &["16 bytes", "found nothing"]);
    check(b"xof 0303txt", &["16 bytes"]);
    check(b"xog 0303txt 0032", &["\"xof \"", "\"xog \""]);
    check(b"xof 0402txt 0032", &["version 03.02 or 03.03", "\"0402\""]);
    check(b"xof 0303com 0032", &["\"bzip\"", "\"com \""]);
    check(b"xof 0303txt 0016", &["\"0064\"", "\"0016\""]);
    check(b"xof 0303txt 0032", &["nothing to show", "frames, meshes or animations"]);
}

#[test]
fn objects() {
    for (objects, expected) in [
        ("Frame a {\n Frame b {\n }", &["line 4", "\"}\" at the end of Frame \"a\" (line 2)", "cut short"][..]),
        ("}", &["an object", "\"}\""]),
        ("\n12;", &["line 3", "an object", "numbers"]),
        ("Frame a b { }", &["\"{\" after \"Frame\"", "\"b\""]),
        ("Frame a { { b c } }", &["a reference", "\"c\""]),
        ("template a {", &["the end of a template"]),
        ("Frame a { \"b }", &["quotation mark"]),
        ("Frame a { <b }", &["GUID"]),
        (
            "Frame a { FrameTransformMatrix {\n 1.0; } }",
            &["FrameTransformMatrix (line 2)", "16 numbers for a matrix", "1 at its end"],
        ),
        ("Mesh m { 5; 0.0;0.0;0.0;; 0; }", &["Mesh \"m\" (line 2)", "5 vertices", "4 numbers"]),
        ("Mesh m { -1; }", &["number of vertices", "negative"]),
        ("Mesh m { 1.5; }", &["number of vertices", "fraction"]),
        ("Mesh m { 1; 0.0;0.0;0.0;; 1; 3; 0,0,1; }", &["an index, a whole number of at most 0", "found 1"]),
        ("Mesh m { 0; 1; 1; 0; }", &["vertices for its faces", "none"]),
        (
            "Mesh m { 0; 0; MeshMaterialList { 1; 1; 0; Material { 1.0; } } }",
            &["Material (line 2)", "4 numbers for a colour"],
        ),
        (
            "Frame a { } AnimationSet { Animation { AnimationKey { 7; } } }",
            &["AnimationKey (line 2)", "kind", "found 7"],
        ),
        ("Frame a { } AnimationSet { Animation { AnimationKey { 2; 9; 0; 3; 1.0; } } }", &["9 keys", "3 numbers"]),
        (
            "Frame a { } AnimationSet { Animation { { a } AnimationKey { 2; 1; 0; 2; 1.0; 1.0; 1.0; } } }",
            &["3 values", "found 2"],
        ),
    ] {
        check(&text(objects), expected);
    }
    check(&text(&"Frame a { ".repeat(1002)), &["at most 1000 objects inside each other"]);
    let long = gaitway_x::convert(&text(&format!("Frame {} {{", "a".repeat(10_000)))).unwrap_err();
    assert!(long.len() < 400, "{long}");
    check(&text("Mesh { 4294967295; } "), &["4294967295 vertices"]);
    let weights = "Frame j { } Mesh { 1;0.0;0.0;0.0;;0; SkinWeights { \"j\"; 1; 1; 1.0; 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;; } }";
    check(&text(weights), &["mesh's 1 vertices"]);
}

#[test]
fn tokens() {
    let with = |bytes: &[u8]| [b"xof 0303bin 0032", bytes].concat();
    check(&with(&[9, 0]), &["byte 16", "unknown one, 9"]);
    check(&with(&[1, 0, 5, 0, 0, 0, b'a']), &["5 bytes", "1, then the end"]);
    check(&with(&[1, 0, 255, 255, 255, 255]), &["4294967295 bytes"]);
    check(&with(&[7, 0, 255, 255, 255, 255]), &["bytes", "0, then the end"]);
    check(&with(&[12, 0]), &["an object", "a declaration"]);
    let whole = binary("Frame a { Frame b { } }", 4);
    for length in 17..whole.len() {
        // An odd byte is padding.
        if length != 17 {
            check(&whole[..length], &[]);
        }
    }
}

#[test]
fn blocks() {
    let whole =
        packed(&binary(&CHARACTER.lines().skip(3).collect::<Vec<_>>().join("\n").replace("{ # another", "{"), 4));
    for length in [17, 19, 20, 21, 25, 40, whole.len() / 2, whole.len() - 1] {
        check(&whole[..length], &["damaged at"]);
    }
    let mut other = whole.clone();
    other[24] = b'X';
    check(&other, &["byte 20", "\"CK\""]);
    let header = b"xof 0303txt 0032";
    let file = |size: usize, stream: Vec<u8>| container(header, 16 + size, [(size, stream)].into_iter());
    let stream = miniz_oxide::deflate::compress_to_vec(b"Frame a { }", 6);
    check(&file(10, stream.clone()), &["a block of 10 bytes"]);
    check(&file(12, stream), &["a block of 12 bytes", "only 11"]);
    check(&file(3, vec![7]), &["a block of 3 bytes", "only 0"]);
    // A distance that reaches before the beginning.
    check(&file(3, vec![0b0000_0011, 0b0000_0010, 0]), &["a block of 3 bytes", "only 0"]);
}
