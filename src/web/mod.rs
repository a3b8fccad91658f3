//! The page: functions for the HTML shell (web/shell/). The shell owns the canvas, dropped files, messages and
//! `window.gaitway`; everything here lives in one wasm instance, which the shell can discard and restart.

#[cfg(feature = "bench")]
mod bench;
mod calls;
mod mirror;
mod page;
mod session;
mod shell;

pub use page::start;
