//! Finds the sample characters, which are part of every program but the page, where they lie beside it.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs, io};

const ENDINGS: [&str; 5] = ["glb", "bvh", "obj", "skel", "attach"];

fn main() -> io::Result<()> {
    const FOLDER: &str = "assets/samples";
    println!("cargo::rerun-if-changed={FOLDER}");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?).join(FOLDER);
    let mut names: Vec<String> =
        fs::read_dir(&folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let mut text = "const FILES: &[(&str, &str, &[u8])] = &[\n".to_owned();
    for file in names {
        let Some((name, ending)) = file.split_once('.') else { continue };
        if ENDINGS.contains(&ending) {
            let path = folder.join(&file);
            writeln!(text, "({name:?}, {file:?}, include_bytes!({path:?})),").map_err(io::Error::other)?;
        }
    }
    text.push_str("];\n");
    fs::write(Path::new(&env::var("OUT_DIR").map_err(io::Error::other)?).join("samples.rs"), text)
}
