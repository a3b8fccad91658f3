//! How much of a character's limbs is inside its body, by winding numbers of the skinned mesh: independent of the solids that
//! contacts are kept by.

use gaitway_character::anim::{Clip, JointIndex, Pose, SampleCursor, model_from_joint};
use gaitway_character::asset::{MeshInstance, Slot};
use gaitway_character::mesh::{DeformedVertices, Geometry, Skin, SkinningMode, deform, palette_entry, write_palette};
use glam::{Affine3A, Vec3};

use crate::people::Loaded;

/// Regions of the body, and the slots in them that are limb ends.
const REGIONS: [(&[Slot], &[Slot]); 5] = {
    use Slot::*;
    [
        (&[Hips, Spine, Chest, UpperChest, Neck, Head], &[]),
        (&[LeftUpperArm, LeftLowerArm, LeftHand], &[LeftLowerArm, LeftHand]),
        (&[RightUpperArm, RightLowerArm, RightHand], &[RightLowerArm, RightHand]),
        (&[LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes], &[LeftLowerLeg, LeftFoot, LeftToes]),
        (&[RightUpperLeg, RightLowerLeg, RightFoot, RightToes], &[RightLowerLeg, RightFoot, RightToes]),
    ]
};

const MAX_LIMB_POINTS: usize = 240;
const MAX_FRAMES: usize = 40;

/// The skinned mesh: triangles by region, and points of limb ends.
struct Surface {
    vertices: Vec<Vec3>,
    triangles: [Vec<[usize; 3]>; 5],
    points: Vec<(usize, usize)>,
}

impl Surface {
    fn new(model: &Loaded) -> Self {
        let part_of: Vec<_> = model.asset.skeleton.joints().map(|joint| part_of(model, joint)).collect();
        let mut surface = Self { vertices: Vec::new(), triangles: Default::default(), points: Vec::new() };
        let mut count = 0;
        for instance in &model.asset.instances {
            let skin = instance.skin.map(|skin| &model.asset.skins[skin]);
            for geometry in &model.asset.meshes[instance.mesh].primitives {
                let part = |vertex: usize| {
                    let joint = joint_of(instance, skin, geometry, vertex);
                    part_of[joint.get()].filter(|_| skin.is_some() || model.slots.slot(joint).is_some())
                };
                let vertices = geometry.positions.len();
                for triangle in geometry.indices.chunks_exact(3) {
                    let triangle = [triangle[0], triangle[1], triangle[2]].map(|index| index as usize);
                    let region = part(triangle[0]).map(|(region, _)| &mut surface.triangles[region]);
                    region.into_iter().for_each(|region| region.push(triangle.map(|index| count + index)));
                }
                surface.points.extend((0..vertices).filter_map(|vertex| {
                    let (region, _) = part(vertex).filter(|(_, is_end)| *is_end)?;
                    Some((count + vertex, region))
                }));
                count += vertices;
            }
        }
        let step = surface.points.len().div_ceil(MAX_LIMB_POINTS).max(1);
        surface.points = surface.points.into_iter().step_by(step).collect();
        surface
    }

    fn pose(&mut self, model: &Loaded, pose: &Pose) {
        let mut world = Vec::new();
        model_from_joint(&model.asset.skeleton, pose, Affine3A::IDENTITY, &mut world);
        self.vertices.clear();
        let (mut palette, mut out) = (Vec::new(), DeformedVertices::default());
        for instance in &model.asset.instances {
            palette.clear();
            match instance.skin {
                Some(skin) => write_palette(&model.asset.skins[skin], &world, SkinningMode::Linear, &mut palette),
                None => {
                    let model_from_mesh = world[instance.joint.get()] * instance.joint_from_mesh;
                    palette.push(palette_entry(&model_from_mesh, SkinningMode::Linear));
                }
            }
            for geometry in &model.asset.meshes[instance.mesh].primitives {
                deform(geometry, &[], &palette, SkinningMode::Linear, &mut out);
                self.vertices.extend(&out.positions);
            }
        }
    }

    /// Whether each point is inside other regions, one bit each. Arms are tested against all others, legs against the other leg.
    fn inside(&self) -> Vec<u8> {
        let boxes = self.triangles.each_ref().map(|triangles| {
            triangles.iter().flatten().fold((Vec3::MAX, Vec3::MIN), |(low, high), &vertex| {
                (low.min(self.vertices[vertex]), high.max(self.vertices[vertex]))
            })
        });
        let inside = |&(vertex, own): &(usize, usize)| {
            let point = self.vertices[vertex];
            (0..5).filter(|&region| region != own && (own < 3 || region >= 3)).fold(0, |bits, region| {
                let (low, high) = boxes[region];
                let is_near = point.cmpge(low).all() && point.cmple(high).all();
                if is_near && self.winding(region, point).abs() > 0.5 { bits | 1 << region } else { bits }
            })
        };
        self.points.iter().map(inside).collect()
    }

    fn winding(&self, region: usize, point: Vec3) -> f32 {
        let angles = self.triangles[region].iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| self.vertices[vertex] - point);
            let [la, lb, lc] = [a, b, c].map(Vec3::length);
            a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        });
        angles.sum::<f32>() / std::f32::consts::TAU
    }
}

/// The region that a joint is in, and whether it is a limb's end.
fn part_of(model: &Loaded, joint: JointIndex) -> Option<(usize, bool)> {
    let in_region = |joint: JointIndex| {
        REGIONS.iter().enumerate().find_map(|(region, (slots, ends))| {
            let slot = slots.iter().find(|&&slot| model.slots.joint(slot) == Some(joint))?;
            Some((region, ends.contains(slot)))
        })
    };
    std::iter::successors(Some(joint), |&joint| model.asset.skeleton.parent(joint)).find_map(in_region)
}

/// The joint that a vertex follows most.
fn joint_of(instance: &MeshInstance, skin: Option<&Skin>, geometry: &Geometry, vertex: usize) -> JointIndex {
    let Some(skin) = skin.filter(|_| !geometry.influences.is_empty()) else { return instance.joint };
    let strongest = geometry.influences.of_vertex(vertex).max_by(|a, b| a.1.total_cmp(&b.1));
    skin.joints()[usize::from(strongest.map_or(0, |(joint, _)| joint))]
}

/// Share of the vertices of limb ends that are inside other regions of the body and aren't at rest, over a clip.
pub fn mesh_penetration(model: &Loaded, clip: &Clip) -> Option<f64> {
    let skeleton = &model.asset.skeleton;
    let mut surface = Surface::new(model);
    if surface.points.is_empty() {
        return None;
    }
    let mut pose = skeleton.rest().clone();
    surface.pose(model, &pose);
    let at_rest = surface.inside();
    let mut cursor = SampleCursor::default();
    let mut count = 0;
    for frame in 0..MAX_FRAMES {
        pose.copy_from(skeleton.rest());
        let time = clip.duration_secs() * (frame as f32 + 0.5) / MAX_FRAMES as f32;
        clip.sample(skeleton, time, &mut cursor, &mut pose);
        surface.pose(model, &pose);
        count += surface.inside().iter().zip(&at_rest).filter(|(now, rest)| **now & !**rest != 0).count();
    }
    Some(count as f64 / (MAX_FRAMES * surface.points.len()) as f64)
}
