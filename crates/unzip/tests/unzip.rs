//! Tests of the reader, on archives made byte by byte and by the `zip` crate.

use std::io::{Cursor, Read, Write};

use flate2::read::DeflateDecoder;
use gaitway_unzip::{Data, Directory, Member};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use damage::{Damage, cases};

#[path = "../../../tests/support/damage.rs"]
mod damage;

const CONTENTS: &[u8] = b"contents";
const CRC: u32 = 7;

/// A member of an archive that is made here. Its contents are [`CONTENTS`], its checksum [`CRC`].
struct Made<'a> {
    name: &'a [u8],
    flags: u16,
    method: u16,
    extra: Vec<u8>,
}

fn made(name: &[u8]) -> Made<'_> {
    Made { name, flags: 0, method: 0, extra: vec![9, 0, 1, 0, 7] }
}

/// How an archive is written.
#[derive(Clone, Copy, Default)]
struct Form {
    /// Its numbers have 64 bits.
    is_long: bool,
    /// The part of a split archive that it is.
    disk: u16,
    /// What the end records say too little about the directory's offset and size.
    missing: [u32; 2],
}

fn archive(members: &[Made], form: Form) -> Vec<u8> {
    let (mut file, mut directory) = (Vec::new(), Vec::new());
    let length = CONTENTS.len() as u32;
    for Made { name, flags, method, extra } in members {
        let (start, name_bytes) = (file.len() as u32, (name.len() as u16).to_le_bytes());
        // Only the directory has sizes, as if a data descriptor followed.
        file.extend([b"PK\x03\x04", &[0; 22][..], &name_bytes, &[3, 0], name, b"???", CONTENTS].concat());
        let (short, offset) = if form.is_long { (u32::MAX, u32::MAX) } else { (length, start) };
        let mut extra = extra.clone();
        if form.is_long {
            let numbers = [length, length, start].map(|number| u64::from(number).to_le_bytes());
            extra.extend([&[1, 0, 24, 0], numbers.as_flattened()].concat());
        }
        let sizes = [CRC, short, short].map(u32::to_le_bytes);
        let lengths = [extra.len() as u16, 3].map(u16::to_le_bytes);
        let mut listed = [b"PK\x01\x02", &[0; 4][..], &flags.to_le_bytes(), &method.to_le_bytes(), &[0; 4]].concat();
        listed.extend([sizes.as_flattened(), &name_bytes, lengths.as_flattened(), &[0; 8]].concat());
        listed.extend([&offset.to_le_bytes(), *name, &extra, b"???"].concat());
        directory.extend(listed);
    }
    let count = members.len();
    let (start, bytes) = (file.len() as u32 - form.missing[0], directory.len() as u32 - form.missing[1]);
    file.extend(&directory);
    let (mut short, mut numbers) = (count as u16, [bytes, start]);
    if form.is_long {
        (short, numbers) = (u16::MAX, [u32::MAX; 2]);
        let numbers = [count as u32, count as u32, bytes, start].map(|number| u64::from(number).to_le_bytes());
        let record = [b"PK\x06\x06", &44_u64.to_le_bytes()[..], &[0; 12], numbers.as_flattened()].concat();
        let locator = [b"PK\x06\x07", &[0; 4][..], &(file.len() as u64).to_le_bytes(), &[1, 0, 0, 0]].concat();
        file.extend([record, locator].concat());
    }
    let (disk, count, numbers) = (form.disk.to_le_bytes(), short.to_le_bytes(), numbers.map(u32::to_le_bytes));
    file.extend([b"PK\x05\x06", &disk[..], &disk, &count, &count, numbers.as_flattened(), b"\x07\0comment"].concat());
    file
}

fn forms() -> [Form; 2] {
    [false, true].map(|is_long| Form { is_long, ..Form::default() })
}

fn members(file: &[u8]) -> Result<Vec<Member<'_>>, String> {
    Directory::find(file)?.members().collect()
}

/// Reads an archive whose members have [`CONTENTS`], and returns their names.
#[track_caller]
fn names(file: &[u8]) -> Vec<String> {
    let members = members(file).unwrap();
    for member in &members {
        assert_eq!(member.data(file), Ok(Data::Stored(CONTENTS)));
        assert!(member.is_sound(8, CRC) && !member.is_sound(8, CRC - 1) && !member.is_sound(7, CRC));
    }
    members.into_iter().map(|member| member.name().into_owned()).collect()
}

