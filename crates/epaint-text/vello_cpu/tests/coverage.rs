//! Coverage against the exact area of each contour within each pixel, found by clipping polygons.

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, MetadataProvider};
use vello_cpu::kurbo::{Affine, BezPath};
use vello_cpu::{Pixmap, RenderContext, Resources};

const FONT: &[u8] = include_bytes!("../../../../assets/font/Ubuntu-Light-derivative-Gaitway.ttf");

type Contour = Vec<(f64, f64)>;

/// Lines for each curve of the reference.
const FINE: u32 = 256;

fn drawn(path: &BezPath, size: (u16, u16), shift: (f64, f64)) -> Vec<u8> {
    let mut context = RenderContext::new(size.0, size.1);
    context.set_transform(Affine::translate(shift));
    context.set_paint(vello_cpu::color::OpaqueColor::WHITE);
    context.fill_path(path);
    let mut pixmap = Pixmap::new(size.0, size.1);
    context.render(&mut pixmap, &mut Resources::new());
    let pixels = pixmap.data_as_u8_slice().chunks_exact(4);
    pixels.inspect(|pixel| assert!(pixel.iter().all(|value| value == &pixel[0]), "{pixel:?}")).map(|p| p[0]).collect()
}

fn polygon(points: &[(f64, f64)]) -> BezPath {
    let mut path = BezPath::new();
    path.move_to(points[0]);
    points[1..].iter().for_each(|&point| path.line_to(point));
    path.close_path();
    path
}

/// Keeps the part of a contour on one side of a line (Sutherland and Hodgman); `distance` is positive on that side.
fn clip(contour: &[(f64, f64)], distance: impl Fn((f64, f64)) -> f64) -> Contour {
    let mut kept = Vec::new();
    for (index, &to) in contour.iter().enumerate() {
        let from = contour[(index + contour.len() - 1) % contour.len()];
        let (a, b) = (distance(from), distance(to));
        if (a < 0.0) != (b < 0.0) {
            let t = a / (a - b);
            kept.push((from.0 + (to.0 - from.0) * t, from.1 + (to.1 - from.1) * t));
        }
        if b >= 0.0 {
            kept.push(to);
        }
    }
    kept
}

fn signed_area(contour: &[(f64, f64)]) -> f64 {
    let next = contour.iter().cycle().skip(1);
    contour.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>() / 2.0
}

fn exact(contours: &[Contour], x: u16, y: u16) -> f64 {
    let (x, y) = (f64::from(x), f64::from(y));
    let areas = contours.iter().map(|contour| {
        let rows = clip(&clip(contour, |p| p.1 - y), |p| y + 1.0 - p.1);
        signed_area(&clip(&clip(&rows, |p| p.0 - x), |p| x + 1.0 - p.0))
    });
    areas.sum::<f64>().abs().min(1.0)
}

fn check(path: &BezPath, contours: &[Contour], size: (u16, u16), what: &str) {
    let pixels = drawn(path, size, (0.0, 0.0));
    let mut places = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
    for &pixel in &pixels {
        let (x, y) = places.next().unwrap();
        let expected = exact(contours, x, y) * 255.0;
        assert!((f64::from(pixel) - expected).abs() <= 1.0, "{what}: {pixel} at {x}, {y}, expected {expected}");
    }
    assert!(pixels.iter().any(|&pixel| pixel > 0), "{what}");
}

fn check_polygon(points: &[(f64, f64)]) {
    check(&polygon(points), &[points.to_vec()], (8, 6), &format!("{points:?}"));
}

#[test]
fn squares_cover_their_area_at_any_offset() {
    for offset in 0..16 {
        let (x, y) = (1.0 + f64::from(offset) / 16.0, 1.0 + f64::from(offset * 5 % 16) / 16.0);
        check_polygon(&[(x, y), (x + 3.0, y), (x + 3.0, y + 2.5), (x, y + 2.5)]);
        check_polygon(&[(x, y), (x, y + 0.3), (x + 0.2, y + 0.3), (x + 0.2, y)]);
    }
    check_polygon(&[(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0)]);
}

#[test]
fn triangles_cover_their_area_whatever_their_slope() {
    check_polygon(&[(0.0, 0.0), (8.0, 0.1), (0.0, 0.2)]);
    check_polygon(&[(0.5, 0.5), (7.25, 1.75), (3.0, 5.9)]);
    check_polygon(&[(7.9, 0.0), (8.0, 6.0), (7.8, 6.0)]);
    check_polygon(&[(0.1, 5.3), (7.7, 2.2), (0.3, 2.1)]);
    check_polygon(&[(1.0, 1.0), (5.0, 1.0), (1.0, 5.0)]);
}

