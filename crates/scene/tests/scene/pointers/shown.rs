//! The value of an animated property in a frame, by its pointer.

use gaitway_character::anim::{JointIndex, TextureSlot};
use gaitway_character::asset::{Asset, CameraProjection, LightKind};
use gaitway_character::mesh::{AlphaMode, Lobes, Material};
use gaitway_scene::frame::Frame;
use serde_json::{Value, json};

/// Returns the property's value in a frame, or `None` if Gaitway doesn't show the property.
pub fn shown(asset: &Asset, json: &Value, frame: &Frame, pointer: &str) -> Option<Vec<f32>> {
    let parts: Vec<&str> = pointer.split('/').skip(1).collect();
    let index: usize = parts.iter().find_map(|part| part.parse().ok())?;
    let joint = || asset.skeleton.joint_of_source(index).expect("a node");
    let weights = |joint: JointIndex| frame.pose().morph_weights[asset.skeleton.morph_range(joint)].to_vec();
    let of_mesh = || {
        let nodes = json["nodes"].as_array().expect("nodes").iter().enumerate();
        let nodes = nodes.filter(|(_, node)| node["mesh"] == json!(index) && node.get("weights").is_none());
        let joints = nodes.map(|(node, _)| asset.skeleton.joint_of_source(node).expect("a node"));
        let all: Vec<Vec<f32>> = joints.map(weights).collect();
        assert!(!all.is_empty() && all.iter().all(|other| *other == all[0]), "{pointer}: {all:?}");
        all[0].clone()
    };
    Some(match parts[..] {
        ["nodes", _, "translation"] => frame.pose().local(joint()).translation.to_array().to_vec(),
        ["nodes", _, "rotation"] => frame.pose().local(joint()).rotation.to_array().to_vec(),
        ["nodes", _, "scale"] => frame.pose().local(joint()).scale.to_array().to_vec(),
        ["nodes", _, "weights"] => weights(joint()),
        ["nodes", _, "weights", target] => vec![weights(joint())[target.parse::<usize>().expect("an index")]],
        ["meshes", _, "weights"] => of_mesh(),
        ["meshes", _, "weights", target] => vec![of_mesh()[target.parse::<usize>().expect("an index")]],
        ["nodes", _, "extensions", "KHR_node_visibility", "visible"] => {
            vec![f32::from(u8::from(frame.is_visible(joint())))]
        }
        ["cameras", _, kind, property] => vec![of_camera(asset, frame, index, kind, property)?],
        ["extensions", "KHR_lights_punctual", "lights", _, ref property @ ..] => {
            of_light(asset, frame, index, &property.join("/"))
        }
        ["materials", _, ref property @ ..] => {
            let animated = &frame.characters[0].materials;
            let material = &animated.iter().find(|(number, _)| *number == index)?.1;
            of_material(material, &property.join("/"))?
        }
        _ => return None,
    })
}

fn of_camera(asset: &Asset, frame: &Frame, number: usize, kind: &str, property: &str) -> Option<f32> {
    let camera = asset.cameras.iter().find(|camera| camera.number == number).expect("a camera");
    match (camera.animated(frame.properties()), kind, property) {
        (CameraProjection::Perspective { y_fov_radians, .. }, "perspective", "yfov") => Some(y_fov_radians),
        (CameraProjection::Perspective { near, .. }, "perspective", "znear") => Some(near),
        (CameraProjection::Perspective { far, .. }, "perspective", "zfar") => far,
        (CameraProjection::Orthographic { y_mag, .. }, "orthographic", "ymag") => Some(y_mag),
        (CameraProjection::Orthographic { near, .. }, "orthographic", "znear") => Some(near),
        (CameraProjection::Orthographic { far, .. }, "orthographic", "zfar") => Some(far),
        _ => None,
    }
}

fn of_light(asset: &Asset, frame: &Frame, number: usize, property: &str) -> Vec<f32> {
    let place = asset.lights.iter().position(|light| light.number == number).expect("a light");
    let light = asset.lights[place].animated(frame.properties());
    let drawn = frame.lights[place];
    assert_eq!((drawn.color, drawn.kind), (light.color * light.intensity, light.kind));
    assert_eq!(drawn.range, light.range.unwrap_or(0.0));
    match (property, light.kind) {
        ("color", _) => light.color.to_array().to_vec(),
        ("intensity", _) => vec![light.intensity],
        ("range", _) => vec![light.range.expect("animated")],
        ("spot/innerConeAngle", LightKind::Spot { inner_cone_radians, .. }) => vec![inner_cone_radians],
        ("spot/outerConeAngle", LightKind::Spot { outer_cone_radians, .. }) => vec![outer_cone_radians],
        _ => panic!("{property} of {light:?}"),
    }
}

