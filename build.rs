//! Finds the sample characters, which are part of every program but the page, where they lie beside it.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs, io};

const ENDINGS: [&str; 5] = ["glb", "bvh", "obj", "skel", "attach"];

fn main() -> io::Result<()> {
    const FOLDER: &str = "assets/samples";
    // It lists every sample, so a new one changes it. The whole folder has more in it that is no part of any program.
    println!("cargo::rerun-if-changed={FOLDER}/README.md");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?).join(FOLDER);
    let mut names: Vec<String> =
        fs::read_dir(&folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let mut text = "const FILES: &[(&str, &str, &[u8])] = &[\n".to_owned();
    for file in names {
        let Some((name, ending)) = file.split_once('.') else { continue };
        if ENDINGS.contains(&ending) {
            println!("cargo::rerun-if-changed={FOLDER}/{file}");
            // The folder is looked up when this is compiled: the checkout may have been moved since.
            let path = format!("/{FOLDER}/{file}");
            writeln!(text, r#"({name:?}, {file:?}, include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), {path:?}))),"#)
                .map_err(io::Error::other)?;
        }
    }
    text.push_str("];\n");
    fs::write(Path::new(&env::var("OUT_DIR").map_err(io::Error::other)?).join("samples.rs"), text)
}
