//! The objects of the scene with what they are: bones, meshes, cameras, lights.

use gaitway_character::asset::{Camera, CameraProjection, Light, LightKind};
use glam::DVec3;

use crate::clip::rest_angles;
use crate::layout::{Attribute, Contents, Model};
use crate::objects::{Id, Objects};
use crate::record::{Properties, Record};

/// Scales are inherited like the rest of the matrix, as in glTF; the alternatives are Maya's.
const INHERIT_ALL: i32 = 1;
/// Width and height of a picture for programs that compute in film: full HD on film of 36 mm.
const PICTURE: [f64; 2] = [1920.0, 1080.0];
const FILM_MILLIMETRES: [f64; 2] = [36.0, 20.25];
const MILLIMETRES_PER_INCH: f64 = 25.4;
/// Height of the picture of a camera without perspective, at a zoom of 1, in units.
const UNITS_PER_ZOOM: f64 = 30.0;
/// Where a camera without an end stops seeing, per where it begins.
const FAR_PER_NEAR: f64 = 1e5;
/// How large bones are drawn, in centimetres.
const BONE_SIZE: f64 = 3.3;

/// Writes an object of the scene.
pub fn write(contents: Contents, model: &Model, objects: &mut Objects) {
    let kind = match model.attribute {
        Attribute::Bone => "LimbNode",
        Attribute::Group | Attribute::LeftOut => "Null",
        Attribute::Mesh(_) => "Mesh",
        Attribute::Camera(_) => "Camera",
        Attribute::Light(_) => "Light",
    };
    let degrees = rest_angles(&model.local.rotation) * (180.0 / std::f64::consts::PI);
    let properties = Properties::new()
        .choice("InheritType", INHERIT_ALL)
        .integer("DefaultAttributeIndex", 0)
        .own("Lcl Translation", &model.local.translation.to_array())
        .own("Lcl Rotation", &degrees.to_array())
        .own("Lcl Scaling", &model.local.scale.to_array())
        .own("Visibility", &[f64::from(u8::from(model.is_visible))]);
    objects.add_as(model.id, "Model", (&model.name, "Model", kind), |record| {
        record
            .with(Record::new("Version").i32(232))
            .with(properties.record())
            .with(Record::new("Shading").flag(true))
            .with(Record::new("Culling").text("CullingOff"))
    });
    objects.connect(model.id, model.parent);
    let Contents { asset, space, .. } = contents;
    let attribute = match model.attribute {
        Attribute::Bone => attribute(
            objects,
            model,
            "LimbNode",
            Properties::new().double("Size", BONE_SIZE * space.unit / 100.0),
            "Skeleton",
        ),
        Attribute::Group => attribute(objects, model, "Null", Properties::new(), "Null"),
        Attribute::Camera(index) => {
            attribute(objects, model, "Camera", camera(&asset.cameras[index], space.unit), "Camera")
        }
        Attribute::Light(index) => attribute(objects, model, "Light", light(&asset.lights[index]), "Light"),
        Attribute::Mesh(_) | Attribute::LeftOut => return,
    };
    objects.connect(attribute, model.id);
}

fn attribute(objects: &mut Objects, model: &Model, kind: &'static str, properties: Properties, flags: &str) -> Id {
    objects.add("NodeAttribute", (&model.name, "NodeAttribute", kind), |record| {
        record.with(properties.record()).with(Record::new("TypeFlags").text(flags))
    })
}

fn camera(camera: &Camera, unit: f64) -> Properties {
    let (near, far, properties) = match camera.projection {
        CameraProjection::Perspective { y_fov_radians, near, far } => {
            let half = 0.5 * f64::from(y_fov_radians);
            let focal = 0.5 * FILM_MILLIMETRES[1] / libm::tan(half);
            let degrees = 2.0 * half.to_degrees();
            let properties = Properties::new()
                .choice("CameraProjectionType", 0)
                // By the height of the picture.
                .choice("ApertureMode", 2)
                .number("FieldOfView", degrees)
                .number("FieldOfViewY", degrees)
                .number("FocalLength", focal);
            let near = f64::from(near);
            (near, far.map_or(near * FAR_PER_NEAR, f64::from), properties)
        }
        CameraProjection::Orthographic { y_mag, near, far } => {
            let properties = Properties::new()
                .choice("CameraProjectionType", 1)
                .double("OrthoZoom", 2.0 * f64::from(y_mag) * unit / UNITS_PER_ZOOM);
            (near.into(), far.into(), properties)
        }
    };
    properties
        .double("FilmWidth", FILM_MILLIMETRES[0] / MILLIMETRES_PER_INCH)
        .double("FilmHeight", FILM_MILLIMETRES[1] / MILLIMETRES_PER_INCH)
        .double("AspectWidth", PICTURE[0])
        .double("AspectHeight", PICTURE[1])
        .double("NearPlane", near * unit)
        .double("FarPlane", far * unit)
}

/// FBX has no physical units: glTF's 1 becomes 100 %.
fn light(light: &Light) -> Properties {
    let color: DVec3 = light.color.as_dvec3();
    let properties = Properties::new()
        .color("Color", color.to_array())
        .number("Intensity", 100.0 * f64::from(light.intensity))
        .flag("CastLight", true);
    match light.kind {
        LightKind::Point => properties.choice("LightType", 0),
        LightKind::Directional => properties.choice("LightType", 1),
        LightKind::Spot { inner_cone_radians, outer_cone_radians } => properties
            .choice("LightType", 2)
            .number("InnerAngle", 2.0 * f64::from(inner_cone_radians).to_degrees())
            .number("OuterAngle", 2.0 * f64::from(outer_cone_radians).to_degrees()),
    }
}
