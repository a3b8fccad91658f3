//! The container: binary FBX 7.4.
//!
//! After a header of 27 bytes, a file is a list of *records*: where the record ends, the number of properties and their size (u32
//! each), the name with its length (u8), the properties, and records below it. A record of zeros ends each list. A property is a
//! letter for its type, then its value; an array may be compressed with zlib. All numbers are little-endian.
//!
//! The crate `fbxcel` writes the same. It is maintained passively and would add `libflate` and `log` beside the compressor that is
//! here anyway, for less code than the mapping of a single kind of object.

use miniz_oxide::deflate::compress_to_vec_zlib;

const HEAD: &[u8; 23] = b"Kaydara FBX Binary  \0\x1a\0";
const VERSION: u32 = 7400;
/// The record of zeros.
const END: [u8; 13] = [0; 13];
/// Autodesk's SDK derives this from the creation time, which [`CREATION_TIME`](crate::document) fixes, and rejects others.
const FOOT_ID: [u8; 16] = *b"\xfa\xbc\xab\x09\xd0\xc8\xd4\x66\xb1\x76\xfb\x83\x1c\xf7\x26\x7e";
const FOOT_MAGIC: [u8; 16] = *b"\xf8\x5a\x8c\x6a\xde\xf5\xd9\x7e\xec\xe9\x0c\xe3\x75\x8f\x29\x0b";
/// Shorter arrays aren't compressed.
const MIN_COMPRESSED_BYTES: usize = 128;
/// zlib's level for arrays.
const LEVEL: u8 = 6;
/// Separates the name of an object from its class.
const CLASS: &[u8] = b"\0\x01";

/// A record under construction.
#[derive(Debug)]
pub struct Record {
    name: &'static str,
    count: u32,
    properties: Vec<u8>,
    children: Vec<Record>,
    /// Has a list of records even if that is empty.
    is_list: bool,
}

macro_rules! scalars {
    ($($name:ident($type:ty) = $letter:literal;)+) => {
        $(
            #[doc = concat!("Appends a property of the type `", $letter, "`.")]
            pub fn $name(self, value: $type) -> Record {
                self.property($letter.as_bytes()[0], &value.to_le_bytes())
            }
        )+
    };
}

macro_rules! arrays {
    ($($name:ident($type:ty) = $letter:literal;)+) => {
        $(
            #[doc = concat!("Appends an array of the type `", $letter, "`.")]
            pub fn $name(self, values: &[$type]) -> Record {
                let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
                self.array($letter.as_bytes()[0], values.len(), &bytes)
            }
        )+
    };
}

impl Record {
    /// Creates a record without properties.
    pub fn new(name: &'static str) -> Record {
        Record { name, count: 0, properties: Vec::new(), children: Vec::new(), is_list: false }
    }

    /// The record's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    scalars! {
        i32(i32) = "I";
        i64(i64) = "L";
        f64(f64) = "D";
    }

    arrays! {
        i32s(i32) = "i";
        i64s(i64) = "l";
        f32s(f32) = "f";
        f64s(f64) = "d";
    }

    fn property(mut self, letter: u8, bytes: &[u8]) -> Record {
        self.count += 1;
        self.properties.push(letter);
        self.properties.extend_from_slice(bytes);
        self
    }

    fn array(mut self, letter: u8, length: usize, bytes: &[u8]) -> Record {
        let packed = (bytes.len() >= MIN_COMPRESSED_BYTES).then(|| compress_to_vec_zlib(bytes, LEVEL));
        let packed = packed.filter(|packed| packed.len() < bytes.len());
        let (encoding, stored) = packed.as_deref().map_or((0_u32, bytes), |packed| (1, packed));
        self = self.property(letter, &(length as u32).to_le_bytes());
        self.properties.extend_from_slice(&encoding.to_le_bytes());
        self.properties.extend_from_slice(&(stored.len() as u32).to_le_bytes());
        self.properties.extend_from_slice(stored);
        self
    }

    fn bytes(mut self, letter: u8, bytes: &[u8]) -> Record {
        self = self.property(letter, &(bytes.len() as u32).to_le_bytes());
        self.properties.extend_from_slice(bytes);
        self
    }

    /// Appends a string.
    pub fn text(self, text: &str) -> Record {
        self.bytes(b'S', text.as_bytes())
    }

    /// Appends bytes without a meaning, such as those of an image.
    pub fn raw(self, bytes: &[u8]) -> Record {
        self.bytes(b'R', bytes)
    }

    /// Appends the name of an object and its class.
    pub fn object_name(self, name: &str, class: &str) -> Record {
        self.bytes(b'S', &[name.as_bytes(), CLASS, class.as_bytes()].concat())
    }

    /// Appends a boolean.
    pub fn flag(self, flag: bool) -> Record {
        self.property(b'C', &[u8::from(flag)])
    }

    /// Appends a record below this one.
    pub fn with(mut self, child: Record) -> Record {
        self.children.push(child);
        self
    }

    /// Appends records below this one.
    pub fn with_all(mut self, children: impl IntoIterator<Item = Record>) -> Record {
        self.children.extend(children);
        self
    }

    /// Appends a record below this one.
    pub fn push(&mut self, child: Record) {
        self.children.push(child);
    }

    /// Gives the record a list of records even if there is none in it.
    pub fn list(mut self) -> Record {
        self.is_list = true;
        self
    }

    fn write(&self, out: &mut Vec<u8>) {
        let start = out.len();
        out.extend_from_slice(&[0; 4]);
        out.extend_from_slice(&self.count.to_le_bytes());
        out.extend_from_slice(&(self.properties.len() as u32).to_le_bytes());
        out.push(self.name.len() as u8);
        out.extend_from_slice(self.name.as_bytes());
        out.extend_from_slice(&self.properties);
        self.children.iter().for_each(|child| child.write(out));
        if self.is_list || !self.children.is_empty() {
            out.extend_from_slice(&END);
        }
        let end = (out.len() as u32).to_le_bytes();
        out[start..start + end.len()].copy_from_slice(&end);
    }
}