#[test]
fn contours_in_the_same_direction_overlap_and_in_opposite_ones_cut_holes() {
    let square = |x: f64, reversed: bool| {
        let mut points = [(x, 1.0), (x + 4.0, 1.0), (x + 4.0, 5.0), (x, 5.0)];
        if reversed {
            points.reverse();
        }
        points
    };
    for (reversed, shared) in [(false, 255), (true, 0)] {
        let mut path = polygon(&square(1.0, false));
        let points = square(3.0, reversed);
        path.move_to(points[0]);
        // Left open: filling closes it.
        points[1..].iter().for_each(|&point| path.line_to(point));
        let pixels = drawn(&path, (8, 6), (0.0, 0.0));
        assert_eq!(pixels[2 * 8..3 * 8], [0, 255, 255, shared, shared, 255, 255, 0]);
    }
}

#[test]
fn what_lies_outside_the_picture_is_cut_off() {
    let path = polygon(&[(-5.0, -5.0), (4.0, -5.0), (4.0, 50.0), (-5.0, 50.0)]);
    for row in drawn(&path, (8, 6), (0.5, 0.0)).chunks(8) {
        assert_eq!(row, [255, 255, 255, 255, 128, 0, 0, 0]);
    }
    for beside in [(1e9, 0.0), (0.0, -1e9), (0.0, 1e9), (f64::NAN, f64::INFINITY)] {
        assert!(drawn(&path, (8, 6), beside).iter().all(|&pixel| pixel == 0), "{beside:?}");
    }
    assert_eq!(drawn(&path, (0, 0), (0.0, 0.0)), []);
}

/// Collects a glyph as epaint does and, as fine polygons, for the reference.
struct Pen {
    path: BezPath,
    contours: Vec<Contour>,
    offset: (f64, f64),
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f64, f64) {
        (f64::from(x) + self.offset.0, self.offset.1 - f64::from(y))
    }

    fn curve(&mut self, at: impl Fn((f64, f64), f64) -> (f64, f64)) {
        let contour = self.contours.last_mut().unwrap();
        let from = *contour.last().unwrap();
        contour.extend((1..=FINE).map(|step| at(from, f64::from(step) / f64::from(FINE))));
    }
}

fn mix(a: (f64, f64), b: (f64, f64), t: f64) -> (f64, f64) {
    (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t)
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.move_to(to);
        self.contours.push(vec![to]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.line_to(to);
        self.curve(|from, t| mix(from, to, t));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let (control, to) = (self.at(cx, cy), self.at(x, y));
        self.path.quad_to(control, to);
        self.curve(|from, t| mix(mix(from, control, t), mix(control, to, t), t));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let (a, b, to) = (self.at(ax, ay), self.at(bx, by), self.at(x, y));
        self.path.curve_to(a, b, to);
        self.curve(|from, t| {
            let (left, middle, right) = (mix(from, a, t), mix(a, b, t), mix(b, to, t));
            mix(mix(left, middle, t), mix(middle, right, t), t)
        });
    }

    fn close(&mut self) {
        self.path.close_path();
    }
}

#[test]
fn glyphs_with_holes_cover_their_area_at_subpixel_offsets() {
    let font = FontRef::new(FONT).unwrap();
    let glyphs = font.outline_glyphs();
    for (character, pixels) in [('o', 14.0), ('B', 14.0), ('8', 10.5), ('&', 28.0), ('ж', 17.0)] {
        let outline = glyphs.get(font.charmap().map(character).unwrap()).unwrap();
        for offset in [0.0, 0.25, 0.5, 0.75] {
            let mut pen = Pen { path: BezPath::new(), contours: Vec::new(), offset: (1.0 + offset, 30.0) };
            outline.draw(DrawSettings::unhinted(Size::new(pixels), LocationRef::default()), &mut pen).unwrap();
            check(&pen.path, &pen.contours, (40, 40), &format!("{character} of {pixels} px at {offset}"));
        }
    }
}

#[test]
fn cubic_curves_cover_their_area() {
    let mut pen = Pen { path: BezPath::new(), contours: Vec::new(), offset: (0.0, 40.0) };
    pen.move_to(2.5, 3.25);
    pen.curve_to(0.0, 35.0, 36.0, 20.0, 37.5, 38.5);
    pen.curve_to(40.0, 10.0, 12.0, 1.0, 2.5, 3.25);
    pen.close();
    check(&pen.path, &pen.contours, (40, 40), "two cubic curves");
}

#[test]
fn bounds_contain_control_points_and_are_rounded_outwards() {
    let mut path = BezPath::new();
    assert_eq!(path.control_box().expand().width(), 0.0);
    path.move_to((0.5, -0.5));
    path.quad_to((3.2, -7.9), (1.0, 2.0));
    let bounds = path.control_box().expand();
    assert_eq!((bounds.x0, bounds.y0, bounds.width(), bounds.height()), (0.0, -8.0, 4.0, 10.0));
}
