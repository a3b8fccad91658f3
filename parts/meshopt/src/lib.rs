//! Decodes the buffer views of `EXT_meshopt_compression` and `KHR_meshopt_compression`, all modes and filters. The glTF around
//! them is the caller's: see `crates/formats/src/gltf/meshopt.rs`.

use gaitway_part::{Answer, Output};
use meshoptimizer_rs::codec;
use meshoptimizer_rs::{Error, Workspace};

/// What the buffer view holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Vertex attributes.
    Attributes,
    /// Indices of a triangle list.
    Triangles,
    /// Any other indices.
    Indices,
}

/// The filter to apply to decoded attributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// No filter.
    None,
    /// From octahedral normals or tangents.
    Octahedral,
    /// From quaternions of three components.
    Quaternion,
    /// From mantissa and exponent.
    Exponential,
    /// From YCoCg (KHR only).
    Color,
}

const MODES: [Mode; 3] = [Mode::Attributes, Mode::Triangles, Mode::Indices];
const FILTERS: [Filter; 5] = [Filter::None, Filter::Octahedral, Filter::Quaternion, Filter::Exponential, Filter::Color];

/// One compressed buffer view.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// What it holds.
    pub mode: Mode,
    /// Applied after decoding.
    pub filter: Filter,
    /// Number of elements.
    pub count: u32,
    /// Bytes from one element to the next.
    pub stride: u16,
    /// The compressed bytes.
    pub source: &'a [u8],
}

/// Mode, filter, stride (u16), count (u32) and length of the compressed bytes (u32), all little-endian.
const HEADER_BYTES: usize = 12;

impl Mode {
    /// Looks up the name that the extension gives it.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "ATTRIBUTES" => Some(Self::Attributes),
            "TRIANGLES" => Some(Self::Triangles),
            "INDICES" => Some(Self::Indices),
            _ => None,
        }
    }
}

impl Filter {
    /// Looks up the name that the extension gives it.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "NONE" => Some(Self::None),
            "OCTAHEDRAL" => Some(Self::Octahedral),
            "QUATERNION" => Some(Self::Quaternion),
            "EXPONENTIAL" => Some(Self::Exponential),
            "COLOR" => Some(Self::Color),
            _ => None,
        }
    }
}

impl<'a> View<'a> {
    /// Appends the view to the input of [`decode`].
    pub fn write(&self, input: &mut Vec<u8>) {
        input.extend([self.mode as u8, self.filter as u8]);
        input.extend(self.stride.to_le_bytes());
        input.extend(self.count.to_le_bytes());
        input.extend((self.source.len() as u32).to_le_bytes());
        input.extend(self.source);
    }

    /// Splits the first view off an input.
    fn read(input: &'a [u8]) -> Option<(Self, &'a [u8])> {
        let (header, rest) = input.split_first_chunk::<HEADER_BYTES>()?;
        let &[mode, filter, s0, s1, c0, c1, c2, c3, l0, l1, l2, l3] = header;
        let (source, rest) = rest.split_at_checked(u32::from_le_bytes([l0, l1, l2, l3]) as usize)?;
        let view = Self {
            mode: *MODES.get(usize::from(mode))?,
            filter: *FILTERS.get(usize::from(filter))?,
            count: u32::from_le_bytes([c0, c1, c2, c3]),
            stride: u16::from_le_bytes([s0, s1]),
            source,
        };
        Some((view, rest))
    }

    fn decode(&self, workspace: &mut Workspace) -> Result<Vec<u8>, Error> {
        let (count, stride) = (self.count as usize, usize::from(self.stride));
        let mut bytes = match self.mode {
            Mode::Attributes => codec::decode_vertex_buffer(count, stride, self.source, workspace),
            Mode::Triangles => codec::decode_index_buffer(count, stride, self.source, workspace),
            Mode::Indices => codec::decode_index_sequence(count, stride, self.source, workspace),
        }?;
        match self.filter {
            Filter::None => Ok(()),
            Filter::Octahedral => codec::decode_filter_oct(&mut bytes, count, stride, workspace),
            Filter::Quaternion => codec::decode_filter_quat(&mut bytes, count, stride, workspace),
            Filter::Exponential => codec::decode_filter_exp(&mut bytes, count, stride, workspace),
            Filter::Color => codec::decode_filter_color(&mut bytes, count, stride, workspace),
        }?;
        Ok(bytes)
    }
}

/// Decodes any number of views ([`View::write`]), one after the other. The output has `count · stride` bytes of each.
///
/// # Errors
/// If a view is damaged; the message names it by its number in the input, from 0.
pub fn decode(mut input: &[u8]) -> Answer {
    let mut workspace = Workspace::default();
    let mut bytes = Vec::new();
    for number in 0.. {
        if input.is_empty() {
            break;
        }
        let (view, rest) = View::read(input).ok_or("the converter's input is damaged")?;
        let decoded = view.decode(&mut workspace);
        bytes.extend(decoded.map_err(|problem| format!("compressed buffer view {number} is damaged ({problem})"))?);
        input = rest;
    }
    Ok(Output { bytes, warnings: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_decoded_one_after_the_other() {
        let indices: Vec<u32> = vec![0, 1, 2, 2, 1, 3];
        let vertices: Vec<u8> = (0..64).collect();
        let mut workspace = Workspace::default();
        let encoded = [
            codec::encode_index_buffer(&indices, codec::IndexEncoding::DEFAULT, &mut workspace).unwrap(),
            codec::encode_vertex_buffer(&vertices, 4, 16, codec::VertexEncoding::DEFAULT, &mut workspace).unwrap(),
        ];
        let mut input = Vec::new();
        let view = View { mode: Mode::Triangles, filter: Filter::None, count: 6, stride: 2, source: &encoded[0] };
        view.write(&mut input);
        let view = View { mode: Mode::Attributes, filter: Filter::None, count: 4, stride: 16, source: &encoded[1] };
        view.write(&mut input);

        let output = decode(&input).unwrap().bytes;
        let decoded: Vec<u32> = output[..12].chunks(2).map(|two| u32::from(two[0])).collect();
        assert_eq!(decoded, indices);
        assert_eq!(output[12..], vertices);

        let cut = decode(&input[..input.len() - 1]).unwrap_err();
        assert!(cut.contains("damaged"), "{cut}");
        let last = input.len() - 3;
        input[last..].fill(0xFF);
        input[HEADER_BYTES] = 0;
        assert!(decode(&input).unwrap_err().contains("buffer view 0"));
    }
}
