//! Names in encodings other than UTF-8.

use std::io::{Cursor, Write};

use encoding_rs::{BIG5, EUC_KR, Encoding, GBK, SHIFT_JIS, WINDOWS_1252};
use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, load, prepare};
use zip::write::SimpleFileOptions;

use crate::build_gltf::one;

/// Names of joints as people write them. In Shift-JIS the second byte of ボ, マ and 表 is `{`, `}` and `\\`.
const NAMES: [(&Encoding, &[&str]); 5] = [
    (
        SHIFT_JIS,
        &[
            "全ての親",
            "センター",
            "上半身",
            "首",
            "頭",
            "左肩",
            "左腕",
            "左ひじ",
            "左手首",
            "右足ＩＫ",
            "ボーン",
            "マント",
            "表情",
            "ソ能",
        ],
    ),
    (GBK, &["骨盆", "脊椎", "颈部", "头", "左大腿", "左小腿", "左脚", "右前臂", "右手", "根骨骼", "腰部", "尾巴"]),
    (BIG5, &["骨盆", "脊椎", "頸部", "頭", "左大腿", "左小腿", "左腳", "右前臂", "右手", "根骨骼", "腰部", "許功蓋"]),
    (
        EUC_KR,
        &["골반", "척추", "목", "머리", "왼쪽허벅지", "왼쪽종아리", "왼발", "오른팔", "오른손", "허리", "가슴", "뼈대"],
    ),
    (WINDOWS_1252, &["Hüfte", "Wirbelsäule", "Schädel", "Ärmel", "tête", "épaule", "señal", "Fuß", "Größe"]),
];

fn encoded(encoding: &'static Encoding, text: &str) -> Vec<u8> {
    let (bytes, used, has_errors) = encoding.encode(text);
    assert!(used == encoding && !has_errors, "{text} in {}", encoding.name());
    bytes.into_owned()
}

fn loaded(name: &str, bytes: Vec<u8>) -> Asset {
    let mut files = one(name, bytes);
    prepare(&mut files).unwrap_or_else(|problem| panic!("{problem}"));
    load(&files).unwrap_or_else(|problem| panic!("{problem}"))
}

/// Checks that files of all text formats with these names load with them.
fn check_names(encoding: &'static Encoding, names: &[&str]) {
    let joints =
        |asset: &Asset| asset.skeleton.joints().map(|joint| asset.skeleton.name(joint).to_owned()).collect::<Vec<_>>();
    let label = encoding.name();

    let nested: String = names.iter().map(|name| format!("JOINT {name}\n{{ OFFSET 0 1 0 CHANNELS 0\n")).collect();
    let bvh = format!("HIERARCHY\nROOT a\n{{ OFFSET 0 0 0 CHANNELS 0\n{nested}{}", "}\n".repeat(names.len() + 1));
    assert_eq!(joints(&loaded("m.bvh", encoded(encoding, &bvh)))[1..], *names, "{label}");

    let frames: String = names.iter().map(|name| format!("Frame {name}{{Frame b{{}}}}\n")).collect();
    let x = loaded("m.x", encoded(encoding, &format!("xof 0303txt 0032\n{frames}")));
    let found: Vec<String> = joints(&x).into_iter().filter(|name| name != "b").collect();
    assert_eq!(found, names, "{label}");

    // Binary names aren't part of a text.
    let mut binary = b"xof 0303bin 0032".to_vec();
    let mut put = |kind: u16, rest: &[u8]| binary.extend([&kind.to_le_bytes(), rest].concat());
    let counted = |name: &[u8]| [&(name.len() as u32).to_le_bytes(), name].concat();
    for name in names {
        put(1, &counted(b"Frame"));
        put(1, &counted(&encoded(encoding, name)));
        put(10, &[]);
        put(11, &[]);
    }
    assert_eq!(joints(&loaded("m.x", binary)), *names, "{label}");

    let faces: String = names.iter().map(|name| format!("usemtl {name}\nf 1 2 3\n")).collect();
    let materials: String = names.iter().map(|name| format!("newmtl {name}\nKd 1 0 0\n")).collect();
    let library = format!("{}.mtl", names[0]);
    let mut files = FileSet::default();
    files.insert("m.obj", encoded(encoding, &format!("mtllib {library}\nv 0 0 0\nv 1 0 0\nv 1 1 0\n{faces}")));
    files.insert(library, encoded(encoding, &materials));
    let asset = load(&files).unwrap_or_else(|problem| panic!("{problem}"));
    let found: Vec<&str> = asset.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!((found, asset.warnings.len()), (names.to_vec(), 0), "{label}");
    assert!(asset.materials.iter().all(|material| material.base_color.x == 1.0));
}

