//! Feeds damaged files to the fuzz targets' entry points, since `cargo fuzz` needs a nightly toolchain and runs for
//! hours. `GAITWAY_FUZZ_SECS` sets a longer time per entry point, and `GAITWAY_FUZZ` chooses one.

use std::io::{Cursor, Write};
use std::panic::catch_unwind;
use std::time::Instant;

use gaitway_formats::{Part, load, prepare};
use gaitway_ktx2::{Formats, request};
use zip::write::SimpleFileOptions;

use crate::build_gltf::{Build, one};
use crate::compressed::{draco, meshopt};
use crate::data_folder::data_folder;
use crate::memory::peak_of;
use crate::mutation::{REAL, damage, generated};
use crate::numpy::{npz, person, stored};
use crate::random::Random;

#[path = "../../fuzz/entries.rs"]
mod entries;

/// Damaged files for each reader by default, and for what follows reading, which takes longer.
const CASES: usize = 1000;
const PIPELINE_CASES: usize = 150;

/// No input takes this long, even without optimization, or as much memory.
const MAX_SECS: f64 = 10.0;
const MAX_BYTES: usize = 1 << 30;

const EXERCISE: &[u8] = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0.3 0.3 0\nvt 0 0\nvn 0 0 1\ng a\nusemtl red\n\
    f 1/1/1 2/1/1 3/1/1 4/1/1\no b\nf -4 -3 -1\n\xFF0 0 0 -1\n0.5 0 0 0\n0 1 0 1\n\xFF0 0\n0.25 0.75\n1 0\n0.5 0.4\n\xFF\
    newmtl red\nKd 1 0.5 0\nd 0.5\nNs 10\nmap_Kd -s 1 1 1 skin.png\n";
