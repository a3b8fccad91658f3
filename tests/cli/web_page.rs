//! Self-contained pages that show a scene, and link cards. The browser's side of them is in tests/browser/web-page.test.mjs.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use base64::prelude::{BASE64_STANDARD, Engine as _};
use flate2::read::DeflateDecoder;
use serde_json::Value;

use crate::program::{check_fails, document, run};

/// Returns an empty folder of a test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("web-page").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Puts a template without a program into a folder, and returns the folder's path.
fn template(folder: &Path) -> String {
    let template = "<head><!-- scene --></head><body><!-- ktx2 -->decoder<!-- /ktx2 --><!-- files --></body>";
    fs::create_dir_all(folder.join("parts")).expect("a folder");
    fs::write(folder.join("parts/standalone-webgl2-0123456789abcdef.html"), template).expect("a template");
    text(folder)
}

fn text(path: &Path) -> String {
    path.to_str().expect("plain text").to_owned()
}

/// What a page has inside.
struct Page {
    title: String,
    link: String,
    /// Role, name and content.
    files: Vec<(String, String, Vec<u8>)>,
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> &'a str {
    text.split_once(before).and_then(|(_, rest)| rest.split_once(after)).map_or("", |(found, _)| found)
}

fn read(path: &Path) -> Page {
    let page = fs::read_to_string(path).expect("a page");
    let blocks = page.split("<script ").skip(1);
    let files = blocks.map(|block| {
        let mut content = Vec::new();
        let packed = BASE64_STANDARD.decode(between(block, ">", "</script>")).expect("base64");
        DeflateDecoder::new(&*packed).read_to_end(&mut content).expect("deflated");
        (between(block, "data-role=\"", "\"").to_owned(), between(block, "data-name=\"", "\"").to_owned(), content)
    });
    Page {
        title: between(&page, "<title>", "</title>").to_owned(),
        link: between(&page, "name=\"gaitway-link\" content=\"", "\"").replace("&amp;", "&"),
        files: files.collect(),
    }
}

fn without_warnings(mut pose: Value) -> Value {
    pose["warnings"] = Value::Null;
    pose
}

#[test]
fn the_files_and_the_link_of_a_page_show_the_same_pose() {
    let folder = folder("pose");
    let (page, out) = (template(&folder), folder.join("scene.html"));
    fs::copy("assets/samples/walk.bvh", folder.join("walk.bvh")).expect("a copy");
    let motion = text(&folder.join("walk.bvh"));
    let view = "v=1&t=1.2&play=0&root=horizontal:in-place&pose=5:0:20:0&camera=30,10,3,0,1,0";
    let scene = ["assets/samples/dwarf.glb", "--motion", &motion, "--view", view];
    let out_text = text(&out);
    let convert = [&["convert"][..], &scene, &["--out", &out_text, "--page", &page, "--title", "A <dwarf>"]].concat();
    let output = run(&convert);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let Page { title, link, files } = read(&out);
    assert_eq!(title, "A &lt;dwarf>");
    assert!(link.contains("embed=1") && !link.contains("file:"), "{link}");
    let names: Vec<_> = files.iter().map(|(role, name, _)| (role.as_str(), name.as_str())).collect();
    assert_eq!(names, [("model", "dwarf.glb"), ("motion", "walk.bvh")]);
    assert_eq!(files[0].2, fs::read("assets/samples/dwarf.glb").expect("the model"), "as it was");
    for (_, name, content) in &files {
        fs::write(folder.join(name), content).expect("a copy");
    }
    let shown = [text(&folder.join("dwarf.glb")), motion.clone()];
    let again = document(&["pose", &shown[0], "--motion", &shown[1], "--view", &link, "--json"]);
    let pose = document(&[&["pose"][..], &scene, &["--json"]].concat());
    assert_eq!(without_warnings(again), without_warnings(pose));
}

#[test]
fn parts_of_a_model_and_files_of_the_same_name_come_along() {
    let folder = folder("parts");
    let (page, out) = (template(&folder), folder.join("scene.html"));
    let output = run(&["convert", "sample:ssd", "--out", &text(&out), "--page", &page]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut names: Vec<String> = read(&out).files.into_iter().map(|(_, name, _)| name).collect();
    names.sort();
    assert_eq!(names, ["ssd.attach", "ssd.obj", "ssd.skel"]);
    let pilot = "assets/samples/pilot.glb";
    let output = run(&["convert", pilot, "--motion", pilot, "--out", &text(&out), "--page", &page]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let Page { link, files, .. } = read(&out);
    let names: Vec<_> = files.iter().map(|(role, name, _)| (role.as_str(), name.as_str())).collect();
    assert_eq!(names, [("model", "pilot.glb"), ("motion", "2/pilot.glb")]);
    assert!(link.contains("model=pilot.glb&motion=2/pilot.glb"), "{link}");
    // Generated, so there is no file.
    assert!(run(&["convert", "sample:walker", "--out", &text(&out), "--page", &page]).status.success());
    let Page { link, files, .. } = read(&out);
    assert!(link.contains("model=sample:walker") || !link.contains("model="), "{link}");
    assert!(files.is_empty());
}

#[test]
fn a_page_needs_its_program_and_an_html() {
    let folder = folder("missing");
    let out = text(&folder.join("scene.html"));
    let convert = |more: &[&str]| [&["convert", "sample:pilot", "--out", &out][..], more].concat().join("\n");
    let fails = |more: &[&str], says: &str| {
        check_fails(&convert(more).split('\n').collect::<Vec<_>>(), 1, says);
    };
    fails(&["--page", &text(&folder)], "there is no standalone-webgl2");
    let page = template(&folder);
    fails(&["--page", &page, "--renderer", "webgpu"], "there is no standalone-webgpu");
    fails(&["--page", &page, "--unit", "cm"], "--view");
    fails(&["--page", &page, "--clip", "Fly"], "“Fly”");
    check_fails(&["convert", "sample:pilot", "--title", "Pilot", "--out", "pilot.glb"], 1, "expected an .html");
}

#[test]
fn a_card_leads_to_its_link() {
    let folder = folder("card");
    let out = folder.join("card.html");
    let link = "https://example.org/gaitway/#v=1&model=https://example.org/a.glb&clip=\"run\"";
    let output = run(&["card", link, "--out", &text(&out), "--title", "A & B"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no picture"));
    let card = fs::read_to_string(&out).expect("a card");
    let escaped = link.replace('&', "&amp;").replace('"', "&quot;");
    assert!(
        card.contains(&format!("content=\"0; url={escaped}\"")) && card.contains(&format!("href=\"{escaped}\"")),
        "{card}"
    );
    assert!(card.contains("<title>A &amp; B</title>") && card.contains("default-src 'none'"), "{card}");
    assert!(!card.contains('{') && !card.contains("<img") && !card.contains("og:image"), "{card}");
    check_fails(&["card", "model=sample:pilot", "--out", &text(&out)], 1, "expected a link");
    check_fails(&["card", link, "--out", &text(&folder.join("card.png"))], 1, ".html");
}
