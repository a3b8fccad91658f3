//! The motion: rotations of the joints and the path of the pelvis, of one or several people or samples.

use gaitway_glb::{Animation, Glb, Warnings};
use glam::{DQuat, DVec3};

use crate::archive::Archive;
use crate::layout::{Grid, unexpected};
use crate::skeleton::Skeleton;
use crate::up::is_z_up;
use crate::{find, solve};

/// Assumed where a file states no rate: that of most video, of tools that fit SMPL bodies to it, and of most motion models.
const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;
/// That of HumanML3D, and so of the models that write positions of its 22 joints.
const HUMAN_ML_FRAMES_PER_SEC: f64 = 20.0;
/// That of AIST++, whose files state none.
const AIST_FRAMES_PER_SEC: f64 = 60.0;

/// Mean distance of joints from their positions in the file, in metres, above which a warning says so.
const MAX_SILENT_ERROR: f64 = 0.005;

/// The motion of one person, or one sample.
pub struct Body {
    /// Relative to the parent: joints × frames.
    pub rotations: Vec<DQuat>,
    /// Where the pelvis is, if it moves.
    pub path: Option<Vec<DVec3>>,
}

/// All motions of a file.
pub struct Motion {
    pub skeleton: Skeleton,
    pub bodies: Vec<Body>,
    pub frames: usize,
    frames_per_sec: f64,
    /// How the arrays were read.
    pub report: String,
}

impl Motion {
    /// Reads the file.
    pub fn read(archive: &Archive, warnings: &mut Warnings) -> Result<Motion, String> {
        let rate = rate(archive)?;
        let found = find::find(archive, warnings)?;
        let mut rate_or = |default: f64| {
            rate.unwrap_or_else(|| {
                warnings.add(format!(
                    "The file has no frame rate (\"mocap_framerate\"): {default} frames per second are assumed. If it has another \
                     one, set the speed of the clip to that divided by {default}."
                ));
                default
            })
        };
        match found {
            find::Found::Rotations(mut motion) => {
                let default = if archive.has(find::SCALING) { AIST_FRAMES_PER_SEC } else { DEFAULT_FRAMES_PER_SEC };
                motion.frames_per_sec = rate_or(default);
                if motion.bodies.iter().all(|body| body.path.is_none()) {
                    warnings.add("The file has no path (\"trans\"), so the person stays in place.".to_owned());
                }
                Ok(motion)
            }
            find::Found::Positions(grid) => {
                let default = if grid.joints() == 22 { HUMAN_ML_FRAMES_PER_SEC } else { DEFAULT_FRAMES_PER_SEC };
                let rate = rate_or(default);
                Ok(Motion::solved(&grid, rate, warnings))
            }
        }
    }

    /// Creates a motion from rotations. Its frame rate isn't known yet.
    pub fn new(skeleton: Skeleton, bodies: Vec<Body>, frames: usize, report: String) -> Motion {
        Motion { skeleton, bodies, frames, frames_per_sec: DEFAULT_FRAMES_PER_SEC, report }
    }

    /// Solves the rotations from joint positions.
    fn solved(grid: &Grid, frames_per_sec: f64, warnings: &mut Warnings) -> Motion {
        let mut skeleton = Skeleton::of(grid.joints());
        solve::measure(grid, &mut skeleton);
        let mut error = solve::Error::default();
        let bodies = (0..grid.samples())
            .map(|sample| {
                let solved = solve::solve(grid, &skeleton, sample, frames_per_sec);
                error.join(solved.error);
                let path = (0..grid.frames()).map(|frame| solve::position(grid, sample, frame, 0)).collect();
                Body { rotations: solved.rotations, path: Some(path) }
            })
            .collect();
        if error.mean() > MAX_SILENT_ERROR {
            warnings.add(format!(
                "Bones change their lengths in the file. With constant lengths, joints are off by {}.",
                error.text()
            ));
        }
        let report = format!(
            "positions of {} joints in {} frames{}; with bones of constant length, joints are off by {}",
            grid.joints(),
            grid.frames(),
            grid.describe(),
            error.text()
        );
        Motion { skeleton, bodies, frames: grid.frames(), frames_per_sec, report }
    }

    /// Writes the skeleton and a clip for each person or sample. Joints that never turn have no keys.
    pub fn write(&self, extension: &str, warnings: &mut Warnings) -> Result<Vec<u8>, String> {
        let is_z_up = is_z_up(self, warnings);
        let y_up = if is_z_up { DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2) } else { DQuat::IDENTITY };
        let mut glb = Glb::new(format!("{extension}: {}; {} up", self.report, if is_z_up { "Z" } else { "Y" }));
        self.skeleton.write(&mut glb);
        let times: Vec<f32> = (0..self.frames).map(|frame| (frame as f64 / self.frames_per_sec) as f32).collect();
        for (number, body) in self.bodies.iter().enumerate() {
            let mut clip = Animation::default();
            for (joint, rotations) in body.rotations.chunks_exact(self.frames).enumerate() {
                let world = if joint == 0 { y_up } else { DQuat::IDENTITY };
                if joint == 0 || rotations.iter().any(|&rotation| rotation != DQuat::IDENTITY) {
                    let values = rotations.iter().flat_map(|&rotation| (world * rotation).as_quat().to_array());
                    clip.add(&mut glb, (joint, "rotation"), "LINEAR", &times, &values.collect::<Vec<f32>>())?;
                }
            }
            if let Some(path) = &body.path {
                let pelvis = path.iter().flat_map(|&at| (y_up * at).as_vec3().to_array());
                clip.add(&mut glb, (0, "translation"), "LINEAR", &times, &pelvis.collect::<Vec<f32>>())?;
            }
            let name = if self.bodies.len() == 1 { String::new() } else { format!("Sample {}", number + 1) };
            clip.write(&name, &mut glb);
        }
        glb.write()
    }
}

/// Returns the frame rate that a file states.
fn rate(archive: &Archive) -> Result<Option<f64>, String> {
    let Some(rate) = archive.find(&["mocap_framerate", "mocap_frame_rate", "fps"])? else { return Ok(None) };
    match rate.values[..] {
        [rate] if (1e-3..=1e6).contains(&rate) => Ok(Some(rate)),
        _ => Err(unexpected(&rate.label, "a number of frames per second", &format!("{:?}", rate.shape))),
    }
}
