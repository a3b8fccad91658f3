//! CRC-32 as in zip archives and PNG images, in place of `crc32fast` 1.5.4 (see `[patch.crates-io]` in the workspace's
//! Cargo.toml).
//!
//! That crate brings its tables along: 16 KB that no compression makes smaller, in the page and again in the part that reads
//! .npz. This one computes the same tables when they are first needed, within microseconds, and is then as fast as the original
//! is in WebAssembly.
//!
//! Left out: the original's faster ways on processors with instructions for it.

#![forbid(unsafe_code)]

use std::sync::LazyLock;

/// The polynomial without its highest power. As in every other number here, bit 31 is the power 0.
const POLYNOMIAL: u32 = 0xedb8_8320;
/// Bytes that are added at once.
const BLOCK: usize = 16;

/// `TABLES[n][byte]` is what a byte makes of the checksum once `n` more bytes have followed.
static TABLES: LazyLock<[[u32; 256]; BLOCK]> = LazyLock::new(tables);

fn tables() -> [[u32; 256]; BLOCK] {
    let first = std::array::from_fn(|byte| (0..8).fold(byte as u32, |remainder, _| times_x(remainder)));
    let mut tables = [first; BLOCK];
    for more in 1..BLOCK {
        tables[more] = tables[more - 1].map(|remainder| with_byte(&first, remainder, 0));
    }
    tables
}

fn with_byte(table: &[u32; 256], remainder: u32, byte: u8) -> u32 {
    table[usize::from(remainder as u8 ^ byte)] ^ (remainder >> 8)
}

fn times_x(polynomial: u32) -> u32 {
    (polynomial >> 1) ^ if polynomial & 1 == 1 { POLYNOMIAL } else { 0 }
}

fn product(a: u32, mut b: u32) -> u32 {
    let mut sum = 0;
    for power in 0..32 {
        if (a << power) >> 31 == 1 {
            sum ^= b;
        }
        b = times_x(b);
    }
    sum
}

/// The checksum of these bytes.
pub fn hash(bytes: &[u8]) -> u32 {
    let mut hasher = Hasher::new();
    hasher.update(bytes);
    hasher.finalize()
}

/// The checksum of the bytes so far.
#[derive(Debug, Clone, Default)]
pub struct Hasher {
    checksum: u32,
    len: u64,
}

impl Hasher {
    /// That of no bytes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Continues after `len` bytes with this checksum.
    pub fn new_with_initial_len(checksum: u32, len: u64) -> Self {
        Self { checksum, len }
    }

    /// Adds bytes.
    pub fn update(&mut self, bytes: &[u8]) {
        let tables = &*TABLES;
        let mut remainder = !self.checksum;
        let (blocks, rest) = bytes.as_chunks::<BLOCK>();
        for block in blocks {
            let [a, b, c, d] = remainder.to_le_bytes();
            let mut block = *block;
            for (byte, before) in block.iter_mut().zip([a, b, c, d]) {
                *byte ^= before;
            }
            let parts = block.iter().zip(tables.iter().rev());
            remainder = parts.fold(0, |sum, (&byte, table)| sum ^ table[usize::from(byte)]);
        }
        for &byte in rest {
            remainder = with_byte(&tables[0], remainder, byte);
        }
        self.checksum = !remainder;
        self.len += bytes.len() as u64;
    }

    /// Adds the bytes that `next` is the checksum of.
    pub fn combine(&mut self, next: &Self) {
        // x⁰ and x⁸.
        let (mut shift, mut power) = (1 << 31, 1 << 23);
        let mut len = next.len;
        while len > 0 {
            if len & 1 == 1 {
                shift = product(shift, power);
            }
            power = product(power, power);
            len >>= 1;
        }
        self.checksum = product(self.checksum, shift) ^ next.checksum;
        self.len += next.len;
    }

    /// Forgets all bytes.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// The checksum.
    pub fn finalize(self) -> u32 {
        self.checksum
    }
}