#[track_caller]
fn check_fails<T: std::fmt::Debug>(outcome: Result<T, String>, parts: &[&str]) {
    let problem = outcome.unwrap_err();
    for part in parts.iter().chain(&["expected ", "found ", "; "]) {
        assert!(problem.contains(part), "{part}: {problem}");
    }
}

#[test]
fn numbers_have_32_or_64_bits_and_names_either_encoding() {
    for form in forms() {
        let members = ["ü/é".as_bytes(), b"\x81/\x82", b"", b"\xff\xb3"].map(made);
        assert_eq!(names(&archive(&members, form)), ["ü/é", "ü/é", "", "\u{a0}│"]);
    }
}

#[test]
fn a_name_in_an_extra_field_counts_while_it_belongs_to_the_other_name() {
    let crc = 0x5E23_7E06_u32; // Python's zlib.crc32(b"name")
    for (crc, expected) in [(crc, "名前"), (crc ^ 1, "name")] {
        let name = "名前".as_bytes();
        let field = [&0x7075_u16.to_le_bytes()[..], &[11, 0, 1], &crc.to_le_bytes(), name].concat();
        let member = Made { extra: [made(b"").extra, field].concat(), ..made(b"name") };
        for form in forms() {
            assert_eq!(names(&archive(std::slice::from_ref(&member), form)), [expected]);
        }
    }
}

#[test]
fn what_surrounds_an_archive_is_skipped() {
    for form in forms() {
        let file = archive(&[made(b"a"), made(b"b")], form);
        for before in [&b""[..], b"MZ", b"#!/bin/sh\nexec unzip $0\n", &archive(&[made(b"c")], form)] {
            // The record of an empty archive, whose directory has two bytes.
            let record = b"PK\x05\x06\0\0\0\0\0\0\0\0\x02\0\0\0\0\0\0\0\0\0";
            for after in [&b""[..], b"\r\n", b"PK\x05\x06", record, &[0; 1000]] {
                assert_eq!(names(&[before, &file, after].concat()), ["a", "b"], "{before:?} {after:?}");
            }
        }
    }
}

/// Go's tests have such archives, which were seen in the wild.
#[test]
fn the_directory_is_found_with_a_wrong_offset_or_size() {
    for form in forms() {
        let entry = (46 + 1 + made(b"").extra.len() + if form.is_long { 28 } else { 0 } + 3) as u32;
        for missing in [[5, 0], [0, 5], [0, entry]] {
            let file = archive(&[made(b"a"), made(b"b")], Form { missing, ..form });
            assert_eq!(names(&file), ["a", "b"], "{missing:?}");
        }
        let file = archive(&[made(b"a")], Form { missing: [1, 1], ..form });
        check_fails(members(&file), &["at its end, found none"]);
    }
}

#[test]
fn an_archive_may_be_empty() {
    for form in forms() {
        let file = archive(&[], form);
        assert_eq!(names(&file), [""; 0]);
        assert_eq!(names(&[b"MZ", &file[..]].concat()), [""; 0]);
    }
}

#[test]
fn folders_are_recognized() {
    let file = archive(&["a/", "a\\", "a/b"].map(|name| made(name.as_bytes())), Form::default());
    let folders: Vec<bool> = members(&file).unwrap().iter().map(Member::is_folder).collect();
    assert_eq!(folders, [true, true, false]);
}

#[test]
fn what_is_not_supported_is_named() {
    let check = |flags, method, found| {
        let file = archive(&[Made { flags, method, ..made(b"a") }], Form::default());
        let [member] = &members(&file).unwrap()[..] else { panic!("one member") };
        check_fails(member.data(&file), &[found, "unpack it with another program"]);
    };
    check(1, 0, "found encrypted data");
    check(1, 99, "found encrypted data");
    check(0, 9, "found Deflate64");
    check(0, 12, "found bzip2");
    check(0, 14, "found LZMA");
    check(0, 93, "found Zstandard");
    check(0, 95, "found XZ");
    check(0, 98, "found PPMd");
    check(0, 6, "found compression method 6");
    let split = archive(&[made(b"a")], Form { disk: 2, ..Form::default() });
    check_fails(members(&split), &["found the last part of a split one"]);
}

#[test]
fn members_that_overlap_are_an_error() {
    let mut file = archive(&[made(b"a"), made(b"b")], Form::default());
    // The first member takes all of the archive but its comment.
    let directory = file.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    let most = (file.len() as u32 - 7).to_le_bytes();
    file[directory + 20..][..4].copy_from_slice(&most);
    check_fails(members(&file), &["entry 2 of 2", "more data than the archive has"]);
}

