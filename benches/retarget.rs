//! Retargeting a clip, and the steps around it: recognizing, proposing a map, measuring. `-- retarget`, `-- propose`,
//! `-- measure` select one.

mod support;

use std::hint::black_box;

use gaitway_character::anim::Clip;
use gaitway_character::asset::Asset;
use gaitway_formats::load;
use gaitway_retarget::{Body, Contacts, ResolvedMap, Retargeting, propose, recognize};
use support::data_folder::data_folder;
use support::{files_of, measure};

fn main() {
    let Some(folder) = data_folder() else { return };
    let read = |name: &str| -> Option<Asset> { load(&files_of(&folder.join(name))?).ok() };
    let (Some(xbot), Some(soldier)) = (read("threejs/Xbot.glb"), read("threejs/Soldier.glb")) else { return };
    let (Some(samba), Some(boxer)) = (read("threejs/Samba_Dancing.glb"), read("bvh/assimp_Boxing_Toes.bvh")) else {
        return;
    };
    let word = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    println!("{:<56} {:>12} {:>12}", "", "µs", "(fastest)");
    for (name, model, motion, clip) in [
        ("Xbot walk → Soldier", &soldier, &xbot, "walk"),
        ("Xbot idle → Soldier", &soldier, &xbot, "idle"),
        ("Soldier Walk → Xbot", &xbot, &soldier, "Walk"),
        ("Soldier Idle → Xbot", &xbot, &soldier, "Idle"),
        ("Samba → Soldier", &soldier, &samba, ""),
        ("Boxing → Soldier", &soldier, &boxer, ""),
    ] {
        let is_wanted = |other: &Clip| clip.is_empty() || other.name() == clip;
        let Some(clip) = motion.clips.iter().position(is_wanted) else { continue };
        let name = format!("{name}, {:.1} s", motion.clips[clip].duration_secs());
        let slots = [recognize(model).humanoid(), recognize(motion).humanoid()];
        let Ok(map) = propose(model, motion).to_map(model, motion).resolve(model, motion) else { continue };
        let bodies = || (Body { asset: model, slots: &slots[0] }, Body { asset: motion, slots: &slots[1] });
        let row = |what: &str, work: &mut dyn FnMut()| {
            if word.as_ref().is_some_and(|word| !what.contains(word)) {
                return;
            }
            let nanos = measure(work);
            println!("{:<56} {:>12.1} {:>12.1}", format!("{name}, {what}"), nanos.median / 1e3, nanos.fastest / 1e3);
        };
        row("retarget", &mut || {
            let (model, motion) = bodies();
            black_box(Retargeting::new(model, motion, clip, &map).and_then(|pair| pair.bake())).ok();
        });
        row("retarget, contacts kept", &mut || {
            let map = ResolvedMap { contacts: Contacts::Keep, ..map.clone() };
            let (model, motion) = bodies();
            black_box(Retargeting::new(model, motion, clip, &map).and_then(|pair| pair.bake())).ok();
        });
        row("propose", &mut || {
            black_box(propose(black_box(model), motion));
        });
        let (model, motion) = bodies();
        let Ok(pair) = Retargeting::new(model, motion, clip, &map) else { continue };
        let Ok(baked) = pair.bake() else { continue };
        row("measure", &mut || {
            black_box(pair.figures(&baked));
        });
    }
}
