//! MToon of VRM 1.0 and 0.x: what is read, and how invalid values are handled.

use gaitway_character::anim::{MaterialProperty, PropertyTarget, TextureSlot, ToonColor};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{AlphaMode, Lobes, Material, OutlineMode, Toon};
use gaitway_formats::{load, pointer_to};
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::build_gltf::{Build, warnings};
use crate::data_folder::data_folder;
use crate::file_set::file_set;
use crate::lobes::triangle_of;

fn mtoon(value: Value) -> Asset {
    triangle_of(json!({ "extensions": { "VRMC_materials_mtoon": value } })).loaded()
}

fn toon(asset: &Asset) -> &Toon {
    asset.materials[0].toon.as_deref().expect("MToon")
}

fn texture(material: &Material, slot: TextureSlot) -> Option<usize> {
    material.texture(slot).map(|texture| texture.texture)
}

#[test]
fn every_value_of_vrm_1_is_read() {
    let asset = mtoon(json!({
        "specVersion": "1.0",
        "shadeColorFactor": [0.01, 0.02, 0.03], "shadeMultiplyTexture": { "index": 4 },
        "shadingShiftFactor": 0.05, "shadingShiftTexture": { "index": 6, "scale": 0.07, "texCoord": 1 },
        "shadingToonyFactor": 0.08, "giEqualizationFactor": 0.09,
        "matcapFactor": [0.1, 0.11, 0.12], "matcapTexture": { "index": 13 },
        "parametricRimColorFactor": [0.14, 0.15, 0.16], "rimMultiplyTexture": { "index": 17 },
        "rimLightingMixFactor": 0.18, "parametricRimFresnelPowerFactor": 1.9, "parametricRimLiftFactor": 0.2,
        "outlineWidthMode": "screenCoordinates", "outlineWidthFactor": 0.21,
        "outlineWidthMultiplyTexture": { "index": 2 },
        "outlineColorFactor": [0.22, 0.23, 0.24], "outlineLightingMixFactor": 0.25,
        "uvAnimationScrollXSpeedFactor": 0.26, "uvAnimationScrollYSpeedFactor": -0.27,
        "uvAnimationRotationSpeedFactor": 2.8, "uvAnimationMaskTexture": { "index": 9 },
    }));
    assert_eq!(warnings(&asset), [""; 0]);
    let slots = TextureSlot::ALL.map(|slot| texture(&asset.materials[0], slot));
    let start = TextureSlot::ShadeMultiply as usize;
    assert_eq!(slots[start..], [Some(4), Some(6), Some(13), Some(17), Some(2), Some(9)]);
    assert!(slots[..start].iter().all(Option::is_none));
    assert_eq!(asset.materials[0].texture(TextureSlot::ShadingShift).map(|texture| texture.uv_set), Some(1));
    let expected = Toon {
        shade_color: Vec3::new(0.01, 0.02, 0.03),
        shading_shift: 0.05,
        shading_shift_scale: 0.07,
        shading_toony: 0.08,
        gi_equalization: 0.09,
        matcap_color: Vec3::new(0.1, 0.11, 0.12),
        rim_color: Vec3::new(0.14, 0.15, 0.16),
        rim_lighting_mix: 0.18,
        rim_fresnel_power: 1.9,
        rim_lift: 0.2,
        outline_mode: OutlineMode::Screen,
        outline_width: 0.21,
        outline_color: Vec3::new(0.22, 0.23, 0.24),
        outline_lighting_mix: 0.25,
        uv_scroll: Vec2::new(0.26, -0.27),
        uv_rotation: 2.8,
        textures: toon(&asset).textures,
    };
    assert_eq!(*toon(&asset), expected);
    assert_eq!(*toon(&mtoon(json!({}))), Toon::default());
}

#[test]
fn mtoon_replaces_its_fallback_extensions_and_textures() {
    let with_fallbacks = triangle_of(json!({
        "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 }, "baseColorTexture": { "index": 2 } },
        "occlusionTexture": { "index": 3 },
        "emissiveFactor": [0.5, 0.5, 0.5],
        "extensions": {
            "KHR_materials_unlit": {},
            "KHR_materials_clearcoat": { "clearcoatFactor": 1 },
            "VRMC_materials_mtoon": {},
        },
    }));
    let asset = with_fallbacks.loaded();
    let material = &asset.materials[0];
    assert_eq!((material.unlit, &material.lobes), (false, &None::<Box<Lobes>>));
    let slots = [TextureSlot::BaseColor, TextureSlot::MetallicRoughness, TextureSlot::Occlusion];
    assert_eq!(slots.map(|slot| texture(material, slot)), [Some(2), None, None]);
    assert_eq!(material.emissive, Vec3::splat(0.5));
}