fn of_material(material: &Material, property: &str) -> Option<Vec<f32>> {
    if let Some((texture, property)) = property.split_once("/extensions/KHR_texture_transform/") {
        let texture = match texture {
            "pbrMetallicRoughness/baseColorTexture" => material.base_color_texture,
            "pbrMetallicRoughness/metallicRoughnessTexture" => material.metallic_roughness_texture,
            "normalTexture" => material.normal_texture,
            "occlusionTexture" => material.occlusion_texture,
            "emissiveTexture" => material.emissive_texture,
            "extensions/KHR_materials_clearcoat/clearcoatNormalTexture" => {
                material.texture(TextureSlot::ClearcoatNormal)
            }
            _ => None,
        };
        let transform = texture?.uv_transform;
        return match property {
            "offset" => Some(transform.offset.to_array().to_vec()),
            "rotation" => Some(vec![transform.rotation_radians]),
            "scale" => Some(transform.scale.to_array().to_vec()),
            _ => None,
        };
    }
    if let Some(property) = property.strip_prefix("extensions/").filter(|property| !property.contains("emissive")) {
        return of_lobes(material.lobes.as_deref()?, property);
    }
    Some(match property {
        "pbrMetallicRoughness/baseColorFactor" => material.base_color.to_array().to_vec(),
        "pbrMetallicRoughness/metallicFactor" => vec![material.metallic],
        "pbrMetallicRoughness/roughnessFactor" => vec![material.roughness],
        "emissiveFactor" => material.emissive.to_array().to_vec(),
        "extensions/KHR_materials_emissive_strength/emissiveStrength" => vec![material.emissive_strength],
        "alphaCutoff" => match material.alpha_mode {
            AlphaMode::Mask { cutoff } => vec![cutoff],
            other => panic!("{other:?}"),
        },
        "normalTexture/scale" => vec![material.normal_scale],
        "occlusionTexture/strength" => vec![material.occlusion_strength],
        _ => return None,
    })
}

fn of_lobes(lobes: &Lobes, property: &str) -> Option<Vec<f32>> {
    Some(match property {
        "KHR_materials_ior/ior" => vec![lobes.ior],
        "KHR_materials_specular/specularFactor" => vec![lobes.specular],
        "KHR_materials_specular/specularColorFactor" => lobes.specular_color.to_array().to_vec(),
        "KHR_materials_clearcoat/clearcoatFactor" => vec![lobes.clearcoat],
        "KHR_materials_clearcoat/clearcoatRoughnessFactor" => vec![lobes.clearcoat_roughness],
        "KHR_materials_clearcoat/clearcoatNormalTexture/scale" => vec![lobes.clearcoat_normal_scale],
        "KHR_materials_sheen/sheenColorFactor" => lobes.sheen_color.to_array().to_vec(),
        "KHR_materials_sheen/sheenRoughnessFactor" => vec![lobes.sheen_roughness],
        "KHR_materials_iridescence/iridescenceFactor" => vec![lobes.iridescence],
        "KHR_materials_iridescence/iridescenceIor" => vec![lobes.iridescence_ior],
        "KHR_materials_iridescence/iridescenceThicknessMinimum" => vec![lobes.iridescence_thickness_min],
        "KHR_materials_iridescence/iridescenceThicknessMaximum" => vec![lobes.iridescence_thickness_max],
        "KHR_materials_anisotropy/anisotropyStrength" => vec![lobes.anisotropy],
        "KHR_materials_anisotropy/anisotropyRotation" => vec![lobes.anisotropy_rotation],
        "KHR_materials_transmission/transmissionFactor" => vec![lobes.transmission],
        "KHR_materials_volume/thicknessFactor" => vec![lobes.thickness],
        "KHR_materials_volume/attenuationDistance" => vec![lobes.attenuation_distance],
        "KHR_materials_volume/attenuationColor" => lobes.attenuation_color.to_array().to_vec(),
        "KHR_materials_dispersion/dispersion" => vec![lobes.dispersion],
        "KHR_materials_diffuse_transmission/diffuseTransmissionFactor" => vec![lobes.diffuse_transmission],
        "KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor" => {
            lobes.diffuse_transmission_color.to_array().to_vec()
        }
        _ => return None,
    })
}
