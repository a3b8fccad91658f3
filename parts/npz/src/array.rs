//! One array: a `.npy` file.

use crate::archive::damaged;

/// What a `.npy` file begins with.
pub const MAGIC: &[u8] = b"\x93NUMPY";

/// Maximum count of numbers, which take 256 MiB as 64-bit floats, whatever their size in the file.
const MAX_NUMBERS: usize = 1 << 25;

/// An array of numbers with its first index varying slowest.
pub struct Array {
    /// What messages call it.
    pub label: String,
    pub shape: Vec<usize>,
    pub values: Vec<f64>,
}

impl Array {
    /// Returns the shape of the array in a `.npy` file, if it has one.
    pub fn shape_of(bytes: &[u8]) -> Option<Vec<usize>> {
        shape(entry(split(bytes)?.0, "shape"))
    }

    /// Reads a `.npy` file. `label` is what messages call it.
    pub fn read(label: &str, bytes: &[u8]) -> Result<Array, String> {
        let (header, data) =
            split(bytes).ok_or_else(|| damaged(label, "a NumPy header", &format!("{} other bytes", bytes.len())))?;
        let kind = quoted(entry(header, "descr")).unwrap_or_default();
        if kind.ends_with('O') {
            return Err(format!(
                "{label} holds pickled Python objects, which are not read because they could run any code: expected numbers. \
                 If you trust it, load it in Python and save its numbers with numpy.save or numpy.savez; for MDM's results.npy: \
                 numpy.save(\"motion.npy\", numpy.load(\"results.npy\", allow_pickle=True).item()[\"motion\"])."
            ));
        }
        let number = Number::of(kind).ok_or_else(|| {
            let found = if kind.is_empty() { "none" } else { kind };
            format!("{label}: expected numbers (float, int or uint), found type {found}. Save it as numpy.float32.")
        })?;
        let shape = shape(entry(header, "shape"))
            .ok_or_else(|| damaged(label, "a shape", &header.chars().take(80).collect::<String>()))?;
        let count = shape.iter().try_fold(1_usize, |count, &side| count.checked_mul(side));
        if let Some(count) = count.filter(|&count| count > MAX_NUMBERS) {
            return Err(format!(
                "{label} is too large: expected at most {MAX_NUMBERS} numbers, found {count}. Cut the motion into \
                 several files."
            ));
        }
        let bytes_expected = count.and_then(|count| count.checked_mul(number.size));
        if bytes_expected != Some(data.len()) {
            return Err(damaged(
                label,
                &format!("{shape:?} numbers of {} bytes", number.size),
                &format!("{} bytes", data.len()),
            ));
        }
        let mut values: Vec<f64> = data.chunks_exact(number.size).map(|bytes| number.read(bytes)).collect();
        if entry(header, "fortran_order").starts_with("True") {
            values = transposed(&values, &shape);
        }
        Ok(Array { label: label.to_owned(), shape, values })
    }
}

/// Splits a `.npy` file into header and data.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let (version, rest) = bytes.strip_prefix(MAGIC)?.split_first_chunk::<2>()?;
    let (length, rest) = if version[0] < 2 {
        let (length, rest) = rest.split_first_chunk()?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk()?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (header, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, data))
}

/// Returns the text after a key of the header's dictionary, or none.
fn entry<'a>(header: &'a str, key: &str) -> &'a str {
    let after = ["'", "\""].iter().find_map(|quote| header.split_once(&format!("{quote}{key}{quote}")));
    after.map_or("", |(_, value)| value.trim_start_matches([':', ' ']))
}

fn quoted(text: &str) -> Option<&str> {
    let quote = text.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
    text[1..].split(quote).next()
}

/// `(100, 156)`, `(1,)` or `()`; Python 2 also wrote `(100L, 156L)`.
fn shape(text: &str) -> Option<Vec<usize>> {
    let (sides, _) = text.strip_prefix('(')?.split_once(')')?;
    let sides = sides.split(',').map(|side| side.trim().trim_end_matches('L')).filter(|side| !side.is_empty());
    sides.map(|side| side.parse().ok()).collect()
}

/// A type of number.
struct Number {
    size: usize,
    kind: u8,
    is_big_endian: bool,
}

impl Number {
    /// `<f8`: byte order, kind, size.
    fn of(text: &str) -> Option<Number> {
        let &[order, kind, size] = text.as_bytes() else { return None };
        let size = usize::from(size.checked_sub(b'0')?);
        let is_known = match kind {
            b'f' => matches!(size, 2 | 4 | 8),
            b'i' | b'u' => matches!(size, 1 | 2 | 4 | 8),
            _ => false,
        };
        (is_known && b"<>|=".contains(&order)).then_some(Number { size, kind, is_big_endian: order == b'>' })
    }

    fn read(&self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        for (place, &byte) in bytes.iter().enumerate() {
            word[if self.is_big_endian { self.size - 1 - place } else { place }] = byte;
        }
        let word = u64::from_le_bytes(word);
        match self.kind {
            b'f' if self.size == 2 => from_half(word as u16),
            b'f' if self.size == 4 => f64::from(f32::from_bits(word as u32)),
            b'f' => f64::from_bits(word),
            b'u' => word as f64,
            _ => {
                // Shifts the sign to the top and back.
                let unused = 64 - 8 * self.size as u32;
                ((word << unused) as i64 >> unused) as f64
            }
        }
    }
}

/// Returns the value of a 16-bit float.
fn from_half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1F), f64::from(bits & 0x3FF) / 1024.0);
    match exponent {
        0 => sign * fraction * 2_f64.powi(-14),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        _ => sign * (1.0 + fraction) * 2_f64.powi(exponent - 15),
    }
}

/// Returns values whose first index varies fastest with the last index varying fastest.
fn transposed(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let mut ordered = Vec::with_capacity(values.len());
    for mut place in 0..values.len() {
        let (mut from, mut stride) = (0, values.len());
        for &side in shape.iter().rev() {
            stride /= side;
            from += place % side * stride;
            place /= side;
        }
        ordered.push(values[from]);
    }
    ordered
}
