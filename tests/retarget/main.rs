//! Borrowed motion, without GPU: laws on figures made in code, and real pairs of files.

mod feet;
mod figure;
mod laws;
