//! MToon of VRM 0.x: `materialProperties`, the properties of a Unity shader. Colours except emission are in gamma
//! space, and V coordinates start at the bottom. Converted as in UniVRM and, except for emission, in three-vrm.

use gaitway_character::anim::TextureSlot;
use gaitway_character::mesh::{AlphaMode, Material, OutlineMode, TextureRef, Toon};
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::super::material_reader::TextureReader;
use super::number;
use crate::error::Problem;

/// Converts a colour of VRM 0.x from gamma to linear space; its alpha is linear already.
pub fn linear(color: Vec4) -> Vec4 {
    color.truncate().max(Vec3::ZERO).powf(2.2).extend(color.w)
}

struct Properties<'a> {
    value: &'a Value,
    /// KHR_texture_transform of all textures except the matcap.
    transform: Value,
}

impl<'a> Properties<'a> {
    fn new(value: &'a Value) -> Self {
        let at = |index: usize, default: f64| value["vectorProperties"]["_MainTex"][index].as_f64().unwrap_or(default);
        let (x, y, width, height) = (at(0, 0.0), at(1, 0.0), at(2, 1.0), at(3, 1.0));
        Self { value, transform: json!({ "offset": [x, 1.0 - height - y], "scale": [width, height] }) }
    }

    fn number(&self, name: &str, default: f32) -> f32 {
        number(&self.value["floatProperties"], name, default)
    }

    /// Returns a colour in linear space.
    fn color(&self, name: &str, default: Vec4) -> Vec4 {
        linear(self.vector(name, default))
    }

    fn vector(&self, name: &str, default: Vec4) -> Vec4 {
        let list = &self.value["vectorProperties"][name];
        let component = |at: usize| {
            let number = list[at].as_f64().map(|number| number as f32);
            number.filter(|number| number.is_finite()).unwrap_or(default[at])
        };
        Vec4::from_array([0, 1, 2, 3].map(component))
    }

    fn texture(
        &self,
        name: &str,
        transform: Option<&Value>,
        reader: &mut TextureReader<'_>,
    ) -> Result<Option<TextureRef>, Problem> {
        let index = &self.value["textureProperties"][name];
        if index.is_null() {
            return Ok(None);
        }
        let mut info = json!({ "index": index });
        if let Some(transform) = transform {
            info["extensions"] = json!({ "KHR_texture_transform": transform });
        }
        reader.extension_texture(Some(&info), &format!("textureProperties.{name}"))
    }

    fn has_keyword(&self, name: &str) -> bool {
        self.value["keywordMap"][name] == true
    }

    fn toon(&self) -> Toon {
        let shift = self.number("_ShadeShift", 0.0);
        let toony = self.number("_ShadeToony", 0.9);
        let shading_toony = toony + (1.0 - toony) * (0.5 + 0.5 * shift);
        let outline_mode = match self.number("_OutlineWidthMode", 0.0) as i32 {
            1 => OutlineMode::World,
            2 => OutlineMode::Screen,
            _ => OutlineMode::None,
        };
        // From centimetres, or from hundredths of half the viewport's height.
        let unit = if outline_mode == OutlineMode::Screen { 0.005 } else { 0.01 };
        let is_mixed = self.number("_OutlineColorMode", 0.0) == 1.0;
        Toon {
            shade_color: self.color("_ShadeColor", Vec4::new(0.97, 0.81, 0.86, 1.0)).truncate(),
            shading_shift: -shift - (1.0 - shading_toony),
            shading_toony,
            gi_equalization: 1.0 - self.number("_IndirectLightIntensity", 0.1),
            rim_color: self.color("_RimColor", Vec4::W).truncate(),
            rim_fresnel_power: self.number("_RimFresnelPower", 1.0),
            rim_lift: self.number("_RimLift", 0.0),
            rim_lighting_mix: self.number("_RimLightingMix", 0.0),
            outline_mode,
            outline_width: unit * self.number("_OutlineWidth", 0.0),
            outline_color: self.color("_OutlineColor", Vec4::W).truncate(),
            outline_lighting_mix: if is_mixed { self.number("_OutlineLightingMix", 1.0) } else { 0.0 },
            uv_scroll: Vec2::new(self.number("_UvAnimScrollX", 0.0), -self.number("_UvAnimScrollY", 0.0)),
            uv_rotation: self.number("_UvAnimRotation", 0.0),
            ..Toon::default()
        }
    }
}

/// Reads an element of `materialProperties`, which overrides the glTF material if its shader is MToon.
pub fn read_0(value: &Value, material: &mut Material, reader: &mut TextureReader<'_>) -> Result<(), Problem> {
    if value["shader"] != "VRM/MToon" {
        return Ok(());
    }
    let properties = Properties::new(value);
    let transform = Some(&properties.transform);
    material.base_color = properties.color("_Color", Vec4::ONE);
    material.base_color_texture = properties.texture("_MainTex", transform, reader)?;
    material.normal_texture = properties.texture("_BumpMap", transform, reader)?;
    material.normal_scale = properties.number("_BumpScale", 1.0);
    // Unity stores HDR colours in linear space.
    material.emissive = properties.vector("_EmissionColor", Vec4::W).truncate().max(Vec3::ZERO);
    material.emissive_strength = 1.0;
    material.emissive_texture = properties.texture("_EmissionMap", transform, reader)?;
    material.alpha_mode = if properties.has_keyword("_ALPHABLEND_ON") {
        AlphaMode::Blend
    } else if properties.has_keyword("_ALPHATEST_ON") {
        AlphaMode::Mask { cutoff: properties.number("_Cutoff", 0.5) }
    } else {
        AlphaMode::Opaque
    };
    material.double_sided = properties.number("_CullMode", 2.0) == 0.0;
    material.shade_as_toon(properties.toon());
    for (name, slot, transform) in [
        ("_ShadeTexture", TextureSlot::ShadeMultiply, transform),
        ("_SphereAdd", TextureSlot::Matcap, None),
        ("_RimTexture", TextureSlot::RimMultiply, transform),
        ("_OutlineWidthTexture", TextureSlot::OutlineWidth, transform),
        ("_UvAnimMaskTexture", TextureSlot::UvAnimationMask, transform),
    ] {
        material.set_texture(slot, properties.texture(name, transform, reader)?);
    }
    Ok(())
}
