//! Checksums against the definition, bit by bit, and against published ones.

use crc32fast::{Hasher, hash};

/// Divides bit by bit.
fn reference(bytes: &[u8]) -> u32 {
    let mut remainder = u32::MAX;
    for &byte in bytes {
        remainder ^= u32::from(byte);
        for _ in 0..8 {
            remainder = (remainder >> 1) ^ (0xedb8_8320 * (remainder & 1));
        }
    }
    !remainder
}

/// Enough for several blocks, without a pattern.
fn bytes() -> Vec<u8> {
    (0..200_u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
}

#[test]
fn checksums_are_those_that_others_publish() {
    assert_eq!(hash(b""), 0);
    // The check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
    assert_eq!(hash(b"123456789"), 0xcbf4_3926);
    // The last chunk of every PNG.
    assert_eq!(hash(b"IEND"), 0xae42_6082);
}

#[test]
fn every_length_has_the_checksum_of_its_definition() {
    let bytes = bytes();
    for len in 0..=bytes.len() {
        assert_eq!(hash(&bytes[..len]), reference(&bytes[..len]), "{len} bytes");
    }
}

#[test]
fn pieces_add_up_to_the_whole() {
    let bytes = bytes();
    let hasher_of = |bytes: &[u8]| {
        let mut hasher = Hasher::new();
        hasher.update(bytes);
        hasher
    };
    for at in 0..=bytes.len() {
        let (start, rest) = bytes.split_at(at);
        let mut updated = hasher_of(start);
        updated.update(rest);
        assert_eq!(updated.finalize(), reference(&bytes), "updated after {at} bytes");
        let mut combined = hasher_of(start);
        combined.combine(&hasher_of(rest));
        assert_eq!(combined.clone().finalize(), reference(&bytes), "combined after {at} bytes");
        // The length counts as well: what is combined can be combined again.
        let mut twice = hasher_of(rest);
        twice.combine(&combined);
        assert_eq!(twice.finalize(), reference(&[rest, &bytes].concat()), "combined again after {at} bytes");
        let mut continued = Hasher::new_with_initial_len(hash(start), at as u64);
        continued.update(rest);
        assert_eq!(continued.finalize(), reference(&bytes), "continued after {at} bytes");
    }
}

#[test]
fn a_reset_forgets_all_bytes() {
    let mut hasher = Hasher::new();
    hasher.update(&bytes());
    hasher.reset();
    hasher.update(b"IEND");
    assert_eq!(hasher.finalize(), hash(b"IEND"));
}
