//! Where `gaitway render --frames` puts its pictures: a folder of PNGs, or a video or GIF that ffmpeg encodes. An encoder of our own
//! would be larger than the rest of the program, and ffmpeg has every codec.

use std::ffi::OsString;
use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::thread::{self, JoinHandle};

use super::failure::{Failure, Outcome};
use super::output::{check_output, write_output};
use crate::files::{Disk, TemporaryFile, describe, encode_png};

/// File extensions for what ffmpeg encodes.
const ENCODED_EXTENSIONS: &[&str] =
    &[Container::Mp4.extension(), Container::WebM.extension(), Container::Gif.extension()];

/// The pictures of a sequence, all of one size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    pub size: [u32; 2],
    pub frames_per_sec: u32,
    pub frame_count: u32,
    /// Whether the background is transparent, which all but an .mp4 can be.
    pub is_transparent: bool,
}

/// Takes one picture after the other.
pub(super) enum Sequence<'a> {
    Folder { folder: &'a Path, format: Format, written: u32 },
    Video(Encoder<'a>),
}

impl<'a> Sequence<'a> {
    /// An output with the extension of a video or GIF becomes one, every other one a folder, which must be new or empty.
    pub fn create(out: &'a Path, format: Format, disk: &Disk) -> Outcome<Self> {
        if out.extension().is_some() && !out.is_dir() {
            check_output(out, ENCODED_EXTENSIONS, disk)?;
            return Encoder::start(out, format).map(Self::Video);
        }
        let failed = |problem| Failure::new(describe(&problem)).in_file(out.display());
        match fs::create_dir(out) {
            Err(problem) if problem.kind() == ErrorKind::AlreadyExists => {}
            created => created.map_err(failed)?,
        }
        if fs::read_dir(out).map_err(failed)?.next().is_some() {
            return Err(Failure::expected("a new or an empty folder", "one with files").in_file(out.display()));
        }
        Ok(Self::Folder { folder: out, format, written: 0 })
    }

    /// Whether transparent pixels are entirely so.
    pub fn has_hard_edges(&self) -> bool {
        matches!(self, Self::Video(Encoder { container: Container::Gif, .. }))
    }

    /// Adds a picture: RGBA rows from the top, with straight alpha.
    pub fn add(&mut self, pixels: &[u8], disk: &Disk) -> Outcome {
        match self {
            Self::Video(encoder) => encoder.add(pixels),
            Self::Folder { folder, format, written } => {
                *written += 1;
                let digits = format.frame_count.to_string().len();
                let [width, height] = format.size;
                let png = encode_png(width, height, pixels).ok_or_else(|| Failure::new(super::render::NOT_READ))?;
                write_output(&folder.join(format!("frame-{written:0digits$}.png")), &png, &["png"], disk)
            }
        }
    }

    /// Completes the output.
    pub fn finish(self, disk: &Disk) -> Outcome {
        match self {
            Self::Folder { .. } => Ok(()),
            Self::Video(encoder) => encoder.finish(disk),
        }
    }
}

/// What ffmpeg writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Container {
    Mp4,
    WebM,
    Gif,
}

/// Frames per second: players slow down GIFs whose frames are shorter than 2 hundredths of a second.
const MAX_GIF_RATE: u32 = 50;

impl Container {
    /// By the file extension, one of [`ENCODED_EXTENSIONS`].
    fn of(out: &Path) -> Self {
        let is =
            |container: &Self| out.extension().is_some_and(|found| found.eq_ignore_ascii_case(container.extension()));
        [Self::Mp4, Self::Gif].into_iter().find(is).unwrap_or(Self::WebM)
    }

    const fn extension(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::WebM => "webm",
            Self::Gif => "gif",
        }
    }

    /// Arguments for how the frames are encoded.
    fn arguments(self, is_transparent: bool) -> impl Iterator<Item = &'static str> {
        // Players take standard definition for BT.601 and everything else for BT.709, unless the file says which it is.
        let bt709 = "-vf scale=out_color_matrix=bt709 -colorspace bt709 -color_primaries bt709 -color_trc bt709";
        let [colors, codec] = match (self, is_transparent) {
            (Self::Mp4, _) => [bt709, "-c:v libx264 -crf 18 -pix_fmt yuv420p -movflags +faststart"],
            (Self::WebM, true) => [bt709, "-c:v libvpx-vp9 -crf 24 -b:v 0 -pix_fmt yuva420p"],
            (Self::WebM, false) => [bt709, "-c:v libvpx-vp9 -crf 24 -b:v 0 -pix_fmt yuv420p"],
            // A palette for each frame, dithered with a pattern that stays where it is.
            (Self::Gif, _) => [
                "-vf split[a][b];[a]palettegen=stats_mode=single[palette];[b][palette]paletteuse=new=1:dither=bayer:bayer_scale=2",
                "-c:v gif",
            ],
        };
        colors.split_whitespace().chain(codec.split_whitespace())
    }
}