#[test]
fn invalid_values_are_reported_and_replaced_by_the_default() {
    for (value, place) in [
        (json!([]), ""),
        (json!({ "shadeColorFactor": [1, 1] }), ".shadeColorFactor"),
        (json!({ "shadingToonyFactor": "sharp" }), ".shadingToonyFactor"),
        (json!({ "outlineWidthMode": "wide" }), ".outlineWidthMode"),
        (json!({ "matcapTexture": { "index": 99 } }), ".matcapTexture.index"),
        (json!({ "rimMultiplyTexture": 3 }), ".rimMultiplyTexture"),
    ] {
        let asset = mtoon(value);
        let place = format!("materials[0].extensions.VRMC_materials_mtoon{place}");
        let warnings = warnings(&asset);
        assert!(matches!(&warnings[..], [warning] if warning.starts_with(&place)), "{warnings:?}");
        assert_eq!(asset.materials[0].toon.clone().unwrap_or_default(), Box::default());
    }
}

/// WebGL2 has texture units for eight of the nine.
#[test]
fn a_texture_too_many_is_left_out() {
    let info = json!({ "index": 1 });
    let names = ["shadeMultiply", "shadingShift", "matcap", "rimMultiply", "outlineWidthMultiply", "uvAnimationMask"];
    let toon: serde_json::Map<String, Value> =
        names.iter().map(|name| (format!("{name}Texture"), info.clone())).collect();
    let asset = triangle_of(json!({
        "pbrMetallicRoughness": { "baseColorTexture": info },
        "normalTexture": info,
        "emissiveTexture": info,
        "extensions": { "VRMC_materials_mtoon": toon },
    }))
    .loaded();
    let material = &asset.materials[0];
    let of_toon = TextureSlot::ALL.into_iter().filter(|&slot| slot >= TextureSlot::ShadeMultiply);
    let left_out: Vec<TextureSlot> = of_toon.filter(|&slot| texture(material, slot).is_none()).collect();
    assert_eq!(left_out, [TextureSlot::ShadingShift]);
    let warnings = warnings(&asset);
    assert!(matches!(&warnings[..], [warning] if warning.contains("shadingShiftTexture")), "{warnings:?}");
}

/// A VRM 0.x file with a single material that has these properties, and these blend shape groups.
fn vrm_0(properties: Value, groups: Value) -> Asset {
    let vrm = json!({ "materialProperties": [properties], "blendShapeMaster": { "blendShapeGroups": groups } });
    let mut build = triangle_of(json!({ "name": "skin", "extensions": { "KHR_materials_unlit": {} } }));
    build.json["extensions"] = json!({ "VRM": vrm });
    build.loaded()
}

#[track_caller]
fn close(a: f32, b: f32) {
    assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
}

#[test]
fn vrm_0_is_converted() {
    let properties = json!({
        "name": "skin",
        "shader": "VRM/MToon",
        "floatProperties": {
            "_Cutoff": 0.3, "_CullMode": 0, "_ShadeShift": 0.2, "_ShadeToony": 0.5, "_IndirectLightIntensity": 0.25,
            "_RimLightingMix": 0.4, "_RimFresnelPower": 3, "_RimLift": 0.1, "_BumpScale": 0.7,
            "_OutlineWidthMode": 1, "_OutlineWidth": 0.5, "_OutlineColorMode": 1, "_OutlineLightingMix": 0.6,
            "_UvAnimScrollX": 0.1, "_UvAnimScrollY": 0.2, "_UvAnimRotation": 0.3 },
        "vectorProperties": {
            "_Color": [0.5, 1, 0, 0.5], "_ShadeColor": [0.5, 0, 0, 1], "_RimColor": [0, 0.5, 0, 1],
            "_OutlineColor": [0, 0, 0.5, 1], "_EmissionColor": [2, 0, 0, 1], "_MainTex": [0.125, 0.25, 0.5, 0.25] },
        "textureProperties": {
            "_MainTex": 1, "_ShadeTexture": 2, "_BumpMap": 3, "_EmissionMap": 4, "_SphereAdd": 5, "_RimTexture": 6,
            "_OutlineWidthTexture": 7, "_UvAnimMaskTexture": 8 },
        "keywordMap": { "_ALPHATEST_ON": true },
    });
    let group = json!({ "name": "blush", "presetName": "unknown", "binds": [], "materialValues": [
        { "materialName": "skin", "propertyName": "_RimColor", "targetValue": [1, 0.5, 0, 1] }] });
    let asset = vrm_0(properties, json!([group]));
    assert_eq!(warnings(&asset), [""; 0]);
    let half = 0.5_f32.powf(2.2);
    let (material, toon) = (&asset.materials[0], toon(&asset));
    assert_eq!(material.base_color, Vec4::new(half, 1.0, 0.0, 0.5));
    assert_eq!(material.emissive, 2.0 * Vec3::X);
    assert_eq!((material.alpha_mode, material.double_sided), (AlphaMode::Mask { cutoff: 0.3 }, true));
    assert_eq!((material.unlit, material.normal_scale), (false, 0.7));
    let slots = [
        TextureSlot::BaseColor,
        TextureSlot::ShadeMultiply,
        TextureSlot::Normal,
        TextureSlot::Emissive,
        TextureSlot::Matcap,
        TextureSlot::RimMultiply,
        TextureSlot::OutlineWidth,
        TextureSlot::UvAnimationMask,
    ];
    for (number, slot) in slots.into_iter().enumerate() {
        assert_eq!(texture(material, slot), Some(number + 1), "{slot:?}");
        let transform = material.texture(slot).expect("a texture").uv_transform;
        // Unity's texture coordinates start at the bottom.
        let (offset, scale) = match slot {
            TextureSlot::Matcap => (Vec2::ZERO, Vec2::ONE),
            _ => (Vec2::new(0.125, 0.5), Vec2::new(0.5, 0.25)),
        };
        assert_eq!((transform.offset, transform.scale), (offset, scale), "{slot:?}");
    }
    // Unity's shade boundary reaches from the shift to where the surface is fully lit, here 0.2 to 0.6.
    close(toon.shading_toony, 0.8);
    close(toon.shading_shift, -0.4);
    close(toon.gi_equalization, 0.75);
    assert_eq!((toon.rim_fresnel_power, toon.rim_lift, toon.rim_lighting_mix), (3.0, 0.1, 0.4));
    assert_eq!((toon.outline_mode, toon.outline_lighting_mix), (OutlineMode::World, 0.6));
    close(toon.outline_width, 0.005);
    assert_eq!((toon.uv_scroll, toon.uv_rotation), (Vec2::new(0.1, -0.2), 0.3));
    let colors = [toon.shade_color, toon.rim_color, toon.outline_color];
    assert_eq!(colors, [half * Vec3::X, half * Vec3::Y, half * Vec3::Z]);
    let [bind] = &asset.avatar.expressions[0].materials[..] else { panic!("no colour") };
    assert_eq!(bind.target, PropertyTarget::Material(0, MaterialProperty::Toon(ToonColor::RimColor)));
    assert_eq!((bind.rest, bind.rest + bind.delta), (Vec4::Y * half, Vec4::new(1.0, half, 0.0, 0.0)));
}

