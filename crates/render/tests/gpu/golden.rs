//! One whole picture, compared with the one kept in `golden/`. `UPDATE_GOLDEN=1` redraws the kept picture: look at it
//! before you commit it.

use std::fmt;
use std::sync::Arc;

use gaitway_character::asset::Asset;
use gaitway_render::{Renderer, RendererOptions, read_pixels};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::samples;
use gaitway_scene::state::{CharacterView, Playhead, ViewerState};

use crate::device::{Gpu, gpu};

const SIZE: [u32; 2] = [160, 120];

/// Small enough that a hand (about 6 pixels across) fills a good part of one.
const BLOCK: u32 = 8;

/// Edges fall slightly differently on other adapters: a few pixels in a block, nothing over the picture as a whole.
const MAX_MEAN: f64 = 0.5;
const MAX_BLOCK_MEAN: f64 = 6.0;

/// Absolute differences of the channels, 0 to 255.
struct Difference {
    mean: f64,
    /// Mean of the block that differs most, and that block's top left pixel.
    worst_block: f64,
    worst_at: [u32; 2],
}

impl Difference {
    fn between(a: &[u8], b: &[u8]) -> Self {
        assert_eq!((a.len(), b.len()), (pixel_count(SIZE) * 4, pixel_count(SIZE) * 4));
        let at = |x: u32, y: u32| {
            let first = 4 * (y * SIZE[0] + x) as usize;
            (first..first + 4).map(|byte| f64::from(a[byte].abs_diff(b[byte]))).sum::<f64>() / 4.0
        };
        let mean = |left: u32, top: u32, size: [u32; 2]| {
            let rows = (top..top + size[1]).flat_map(|y| (left..left + size[0]).map(move |x| (x, y)));
            rows.map(|(x, y)| at(x, y)).sum::<f64>() / pixel_count(size) as f64
        };
        // Blocks overlap by half, so that one of them holds most of any small part.
        let steps = |size: u32| (0..=size - BLOCK).step_by(BLOCK as usize / 2);
        let blocks = steps(SIZE[1]).flat_map(|top| steps(SIZE[0]).map(move |left| [left, top]));
        let blocks = blocks.map(|[left, top]| (mean(left, top, [BLOCK; 2]), [left, top]));
        let (worst_block, worst_at) = blocks.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a picture has blocks");
        Self { mean: mean(0, 0, SIZE), worst_block, worst_at }
    }

    fn is_small(&self) -> bool {
        self.mean < MAX_MEAN && self.worst_block < MAX_BLOCK_MEAN
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.worst_at;
        write!(f, "mean {:.3}, {:.1} in the block at {x}, {y}", self.mean, self.worst_block)
    }
}

fn pixel_count(size: [u32; 2]) -> usize {
    (size[0] * size[1]) as usize
}

/// The walker in mid-stride.
fn draw(gpu: &Gpu, model: Model) -> Vec<u8> {
    let Gpu { device, queue } = gpu;
    let mut library = Library::default();
    library.add(model);
    let state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, ..Default::default() },
            ..CharacterView::default()
        },
        ..Default::default()
    };
    let mut frame = Frame::default();
    evaluate(&library, &state, SIZE[0] as f32 / SIZE[1] as f32, &mut frame);
    let mut renderer = Renderer::new(device, queue, RendererOptions { samples: 1 });
    renderer.upload(device, queue, library.active().unwrap()).unwrap();
    renderer.draw(device, queue, &frame, SIZE);
    pollster::block_on(read_pixels(device, queue, renderer.output()))
}

fn walker() -> Model {
    samples::load(samples::WALKER).unwrap()
}

/// The walker without the triangles that follow one of its joints most.
fn walker_without(joint: &str) -> Model {
    let model = walker();
    let mut asset = Arc::into_inner(model.asset).expect("nobody else has it yet").into_parts();
    let joint = asset.skeleton.find(joint).unwrap();
    let in_skin = asset.skins[0].joints().iter().position(|&other| other == joint).unwrap();
    let parts = asset.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives);
    let mut removed = 0;
    for part in parts {
        let follows = |vertex: &u32| {
            let strongest = part.influences.of_vertex(*vertex as usize).next();
            strongest.is_some_and(|(joint, _)| usize::from(joint) == in_skin)
        };
        let (triangles, _) = part.indices.as_chunks::<3>();
        let kept = triangles.iter().filter(|triangle| !triangle.iter().all(follows)).flatten().copied().collect();
        removed += part.indices.len() - Vec::len(&kept);
        part.indices = kept;
    }
    assert!(removed > 0, "no triangle follows {in_skin}");
    Model::new(model.source, Asset::new(asset).expect("still valid"), model.images)
}

const PATH: &str = "tests/gpu/golden/walker.png";

fn golden() -> Vec<u8> {
    let golden = image::open(PATH).unwrap_or_else(|error| panic!("{PATH}: {error}")).into_rgba8();
    assert_eq!(golden.dimensions(), (SIZE[0], SIZE[1]));
    golden.into_raw()
}

#[test]
fn the_walker_looks_as_it_did() {
    let Some(gpu) = gpu() else { return };
    let pixels = draw(&gpu, walker());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        image::save_buffer(PATH, &pixels, SIZE[0], SIZE[1], image::ColorType::Rgba8).unwrap();
    }
    let difference = Difference::between(&golden(), &pixels);
    assert!(difference.is_small(), "{difference}; run with UPDATE_GOLDEN=1 and look at the picture");
}

/// Guards the comparison itself: a tolerance that lets this pass would let a broken limb pass.
#[test]
fn a_missing_hand_foot_or_neck_is_noticed() {
    let Some(gpu) = gpu() else { return };
    let golden = golden();
    for joint in ["LeftHand", "RightHand", "LeftToes", "RightToes", "Neck"] {
        let difference = Difference::between(&golden, &draw(&gpu, walker_without(joint)));
        assert!(!difference.is_small(), "without {joint}: {difference}");
    }
}
