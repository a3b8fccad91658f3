//! `.skel`: one joint per line, `x y z parent`: the offset from its parent and the parent's number, −1 for a root. Parents come
//! first. Joints have neither names nor rotations, and the length of the last bones is unknown.

use gaitway_character::anim::{Joint, Skeleton, Transform};
use glam::Vec3;

use crate::error::Problem;
use crate::limits::{Budget, Limit};
use crate::lines::{Lines, number, quoted, text};

/// Maximum number of joints that influences can refer to.
const MAX_JOINTS: usize = u16::MAX as usize;

pub fn read(bytes: &[u8], budget: &Budget) -> Result<Skeleton, Problem> {
    let mut joints: Vec<Joint> = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((line, content)) = lines.next_full_line() {
        if content.starts_with(b"#") {
            continue;
        }
        let place = format!("line {line}");
        if joints.len() == MAX_JOINTS {
            return Err(Problem::new(place, format!("at most {MAX_JOINTS} joints"), "more"));
        }
        budget.spend(Limit::Nodes, 1, &place)?;
        let words: Vec<&[u8]> =
            content.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).take(5).collect();
        let [x, y, z, parent] = words[..] else {
            let found = if words.len() > 4 { "more".to_owned() } else { words.len().to_string() };
            return Err(Problem::new(place, "4 numbers: x y z and the parent's number", found));
        };
        let mut offset = [0.0; 3];
        for (coordinate, word) in offset.iter_mut().zip([x, y, z]) {
            let value = number(word).map(|value| value as f32).filter(|value| value.is_finite());
            *coordinate = value.ok_or_else(|| Problem::new(&*place, "a finite number", quoted(Some(word))))?;
        }
        let parent = parent_of(parent, joints.len())
            .map_err(|expected| Problem::new(&*place, expected, quoted(Some(parent))))?;
        joints.push(Joint {
            name: format!("joint {}", joints.len()),
            parent,
            rest: Transform::from_translation(Vec3::from(offset)),
            morph_weights: Vec::new(),
        });
    }
    if joints.is_empty() {
        return Err(Problem::new(lines.place(), "a line `x y z -1` with the first joint", "the end of the file"));
    }
    Skeleton::new(joints).map_err(|problem| Problem::new("joints", "a tree", problem))
}

/// Parses the parent of joint `joint`; fails with what was expected.
fn parent_of(word: &[u8], joint: usize) -> Result<Option<usize>, String> {
    let parent: Option<i64> = text(word).parse().ok();
    match parent {
        Some(-1) => Ok(None),
        Some(parent) if parent >= 0 && (parent as u64) < joint as u64 => Ok(Some(parent as usize)),
        _ if joint == 0 => Err("-1: the first joint has no parent".to_owned()),
        _ => Err(format!("the parent of joint {joint}, which comes before it: 0 to {}, or -1 for none", joint - 1)),
    }
}