/// In UniVRM's own test file, MToon's emission of 0.5 looks like an unlit 0.5 in linear space.
#[test]
fn emission_of_vrm_0_is_linear() {
    let Some(data) = data_folder() else { return };
    let asset = load(&file_set(&data.join("vrm/vrm0_EmissionMigration_v0.107.0.vrm"))).expect("a valid file");
    let material = |name: &str| {
        asset.materials.iter().find(|material| material.name == name).unwrap_or_else(|| panic!("no material {name}"))
    };
    assert_eq!(material("MToon_Emission_0.5").emissive, material("Unlit_Linear_0.5").base_color.truncate());
    assert_eq!(material("MToon_Emission_2.0").emissive, Vec3::splat(2.0));
    assert!(material("MToon_Emission_2.0").toon.is_some() && material("Unlit_Linear_0.5").toon.is_none());
}

#[test]
fn other_shaders_of_vrm_0_keep_the_gltf_material() {
    let asset =
        vrm_0(json!({ "shader": "VRM_USE_GLTFSHADER", "vectorProperties": { "_Color": [0, 0, 0, 1] } }), json!([]));
    let material = &asset.materials[0];
    assert_eq!((material.base_color, material.unlit, material.toon.is_none()), (Vec4::ONE, true, true));
    // Missing and invalid values are replaced by Unity's defaults.
    let invalid = json!({ "shader": "VRM/MToon", "floatProperties": [], "vectorProperties": { "_Color": "red" } });
    let asset = vrm_0(invalid, json!([]));
    close(toon(&asset).shading_toony, 0.95);
    close(toon(&asset).shade_color.x, 0.97_f32.powf(2.2));
    assert_eq!((asset.materials[0].base_color, toon(&asset).outline_mode), (Vec4::ONE, OutlineMode::None));
}

#[test]
fn colours_and_texture_transforms_can_be_animated() {
    let mut build = Build::triangle();
    build.json["textures"] = json!([{}]);
    let toon = json!({ "shadeMultiplyTexture": { "index": 0 } });
    build.json["materials"] = json!([{ "extensions": { "VRMC_materials_mtoon": toon } }, {}]);
    let pointers = [
        "/materials/0/extensions/VRMC_materials_mtoon/shadeColorFactor",
        "/materials/0/extensions/VRMC_materials_mtoon/shadeMultiplyTexture/extensions/KHR_texture_transform/offset",
        "/materials/1/extensions/VRMC_materials_mtoon/shadeColorFactor",
    ];
    for (pointer, shape) in pointers.into_iter().zip(["VEC3", "VEC2", "VEC3"]) {
        build.point(pointer, "LINEAR", shape, &[0.0, 1.0], if shape == "VEC3" { &[0.5; 6] } else { &[0.5; 4] });
    }
    let asset = build.load().expect("a valid file");
    let found: Vec<String> =
        asset.clips[0].properties().iter().map(|channel| pointer_to(channel.target, &asset)).collect();
    // Ordered by property. The second material is not MToon, so its pointer is ignored.
    assert_eq!(found, [pointers[1], pointers[0]]);
}