/// A running ffmpeg. It writes to a temporary file, since an .mp4 is completed at its beginning.
pub(super) struct Encoder<'a> {
    out: &'a Path,
    container: Container,
    temporary: TemporaryFile,
    process: Child,
    input: ChildStdin,
    /// What it prints, read all along so that it never waits for a reader.
    said: JoinHandle<String>,
}

impl<'a> Encoder<'a> {
    fn start(out: &'a Path, format: Format) -> Outcome<Self> {
        let Format { size: [width, height], frames_per_sec, is_transparent, .. } = format;
        let container = Container::of(out);
        if container != Container::Gif && (width % 2 != 0 || height % 2 != 0) {
            // Videos store colours at half the resolution.
            return Err(
                Failure::expected("an even width and height for a video", format!("{width}x{height}")).at("--size")
            );
        }
        if container == Container::Gif && frames_per_sec > MAX_GIF_RATE {
            let failure = Failure::expected(format!("at most {MAX_GIF_RATE} for a .gif"), frames_per_sec.to_string());
            return Err(failure.at("--frames"));
        }
        if container == Container::Mp4 && is_transparent {
            let failure = Failure::new("an .mp4 can't be transparent");
            return Err(failure
                .with_hint("choose .webm, .gif, a folder of PNGs, or another background")
                .in_file(out.display()));
        }
        let folder = std::env::temp_dir();
        let temporary = TemporaryFile::create(|name| folder.join(format!("{name}.{}", container.extension())))
            .map_err(|problem| Failure::new(describe(&problem)).in_file(folder.display()))?;
        let size = format!("{width}x{height}");
        let rate = frames_per_sec.to_string();
        let input = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s:v", &size, "-r", &rate, "-i", "-"];
        let started = Command::new("ffmpeg")
            .args(["-hide_banner", "-loglevel", "error", "-y"])
            .args(input)
            .args(container.arguments(is_transparent))
            .arg(as_argument(temporary.path()))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn();
        let mut process = started.map_err(|problem| match problem.kind() {
            ErrorKind::NotFound => Failure::new("ffmpeg, which encodes videos, isn't installed")
                .with_hint("install it, or give --out a folder for PNGs")
                .in_file(out.display()),
            _ => Failure::new(describe(&problem)).in_file("ffmpeg"),
        })?;
        let (Some(input), Some(mut errors)) = (process.stdin.take(), process.stderr.take()) else {
            return Err(Failure::new("ffmpeg has no standard input").in_file(out.display()));
        };
        let said = thread::spawn(move || {
            let mut said = Vec::new();
            // What was read until an error is what there is to report.
            let _ = errors.read_to_end(&mut said);
            String::from_utf8_lossy(&said).trim().replace('\n', ", ")
        });
        Ok(Self { out, container, temporary, process, input, said })
    }

    fn add(&mut self, pixels: &[u8]) -> Outcome {
        // If ffmpeg has stopped, `finish` reports why.
        match self.input.write_all(pixels) {
            Err(problem) if problem.kind() != ErrorKind::BrokenPipe => {
                Err(Failure::new(describe(&problem)).in_file("ffmpeg"))
            }
            _ => Ok(()),
        }
    }

    fn finish(mut self, disk: &Disk) -> Outcome {
        drop(self.input);
        let status = self.process.wait();
        let said = self.said.join().unwrap_or_default();
        match (status, fs::read(self.temporary.path())) {
            (Ok(status), Ok(video)) if status.success() && !video.is_empty() => {
                write_output(self.out, &video, ENCODED_EXTENSIONS, disk)
            }
            _ => Err(Failure::new(format!("ffmpeg couldn't encode the video: {said}")).in_file(self.out.display())),
        }
    }
}

/// Returns a path as a URL for ffmpeg, which would take one that begins with `-` for an option, and one with a colon for another
/// protocol.
fn as_argument(path: &Path) -> OsString {
    let mut argument = OsString::from("file:");
    argument.push(path);
    argument
}
