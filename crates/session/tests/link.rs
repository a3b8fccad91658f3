//! The files that a link names: listing them, marking local ones for the recipient to supply, leaving out missing ones,
//! and adding them again.

use gaitway_session::{Link, LinkRole, LinkedFile};
use serde_json::{Value, json};

fn file(role: LinkRole, name: &str, member: &str, is_to_bring: bool) -> LinkedFile {
    LinkedFile { role, name: name.to_owned(), member: member.to_owned(), is_to_bring }
}

fn owned(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|&text| text.to_owned()).collect()
}

#[track_caller]
fn check_file(pair: &str, expected: LinkedFile) {
    assert_eq!(Link::from(format!("v=1&{pair}&t=1")).files(), [expected], "{pair}");
}

fn files(link: &str) -> Vec<LinkedFile> {
    Link::from(link).files().to_vec()
}

fn shown_files(link: &str) -> String {
    Link::from(link).shown_files()
}

#[test]
fn a_file_is_a_url_a_sample_or_a_local_name() {
    check_file("model=sample:pilot", file(LinkRole::Model, "sample:pilot", "", false));
    check_file("motion=https://a.example/x%20y.bvh", file(LinkRole::Motion, "https://a.example/x y.bvh", "", false));
    check_file("model=file:S%C3%B6ldner.glb", file(LinkRole::Model, "Söldner.glb", "", true));
    check_file("model=100%", file(LinkRole::Model, "100%", "", false));
    assert_eq!(files("model=&motion=&t=1"), [], "no file has an empty name");
    assert_eq!(files("v=1&map=https://a.example/map.json&models=x&t=1"), []);
    assert_eq!(files(""), []);
}

/// web/still.js searches these links before the program has loaded; tests/browser/still.test.mjs checks that it finds
/// the same files.
#[test]
fn what_is_loaded_early_is_what_the_link_names() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("../../scene/tests/scene/early.json")).expect("JSON");
    for case in cases {
        let link = case["link"].as_str().expect("a text");
        let read = Link::from(link);
        let models: Vec<String> =
            read.files_of(LinkRole::Model).map(|file| format!("{}{}", file.name, file.member)).collect();
        assert_eq!(json!(models), case["models"], "{link}");
        let samples: Vec<&str> = read.files().iter().filter_map(|file| file.name.strip_prefix("sample:")).collect();
        assert_eq!(json!(samples), case["samples"], "{link}");
    }
}

#[test]
fn a_model_in_an_archive_belongs_to_the_archive() {
    check_file("model=two.zip%23!%2Fb%2Fman.glb", file(LinkRole::Model, "two.zip", "#!/b/man.glb", false));
    check_file("model=file:two.zip%23!/man.glb", file(LinkRole::Model, "two.zip", "#!/man.glb", true));
    check_file("model=a-folder%23!/man.glb", file(LinkRole::Model, "a-folder", "#!/man.glb", false));
    // The separator of an early version.
    check_file("model=Two.ZIP%23/man.glb", file(LinkRole::Model, "Two.ZIP", "#!/man.glb", false));
    check_file("model=odd%23/man.glb", file(LinkRole::Model, "odd#/man.glb", "", false));
}

#[test]
fn links_to_the_same_files_are_recognized() {
    let same = |link: &str, other: &str| assert_eq!(shown_files(link), shown_files(other), "{link}, {other}");
    let differ = |link: &str, other: &str| assert_ne!(shown_files(link), shown_files(other), "{link}, {other}");
    same("model=a.zip%23/b.glb", "model=a.zip%23!/b.glb");
    same("v=1&model=sample:pilot&t=1", "model=sample%3Apilot&clip=run");
    same("", "v=1&model=sample:walker");
    same("motion=a.bvh", "model=sample:walker&motion=a.bvh");
    differ("model=a.glb", "model=b.glb");
    differ("model=a.glb", "model=a.glb&motion=a.bvh");
    differ("model=a.glb&model=b.glb", "model=b.glb&model=a.glb");
    differ("model=a.zip%23!/a.glb", "model=a.zip%23!/b.glb");
}

