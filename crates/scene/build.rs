//! Lists the sample files to embed, except in the page, which serves them as separate files.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs, io};

/// A link to the repository's folder, which is a folder in the published package; a checkout on Windows may lack links.
const FOLDERS: [&str; 2] = ["samples", "../../assets/samples"];

const EXTENSIONS: [&str; 5] = ["glb", "bvh", "obj", "skel", "attach"];

fn main() -> io::Result<()> {
    let root = env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?;
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    let is_here = |folder: &&str| Path::new(&root).join(folder).is_dir();
    let folder = FOLDERS.into_iter().find(is_here).ok_or(io::ErrorKind::NotFound)?;
    // The README lists every sample, so it changes when one is added. The folder itself also holds files that are not
    // embedded.
    println!("cargo::rerun-if-changed={folder}/README.md");
    let mut names: Vec<String> = fs::read_dir(Path::new(&root).join(folder))?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    let mut text = "const FILES: &[(&str, &str, &[u8])] = &[\n".to_owned();
    for file in names {
        let Some((name, extension)) = file.split_once('.') else { continue };
        if EXTENSIONS.contains(&extension) {
            println!("cargo::rerun-if-changed={folder}/{file}");
            // Resolved when the crate is compiled, because the checkout may have moved since this ran.
            let path = format!("/{folder}/{file}");
            writeln!(text, r#"({name:?}, {file:?}, include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), {path:?}))),"#)
                .map_err(io::Error::other)?;
        }
    }
    text.push_str("];\n");
    fs::write(Path::new(&out).join("samples.rs"), text)
}
