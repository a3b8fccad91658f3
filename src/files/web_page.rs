//! Self-contained pages that show a scene: a template with a program, from the page's build (xtask/site/standalone.mjs), with
//! title, picture, link and files added. web/web-page.js does the same on the page.

use std::fs::{read_dir, read_to_string};
use std::io::Write;
use std::path::{Path, PathBuf};

use base64::prelude::{BASE64_STANDARD, Engine as _};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use gaitway_character::asset::SharedBytes;
use gaitway_scene::editor::Scene;

/// The environment variable with the folder of the templates.
pub const PAGE_VARIABLE: &str = "GAITWAY_PAGE";

/// The graphics API that a page draws with. Each has a template with its own program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Backend {
    /// Every current browser has it.
    #[default]
    WebGl2,
    /// Its program is a quarter smaller.
    WebGpu,
}

impl Backend {
    /// Returns its key in links and file names.
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
    /// The graphics API of its program.
    pub backend: Backend,
    /// Where it was looked for.
    pub folders: Vec<PathBuf>,
}

fn listed(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Reads the template for a graphics API: from `folder` or the one that [`PAGE_VARIABLE`] names, otherwise from the folders in
/// `near` and where packages put such files beside them.
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
    /// Its title.
    pub title: &'a str,
    /// A JPEG for previews of links to the page, and to cover it while it starts.
    pub picture: Option<&'a [u8]>,
    /// The files and the view of them.
    pub scene: &'a Scene,
    /// Whether images of the model have to be transcoded.
    pub has_ktx2: bool,
}

impl WebPage<'_> {
    /// Returns the page, or `None` if the text is not a template.
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
            page += &format!(
                "\n    <meta property=\"og:image\" content=\"data:image/jpeg;base64,{}\">",
                BASE64_STANDARD.encode(picture)
            );
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
    // Writing to memory cannot fail.
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    let name = escaped(name);
    page.push_str(&format!(
        "<script type=\"application/octet-stream\" data-name=\"{name}\" data-role=\"{role}\" data-coding=\"deflate\">"
    ));
    page.push_str(&BASE64_STANDARD.encode(&packed));
    page.push_str("</script>\n");
}

/// Escapes a text for HTML, also between quotation marks.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

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