const X: &str =
    "Frame a { FrameTransformMatrix { 1,0,0,0, 0,1,0,0, 0,0,1,0, 0,2,0,1;; } Mesh { 4; 0;0;0;,0;1;0;,1;1;0;,1;0;0;;
    1; 4;0,1,2,3;; MeshNormals { 1; 0;0;-1;; 1; 4;0,0,0,0;; } MeshTextureCoords { 4; 0;0;,0;1;,1;1;,1;0;; }
    MeshMaterialList { 1; 1; 0; Material m { 1;0;0;1;; 8; 1;1;1;; 0;0;0;; TextureFilename { \"a.png\"; } } }
    SkinWeights { \"a\"; 2; 0,2; 0.5,0.25; 1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1;; } } }
    AnimTicksPerSecond { 30; } AnimationSet s { Animation { { a } AnimationKey { 0; 2; 0;4;1,0,0,0;;,9;4;0,1,0,0;;; }
    AnimationKey { 2; 2; 0;3;0,0,0;;,9;3;1,2,3;;; } } }";
/// A joint that turns.
const FBX: &str = "; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n\
    Objects: {\nModel: 1, \"Model::Hips\", \"LimbNode\" {\nVersion: 232\n}\n\
    AnimationStack: 2, \"AnimStack::Turn\", \"\" {\nProperties70: {\n\
    P: \"LocalStop\", \"KTime\", \"Time\", \"\",46186158000\n}\n}\n\
    AnimationLayer: 3, \"AnimLayer::Base\", \"\" {\n}\nAnimationCurveNode: 4, \"AnimCurveNode::R\", \"\" {\n}\n\
    AnimationCurve: 5, \"AnimCurve::\", \"\" {\nKeyVer: 4008\nKeyTime: *2 {\na: 0,46186158000\n}\n\
    KeyValueFloat: *2 {\na: 0,90\n}\nKeyAttrFlags: *1 {\na: 4\n}\nKeyAttrDataFloat: *4 {\na: 0,0,0,0\n}\n\
    KeyAttrRefCount: *1 {\na: 2\n}\n}\n}\nConnections: {\nC: \"OO\",1,0\nC: \"OO\",3,2\nC: \"OO\",4,3\n\
    C: \"OP\",4,1, \"Lcl Rotation\"\nC: \"OP\",5,4, \"d|Z\"\n}\n";
const MAP: &[u8] = br##"{"gaitway_map":1,"joints":{"spine":{"source":"neck"},"#3":{"source":5,"correction":[0,0,0,1]},
    "middle":{"source":null,"unmapped":{"clip":0,"hold":"first-key"}}},"unmapped":"rest","rest":{"model":"auto","motion":"bind"},
    "root":{"horizontal":"keep","vertical":"in-place","yaw":"freeze","extract":true,"origin":"feet"},
    "translations":"auto","scales":"drop","muted_channels":[{"source":"hips","property":"translation"}],"feet":"plant",
    "contacts":"keep","crossfade_secs":0.5}"##;
const LINK: &[u8] = b"v=1&model=sample:pilot&motion=https://example.org/walk.bvh&clip=Run&t=0.5&play=0&speed=2&loop=once&\
    range=0.1,0.9&skinning=rigid&morph=0:1&pose=3:10,20,30&show=skeleton,grid&camera=90,10,4,0,1,0&fov=35&map=1.ffffffff.0-5,1-&\
    zoo=1%262&up=z&exposure=1.5&background=ff8800";

/// The links whose meaning crates/scene/tests/scene fixes, which together have most keys, and one with invalid parts.
fn links() -> Vec<Vec<u8>> {
    let fixtures: serde_json::Value =
        serde_json::from_str(include_str!("../../crates/scene/tests/scene/links.json")).expect("JSON");
    let links = fixtures["links"].as_array().expect("a list").iter().map(|fixture| &fixture["link"]);
    links.map(|link| link.as_str().expect("a text").as_bytes().to_vec()).chain([LINK.to_vec()]).collect()
}

/// Two rows of eight pixels, component by component, and one in the old encoding.
const HDR: &[u8] = b"#?RADIANCE\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 8\n\
    \x02\x02\x00\x08\x88\x80\x08\x01\x02\x03\x04\x05\x06\x07\x08\x83\x00\x85\x40\x88\x81\
    \x02\x02\x00\x08\x88\x10\x88\x20\x88\x30\x88\x90\x80\x40\x20\x81\x01\x01\x01\x07";

fn zipped() -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in [("in/m.gltf", Build::triangle().gltf("mesh.bin")), ("in/mesh.bin", vec![0; 36])] {
        writer.start_file(name, SimpleFileOptions::default()).expect("in memory");
        writer.write_all(&bytes).expect("in memory");
    }
    writer.finish().expect("in memory").into_inner()
}

/// Text, binary, and text in two compressed blocks.
fn x_files() -> Vec<Vec<u8>> {
    let binary = b"xof 0303bin 0032\x01\0\x05\0\0\0Frame\x01\0\x01\0\0\0a\x0A\0\x05\0guid of 16 bytes\
        \x01\0\x06\0\0\0Camera\x0A\0\x07\0\x02\0\0\0\0\0\x80?\0\0\0\0\x02\0\x01\0\0\0b\x14\0\x0B\0\x0B\0\
        \x01\0\x12\0\0\0AnimTicksPerSecond\x0A\0\x06\0\x01\0\0\0\x1E\0\0\0\x0B\0";
    let mut packed = [b"xof 0303tzip0032", &(16 + X.len() as u32).to_le_bytes()[..]].concat();
    for block in X.as_bytes().chunks(X.len() / 2 + 1) {
        let length = block.len() as u16;
        // Deflate's stored block: the last one, its length, and the inverse of that.
        let stream = [&[1][..], &length.to_le_bytes(), &(!length).to_le_bytes(), block].concat();
        packed.extend([length.to_le_bytes(), (stream.len() as u16 + 2).to_le_bytes()].concat());
        packed.extend([b"CK", &stream[..]].concat());
    }
    vec![[b"xof 0303txt 0032\n", X.as_bytes()].concat(), binary.to_vec(), packed]
}

/// Images, each after what the decoder is asked for.
fn ktx2_inputs() -> Vec<Vec<u8>> {
    let images: [&[u8]; 4] = [
        include_bytes!("../support/ktx2/etc1s-alpha.ktx2"),
        include_bytes!("../support/ktx2/etc1s.ktx2"),
        include_bytes!("../support/ktx2/uastc-single.ktx2"),
        include_bytes!("../support/ktx2/uastc.ktx2"),
    ];
    let formats = [Formats(0), Formats(7)];
    images.iter().flat_map(|image| formats.map(|formats| request(formats, 4096, image))).collect()
}

fn seeds(entry: &str) -> Vec<Vec<u8>> {
    let mut models: Vec<(String, Vec<u8>)> =
        generated().into_iter().map(|(name, bytes)| (name.to_owned(), bytes)).collect();
    if let Some(data) = data_folder() {
        models.extend(REAL.map(|path| (path.to_owned(), std::fs::read(data.join(path)).expect(path))));
    }
    let is_bvh = |name: &str| name.ends_with(".bvh");
    match entry {
        "gltf" | "bvh" => {
            models.retain(|(name, _)| is_bvh(name) == (entry == "bvh"));
            models.into_iter().map(|(_, bytes)| bytes).collect()
        }
        "fbx" => vec![FBX.as_bytes().to_vec()],
        "draco" => draco(),
        "meshopt" => meshopt(),
        "ktx2" => ktx2_inputs(),
        // All of them are motions, or stand still.
        "pipeline" => models.into_iter().map(|(_, bytes)| [&[0; 4], &bytes[..]].concat()).collect(),
        "x" => x_files(),
        "npz" => vec![npz(&person(22)), stored(&person(52))],
        "exercise" => vec![EXERCISE.to_vec()],
        "archive" => vec![zipped()],
        "map" => vec![MAP.to_vec()],
        "link" => links(),
        "hdr" => vec![HDR.to_vec()],
        other => panic!("no seeds for {other}"),
    }
}

/// Makes other choices of what follows reading, whatever the damage did to them.
fn choose(input: &mut [u8], random: &mut Random) {
    if let Some(choices) = input.first_chunk_mut() {
        *choices = (random.bits() as u32).to_le_bytes();
    }
}

/// Damages the seeds repeatedly and returns the number of cases.
fn run(entry: entries::Entry, is_over: impl Fn(usize) -> bool) -> usize {
    let (name, read) = entry;
    let seeds = seeds(name);
    seeds.iter().for_each(|seed| read(seed));
    let mut random = Random(0x5DEE_CE66_D123_4567);
    let mut cases = 0;
    while !is_over(cases) {
        let mut input = seeds[random.below(seeds.len())].clone();
        for _ in 0..=random.below(3) {
            input = if input.is_empty() { input } else { damage(&input, &mut random) };
        }
        if name == "pipeline" {
            choose(&mut input, &mut random);
        }
        let begun = Instant::now();
        let (outcome, bytes) = peak_of(|| catch_unwind(|| read(&input)));
        let secs = begun.elapsed().as_secs_f64();
        if outcome.is_err() || secs > MAX_SECS || bytes > MAX_BYTES {
            let path = std::env::temp_dir().join(format!("gaitway-fuzz-{name}-{cases}"));
            std::fs::write(&path, &input).expect("a file in the temporary folder");
            panic!("{name}, case {cases}: a panic, or {secs:.1} s, or {bytes} bytes; the input is {}", path.display());
        }
        cases += 1;
    }
    cases
}

#[test]
fn everything_survives_damaged_files() {
    let secs: Option<f64> = std::env::var("GAITWAY_FUZZ_SECS").ok().and_then(|secs| secs.parse().ok());
    let chosen = std::env::var("GAITWAY_FUZZ").ok();
    for entry in entries::ENTRIES.into_iter().filter(|(name, _)| chosen.as_ref().is_none_or(|chosen| chosen == name)) {
        let start = Instant::now();
        // By default the same files on every machine.
        let cases = run(entry, |cases| match secs {
            Some(secs) => start.elapsed().as_secs_f64() >= secs,
            None => cases == if entry.0 == "pipeline" { PIPELINE_CASES } else { CASES },
        });
        println!("{}: {cases} damaged files", entry.0);
        assert!(cases > 0);
    }
}

/// Damaging a seed that is rejected anyway tests little.
#[test]
fn seeds_are_whole() {
    let seeds = [("x", x_files()), ("fbx", seeds("fbx")), ("glb", [draco(), meshopt()].concat())];
    for (extension, seeds) in seeds {
        for seed in seeds.into_iter().filter(|seed| extension != "glb" || seed.starts_with(b"glTF")) {
            let mut files = one(&format!("seed.{extension}"), seed);
            prepare(&mut files).expect("a whole file");
            load(&files).expect("a model");
        }
    }
    for (part, inputs) in [(Part::Draco, draco()), (Part::Meshopt, meshopt()), (Part::Ktx2, ktx2_inputs())] {
        for input in inputs.into_iter().filter(|input| !input.starts_with(b"glTF")) {
            part.run(&input).expect("whole data");
        }
    }
}

#[test]
fn what_fuzzing_found_stays_fixed() {
    entries::map(br#"{"gaitway_map":1,"joints":{"a":{"source":0,"correction":[0,0,0,1e39]}}}"#);
    entries::link(b"v=1&model=https://example.org/a.zip%23/b%23/c.glb");
}

#[test]
fn every_entry_point_has_a_fuzz_target_that_runs_on_schedule() {
    let manifest = include_str!("../../fuzz/Cargo.toml");
    for (name, _) in entries::ENTRIES {
        assert!(manifest.contains(&format!("path = \"fuzz_targets/{name}.rs\"")), "{name}");
    }
    let names = entries::ENTRIES.map(|(name, _)| name).join(", ");
    assert!(include_str!("../../.github/workflows/fuzz.yml").contains(&format!("target: [{names}]")), "{names}");
}