#[test]
fn a_damaged_directory_names_the_entry() {
    let mut file = archive(&[made(b"a"), made(b"b")], Form::default());
    let second = file.windows(4).rposition(|window| window == b"PK\x01\x02").unwrap();
    file[second] = b'Q';
    check_fails(members(&file), &["entry 2 of 2 in the list of files: expected a file, found other data"]);
    let mut file = archive(&[made(b"a")], Form::default());
    let count = file.len() - b"comment".len() - 12;
    file[count] = 3;
    check_fails(members(&file), &["entry 2 of 3"]);
}

#[test]
fn what_is_cut_short_has_no_members() {
    for form in forms() {
        let file = archive(&[made(b"a")], form);
        // The end of the comment isn't missed.
        for end in 0..file.len() - 7 {
            check_fails(members(&file[..end]), &["cut short?"]);
        }
        for start in 1..file.len() {
            let cut = &file[start..];
            let Ok(members) = members(cut) else { continue };
            for member in members {
                check_fails(member.data(cut), &["expected 8 bytes of data at byte 0", "download or save it again"]);
            }
        }
    }
}

/// Names and contents, of archives that nothing is wrong with.
type Files = Vec<(String, Vec<u8>)>;

fn ours(file: &[u8]) -> Result<Files, String> {
    let read = |member: Result<Member, String>| {
        let member = member?;
        let mut contents = Vec::new();
        match member.data(file)? {
            Data::Stored(bytes) => contents.extend(bytes),
            Data::Deflated(packed) => {
                let inflated = DeflateDecoder::new(packed).take(member.bytes + 1).read_to_end(&mut contents);
                inflated.map_err(|_| member.damaged())?;
            }
        }
        let mut crc = flate2::Crc::new();
        crc.update(&contents);
        let is_sound = member.is_sound(contents.len(), crc.sum());
        if is_sound { Ok((member.name().into_owned(), contents)) } else { Err(member.damaged()) }
    };
    Directory::find(file)?.members().map(read).collect()
}

fn theirs(file: &[u8]) -> Option<Files> {
    let mut archive = ZipArchive::new(Cursor::new(file)).ok()?;
    let mut files = Vec::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).ok()?;
        let (name, mut contents) = (entry.name().ok()?.into_owned(), Vec::new());
        entry.read_to_end(&mut contents).ok()?;
        files.push((name, contents));
    }
    Some(files)
}

/// Archives as the `zip` crate writes them.
fn written() -> Vec<Vec<u8>> {
    fn fill<W: Write + std::io::Seek>(mut writer: ZipWriter<W>, is_long: bool) -> W {
        for (name, method) in [("a.txt", CompressionMethod::Stored), ("ü/名.bin", CompressionMethod::Deflated)] {
            let options = SimpleFileOptions::default().compression_method(method).large_file(is_long);
            writer.start_file(name, options).unwrap();
            writer.write_all(&name.repeat(50).into_bytes()).unwrap();
        }
        writer.start_file("empty", SimpleFileOptions::default()).unwrap();
        writer.add_directory("folder", SimpleFileOptions::default()).unwrap();
        writer.set_comment("a comment").unwrap();
        writer.finish().unwrap()
    }
    // A stream has data descriptors.
    let streamed = fill(ZipWriter::new_stream(Vec::new()), false).into_inner();
    let seekable = [false, true].map(|is_long| fill(ZipWriter::new(Cursor::new(Vec::new())), is_long).into_inner());
    [vec![streamed], seekable.to_vec()].concat()
}

#[test]
fn the_zip_crate_reads_the_same() {
    for file in written() {
        let files = ours(&file).unwrap();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["a.txt", "ü/名.bin", "empty", "folder/"]);
        assert_eq!(Some(files), theirs(&file));
    }
}

#[test]
fn of_damaged_archives_the_zip_crate_reads_the_same_or_nothing() {
    let (mut damage, mut both) = (Damage::new(), 0);
    for seed in written() {
        for case in 0..cases() {
            let file = damage.of(&seed);
            match (ours(&file), theirs(&file)) {
                (Ok(ours), Some(theirs)) => {
                    // It decodes names as the archive says, and keeps one file of each name.
                    let contents =
                        |files: &Files| files.iter().map(|(_, contents)| contents.clone()).collect::<Vec<_>>();
                    assert_eq!(contents(&ours), contents(&theirs), "{case}");
                    both += 1;
                }
                (Err(problem), _) => check_fails::<()>(Err(problem), &[]),
                _ => {}
            }
        }
    }
    println!("{both} of {} were read", 3 * cases());
    assert!((1..3 * cases()).contains(&both));
}