#[test]
fn a_public_link_marks_only_local_files() {
    let check = |link: &str, local: &[&str], expected: &str| {
        assert_eq!(Link::from(link).public(&owned(local)).text(), expected, "{link}");
    };
    check("v=1&model=sample:pilot&t=1", &["fox.glb"], "v=1&model=sample:pilot&t=1");
    check("v=1&model=fox.glb&motion=fox.glb", &["fox.glb"], "v=1&model=file:fox.glb&motion=file:fox.glb");
    check("model=a/b%20c.glb&names=4:fox.glb", &["a/b c.glb"], "model=file:a%2Fb%20c.glb&names=4:fox.glb");
    check("model=two.zip%23!/b/man.glb", &["two.zip"], "model=file:two.zip%23!%2Fb%2Fman.glb");
    check("model=file:fox.glb", &["fox.glb"], "model=file:fox.glb");
    check("model=S%C3%B6ldner!.glb", &["Söldner!.glb"], "model=file:S%C3%B6ldner!.glb");
}

#[test]
fn an_embedded_link_has_one_embed_key() {
    assert_eq!(Link::from("v=1&embed=0&t=1").embedded().text(), "v=1&t=1&embed=1");
    assert_eq!(Link::from("v=1").embedded().text(), "v=1&embed=1");
}

#[test]
fn only_keys_that_apply_without_the_missing_files_are_kept() {
    let check = |link: &str, expected: &str| assert_eq!(Link::from(link).without_missing().text(), expected, "{link}");
    check("v=1&model=a.glb&clip=run&&t=1", "v=1&model=a.glb&clip=run&&t=1");
    // An empty stage stands for the model, and keeps the rest.
    let awaited = "v=1&model=file:a.glb&motion=file:b.bvh&t=1&exposure=1&embed=1&show=skeleton,weights";
    check(awaited, awaited);
    check("v=1&model=a.glb&motion=file:b.bvh&map=x.json&clip=run&t=1", "v=1&model=a.glb&map=x.json&clip=run&t=1");
    check("model=a.glb&motion=b.bvh&motion=file:c.bvh&play=0", "model=a.glb&motion=b.bvh&play=0");
    // An index counts the clips of all motions.
    check("model=a.glb&motion=file:b.bvh&motion=c.bvh&clip=1&t=1", "model=a.glb&motion=c.bvh&t=1");
    check("model=a.glb&light=file:c.hdr&clip=1", "model=a.glb&clip=1");
}

#[test]
fn supplied_files_replace_the_missing_ones() {
    let check = |link: &str, names: &[&str], expected: &str| {
        assert_eq!(Link::from(link).with_names(&owned(names)).text(), expected, "{link}");
    };
    check("v=1&model=file:a.glb&t=1", &["in/a b.glb"], "v=1&model=in%2Fa%20b.glb&t=1");
    check("model=file:two.zip%23!/man.glb&motion=c.bvh", &["two.zip"], "model=two.zip%23!%2Fman.glb&motion=c.bvh");
    check("model=file:a.glb&motion=file:b.bvh", &["x/a.glb", "b.bvh"], "model=x%2Fa.glb&motion=b.bvh");
    check("model=a.glb", &[], "model=a.glb");
    check(
        "model=file:a.glb&motion=file:b.bvh&motion=file:c.bvh",
        &["", "x/b.bvh"],
        "model=file:a.glb&motion=x%2Fb.bvh&motion=file:c.bvh",
    );
}

#[test]
fn sharing_a_link_and_supplying_its_files_restores_it() {
    let link = "v=1&model=two.zip%23!%2Fman.glb&motion=d%20e.bvh&clip=run";
    let shared = Link::from(link).public(&owned(&["two.zip", "d e.bvh"]));
    assert!(shared.files().iter().all(|file| file.is_to_bring), "{shared:?}");
    let names: Vec<String> = shared.files().iter().map(|file| file.name.clone()).collect();
    assert_eq!(shared.with_names(&names).text(), link);
}

