//! Damaged files: an error or a valid glTF, and never a crash.

use crate::damage::{Damage, cases};
use crate::glb;
use crate::numpy::{npz, person, stored};

#[test]
fn damaged_files_convert_or_say_why_not() {
    let mut damage = Damage::new();
    for (kind, seed) in [("compressed", npz(&person(24))), ("stored", stored(&person(22)))] {
        let mut converted = 0;
        for _ in 0..cases() {
            match gaitway_npz::convert(&damage.of(&seed)) {
                Ok(output) => {
                    glb::check(&output.bytes);
                    converted += 1;
                }
                Err(message) => assert!(message.ends_with('.') && message.contains("expected "), "{message}"),
            }
        }
        println!("{kind}: {converted} of {} converted", cases());
        assert!((1..cases()).contains(&converted), "{kind}: {converted} were converted");
    }
}
