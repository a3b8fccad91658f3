//! Writes the GLB container (§4.4). See `container` for reading.

use super::WriteError;

const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;

/// Appends `byte` until the length is a multiple of four.
pub fn pad(bytes: &mut Vec<u8>, byte: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), byte);
}

/// Omits the binary chunk if `binary` is empty.
pub fn glb(mut json: Vec<u8>, mut binary: Vec<u8>) -> Result<Vec<u8>, WriteError> {
    pad(&mut json, b' ');
    pad(&mut binary, 0);
    let binary_chunk = if binary.is_empty() { 0 } else { 8 + binary.len() };
    let bytes = 12 + 8 + json.len() + binary_chunk;
    let total = u32::try_from(bytes).map_err(|_| WriteError::TooLarge { bytes })?;
    let mut file = Vec::with_capacity(bytes);
    file.extend_from_slice(b"glTF");
    file.extend_from_slice(&2_u32.to_le_bytes());
    file.extend_from_slice(&total.to_le_bytes());
    let mut chunk = |kind: u32, data: &[u8]| {
        file.extend_from_slice(&(data.len() as u32).to_le_bytes());
        file.extend_from_slice(&kind.to_le_bytes());
        file.extend_from_slice(data);
    };
    chunk(JSON_CHUNK, &json);
    if !binary.is_empty() {
        chunk(BINARY_CHUNK, &binary);
    }
    Ok(file)
}
