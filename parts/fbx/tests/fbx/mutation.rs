//! Damaged files: an error or a valid glTF, quickly, and never a crash.

use std::time::{Duration, Instant};

use crate::ascii;
use crate::data;
use crate::data_folder::data_folder;
use crate::glb;
use crate::random::Random;

/// Mutations in an ordinary run; `GAITWAY_FBX_MUTATIONS` sets another number.
const MUTATIONS: usize = 10_000;
/// No conversion may take longer.
const LIMIT: Duration = Duration::from_secs(5);

/// Numbers that counts, offsets and coordinates don't expect.
const NUMBERS: [&str; 10] =
    ["0", "-1", "1e39", "-1e308", "nan", "2147483647", "4294967295", "9223372036854775807", "1e-320", "65536"];

/// Returns small files of all kinds: text made here, and real ones if available.
fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = vec![ascii::character().into_bytes(), ascii::cube().into_bytes()];
    if let Some(folder) = data_folder() {
        let small = data::files(&folder).into_iter().map(|path| std::fs::read(path).unwrap());
        seeds.extend(small.filter(|bytes| bytes.len() < 60_000));
    }
    seeds
}

/// Damages a file in one to three places.
fn mutate(file: &mut Vec<u8>, random: &mut Random) {
    let text = file.iter().take(2000).all(|&byte| byte != 0);
    for _ in 0..=random.below(3) {
        let at = random.below(file.len());
        // Most of them change values in place: what changes the length rarely gets past the first checks.
        match random.below(if text { 12 } else { 9 }) {
            0..=2 => file[at] ^= 1 << random.below(8),
            6 => file[at] = random.bits() as u8,
            7 | 8 => {
                let word = [0, u32::MAX, 0x7fff_ffff, 0x8000_0000, 0x7fc0_0000, random.bits() as u32][random.below(6)];
                for (place, byte) in file[at..].iter_mut().zip(word.to_le_bytes()) {
                    *place = byte;
                }
            }
            3 => file.truncate(at.max(1)),
            4 => drop(file.drain(at..(at + random.below(64)).min(file.len()))),
            5 => {
                let piece = file[at..(at + random.below(256)).min(file.len())].to_vec();
                let place = random.below(file.len());
                file.splice(place..place, piece);
            }
            _ => replace_number(file, at, NUMBERS[random.below(NUMBERS.len())]),
        }
        if file.is_empty() {
            return;
        }
    }
}

fn replace_number(file: &mut Vec<u8>, from: usize, number: &str) {
    let digit = |byte: &u8| byte.is_ascii_digit() || b"+-.e".contains(byte);
    let Some(start) = file[from..].iter().position(|byte| byte.is_ascii_digit()).map(|offset| from + offset) else {
        return;
    };
    let end = file[start..].iter().position(|byte| !digit(byte)).map_or(file.len(), |offset| start + offset);
    file.splice(start..end, number.bytes());
}

#[test]
fn damaged_files_convert_or_say_why_not() {
    let count = std::env::var("GAITWAY_FBX_MUTATIONS").map_or(MUTATIONS, |count| count.parse().unwrap());
    let seeds = seeds();
    let mut random = Random(1);
    let (mut converted, mut slowest) = (0, Duration::ZERO);
    for number in 0..count {
        let mut file = seeds[random.below(seeds.len())].clone();
        mutate(&mut file, &mut random);
        if let Ok(path) = std::env::var("GAITWAY_FBX_LAST") {
            std::fs::write(path, &file).unwrap();
        }
        let start = Instant::now();
        let result = gaitway_fbx::convert(&file);
        let time = start.elapsed();
        slowest = slowest.max(time);
        assert!(time < LIMIT, "mutation {number} took {time:?}");
        match result {
            Ok(result) => {
                glb::check(&result.bytes);
                converted += 1;
            }
            Err(message) => assert!(message.ends_with('.') && message.contains(": "), "{message}"),
        }
    }
    println!("{count} mutations of {} files: {converted} converted, slowest {slowest:?}", seeds.len());
    if let Some(peak) = peak_bytes() {
        println!("peak memory {} MB", peak >> 20);
        assert!(peak < 2 << 30, "{peak} bytes");
    }
}

/// Returns the peak memory of this process, where the system reports it.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kilobytes| kilobytes << 10)
}
