//! Strips comments and indentation from the shaders, which are part of the page's download.

use std::path::Path;
use std::{env, fs, io};

/// A link to the repository's folder, which is a folder in the published package; a checkout on Windows may lack links.
const FOLDERS: [&str; 2] = ["shaders", "../../shaders"];

fn main() -> io::Result<()> {
    let root = env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?;
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    let is_here = |folder: &&str| Path::new(&root).join(folder).is_dir();
    let folder = FOLDERS.into_iter().find(is_here).ok_or(io::ErrorKind::NotFound)?;
    println!("cargo::rerun-if-changed={folder}");
    for entry in fs::read_dir(Path::new(&root).join(folder))? {
        let path = entry?.path();
        let text = fs::read_to_string(&path)?;
        let lines = text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code).trim());
        let lines: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
        if let Some(name) = path.file_name() {
            fs::write(Path::new(&out).join(name), lines.join("\n") + "\n")?;
        }
    }
    Ok(())
}