#[test]
fn the_most_similar_link_shows_the_same_files() {
    let scenes = [
        "v=1&model=sample:pilot&clip=run&t=0.27",
        "v=1&model=sample:pilot&clip=idle&show=grid,split",
        "v=1&model=sample:mannequin&motion=sample:run",
    ]
    .map(Link::from);
    let check = |link: &str, expected| assert_eq!(Link::from(link).most_similar(&scenes), expected, "{link}");
    check("v=1&model=sample:pilot&clip=run&t=3", Some(0));
    check("v=1&model=sample:pilot&clip=idle&t=3", Some(1));
    check("v=1&model=sample:pilot", Some(0));
    check("v=1&model=sample:pilot&clip=wave&show=grid", Some(0));
    check("motion=sample:run&model=sample:mannequin&speed=2", Some(2));
    check("v=1&model=sample:mannequin", None);
    check("v=1", None);
}

/// Whoever shares a view whose motion hasn't arrived shares the motion, too.
#[test]
fn a_shared_link_asks_for_what_is_missing_here() {
    let asking = "v=1&model=sample:pilot&motion=file:walk.bvh&motion=sample:walk&light=file:beach.hdr&clip=9&fov=30&camera=1,2,3,4,5,6";
    let now = "v=1&model=sample:pilot&motion=sample:walk&copy=A:walk&clip=run&fov=20";
    assert_eq!(
        Link::from(now).with_missing(&asking.into()).text(),
        "model=sample:pilot&motion=file:walk.bvh&motion=sample:walk&light=file:beach.hdr&v=1&copy=A:walk&clip=run&fov=20\
         &camera=1,2,3,4,5,6"
    );
    // Which clip plays without a name is up to the version.
    let merged = |now: &str, asking: &str| Link::from(now).with_missing(&asking.into()).text().to_owned();
    assert_eq!(merged("v=2&model=a&t=1", "model=a&motion=file:b"), "model=a&motion=file:b&v=1&t=1");
    assert_eq!(merged("v=2&model=a&t=1", "v=2&model=a&motion=file:b"), "model=a&motion=file:b&v=2&t=1");
    assert_eq!(merged("v=2&model=a&clip=W", "v=1&model=a&motion=file:b"), "model=a&motion=file:b&v=2&clip=W");
    let other = "v=1&model=sample:dwarf&fov=20";
    assert_eq!(Link::from(other).with_missing(&asking.into()).text(), other, "something else is shown");
}

#[test]
fn an_image_that_lights_the_scene_is_a_file_of_the_link() {
    let link = "v=1&model=fox.glb&clip=Run&light=beach.hdr";
    let roles = |link: &str| files(link).iter().map(|file| (file.role, file.is_to_bring)).collect::<Vec<_>>();
    assert_eq!(roles(link), [(LinkRole::Model, false), (LinkRole::Light, false)]);
    assert_eq!(roles("v=1&light=outdoor"), [], "a generated light is none");
    assert_eq!(roles("v=1&light=outdor"), [], "nor is a misspelt one");
    let public = Link::from(link).public(&owned(&["beach.hdr"]));
    assert_eq!(public.text(), "v=1&model=fox.glb&clip=Run&light=file:beach.hdr");
    assert_eq!(public.without_missing().text(), "v=1&model=fox.glb&clip=Run");
    let awaiting = "v=1&model=file:fox.glb&clip=Run&light=file:beach.hdr&fov=20";
    assert_eq!(Link::from(awaiting).without_missing().text(), awaiting, "an empty stage keeps all");
    assert_eq!(public.with_names(&owned(&["beach.hdr"])).text(), link);
    assert_ne!(shown_files(link), shown_files("v=1&model=fox.glb&light=other.hdr"));
}