#[test]
fn names_are_decoded() {
    for (encoding, names) in NAMES {
        check_names(encoding, names);
        // However few there are, as long as a person could tell.
        for pair in names.windows(2) {
            check_names(encoding, pair);
        }
    }
}

#[test]
fn single_names_of_a_body_are_decoded() {
    for (encoding, names) in [
        (SHIFT_JIS, &["左腕", "首", "頭", "センター", "右ひざ"][..]),
        (GBK, &["头部", "左手", "右脚", "脊椎"]),
        (BIG5, &["頭", "左手", "右腳", "脊椎"]),
        (EUC_KR, &["머리", "왼손", "오른발", "척추"]),
        (WINDOWS_1252, &["Hüfte", "Ärmel", "tête"]),
    ] {
        names.iter().for_each(|name| check_names(encoding, &[name]));
    }
}

#[test]
fn text_that_is_utf8_but_for_a_character_stays_so() {
    let text = "HIERARCHY\nROOT 左腕\n{ OFFSET 0 0 0 CHANNELS 0 JOINT 頭\n{ OFFSET 0 1 0 CHANNELS 0 JOINT x\n\
                { OFFSET 0 1 0 CHANNELS 0 } } }\n";
    let mut bytes = text.as_bytes().to_vec();
    let at = text.find("x\n").expect("a joint");
    bytes[at] = 0xE4;
    let asset = loaded("m.bvh", bytes);
    assert!(asset.skeleton.find("左腕").is_some() && asset.skeleton.find("頭").is_some());
}

/// Returns an archive whose names are these bytes.
fn zipped(names: &[Vec<u8>]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let placeholder = |index: usize, length: usize| format!("{:_<length$}", char::from(b'A' + index as u8));
    for (index, name) in names.iter().enumerate() {
        writer.start_file(placeholder(index, name.len()), SimpleFileOptions::default()).unwrap();
        writer.write_all(b"x").unwrap();
    }
    let mut bytes = writer.finish().unwrap().into_inner();
    for (index, name) in names.iter().enumerate() {
        let written = placeholder(index, name.len()).into_bytes();
        for at in 0..bytes.len() - written.len() {
            if bytes[at..].starts_with(&written) {
                bytes[at..at + written.len()].copy_from_slice(name);
            }
        }
    }
    bytes
}

#[test]
fn names_in_archives_are_decoded() {
    for (encoding, names) in NAMES.into_iter().filter(|(encoding, _)| *encoding != WINDOWS_1252) {
        let expected: Vec<String> = names.iter().map(|name| format!("{name}.png")).collect();
        let encoded: Vec<Vec<u8>> = expected.iter().map(|name| encoded(encoding, name)).collect();
        let mut files = FileSet::default();
        files.add("m.zip", zipped(&encoded)).unwrap();
        assert_eq!(files.names().collect::<Vec<_>>(), expected, "{}", encoding.name());
    }
    // MS-DOS's: Hüfte, Größe, tête, höhe, Ärmel.
    let names = [&b"H\x81fte"[..], b"Gr\x94\xE1e", b"t\x88te", b"h\x94he", b"\x8Ermel"].map(<[u8]>::to_vec);
    let mut files = FileSet::default();
    files.add("m.zip", zipped(&names)).unwrap();
    assert_eq!(files.names().collect::<Vec<_>>(), ["Hüfte", "Größe", "tête", "höhe", "Ärmel"]);
}