/// Returns a file of these records, or its size if that is more than offsets can express.
pub fn file(records: &[Record]) -> Result<Vec<u8>, usize> {
    let mut out = HEAD.to_vec();
    out.extend_from_slice(&VERSION.to_le_bytes());
    records.iter().for_each(|record| record.write(&mut out));
    out.extend_from_slice(&END);
    out.extend_from_slice(&FOOT_ID);
    out.extend_from_slice(&[0; 4]);
    // Up to the next multiple of 16, and never nothing.
    out.resize((out.len() + 1).next_multiple_of(16), 0);
    out.extend_from_slice(&VERSION.to_le_bytes());
    out.resize(out.len() + 120, 0);
    out.extend_from_slice(&FOOT_MAGIC);
    if u32::try_from(out.len()).is_ok() { Ok(out) } else { Err(out.len()) }
}

/// The `Properties70` of an object.
#[derive(Debug)]
pub struct Properties(Record);

impl Properties {
    pub fn new() -> Properties {
        Properties(Record::new("Properties70").list())
    }

    fn with(mut self, name: &str, [kind, label, flags]: [&str; 3], value: impl FnOnce(Record) -> Record) -> Properties {
        self.0.push(value(Record::new("P").text(name).text(kind).text(label).text(flags)));
        self
    }

    pub fn integer(self, name: &str, value: i32) -> Properties {
        self.with(name, ["int", "Integer", ""], |record| record.i32(value))
    }

    pub fn choice(self, name: &str, value: i32) -> Properties {
        self.with(name, ["enum", "", ""], |record| record.i32(value))
    }

    pub fn flag(self, name: &str, value: bool) -> Properties {
        self.with(name, ["bool", "", ""], |record| record.i32(value.into()))
    }

    pub fn double(self, name: &str, value: f64) -> Properties {
        self.with(name, ["double", "Number", ""], |record| record.f64(value))
    }

    /// A number that can be animated.
    pub fn number(self, name: &str, value: f64) -> Properties {
        self.with(name, ["Number", "", "A"], |record| record.f64(value))
    }

    /// A property of its own type, such as `Visibility`, that can be animated.
    pub fn own(self, name: &str, value: &[f64]) -> Properties {
        self.with(name, [name, "", "A"], |record| value.iter().fold(record, |record, &value| record.f64(value)))
    }

    pub fn color(self, name: &str, value: [f64; 3]) -> Properties {
        self.with(name, ["Color", "", "A"], |record| value.into_iter().fold(record, Record::f64))
    }

    pub fn time(self, name: &str, ticks: i64) -> Properties {
        self.with(name, ["KTime", "Time", ""], |record| record.i64(ticks))
    }

    pub fn text(self, name: &str, value: &str) -> Properties {
        self.with(name, ["KString", "", ""], |record| record.text(value))
    }

    pub fn record(self) -> Record {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_says_where_it_ends() {
        let mut out = Vec::new();
        Record::new("A").i32(7).with(Record::new("B")).write(&mut out);
        let child = [&40_u32.to_le_bytes()[..], &[0; 8], &[1, b'B']].concat();
        let head =
            [&(19 + 14 + 13_u32).to_le_bytes()[..], &[1, 0, 0, 0, 5, 0, 0, 0, 1, b'A', b'I', 7, 0, 0, 0]].concat();
        assert_eq!(out[..19], head);
        assert_eq!(out[19..33], [&33_u32.to_le_bytes()[..], &child[4..]].concat());
        assert_eq!(out[33..], END);
    }

    #[test]
    fn the_end_is_at_a_multiple_of_16() {
        for length in 0..40 {
            let bytes = file(&[Record::new("A").raw(&vec![1; length])]).unwrap();
            assert_eq!((bytes.len() - 4 - 120 - 16) % 16, 0, "{length}");
            assert!(bytes.ends_with(&FOOT_MAGIC));
        }
    }
}
