//! Skins (§3.7.3.1).

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::Skin;
use glam::{Affine3A, Mat4};
use gltf::json::Index;

use super::accessor::{Accessors, get};
use crate::error::Problem;

/// A joint's index and its bind matrix, which a skin holds in two forms.
const JOINT_BYTES: usize = size_of::<JointIndex>() + 2 * size_of::<Affine3A>();

pub fn skins(accessors: &Accessors, skeleton: &Skeleton, warnings: &mut Warnings) -> Result<Vec<Skin>, Problem> {
    let root = &accessors.document.root;
    let mut skins = Vec::with_capacity(root.skins.len());
    for (index, skin) in root.skins.iter().enumerate() {
        let here = format!("skins[{index}]");
        accessors.budget.allocate(skin.joints.len(), JOINT_BYTES, &here)?;
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (at, joint) in skin.joints.iter().map(Index::value).enumerate() {
            get(&root.nodes, joint, &format!("{here}.joints[{at}]"), "nodes")?;
            joints.extend(skeleton.joint_of_source(joint));
        }
        if let Some(node) = skin.skeleton {
            get(&root.nodes, node.value(), &format!("{here}.skeleton"), "nodes")?;
        }
        let joint_from_bind = match skin.inverse_bind_matrices {
            None => vec![Affine3A::IDENTITY; joints.len()],
            Some(accessor) => {
                let place = format!("{here}.inverseBindMatrices");
                let found = accessors.count(accessor.value(), &place)?;
                if found < joints.len() {
                    return Err(Problem::new(place, format!("{} matrices, one for each joint", joints.len()), found));
                }
                let matrices = accessors.floats::<16>(accessor.value(), &place, "MAT4")?;
                read_matrices(&matrices[..joints.len()], &place, warnings)
            }
        };
        let skin = Skin::new(skin.name.clone().unwrap_or_default(), joints, joint_from_bind, skeleton.len())
            .map_err(|problem| Problem::new(here, "a usable skin", problem))?;
        skins.push(skin);
    }
    Ok(skins)
}

fn read_matrices(matrices: &[[f32; 16]], place: &str, warnings: &mut Warnings) -> Vec<Affine3A> {
    let mut projective = 0;
    let affine = matrices
        .iter()
        .map(|columns| {
            let matrix = Mat4::from_cols_array(columns);
            projective += usize::from(!matrix.row(3).abs_diff_eq(glam::Vec4::W, 1e-4));
            Affine3A::from_mat4(matrix)
        })
        .collect();
    if projective > 0 {
        let problem = format!("the fourth row of {projective} matrices is not 0 0 0 1; it is treated as if it were");
        warnings.push(Warning::Other { code: "bind-matrix-row", place: place.to_owned(), problem });
    }
    affine
}
