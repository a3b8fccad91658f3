//! Why a load failed: the file, the place in it, what was expected, what was found, what to do.

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    #[error("no model among the files ({}); Gaitway reads .glb, .gltf with its files, .vrm, or a .zip of these", found.join(", "))]
    NoModel { found: Vec<String> },
    #[error("{file}: {place}: {problem}")]
    Invalid { file: String, place: String, problem: String },
}
