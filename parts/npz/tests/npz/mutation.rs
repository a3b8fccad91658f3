//! Damaged files: an error or a valid glTF, and never a crash.

use crate::damage::{Damage, cases};
use crate::glb;
use crate::numpy::{floats, npz, person, stored};
use crate::person::Person;

/// Whether the file is converted. Otherwise the message has to say what was expected.
fn converts(file: &[u8]) -> bool {
    match gaitway_npz::convert(file) {
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

fn check(kind: &str, mut damaged: impl FnMut(usize) -> Vec<u8>) {
    let converted = (0..cases()).filter(|&case| converts(&damaged(case))).count();
    println!("{kind}: {converted} of {} converted", cases());
    assert!((1..cases()).contains(&converted), "{kind}: {converted} were converted");
}

#[test]
fn damaged_files_convert_or_say_why_not() {
    let mut damage = Damage::new();
    let positions = floats("(2, 6, 22, 3)", &Person::new(22, 12, 0.0).all_positions());
    let soma = Person::soma(3);
    let turns = floats("(3, 77, 3, 3)", &soma.numbers(|frame| soma.locals(frame).concat().concat()));
    let soma = [("local_rot_mats", turns), ("posed_joints", floats("(3, 77, 3)", &soma.all_positions()))];
    for (kind, seed) in [
        ("compressed", npz(&person(24))),
        ("stored", stored(&person(22))),
        ("positions", positions),
        ("bones", stored(&soma)),
    ] {
        check(kind, |_| damage.of(&seed));
    }
}

/// The archive's checksums are right, so the damage is read.
#[test]
fn damaged_arrays_convert_or_say_why_not() {
    let (person, mut damage) = (person(22), Damage::new());
    check("arrays", |case| {
        let mut arrays = person.clone();
        let (_, array) = &mut arrays[case % person.len()];
        *array = damage.of(array);
        stored(&arrays)
    });
}
