//! Resolves URIs of buffers and images: data URIs, or files in the set.

use std::borrow::Cow;

use base64::Engine;
use gaitway_character::asset::{SharedBytes, Warning, Warnings};
use percent_encoding::percent_decode_str;

use crate::FileSet;
use crate::error::Problem;
use crate::file_set::Found;

pub fn is_data_uri(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// Percent-decodes a URI, unless the result is not UTF-8. As in browsers, `\` is `/`.
pub fn decode_uri(uri: &str) -> Cow<'_, str> {
    let decoded = percent_decode_str(uri).decode_utf8().unwrap_or(Cow::Borrowed(uri));
    if decoded.contains('\\') { decoded.replace('\\', "/").into() } else { decoded }
}

pub fn data_uri(place: &str, uri: &str) -> Result<Vec<u8>, Problem> {
    let Some((header, body)) = uri.split_once(',') else {
        return Err(Problem::new(place, "a data URI with a comma before its data", "none"));
    };
    if !header.to_ascii_lowercase().ends_with(";base64") {
        return Ok(percent_decode_str(body).collect());
    }
    let engine = base64::engine::GeneralPurpose::new(
        &base64::alphabet::STANDARD,
        base64::engine::GeneralPurposeConfig::new()
            .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent)
            .with_decode_allow_trailing_bits(true),
    );
    let body: Cow<'_, [u8]> = percent_decode_str(body).into();
    engine.decode(body.trim_ascii()).map_err(|problem| Problem::new(place, "base64", problem))
}

/// Tries the decoded URI, then the text itself: some exporters leave a bare `%` in names.
pub fn find<'a>(files: &'a FileSet, base: &str, uri: &str) -> Option<Found<'a>> {
    files.resolve(base, &decode_uri(uri)).or_else(|| files.resolve(base, uri))
}

/// Returns the bytes of the file that `uri` refers to, relative to the file `base`.
pub fn file(files: &FileSet, base: &str, uri: &str, warnings: &mut Warnings) -> Option<SharedBytes> {
    let found = find(files, base, uri)?;
    if found.by_bare_name {
        let uri = decode_uri(uri).into_owned();
        warnings.push(Warning::FoundByBareName { uri, used: found.name.to_owned() });
    }
    Some(found.bytes.clone())
}
