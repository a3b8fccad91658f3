//! Every shader is valid and translates to GLSL ES 3.00, the language of WebGL2.

use gaitway_character::anim::TextureSlot;
use gaitway_render::shaders::{ALL, SKINNED_VERTEX, Shader, SurfacePermutation};
use naga::back::glsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Sets every override to this value; booleans become true.
fn check(shader: &Shader, overrides: u8) {
    let source = shader.source();
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}: {}", shader.label, error.emit_to_string(&source)));
    // WebGPU's baseline, without optional capabilities.
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}: {}", shader.label, error.emit_to_string(&source)));
    let constants =
        module.overrides.iter().filter_map(|(_, value)| Some((value.name.clone()?, f64::from(overrides)))).collect();
    let options = glsl::Options {
        version: glsl::Version::Embedded { version: 300, is_webgl: true },
        writer_flags: glsl::WriterFlags::ADJUST_COORDINATE_SPACE,
        ..Default::default()
    };
    assert!(!module.entry_points.is_empty() || shader.label == SKINNED_VERTEX.label, "{}", shader.label);
    for entry in &module.entry_points {
        let at = format!("{}, {}, {overrides}", shader.label, entry.name);
        let (module, info) = naga::back::pipeline_constants::process_overrides(
            &module,
            &info,
            Some((entry.stage, &entry.name)),
            &constants,
        )
        .unwrap_or_else(|error| panic!("{at}: {error}"));
        let pipeline =
            glsl::PipelineOptions { shader_stage: entry.stage, entry_point: entry.name.clone(), multiview: None };
        let mut text = String::new();
        glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, naga::proc::BoundsCheckPolicies::default())
            .and_then(|mut writer| writer.write())
            .unwrap_or_else(|error| panic!("{at}: {error}"));
        assert!(text.starts_with("#version 300 es"), "{at}");
        // WebGL2 guarantees 16 textures per stage and 16 vertex attributes.
        assert!(text.matches("uniform highp sampler").count() <= 16, "{at}");
        assert!(text.matches("layout(location = ").count() <= 16, "{at}");
    }
}

#[test]
fn every_shader_is_valid_and_translates_to_webgl2() {
    for shader in ALL.iter().chain([&SKINNED_VERTEX]) {
        for overrides in 0..4 {
            check(shader, overrides);
        }
    }
}

fn snake_case(camel_case: &str) -> String {
    let mut name = String::new();
    for letter in camel_case.chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

/// The texture maps of the shader and the texture slots of materials have the same names and numbers.
#[test]
fn every_texture_slot_is_a_map_of_the_shader() {
    let every_map = (1 << TextureSlot::ALL.len()) - 1;
    let source = Shader::mesh(SurfacePermutation(every_map)).source();
    for (number, slot) in TextureSlot::ALL.into_iter().enumerate() {
        assert_eq!(slot as usize, number);
        let name = snake_case(&format!("{slot:?}"));
        let texel = match slot {
            // Read by the vertex stage.
            TextureSlot::OutlineWidth => {
                format!("return textureSampleLevel({name}_map, {name}_sampler, map_uv({number}u, uv), 0.0);")
            }
            _ => format!("return textureSample({name}_map, {name}_sampler, map_uv({number}u, uv));"),
        };
        assert!(source.contains(&texel), "{texel}");
    }
}

/// The maps of a lobe, as bits of a [`SurfacePermutation`].
fn maps_of(lobe: u64) -> u64 {
    let maps: &[u32] = match lobe {
        SurfacePermutation::SPECULAR => &[5, 6],
        SurfacePermutation::CLEARCOAT => &[7, 8, 9],
        SurfacePermutation::SHEEN => &[10, 11],
        SurfacePermutation::IRIDESCENCE => &[12, 13],
        SurfacePermutation::ANISOTROPY => &[14],
        SurfacePermutation::TRANSMISSION => &[15],
        SurfacePermutation::VOLUME => &[16],
        SurfacePermutation::DIFFUSE_TRANSMISSION => &[17, 18],
        _ => &[],
    };
    maps.iter().map(|map| 1 << map).sum()
}

/// Every lobe alone and with every other one, with and without maps, and all lobes at once with as many maps as fit.
#[test]
fn every_pair_of_lobes_is_valid_and_translates_to_webgl2() {
    use SurfacePermutation as Variant;
    let lobes: Vec<u64> = (25..35).map(|bit| 1 << bit).collect();
    assert_eq!(lobes.iter().sum::<u64>(), Variant::LOBES);
    let with_needed = |lobes: u64| {
        let needs_transmission = lobes & (Variant::VOLUME | Variant::DISPERSION) != 0;
        let needs = |lobe, is_needed| if is_needed { lobe } else { 0 };
        lobes
            | needs(Variant::TRANSMISSION, needs_transmission && lobes & Variant::DIFFUSE_TRANSMISSION == 0)
            | needs(Variant::TRANSMISSION | Variant::VOLUME, lobes & Variant::DISPERSION != 0)
            | needs(Variant::SPECULAR, lobes & Variant::GLOSSINESS != 0)
    };
    let mut checked = std::collections::BTreeSet::new();
    for &a in &lobes {
        for &b in &lobes {
            let pair = with_needed(a | b);
            let maps: u64 = lobes.iter().filter(|&lobe| pair & lobe != 0).map(|&lobe| maps_of(lobe)).sum();
            // Of the core's maps, only the normal map: all of them would be too many.
            checked.extend([pair, pair | maps | 1 << 2]);
        }
    }
    checked.insert(Variant::LOBES | 0b1_1111 | maps_of(Variant::CLEARCOAT));
    for variant in checked {
        for overrides in 0..2 {
            check(&Shader::mesh(Variant(variant)), overrides);
        }
    }
}

/// Without maps, with each of its maps alone and with all of them.
#[test]
fn mtoon_is_valid_and_translates_to_webgl2() {
    let slots = TextureSlot::ALL.into_iter().filter(|&slot| {
        let unused = [TextureSlot::MetallicRoughness, TextureSlot::Occlusion];
        (slot < TextureSlot::Specular || slot >= TextureSlot::ShadeMultiply) && !unused.contains(&slot)
    });
    let maps: Vec<u64> = slots.map(|slot| 1 << slot as u32).collect();
    assert_eq!(maps.len(), 9);
    for maps in maps.iter().copied().chain([0, maps.iter().sum()]) {
        for overrides in 0..2 {
            check(&Shader::mesh(SurfacePermutation(SurfacePermutation::TOON | maps)), overrides);
        }
    }
}

/// For plain materials, MToon, and some lobes with maps.
#[test]
fn channels_are_valid_and_translate_to_webgl2() {
    use SurfacePermutation as Variant;
    let toon = Variant::TOON | 0b1_0111;
    let with_needed = |lobe| if lobe == Variant::GLOSSINESS { lobe | Variant::SPECULAR } else { lobe };
    let lobes =
        [Variant::SPECULAR, Variant::GLOSSINESS, Variant::CLEARCOAT, Variant::ANISOTROPY, Variant::TRANSMISSION];
    let lobes = lobes.map(with_needed).map(|lobes| lobes | maps_of(Variant::SPECULAR) | 1 << 2);
    for variant in lobes.into_iter().chain([Variant::PLAIN.0, toon, 0]) {
        for overrides in 0..2 {
            check(&Shader::mesh(Variant(variant | Variant::CHANNEL)), overrides);
        }
    }
}
