//! Every shader is valid and translates to GLSL ES 3.00, the language of WebGL2.

use gaitway::render::shaders::{ALL, SKINNED_VERTEX, Shader};
use naga::back::glsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Sets every override to this value; what is not a number becomes true.
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
