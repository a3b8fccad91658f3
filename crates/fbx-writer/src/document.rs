//! What surrounds the objects: header, settings, definitions.
//!
//! Dates and identifiers are constants: the same model gives the same bytes, whenever and wherever it is written.

use crate::objects::{Objects, ROOT};
use crate::record::{Properties, Record};
use crate::space::Space;

/// FBX's unit of time.
pub const TICKS_PER_SEC: f64 = 46_186_158_000.0;
/// What the SDK derives the file's identifiers from.
const CREATION_TIME: &str = "1970-01-01 10:00:00:000";
const FILE_ID: [u8; 16] = *b"\x28\xb3\x2a\xeb\xb6\x24\xcc\xc2\xbf\xc8\xb0\x2a\xa9\x2b\xfc\xf1";
const CREATOR: &str = "Gaitway";
/// Metres are what glTF has, centimetres what `UnitScaleFactor` counts.
const CENTIMETRES_PER_METRE: f64 = 100.0;
/// `TimeMode` of frame rates.
const TIME_MODES: [(f64, i32); 8] =
    [(120.0, 1), (100.0, 2), (60.0, 3), (50.0, 4), (48.0, 5), (30.0, 6), (25.0, 10), (24.0, 11)];
/// `TimeMode` of any other frame rate.
const CUSTOM_TIME_MODE: i32 = 14;

/// A clip as the list of takes has it.
#[derive(Debug)]
pub struct Take {
    pub name: String,
    pub end_ticks: i64,
}

/// Converts seconds.
pub fn ticks(secs: f64) -> i64 {
    libm::round(secs * TICKS_PER_SEC) as i64
}

/// Returns all records of a file.
pub fn records(objects: Objects, space: &Space, takes: &[Take], frames_per_sec: f64) -> Vec<Record> {
    let definitions = definitions(&objects);
    vec![
        header(),
        Record::new("FileId").raw(&FILE_ID),
        Record::new("CreationTime").text(CREATION_TIME),
        Record::new("Creator").text(CREATOR),
        settings(space, takes, frames_per_sec),
        documents(takes),
        Record::new("References").list(),
        definitions,
        Record::new("Objects").list().with_all(objects.objects),
        Record::new("Connections").list().with_all(objects.connections),
        Record::new("Takes")
            .with(Record::new("Current").text(takes.first().map_or("", |take| &take.name)))
            .with_all(takes.iter().map(take)),
    ]
}

fn header() -> Record {
    let date =
        [("Year", 1970), ("Month", 1), ("Day", 1), ("Hour", 10), ("Minute", 0), ("Second", 0), ("Millisecond", 0)];
    let stamp = Record::new("CreationTimeStamp").with(Record::new("Version").i32(1000));
    let stamp = stamp.with_all(date.map(|(name, value)| Record::new(name).i32(value)));
    let texts = ["Title", "Subject", "Author", "Keywords", "Revision", "Comment"];
    let about = Record::new("MetaData").with(Record::new("Version").i32(100));
    let about = about.with_all(texts.map(|name| Record::new(name).text("")));
    let application =
        Properties::new().text("Original|ApplicationName", CREATOR).text("LastSaved|ApplicationName", CREATOR);
    Record::new("FBXHeaderExtension")
        .with(Record::new("FBXHeaderVersion").i32(1003))
        .with(Record::new("FBXVersion").i32(7400))
        .with(Record::new("EncryptionType").i32(0))
        .with(stamp)
        .with(Record::new("Creator").text(CREATOR))
        .with(
            Record::new("SceneInfo")
                .object_name("GlobalInfo", "SceneInfo")
                .text("UserData")
                .with(Record::new("Type").text("UserData"))
                .with(Record::new("Version").i32(100))
                .with(about)
                .with(application.record()),
        )
}

fn settings(space: &Space, takes: &[Take], frames_per_sec: f64) -> Record {
    // X is to the right in both.
    let (up, front, front_sign) = if space.is_z_up { (2, 1, -1) } else { (1, 2, 1) };
    let scale = CENTIMETRES_PER_METRE / space.unit;
    let mode = TIME_MODES.into_iter().find(|(rate, _)| (rate - frames_per_sec).abs() < 1e-3);
    let mode = mode.map_or(CUSTOM_TIME_MODE, |(_, mode)| mode);
    let end = takes.iter().map(|take| take.end_ticks).max().unwrap_or_default();
    let properties = Properties::new()
        .integer("UpAxis", up)
        .integer("UpAxisSign", 1)
        .integer("FrontAxis", front)
        .integer("FrontAxisSign", front_sign)
        .integer("CoordAxis", 0)
        .integer("CoordAxisSign", 1)
        .integer("OriginalUpAxis", up)
        .integer("OriginalUpAxisSign", 1)
        .double("UnitScaleFactor", scale)
        .double("OriginalUnitScaleFactor", scale)
        .text("DefaultCamera", "Producer Perspective")
        .choice("TimeMode", mode)
        .time("TimeSpanStart", 0)
        .time("TimeSpanStop", end)
        .double("CustomFrameRate", if mode == CUSTOM_TIME_MODE { frames_per_sec } else { -1.0 });
    Record::new("GlobalSettings").with(Record::new("Version").i32(1000)).with(properties.record())
}

fn documents(takes: &[Take]) -> Record {
    let active = takes.first().map_or("", |take| &take.name);
    let document = Record::new("Document")
        .i64(1)
        .text("")
        .text("Scene")
        .with(Properties::new().text("ActiveAnimStackName", active).record())
        .with(Record::new("RootNode").i64(ROOT));
    Record::new("Documents").with(Record::new("Count").i32(1)).with(document)
}

fn definitions(objects: &Objects) -> Record {
    let all: i32 = objects.counts.values().sum();
    let count = |name: &str, count: i32| Record::new("ObjectType").text(name).with(Record::new("Count").i32(count));
    Record::new("Definitions")
        .with(Record::new("Version").i32(100))
        .with(Record::new("Count").i32(all + 1))
        .with(count("GlobalSettings", 1))
        .with_all(objects.counts.iter().map(|(name, number)| count(name, *number)))
}

fn take(take: &Take) -> Record {
    let range = |name| Record::new(name).i64(0).i64(take.end_ticks);
    Record::new("Take")
        .text(&take.name)
        .with(Record::new("FileName").text(&format!("{}.tak", take.name)))
        .with(range("LocalTime"))
        .with(range("ReferenceTime"))
}
