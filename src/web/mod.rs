//! The page: what the HTML shell (web/shell.js) calls. The shell owns the canvas, the dropped files, the messages and
//! `window.gaitway`; everything here lives in one wasm instance that the shell may throw away and start again.

#[cfg(feature = "bench")]
mod bench;
mod calls;
mod links;
mod page;
mod shell;

pub use page::start;
