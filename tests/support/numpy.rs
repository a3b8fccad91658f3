//! Archives as NumPy writes them.

// Each test program uses a part of it.
#![allow(dead_code)]

use std::io::{Cursor, Write};

use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

/// Returns a `.npy` file of 64-bit floats.
pub fn floats(shape: &str, values: &[f64]) -> Vec<u8> {
    array("<f8", shape, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
}

/// Returns a `.npy` file with C order.
pub fn array(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    npy(&format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}"), data)
}

/// Returns a `.npy` file of version 1.0. NumPy pads its header to a multiple of 64 bytes.
pub fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let header = format!("{header:<width$}\n", width = length - 1);
    [b"\x93NUMPY\x01\0", &(length as u16).to_le_bytes()[..], header.as_bytes(), data].concat()
}

/// Returns a `.npz` file as `numpy.savez_compressed` writes it, with 64-bit sizes.
pub fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    zipped(arrays, CompressionMethod::Deflated)
}

/// Returns a `.npz` file as `numpy.savez` writes it.
pub fn stored(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    zipped(arrays, CompressionMethod::Stored)
}

fn zipped(arrays: &[(&str, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method).large_file(true);
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A person of `joints` joints for two frames, 10 per second: the left knee bends by 1 around X in the second one.
pub fn person(joints: usize) -> Vec<(&'static str, Vec<u8>)> {
    let mut poses = vec![0.0; 2 * 3 * joints];
    poses[3 * joints + 3 * 4] = 1.0;
    vec![
        ("poses", floats(&format!("(2, {})", 3 * joints), &poses)),
        ("trans", floats("(2, 3)", &[0.0, 1.17, -0.03, 0.5, 1.27, 0.97])),
        ("mocap_framerate", floats("()", &[10.0])),
        ("gender", array("<U4", "()", b"m\0\0\0a\0\0\0l\0\0\0e\0\0\0")),
    ]
}
