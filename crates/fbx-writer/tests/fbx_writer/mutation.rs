//! Damaged input: an error or a file that can be read, and never a panic.

use gaitway_fbx_writer::{FbxOptions, FbxRecipient, fbx};

use crate::built;
use crate::data_folder::data_folder;
use crate::random::Random;
use crate::read::{asset, glb};

/// Mutations in an ordinary run; `GAITWAY_FBX_MUTATIONS` sets another number.
const MUTATIONS: usize = 10_000;

/// Numbers that indices, counts and coordinates don't expect.
const NUMBERS: [&str; 9] = ["0", "-1", "1e39", "-1e30", "65536", "4294967295", "1e-40", "0.5", "7"];

/// Small files of all kinds.
const SMALL: [&str; 7] = [
    "khronos/RiggedSimple/glTF-Binary/RiggedSimple.glb",
    "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
    "khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
    "khronos/InterpolationTest/glTF-Binary/InterpolationTest.glb",
    "khronos/SimpleSkin/glTF-Embedded/SimpleSkin.gltf",
    "khronos/Cameras/glTF-Embedded/Cameras.gltf",
    "materials/playcanvas/simple-instancing.glb",
];

fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = vec![built::everything()];
    if let Some(folder) = data_folder() {
        seeds.extend(SMALL.map(|name| glb(&folder.join(name))));
    }
    seeds
}

/// Damages the JSON or the numbers of a GLB in one to three places; the length stays.
fn mutate(file: &mut [u8], random: &mut Random) {
    let json = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    for _ in 0..=random.below(3) {
        if random.below(3) == 0 {
            // A number of the JSON.
            let from = 20 + random.below(json);
            let is_digit = |byte: &u8| byte.is_ascii_digit();
            let Some(at) = file[from..20 + json].iter().position(is_digit).map(|offset| from + offset) else {
                continue;
            };
            let length = file[at..20 + json].iter().take_while(|byte| is_digit(byte) || **byte == b'.').count();
            let number = NUMBERS[random.below(NUMBERS.len())];
            if number.len() <= length {
                file[at..at + length].fill(b' ');
                file[at..at + number.len()].copy_from_slice(number.as_bytes());
            }
        } else {
            let at = 20 + json + 8 + 4 * random.below((file.len() - json - 28) / 4);
            let word = [0, 0x7f7f_ffff, 0x0000_0001, 0x7fc0_0000, 0xff80_0000, random.bits() as u32][random.below(6)];
            let Some(place) = file.get_mut(at..at + 4) else { continue };
            place.copy_from_slice(&word.to_le_bytes());
        }
    }
}

#[test]
fn damaged_models_are_written_or_refused() {
    let count = std::env::var("GAITWAY_FBX_MUTATIONS").map_or(MUTATIONS, |count| count.parse().unwrap());
    let seeds = seeds();
    let mut random = Random(1);
    let mut written = 0;
    for number in 0..count {
        let mut file = seeds[random.below(seeds.len())].clone();
        mutate(&mut file, &mut random);
        let recipient = FbxRecipient::ALL[random.below(4)];
        let options = FbxOptions { recipient, clips_only: random.below(4) == 0 };
        if let Ok(path) = std::env::var("GAITWAY_FBX_LAST") {
            std::fs::write(path, &file).unwrap();
        }
        match fbx(&file, &options) {
            Ok(output) => {
                written += 1;
                if number % 10 == 0 {
                    asset("model.fbx", &output.bytes);
                }
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    println!("{count} mutations of {} files: {written} written", seeds.len());
    assert!(written > count / 4);
}
