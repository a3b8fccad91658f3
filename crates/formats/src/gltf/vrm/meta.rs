//! `meta` and first-person flags of both versions. They are shown to the user, not applied.

use gaitway_character::avatar::Avatar;
use serde_json::Value;

use super::{Reader, index, text};

/// Longer values are truncated.
const MAX_CHARS: usize = 500;
const MAX_ENTRIES: usize = 64;
const MAX_FLAGS: usize = 1024;

pub fn read(reader: &mut Reader, vrm: &Value, avatar: &mut Avatar) {
    avatar.spec_version = text(vrm, "specVersion").chars().take(MAX_CHARS).collect();
    for (key, value) in vrm["meta"].as_object().into_iter().flatten().take(MAX_ENTRIES) {
        // Numbers are indices of images.
        let value = match value {
            Value::String(text) => text.clone(),
            Value::Bool(flag) => if *flag { "yes" } else { "no" }.to_owned(),
            Value::Array(values) => values.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(", "),
            _ => continue,
        };
        if !value.trim().is_empty() {
            avatar.meta.push((key.clone(), value.chars().take(MAX_CHARS).collect()));
        }
    }
    let flags = reader.list("firstPerson.meshAnnotations", &vrm["firstPerson"]["meshAnnotations"], MAX_FLAGS);
    for value in flags {
        let mesh = index(&value["mesh"]);
        // 1.0 refers to nodes, 0.x to meshes.
        let (joint, flag) = match reader.joint(&value["node"]) {
            Some(joint) => (Some(joint), text(value, "type")),
            None => {
                let drawn = reader.context.instances.iter().find(|instance| Some(instance.mesh) == mesh);
                (drawn.map(|instance| instance.joint), text(value, "firstPersonFlag"))
            }
        };
        if let Some(joint) = joint.filter(|_| !flag.is_empty()) {
            avatar.first_person.push((joint, flag.chars().take(MAX_CHARS).collect()));
        }
    }
}
