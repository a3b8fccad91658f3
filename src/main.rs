//! The only binary: the command line natively, the page on wasm32.

#![forbid(unsafe_code)]

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    gaitway::cli::main()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    gaitway::web::start();
}
