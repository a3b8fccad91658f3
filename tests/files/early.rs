//! A model that is shown before its images have arrived.

use std::cell::RefCell;

use gaitway::files::{EarlyWatch, ImageLimits, Role, decode_images, read_paths};
use gaitway_formats::{FileSet, load};
use gaitway_scene::editor::{Contents, Editor, Export, ModelFiles, OpenedModel};
use gaitway_scene::library::{ClipId, ImageData, Model, ModelId};
use gaitway_scene::state::{Command, ViewerState, from_link};
use serde_json::json;

use crate::build_gltf::{Build, F32, floats};

const URL: &str = "https://example.org/model.glb";

/// A moving triangle with three images at the end of the file, which are large for what they show.
fn file() -> Vec<u8> {
    let mut build = Build::animated("translation", &[0.0, 1.0], "VEC3", 2, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let uvs = build.accessor(F32, "VEC2", 3, &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    build.attribute("TEXCOORD_0", uvs);
    let png = [gaitway::files::encode_png(1, 1, &[10, 20, 30, 255]).expect("a PNG"), vec![0; 100_000]].concat();
    let views: Vec<usize> = (0..3).map(|_| build.view(&png)).collect();
    build.json["images"] = views.iter().map(|view| json!({ "bufferView": view })).collect();
    build.json["textures"] = json!([{ "source": 0 }, { "source": 1 }, { "source": 2 }]);
    build.json["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "occlusionTexture": { "index": 1 },
        "normalTexture": { "index": 2 },
    }]);
    build.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    build.glb()
}

/// Feeds a file in pieces; returns what was shown.
fn shown_early(view: &ViewerState, file: &[u8]) -> Vec<Model> {
    let shown = RefCell::new(Vec::new());
    let show = |model: Model| shown.borrow_mut().push(model);
    let Some(mut watch) = EarlyWatch::of(view, &show) else { return Vec::new() };
    for end in (0..file.len()).step_by(1000) {
        watch.notice("model.glb", &file[..end]);
    }
    drop(watch);
    shown.into_inner()
}

fn complete(file: &[u8]) -> OpenedModel {
    let mut set = FileSet::default();
    set.insert("model.glb", file);
    let mut asset = load(&set).expect("a good file");
    let images = decode_images(&mut asset, &ImageLimits::default());
    let files = Some(ModelFiles { set, name: "model.glb".to_owned() });
    OpenedModel { model: Model::new(URL.to_owned(), asset, images), files }
}

/// An editor with the model that was shown early.
fn early_editor() -> (Editor, ModelId) {
    let view = ViewerState::of_model(URL.to_owned());
    let mut early = shown_early(&view, &file());
    let models = early.drain(..).map(OpenedModel::from).collect();
    let mut editor = Editor::default();
    editor
        .open(Contents { models, motions: Some(Vec::new()), ..Contents::default() }, Some(view), &mut any)
        .expect("fits");
    let id = editor.library().active().expect("it was shown").id;
    (editor, id)
}

#[test]
fn a_view_with_more_files_is_shown_once_all_are_there() {
    let shown = |link: &str| shown_early(&from_link(link).0, &file()).len();
    assert_eq!(shown(&format!("model={URL}")), 1);
    assert_eq!(shown(&format!("model={URL}&motion=walk.bvh")), 0);
    assert_eq!(shown(&format!("model={URL}&light=sky.hdr")), 0);
    assert_eq!(shown(&format!("model={URL}&model=other.glb")), 0);
    assert_eq!(shown("model=sample:pilot"), 0);
    assert_eq!(shown("model=https://example.org/all.zip%23!/model.glb"), 0);
}

#[test]
fn stand_ins_look_like_no_image() {
    let (editor, _) = early_editor();
    let model = editor.library().active().expect("a model");
    let texel = |image: &Option<ImageData>| match image {
        Some(ImageData::Rgba8 { width: 1, height: 1, pixels }) => pixels.clone(),
        other => panic!("{other:?}"),
    };
    let texels: Vec<Vec<u8>> = model.images.shown().iter().map(texel).collect();
    assert_eq!(
        texels,
        [[255, 255, 255, 255], [255, 255, 0, 255], [128, 128, 255, 255]],
        "rough, not metallic, and flat"
    );
    assert_eq!((model.source.as_str(), model.origin.as_str()), (URL, URL));
    assert!(model.awaits_images() && model.findings().is_empty(), "none is reported missing: {:?}", model.findings());
    assert!(!editor.has_gltf(), "its file has yet to arrive");
}

#[test]
fn completing_a_model_changes_nothing_else() {
    let (mut editor, id) = early_editor();
    editor.apply(Command::SetSpeed(2.0));
    editor.apply(Command::Advance(0.2));
    editor.apply(Command::SelectJoint(Some(0)));
    let before = (editor.state().clone(), editor.can_undo(), editor.take_events());
    editor.take_needs_redraw();
    let mut admitted = Vec::new();
    let admit = &mut |model: &Model| {
        admitted.push((model.id, model.images.shown().iter().flatten().count()));
        Ok(())
    };
    editor.complete(id, complete(&file()), admit).expect("fits");
    assert_eq!(admitted, [(id, 3)]);
    assert!(editor.take_needs_redraw());
    assert_eq!((editor.state(), editor.can_undo()), (&before.0, before.1));
    assert!(editor.take_events().is_empty(), "nothing is said about it");
    let model = editor.library().active().expect("a model");
    assert!(model.id == id && model.asset.images.iter().all(|image| !image.bytes.is_empty()));
    assert!(!model.awaits_images());
    assert!(editor.has_gltf());
}

#[test]
fn a_model_is_exported_once_its_images_are_there() {
    let (mut editor, id) = early_editor();
    let whole = Export::FullModel { posed: false };
    for what in [&whole, &Export::Model { clip: ClipId::Own(0) }] {
        let refused = editor.export(what).expect_err("the file has not arrived");
        assert!(refused.contains("images have not arrived"), "{refused}");
    }
    editor.complete(id, complete(&file()), &mut any).expect("fits");
    let exported = editor.export(&whole).expect("the file is there");
    assert!(exported.bytes.len() > 3 * 100_000, "{}", exported.bytes.len());
}

#[test]
fn only_the_active_model_has_to_fit() {
    let (mut editor, id) = early_editor();
    let refuse = &mut |_: &Model| Err("too large".to_owned());
    assert_eq!(editor.complete(id, complete(&file()), refuse), Err("too large".to_owned()));
    let pilot = read_paths(&["sample:pilot".into()], Role::Any).expect("a sample");
    editor.open(pilot, None, &mut any).expect("fits");
    assert_eq!(editor.complete(id, complete(&file()), refuse), Ok(()));
    // It may be gone by then.
    assert_eq!(editor.complete(ModelId(99), complete(&file()), refuse), Ok(()));
    assert_eq!(editor.library().models().len(), 2);
}

/// The link may be opened again after its download has failed.
#[test]
fn opening_the_complete_file_closes_the_model_without_images() {
    let (mut editor, id) = early_editor();
    let contents = Contents { models: vec![complete(&file())], ..Contents::default() };
    editor.open(contents, Some(ViewerState::of_model(URL.to_owned())), &mut any).expect("fits");
    let models: Vec<ModelId> = editor.library().models().iter().map(|model| model.id).collect();
    assert!(models.len() == 1 && models[0] != id, "{models:?}");
}

fn any(_: &Model) -> Result<(), String> {
    Ok(())
}
