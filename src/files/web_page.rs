//! Pages that show a scene by themselves: a template of the page's build (xtask/site/standalone.mjs), which has a program inside, with
//! title, picture, link and files added. web/web-page.js does the same on the page.

use std::fs::{read_dir, read_to_string};
use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::DeflateEncoder;
use gaitway_character::asset::SharedBytes;
use gaitway_scene::editor::Scene;

/// Names the folder with the templates.
pub const PAGE_VARIABLE: &str = "GAITWAY_PAGE";

/// The graphics API that a page draws with, of which its template has the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Backend {
    /// Every current browser has it.
    #[default]
    WebGl2,
    /// Its program is a quarter smaller.
    WebGpu,
}

impl Backend {
    /// Its key in links and file names.
    pub fn key(self) -> &'static str {
        match self {
            Self::WebGl2 => "webgl2",
            Self::WebGpu => "webgpu",
        }
    }
}

/// There is no template.
#[derive(Debug, thiserror::Error)]
#[error(
    "the page's program is missing: there is no standalone-{}….html in {}; build it with `cargo xtask build` and name its folder, \
     dist, with --page or {}",
    .backend.key(), listed(.folders), PAGE_VARIABLE
)]
pub struct NoTemplate {
    /// Whose program it would have.
    pub backend: Backend,
    /// Where it was looked for.
    pub folders: Vec<PathBuf>,
}

fn listed(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Reads the template for pages with a program: from `folder` or what [`PAGE_VARIABLE`] names, otherwise from `near`, a program's own
/// folder, and the places beside it where packages put such files.
///
/// # Errors
/// If there is none.
pub fn read_template(backend: Backend, folder: Option<&Path>, near: &[PathBuf]) -> Result<String, NoTemplate> {
    let named = folder.map(Path::to_owned).or_else(|| std::env::var_os(PAGE_VARIABLE).map(PathBuf::from));
    let places = |near: &PathBuf| [near.clone(), near.join("share/gaitway"), near.join("../share/gaitway")];
    let folders: Vec<PathBuf> = named.map_or_else(|| near.iter().flat_map(places).collect(), |named| vec![named]);
    let found = folders.iter().flat_map(|folder| [folder.clone(), folder.join("parts")]).find_map(|folder| {
        let names = read_dir(&folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let start = format!("standalone-{}", backend.key());
        let name = names.filter(|name| name.starts_with(&start) && name.ends_with(".html")).max()?;
        read_to_string(folder.join(name)).ok()
    });
    found.ok_or(NoTemplate { backend, folders })
}

/// What a page shows besides its program.
#[derive(Debug)]
pub struct WebPage<'a> {
    /// What to call it.
    pub title: &'a str,
    /// A JPEG for previews of links to the page, and to cover it while it starts.
    pub picture: Option<&'a [u8]>,
    /// The files and the view of them.
    pub scene: &'a Scene,
    /// Images of the model have to be transcoded.
    pub has_ktx2: bool,
}

impl WebPage<'_> {
    /// Returns the page, if the template is one.
    pub fn write(&self, template: &str) -> Option<String> {
        let (before, rest) = template.split_once("<!-- scene -->")?;
        let (middle, after) = rest.split_once("<!-- files -->")?;
        let mut page = before.to_owned();
        let title = escaped(self.title);
        page += &format!(
            "<title>{title}</title>\n    <meta name=\"gaitway-link\" content=\"{}\">",
            escaped(&self.scene.link)
        );
        page += &format!("\n    <meta property=\"og:title\" content=\"{title}\">");
        if let Some(picture) = self.picture {
            page +=
                &format!("\n    <meta property=\"og:image\" content=\"data:image/jpeg;base64,{}\">", base64(picture));
        }
        match (self.has_ktx2, middle.split_once("<!-- ktx2 -->"), middle.split_once("<!-- /ktx2 -->")) {
            (false, Some((before, _)), Some((_, after))) => page.extend([before, after]),
            _ => page += middle,
        }
        for (role, files) in [("model", &self.scene.model), ("motion", &self.scene.motion)] {
            files.iter().for_each(|file| add_block(&mut page, role, file));
        }
        page += after;
        Some(page)
    }
}

fn add_block(page: &mut String, role: &str, (name, bytes): &(String, SharedBytes)) {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    // Nothing fails in memory.
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    let name = escaped(name);
    page.push_str(&format!(
        "<script type=\"application/octet-stream\" data-name=\"{name}\" data-role=\"{role}\" data-coding=\"deflate\">"
    ));
    page.push_str(&base64(&packed));
    page.push_str("</script>\n");
}

/// Escapes a text for HTML, also between quotation marks.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;")
}

/// Encodes bytes with the standard alphabet and padding.
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |at: usize| u32::from(group.get(at).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for at in 0..4 {
            let letter = char::from(LETTERS[(bits >> (18 - 6 * at) & 63) as usize]);
            text.push(if at <= group.len() { letter } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_pads_groups() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("\u{ff}", "w78=")];
        for (text, expected) in cases {
            assert_eq!(base64(text.as_bytes()), expected, "{text}");
        }
    }

    #[test]
    fn a_page_has_the_scene_where_the_template_says() {
        let template = "<!-- scene -->|<!-- ktx2 -->decoder<!-- /ktx2 -->|<!-- files -->|";
        let scene = Scene {
            title: String::new(),
            link: "v=1&clip=\"a\"".to_owned(),
            model: vec![("a<b.glb".to_owned(), SharedBytes::new(b"model".to_vec()))],
            motion: Vec::new(),
        };
        let page = WebPage { title: "<script>", picture: Some(b"JPEG"), scene: &scene, has_ktx2: false };
        let written = page.write(template).unwrap();
        assert!(written.starts_with("<title>&lt;script></title>"), "{written}");
        assert!(written.contains("content=\"v=1&amp;clip=&quot;a&quot;\""), "{written}");
        assert!(written.contains("data-name=\"a&lt;b.glb\" data-role=\"model\""), "{written}");
        assert!(!written.contains("decoder"), "{written}");
        assert!(WebPage { has_ktx2: true, ..page }.write(template).unwrap().contains("decoder"));
        assert_eq!(WebPage { title: "", picture: None, scene: &scene, has_ktx2: true }.write("something else"), None);
    }
}
