//! Material extensions that add lobes: what is read, and how invalid values are handled.

use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{Lobes, Material};
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::build_gltf::{Build, warnings};

/// The triangle with this material, in a file with 20 textures.
pub fn triangle_of(material: Value) -> Build {
    let mut build = Build::triangle();
    build.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    build.json["materials"] = json!([material]);
    build.json["textures"] = Value::Array(vec![json!({}); 20]);
    build
}

fn read(material: Value) -> Asset {
    triangle_of(material).loaded()
}

fn extended(extensions: Value) -> Asset {
    read(json!({ "extensions": extensions }))
}

fn lobes(asset: &Asset) -> &Lobes {
    asset.materials[0].lobes.as_deref().expect("lobes")
}

#[test]
fn every_factor_is_read() {
    let asset = extended(json!({
        "KHR_materials_anisotropy": { "anisotropyStrength": 0.01, "anisotropyRotation": 0.02 },
        "KHR_materials_clearcoat": { "clearcoatFactor": 0.03, "clearcoatRoughnessFactor": 0.04 },
        "KHR_materials_diffuse_transmission":
            { "diffuseTransmissionFactor": 0.05, "diffuseTransmissionColorFactor": [0.06, 0.07, 0.08] },
        "KHR_materials_dispersion": { "dispersion": 0.09 },
        "KHR_materials_ior": { "ior": 1.1 },
        "KHR_materials_iridescence": {
            "iridescenceFactor": 0.12, "iridescenceIor": 1.13,
            "iridescenceThicknessMinimum": 14, "iridescenceThicknessMaximum": 15 },
        "KHR_materials_sheen": { "sheenColorFactor": [0.16, 0.17, 0.18], "sheenRoughnessFactor": 0.19 },
        "KHR_materials_specular": { "specularFactor": 0.2, "specularColorFactor": [0.21, 2.2, 0.23] },
        "KHR_materials_transmission": { "transmissionFactor": 0.24 },
        "KHR_materials_volume":
            { "thicknessFactor": 0.25, "attenuationDistance": 0.26, "attenuationColor": [0.27, 0.28, 0.29] },
    }));
    assert_eq!(warnings(&asset), [""; 0]);
    let expected = Lobes {
        anisotropy: 0.01,
        anisotropy_rotation: 0.02,
        clearcoat: 0.03,
        clearcoat_roughness: 0.04,
        diffuse_transmission: 0.05,
        diffuse_transmission_color: Vec3::new(0.06, 0.07, 0.08),
        dispersion: 0.09,
        ior: 1.1,
        iridescence: 0.12,
        iridescence_ior: 1.13,
        iridescence_thickness_min: 14.0,
        iridescence_thickness_max: 15.0,
        sheen_color: Vec3::new(0.16, 0.17, 0.18),
        sheen_roughness: 0.19,
        specular: 0.2,
        specular_color: Vec3::new(0.21, 2.2, 0.23),
        transmission: 0.24,
        thickness: 0.25,
        attenuation_distance: 0.26,
        attenuation_color: Vec3::new(0.27, 0.28, 0.29),
        ..Lobes::default()
    };
    assert_eq!(*lobes(&asset), expected);
    assert_eq!(*lobes(&extended(json!({ "KHR_materials_sheen": {} }))), Lobes::default());
    assert_eq!(read(json!({})).materials[0].lobes, None);
}

#[test]
fn every_texture_is_read_with_its_transform() {
    use TextureSlot as Slot;
    let extensions = [
        ("specular", vec![(Slot::Specular, "specular"), (Slot::SpecularColor, "specularColor")]),
        (
            "clearcoat",
            vec![
                (Slot::Clearcoat, "clearcoat"),
                (Slot::ClearcoatRoughness, "clearcoatRoughness"),
                (Slot::ClearcoatNormal, "clearcoatNormal"),
            ],
        ),
        ("sheen", vec![(Slot::SheenColor, "sheenColor"), (Slot::SheenRoughness, "sheenRoughness")]),
        ("iridescence", vec![(Slot::Iridescence, "iridescence"), (Slot::IridescenceThickness, "iridescenceThickness")]),
        ("anisotropy", vec![(Slot::Anisotropy, "anisotropy")]),
        ("transmission", vec![(Slot::Transmission, "transmission")]),
        ("volume", vec![(Slot::Thickness, "thickness")]),
        (
            "diffuse_transmission",
            vec![
                (Slot::DiffuseTransmission, "diffuseTransmission"),
                (Slot::DiffuseTransmissionColor, "diffuseTransmissionColor"),
            ],
        ),
    ];
    let textures = extensions
        .into_iter()
        .flat_map(|(extension, textures)| textures.into_iter().map(move |(slot, name)| (extension, slot, name)));
    for (index, (extension, slot, name)) in textures.enumerate() {
        let (extension, member) = (format!("KHR_materials_{extension}"), &*format!("{name}Texture"));
        let transform = json!({ "KHR_texture_transform": { "offset": [0.5, 0.25] } });
        let texture = json!({ "index": index, "texCoord": 1, "scale": 0.7, "extensions": transform });
        let asset = extended(json!({ extension: { member: texture } }));
        assert_eq!(warnings(&asset), [""; 0]);
        let material = &asset.materials[0];
        let found = material.texture(slot).expect(member);
        assert_eq!((found.texture, found.uv_set, found.uv_transform.offset), (index, 1, Vec2::new(0.5, 0.25)));
        let count = TextureSlot::ALL.into_iter().filter(|&slot| material.texture(slot).is_some()).count();
        assert_eq!(count, 1, "{member}");
        let scale = if slot == TextureSlot::ClearcoatNormal { 0.7 } else { 1.0 };
        assert_eq!(lobes(&asset).clearcoat_normal_scale, scale);
    }
}

