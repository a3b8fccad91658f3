//! An archive of files, stored without compression: what goes in is compressed or small. No clock is read, so the same files give
//! the same archive.

use flate2::Crc;

/// The earliest date that the format can express, 1 January 1980.
const DATE: u16 = 0x21;
/// Version 2.0 of the format, with names in UTF-8.
const VERSION: u16 = 20;
const UTF8: u16 = 1 << 11;

/// Returns an archive of files with these names. `None` if it would exceed 4 GiB or 65,535 files, for which the format has an
/// extension that not everything reads.
pub fn zip<'a>(files: impl ExactSizeIterator<Item = (&'a str, &'a [u8])>) -> Option<Vec<u8>> {
    let count = u16::try_from(files.len()).ok()?;
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let start = u32::try_from(archive.len()).ok()?;
        let (length, name_length) = (u32::try_from(bytes.len()).ok()?, u16::try_from(name.len()).ok()?);
        let mut crc = Crc::new();
        crc.update(bytes);
        // What both headers share: version, flags, method, time, date, checksum, sizes, lengths of the name and of extra fields.
        let mut common = Vec::new();
        common.extend([VERSION, UTF8, 0, 0, DATE].map(u16::to_le_bytes).concat());
        common.extend([crc.sum(), length, length].map(u32::to_le_bytes).concat());
        common.extend([name_length, 0].map(u16::to_le_bytes).concat());
        archive.extend(b"PK\x03\x04");
        archive.extend(&common);
        archive.extend(name.as_bytes());
        archive.extend(bytes);
        directory.extend(b"PK\x01\x02");
        directory.extend(VERSION.to_le_bytes());
        directory.extend(common);
        // Length of a comment, disk, attributes.
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (start, length) = (u32::try_from(archive.len()).ok()?, u32::try_from(directory.len()).ok()?);
    archive.append(&mut directory);
    archive.extend(b"PK\x05\x06");
    archive.extend([0, 0, count, count].map(u16::to_le_bytes).concat());
    archive.extend([length, start].map(u32::to_le_bytes).concat());
    archive.extend([0; 2]);
    Some(archive)
}
