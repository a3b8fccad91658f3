//! Damaged files: an error or a valid glTF, quickly, and never a crash.

use std::time::{Duration, Instant};

use crate::damage::{Damage, cases};
use crate::data_folder::data_folder;
use crate::encode::{binary, packed, text};
use crate::glb;
use crate::meaning::CHARACTER;

/// No conversion may take longer.
const LIMIT: Duration = Duration::from_secs(5);

fn check(file: &[u8]) -> bool {
    let start = Instant::now();
    let result = gaitway_x::convert(file);
    let time = start.elapsed();
    assert!(time < LIMIT, "{time:?}");
    match result {
        Ok(output) => {
            glb::check(&output.bytes);
            true
        }
        Err(message) => {
            assert!(message.ends_with('.') && message.contains("expected "), "{message}");
            false
        }
    }
}

#[test]
fn damaged_files_convert_or_say_why_not() {
    let plain = CHARACTER.lines().skip(3).collect::<Vec<_>>().join("\n").replace("{ # another", "{");
    let mut seeds = vec![text(CHARACTER), binary(&plain, 4), binary(&plain, 8), packed(&binary(&plain, 4))];
    if let Some(folder) = data_folder() {
        // Only the beginning, which has meshes: the rest is missing.
        let dwarf = std::fs::read(folder.join("cosc422/original/Dwarf/dwarf.x")).unwrap();
        seeds.push(dwarf[..20_000].to_vec());
    }
    let mut damage = Damage::new();
    for seed in &seeds {
        let converted = (0..cases()).filter(|_| check(&damage.of(seed))).count();
        let kind = seed[8..16].escape_ascii();
        println!("{kind}: {converted} of {} converted", cases());
        let is_whole = seed.len() < 20_000;
        assert!(!is_whole || (1..cases()).contains(&converted), "{kind}: {converted} were converted");
    }
}
