//! Getting at bytes: disk, drop, picker, network; and decoding images. Produces [`crate::library::Model`]s.
