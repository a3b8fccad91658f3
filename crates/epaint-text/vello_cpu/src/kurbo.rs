//! Paths of lines and Bézier curves, their bounds and their lines. Coordinates are pixels, Y down.

/// Maximum distance between a curve and the lines that approximate it, in pixels. Over the width of a pixel, the
/// missing area stays below half of 1/255.
const TOLERANCE: f64 = 1.0 / 512.0;

/// Limits the lines of one curve, whatever its size. Reached by curves of several thousand pixels.
const MAX_LINES: f64 = 512.0;

/// A point or a vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// To the right.
    pub x: f64,
    /// Down.
    pub y: f64,
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Self { x, y }
    }
}

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rect {
    /// Left.
    pub x0: f64,
    /// Top.
    pub y0: f64,
    /// Right.
    pub x1: f64,
    /// Bottom.
    pub y1: f64,
}

impl Rect {
    /// Returns the smallest rectangle with whole coordinates that contains this one.
    pub fn expand(self) -> Self {
        Self { x0: self.x0.floor(), y0: self.y0.floor(), x1: self.x1.ceil(), y1: self.y1.ceil() }
    }

    /// Returns the distance from the left to the right side.
    pub fn width(self) -> f64 {
        self.x1 - self.x0
    }

    /// Returns the distance from the top to the bottom side.
    pub fn height(self) -> f64 {
        self.y1 - self.y0
    }
}

/// A translation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Affine {
    x: f64,
    y: f64,
}

impl Affine {
    /// Moves by a vector.
    pub fn translate((x, y): (f64, f64)) -> Self {
        Self { x, y }
    }
}

#[derive(Debug, Clone, Copy)]
enum Element {
    Move(Point),
    Line(Point),
    Quad([Point; 2]),
    Cubic([Point; 3]),
    Close,
}

impl Element {
    fn points(&self) -> &[Point] {
        match self {
            Self::Move(point) | Self::Line(point) => std::slice::from_ref(point),
            Self::Quad(points) => points,
            Self::Cubic(points) => points,
            Self::Close => &[],
        }
    }
}

/// A path of any number of contours. Filling closes those that are open.
#[derive(Debug, Clone, Default)]
pub struct BezPath(Vec<Element>);

impl BezPath {
    /// Creates an empty path.
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins a contour.
    pub fn move_to(&mut self, point: impl Into<Point>) {
        self.0.push(Element::Move(point.into()));
    }

    /// Draws a straight line.
    pub fn line_to(&mut self, point: impl Into<Point>) {
        self.0.push(Element::Line(point.into()));
    }

    /// Draws a quadratic Bézier curve.
    pub fn quad_to(&mut self, control: impl Into<Point>, point: impl Into<Point>) {
        self.0.push(Element::Quad([control.into(), point.into()]));
    }

    /// Draws a cubic Bézier curve.
    pub fn curve_to(&mut self, control0: impl Into<Point>, control1: impl Into<Point>, point: impl Into<Point>) {
        self.0.push(Element::Cubic([control0.into(), control1.into(), point.into()]));
    }

    /// Ends a contour with a line to its beginning.
    pub fn close_path(&mut self) {
        self.0.push(Element::Close);
    }

    /// Returns the bounds of all points including control points, or an empty rectangle without any.
    pub fn control_box(&self) -> Rect {
        let mut points = self.0.iter().flat_map(Element::points);
        let Some(&Point { x, y }) = points.next() else { return Rect::default() };
        points.fold(Rect { x0: x, y0: y, x1: x, y1: y }, |bounds, point| Rect {
            x0: bounds.x0.min(point.x),
            y0: bounds.y0.min(point.y),
            x1: bounds.x1.max(point.x),
            y1: bounds.y1.max(point.y),
        })
    }

    /// Calls `line` with both ends of every line of the closed contours, curves divided into lines.
    pub(crate) fn flatten(&self, Affine { x, y }: Affine, mut line: impl FnMut(Point, Point)) {
        let mut line = |from: Point, to: Point| {
            line(Point { x: from.x + x, y: from.y + y }, Point { x: to.x + x, y: to.y + y });
        };
        let origin = Point { x: 0.0, y: 0.0 };
        let (mut start, mut current) = (origin, origin);
        for element in &self.0 {
            match *element {
                Element::Move(to) => {
                    line(current, start);
                    start = to;
                }
                Element::Line(to) => line(current, to),
                Element::Quad([a, b]) => {
                    let bend = bend(current, a, b);
                    flatten_curve(current, (bend / 4.0).sqrt(), |t| quad_at([current, a, b], t), &mut line);
                }
                Element::Cubic([a, b, c]) => {
                    let bend = bend(current, a, b).max(bend(a, b, c));
                    flatten_curve(current, (bend * 0.75).sqrt(), |t| cubic_at([current, a, b, c], t), &mut line);
                }
                Element::Close => line(current, start),
            }
            current = element.points().last().copied().unwrap_or(start);
        }
        line(current, start);
    }
}

/// How far three control points are from an even, straight line. `n` lines for a curve deviate from it by at most
/// `bend / 4 / n²` if it is quadratic and `bend * 3/4 / n²` if it is cubic: an eighth of the second derivative.
fn bend(a: Point, b: Point, c: Point) -> f64 {
    (a.x - 2.0 * b.x + c.x).hypot(a.y - 2.0 * b.y + c.y)
}

/// Divides a curve into enough lines that none deviates by more than [`TOLERANCE`]. `deviation_root` is the square root
/// of the deviation of a single line.
fn flatten_curve(start: Point, deviation_root: f64, at: impl Fn(f64) -> Point, line: &mut impl FnMut(Point, Point)) {
    let count = (deviation_root / TOLERANCE.sqrt()).ceil().clamp(1.0, MAX_LINES);
    let mut from = start;
    for index in 1..=count as u32 {
        let to = at(f64::from(index) / count);
        line(from, to);
        from = to;
    }
}

fn mix(a: Point, b: Point, t: f64) -> Point {
    Point { x: a.x * (1.0 - t) + b.x * t, y: a.y * (1.0 - t) + b.y * t }
}

fn quad_at([a, b, c]: [Point; 3], t: f64) -> Point {
    mix(mix(a, b, t), mix(b, c, t), t)
}

fn cubic_at([a, b, c, d]: [Point; 4], t: f64) -> Point {
    mix(quad_at([a, b, c], t), quad_at([b, c, d], t), t)
}