#[test]
fn invalid_values_are_reported_and_replaced_by_the_default() {
    for (extension, value, place) in [
        ("ior", json!({ "ior": "glass" }), ".ior"),
        ("ior", json!({ "ior": 1e300 }), ".ior"),
        ("ior", json!([1.4]), ""),
        ("sheen", json!({ "sheenColorFactor": [1, 1] }), ".sheenColorFactor"),
        ("clearcoat", json!({ "clearcoatTexture": { "index": 99 } }), ".clearcoatTexture.index"),
        ("clearcoat", json!({ "clearcoatTexture": 3 }), ".clearcoatTexture"),
    ] {
        let extension = format!("KHR_materials_{extension}");
        let place = format!("materials[0].extensions.{extension}{place}");
        let asset = extended(json!({ extension: value }));
        let warnings = warnings(&asset);
        assert!(matches!(&warnings[..], [warning] if warning.starts_with(&place)), "{warnings:?}");
        assert_eq!(asset.materials[0].lobes.clone().unwrap_or_default(), Box::default());
    }
}

/// Keeps the diffuse colour and the reflectance at normal incidence; glossiness stays in the specular texture.
#[test]
fn specular_glossiness_becomes_a_dielectric() {
    let asset = read(json!({
        "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 7 }, "baseColorFactor": [0, 0, 0, 1] },
        "extensions": { "KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.1, 0.2, 0.3, 0.4],
            "diffuseTexture": { "index": 4 },
            "specularFactor": [0.5, 0.6, 0.7],
            "glossinessFactor": 0.8,
            "specularGlossinessTexture": { "index": 5, "texCoord": 1 },
        } },
    }));
    assert_eq!(warnings(&asset), [""; 0]);
    let material = &asset.materials[0];
    assert_eq!((material.base_color, material.metallic), (Vec4::new(0.1, 0.2, 0.3, 0.4), 0.0));
    assert!((material.roughness - 0.2).abs() < 1e-6);
    let texture = |slot| material.texture(slot).map(|texture| (texture.texture, texture.uv_set));
    assert_eq!(texture(TextureSlot::BaseColor), Some((4, 0)));
    assert_eq!(texture(TextureSlot::MetallicRoughness), None);
    assert_eq!(texture(TextureSlot::SpecularColor), Some((5, 1)));
    let lobes = lobes(&asset);
    assert_eq!((lobes.ior, lobes.specular_color), (0.0, Vec3::new(0.5, 0.6, 0.7)));
    assert!(lobes.glossiness_in_specular_color);
    let defaults = extended(json!({ "KHR_materials_pbrSpecularGlossiness": {} }));
    let Material { base_color, roughness, lobes, .. } = &defaults.materials[0];
    assert_eq!((*base_color, *roughness), (Vec4::ONE, 0.0));
    assert!(!lobes.as_deref().expect("lobes").glossiness_in_specular_color);
}

#[test]
fn the_least_visible_of_too_many_textures_are_dropped() {
    let texture = |index: usize| json!({ "index": index });
    let mut material = json!({
        "pbrMetallicRoughness": { "baseColorTexture": texture(0), "metallicRoughnessTexture": texture(1) },
        "normalTexture": texture(2), "occlusionTexture": texture(3), "emissiveTexture": texture(4),
        "extensions": {
            "KHR_materials_clearcoat": {
                "clearcoatTexture": texture(5),
                "clearcoatRoughnessTexture": texture(6),
                "clearcoatNormalTexture": texture(7),
            },
        },
    });
    assert_eq!(warnings(&read(material.clone())), [""; 0]);
    material["extensions"]["KHR_materials_sheen"] =
        json!({ "sheenColorTexture": texture(8), "sheenRoughnessTexture": texture(9) });
    material["extensions"]["KHR_materials_transmission"] = json!({ "transmissionTexture": texture(10) });
    let asset = read(material);
    let warnings = warnings(&asset);
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(warning.contains("11 textures") && warning.contains("sheenRoughnessTexture"), "{warning}");
    let dropped = [TextureSlot::SheenRoughness, TextureSlot::ClearcoatRoughness, TextureSlot::ClearcoatNormal];
    for slot in dropped {
        assert_eq!(asset.materials[0].texture(slot), None);
    }
    let count = TextureSlot::ALL.into_iter().filter(|&slot| asset.materials[0].texture(slot).is_some()).count();
    assert_eq!(count, 8);
}
