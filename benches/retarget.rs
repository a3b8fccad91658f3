//! Retargeting a clip, and the steps before and after: proposing a map and measuring the result.
//! `-- retargeted`, `-- proposed` or `-- figures` runs only these.

mod support;

use std::hint::black_box;

use gaitway::asset::Asset;
use gaitway::formats::load;
use gaitway::retarget::{Body, Retargeting, propose, recognize};
use support::data_folder::data_folder;
use support::{files_of, measure};

fn main() {
    let Some(folder) = data_folder() else { return };
    let read = |name: &str| -> Option<Asset> { load(&files_of(&folder.join(name))?).ok() };
    let (Some(xbot), Some(soldier)) = (read("threejs/Xbot.glb"), read("threejs/Soldier.glb")) else { return };
    let word = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    println!("{:<36} {:>12} {:>12}", "", "µs", "(fastest)");
    for (name, model, motion, clip) in [
        ("Xbot walk → Soldier", &soldier, &xbot, "walk"),
        ("Xbot idle → Soldier", &soldier, &xbot, "idle"),
        ("Soldier Walk → Xbot", &xbot, &soldier, "Walk"),
        ("Soldier Idle → Xbot", &xbot, &soldier, "Idle"),
    ] {
        let Some(clip) = motion.clips.iter().position(|other| other.name() == clip) else { continue };
        let slots = [recognize(model).humanoid(), recognize(motion).humanoid()];
        let Ok(map) = propose(model, motion).to_map(model, motion).resolve(model, motion) else { continue };
        let bodies = || (Body { asset: model, slots: &slots[0] }, Body { asset: motion, slots: &slots[1] });
        let row = |what: &str, work: &mut dyn FnMut()| {
            if word.as_ref().is_some_and(|word| !what.contains(word)) {
                return;
            }
            let nanos = measure(work);
            println!("{:<36} {:>12.1} {:>12.1}", format!("{name}, {what}"), nanos.median / 1e3, nanos.fastest / 1e3);
        };
        row("retargeted", &mut || {
            let (model, motion) = bodies();
            black_box(Retargeting::new(model, motion, clip, &map).and_then(|pair| pair.bake())).ok();
        });
        row("map proposed", &mut || {
            black_box(propose(black_box(model), motion));
        });
        let (model, motion) = bodies();
        let Ok(pair) = Retargeting::new(model, motion, clip, &map) else { continue };
        let Ok(made) = pair.bake() else { continue };
        row("figures", &mut || {
            black_box(pair.figures(&made));
        });
    }
}
