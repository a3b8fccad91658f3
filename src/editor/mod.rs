//! The editor: what happens to opened files. Free of UI, GPU and I/O, so that the page, the window, the command line and
//! the tests are shells around it.

mod contents;

pub use contents::{Contents, MEMBER, ModelFiles, OpenedModel, container_of};
