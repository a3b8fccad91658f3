//! URLs as people copy them from the address bar.

use gaitway::files::raw_address;

fn check(page: &str, raw: &str) {
    assert_eq!(raw_address(page), raw, "{page}");
    assert_eq!(raw_address(raw), raw, "the raw URL is unchanged");
}

fn check_same(url: &str) {
    assert_eq!(raw_address(url), url);
}

#[test]
fn the_github_page_of_a_file_becomes_the_raw_file() {
    let fox = "https://raw.githubusercontent.com/KhronosGroup/glTF-Sample-Assets/main/Models/Fox/glTF-Binary/Fox.glb";
    let page = "github.com/KhronosGroup/glTF-Sample-Assets/blob/main/Models/Fox/glTF-Binary/Fox.glb";
    check(&format!("https://{page}"), fox);
    check(&format!("http://www.{page}?raw=true"), fox);
    check(&format!("HTTPS://GitHub.com/{}#L3", page.split_once('/').expect("has one").1), fox);
    check(&format!(" https://{page} "), fox);
    check(&format!("https://{}", page.replace("/blob/", "/raw/")), fox);
    check(
        "https://github.com/o/r/blob/feature/new%20walk/a%20b/walk.bvh?plain=1",
        "https://raw.githubusercontent.com/o/r/feature/new%20walk/a%20b/walk.bvh",
    );
    check(
        "https://github.com/o/r/raw/refs/heads/main/map.json",
        "https://raw.githubusercontent.com/o/r/refs/heads/main/map.json",
    );
}

#[test]
fn a_gist_becomes_its_raw_file() {
    let id = "0123456789abcdef0123456789abcdef";
    check(
        &format!("https://gist.github.com/someone/{id}#file-map-json"),
        &format!("https://gist.githubusercontent.com/someone/{id}/raw"),
    );
    check(
        &format!("https://gist.github.com/someone/{id}/raw/map.json"),
        &format!("https://gist.githubusercontent.com/someone/{id}/raw/map.json"),
    );
}

#[test]
fn other_urls_are_unchanged() {
    check_same("");
    check_same("sample:walker");
    check_same("models/blob/main/fox.glb");
    check_same("https://example.org/o/r/blob/main/fox.glb?raw=true");
    check_same("https://github.com/o/r");
    check_same("https://github.com/o/r/blob/main");
    check_same("https://github.com/o/r/tree/main/models");
    check_same("https://github.com/o/r/releases/download/v1/fox.glb");
    check_same("https://github.com.example.org/o/r/blob/main/fox.glb");
    check_same("https://gist.github.com/someone");
    check_same("https://gist.github.com/someone/not-a-gist");
    check_same("ftp://github.com/o/r/blob/main/fox.glb");
}
