//! The statements of a Wavefront .obj: vertices, faces, and the names of groups and materials.
//!
//! ```text
//! v x y z [w | r g b]     vertex, with a weight for curves (ignored) or a colour
//! vt u [v [w]]            texture coordinate, v upwards
//! vn x y z                normal
//! f 1 2 3                 face with corners v, v/vt, v//vn or v/vt/vn; from 1, or backwards from −1, the last so far
//! o, g, usemtl, mtllib    object, groups, material, material libraries
//! ```
//!
//! A `\` at the end of a line continues it; `#` begins a comment. Vertex numbers may point forward. Lines, points, curves and
//! surfaces are skipped with a warning.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gaitway_character::asset::{Warning, Warnings};
use glam::{DVec3, Vec2, Vec3};

use crate::encoding;
use crate::error::Problem;
use crate::limits::Budget;
use crate::lines::{Lines, number, quoted, text};

/// Each group is a draw of its own.
const MAX_GROUPS: usize = 4096;

/// Longer names are truncated: each group has its own copy.
const MAX_NAME_BYTES: usize = 256;

/// Limit on libraries, each of which is looked up among the files or fetched.
const MAX_LIBRARIES: usize = 64;

/// Stands for a missing texture coordinate or normal.
pub const NONE: u32 = u32::MAX;

/// Stands for a texture coordinate or normal that can't exist, as none has the index 0.
const ABSENT: u32 = NONE - 1;

/// Indices of vertex, texture coordinate and normal, from 0. The latter two may be [`NONE`].
pub type Corner = [u32; 3];

#[derive(Debug, Default)]
pub struct ObjText {
    pub positions: Vec<Vec3>,
    /// One per vertex, in sRGB; empty if any vertex has none.
    pub colors: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    /// The corners of all faces, in order.
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    pub groups: Vec<Group>,
    /// Names of material libraries.
    pub libraries: Vec<String>,
}

#[derive(Debug, Clone, Copy)]
pub struct Face {
    /// End of its corners, which begin where those of the previous face end.
    pub end: u32,
    pub group: u32,
    line: u32,
}

/// Faces with the same object, group and material.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Group {
    pub object: String,
    pub group: String,
    pub material: String,
}

struct Reader<'a> {
    obj: ObjText,
    group: Group,
    group_index: Option<u32>,
    known_groups: BTreeMap<Group, u32>,
    budget: &'a Budget,
    warnings: &'a mut Warnings,
}

pub fn read(bytes: &[u8], budget: &Budget, warnings: &mut Warnings) -> Result<ObjText, Problem> {
    let bytes = &*encoding::utf8(bytes);
    let mut reader = Reader {
        obj: ObjText::default(),
        group: Group::default(),
        group_index: None,
        known_groups: BTreeMap::new(),
        budget,
        warnings,
    };
    let mut lines = Lines::new(bytes);
    while let Some((line, words)) = lines.next_full_line() {
        let words = continued(words, &mut lines);
        reader.statement(line, &words)?;
    }
    let mut obj = reader.obj;
    if obj.colors.len() != obj.positions.len() {
        obj.colors = Vec::new();
    }
    let absent = check_corners(&mut obj)?;
    if let Some((line, count)) = absent {
        let problem = format!(
            "{count} corners of faces, the first on this line, refer to texture coordinates or normals that don't exist; they are \
             read without"
        );
        warnings.push(Warning::Other { code: "obj-corners", place: place(line), problem });
    }
    Ok(obj)
}

/// Returns the material libraries that a file names, without reading the rest.
pub fn libraries(bytes: &[u8]) -> Vec<String> {
    let mut found = Vec::new();
    let bytes = encoding::utf8(bytes);
    let mut lines = Lines::new(&bytes);
    while let Some((_, line)) = lines.next_full_line() {
        if let Some(names) = line.strip_prefix(b"mtllib")
            && !add_libraries(&continued(names, &mut lines), &mut found)
        {
            break;
        }
    }
    found
}

/// Adds the libraries of a statement. Returns false if that would exceed [`MAX_LIBRARIES`].
fn add_libraries(names: &[u8], found: &mut Vec<String>) -> bool {
    for library in library_names(&text(names)) {
        if !found.contains(&library) {
            if found.len() == MAX_LIBRARIES {
                return false;
            }
            found.push(library);
        }
    }
    true
}

/// Truncates a name to [`MAX_NAME_BYTES`].
pub fn cut_name(name: &[u8]) -> String {
    let mut cut = text(&name[..name.len().min(MAX_NAME_BYTES)]).into_owned();
    cut.truncate(cut.floor_char_boundary(MAX_NAME_BYTES));
    cut
}

/// Joins a line with those that continue it.
fn continued<'a>(line: &'a [u8], lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let mut joined = Cow::Borrowed(line);
    while let Some(kept) = joined.strip_suffix(b"\\") {
        let kept = kept.len();
        let joined = joined.to_mut();
        joined.truncate(kept);
        joined.push(b' ');
        match lines.next_full_line() {
            Some((_, more)) => joined.extend_from_slice(more),
            None => break,
        }
    }
    joined
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = line.split(|byte| byte.is_ascii_whitespace() || *byte == 0x0B).filter(|word| !word.is_empty());
    words.take_while(|word| !word.starts_with(b"#"))
}

impl Reader<'_> {
    /// Counts one more element towards the budget.
    fn allocate<T>(&self, line: usize) -> Result<(), Problem> {
        self.budget.allocate(1, size_of::<T>(), &format_args!("line {line}"))
    }

    fn statement(&mut self, line: usize, statement: &[u8]) -> Result<(), Problem> {
        let mut rest = words(statement);
        let Some(keyword) = rest.next() else { return Ok(()) };
        match keyword {
            b"v" => self.vertex(line, rest),
            b"vt" => {
                let (found, uv) = numbers::<3>(line, rest)?;
                if found == 0 {
                    return Err(Problem::new(place(line), "1 to 3 numbers after “vt”", "none"));
                }
                self.allocate::<Vec2>(line)?;
                // Texture rows count from the top, as in glTF.
                self.obj.uvs.push(Vec2::new(uv[0], 1.0 - uv[1]));
                Ok(())
            }
            b"vn" => {
                let (found, normal) = numbers::<3>(line, rest)?;
                if found != 3 {
                    return Err(Problem::new(place(line), "3 numbers after “vn”", found));
                }
                self.allocate::<Vec3>(line)?;
                self.obj.normals.push(Vec3::from(normal).normalize_or(Vec3::Y));
                Ok(())
            }
            b"f" | b"fo" => self.face(line, rest),
            b"o" | b"g" | b"usemtl" => {
                let name = statement[keyword.len()..].trim_ascii();
                if name.len() > MAX_NAME_BYTES {
                    let problem = format!("the name is cut after {MAX_NAME_BYTES} bytes");
                    self.warnings.push(Warning::Other { code: "obj-name", place: place(line), problem });
                }
                let name = cut_name(name);
                self.group_index = None;
                match keyword {
                    b"o" => {
                        self.group = Group { object: name, group: String::new(), ..std::mem::take(&mut self.group) };
                    }
                    b"g" => self.group.group = name,
                    _ => self.group.material = name,
                }
                Ok(())
            }
            b"mtllib" => {
                if !add_libraries(&statement[keyword.len()..], &mut self.obj.libraries) {
                    let problem = format!("more than {MAX_LIBRARIES} material libraries; the first ones are read");
                    self.warnings.push(Warning::Other { code: "obj-libraries", place: place(line), problem });
                }
                Ok(())
            }
            // Smoothing groups: a model without normals is flat-shaded, or smooth if the user chooses so.
            b"s" => Ok(()),
            other => {
                let problem = format!("{} is not read; vertices and faces are", quoted(Some(other)));
                self.warnings.push(Warning::Other { code: "obj-statement", place: place(line), problem });
                Ok(())
            }
        }
    }

    fn vertex<'a>(&mut self, line: usize, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Problem> {
        let (found, read) = numbers::<7>(line, words)?;
        let color = match found {
            3 | 4 => None,
            6 | 7 => Some(Vec3::new(read[found - 3], read[found - 2], read[found - 1])),
            _ => {
                let expected = "3 numbers after “v”, or 4 with a weight, or 3 more with a colour";
                return Err(Problem::new(place(line), expected, found));
            }
        };
        self.allocate::<[Vec3; 2]>(line)?;
        let obj = &mut self.obj;
        if let Some(color) = color.filter(|_| obj.colors.len() == obj.positions.len()) {
            obj.colors.push(color);
        }
        obj.positions.push(Vec3::new(read[0], read[1], read[2]));
        if obj.positions.len() >= ABSENT as usize {
            return Err(Problem::new(place(line), "fewer vertices than 32 bits can count", "more"));
        }
        Ok(())
    }

    /// Reads the indices of one corner of a face. The error continues the description of what was expected.
    fn corner(&self, word: &[u8]) -> Result<Corner, &'static str> {
        let mut indices = word.split(|&byte| byte == b'/');
        let mut corner = [NONE; 3];
        let so_far = [self.obj.positions.len(), self.obj.uvs.len(), self.obj.normals.len()];
        for (at, (slot, so_far)) in corner.iter_mut().zip(so_far).enumerate() {
            if let Some(digits) = indices.next().filter(|digits| !digits.is_empty()) {
                let found = index(digits, so_far).ok_or("")?;
                *slot = found.or((at > 0).then_some(ABSENT)).ok_or(", counted from 1 or backwards from -1")?;
            }
        }
        if corner[0] == NONE || indices.next().is_some() { Err("") } else { Ok(corner) }
    }

    fn face<'a>(&mut self, line: usize, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Problem> {
        let first = self.obj.corners.len();
        for word in words {
            let corner = self.corner(word).map_err(|details| {
                let expected = format!("corners such as 1, 1/1, 1//1 or 1/1/1{details}");
                Problem::new(place(line), expected, quoted(Some(word)))
            })?;
            self.allocate::<Corner>(line)?;
            self.obj.corners.push(corner);
        }
        self.allocate::<Face>(line)?;
        let (count, end) = (self.obj.corners.len() - first, self.obj.corners.len());
        if count < 3 {
            return Err(Problem::new(place(line), "a face of at least 3 corners", count));
        }
        let end = u32::try_from(end)
            .map_err(|_| Problem::new(place(line), "fewer corners than 32 bits can count", "more"))?;
        let group = self.group_of_next_face(line);
        self.obj.faces.push(Face { end, group, line: u32::try_from(line).unwrap_or(u32::MAX) });
        Ok(())
    }

    fn group_of_next_face(&mut self, line: usize) -> u32 {
        if let Some(group) = self.group_index {
            return group;
        }
        let next = self.obj.groups.len() as u32;
        let index = match self.known_groups.get(&self.group) {
            Some(&index) => index,
            None if self.obj.groups.len() == MAX_GROUPS => {
                let problem = format!("more than {MAX_GROUPS} parts; what follows is put into the last of them");
                self.warnings.push(Warning::Other { code: "obj-parts", place: place(line), problem });
                next - 1
            }
            None => {
                self.known_groups.insert(self.group.clone(), next);
                self.obj.groups.push(self.group.clone());
                next
            }
        };
        self.group_index = Some(index);
        index
    }
}

fn place(line: usize) -> String {
    format!("line {line}")
}

/// Parses up to `N` numbers that fit into 32 bits. Returns how many there are, and the numbers.
fn numbers<'a, const N: usize>(
    line: usize,
    words: impl Iterator<Item = &'a [u8]>,
) -> Result<(usize, [f32; N]), Problem> {
    let mut read = [0.0; N];
    let mut found = 0;
    for word in words {
        let Some(slot) = read.get_mut(found) else {
            return Err(Problem::new(place(line), format!("at most {N} numbers"), "more"));
        };
        let value = number(word).map(|value| value as f32).filter(|value| value.is_finite());
        *slot = value.ok_or_else(|| Problem::new(place(line), "a finite number", quoted(Some(word))))?;
        found += 1;
    }
    Ok((found, read))
}

/// Parses a number that counts from 1, or backwards from the count so far if it is negative. Returns it from 0; `Some(None)` if
/// nothing can have that index.
fn index(word: &[u8], so_far: usize) -> Option<Option<u32>> {
    let number: i64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    let index = if number < 0 { (so_far as i64).checked_add(number) } else { number.checked_sub(1) };
    Some(index.and_then(|index| u32::try_from(index).ok()).filter(|&index| index < ABSENT))
}

/// Splits a list of names, which may contain spaces.
fn library_names(names: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut name = String::new();
    for word in names.split_whitespace() {
        if !name.is_empty() {
            name.push(' ');
        }
        // Paths may come from Windows.
        name.push_str(&word.replace('\\', "/"));
        if word.to_lowercase().ends_with(".mtl") {
            found.push(std::mem::take(&mut name));
        }
    }
    if !name.is_empty() {
        found.push(name);
    }
    found
}

/// Removes texture coordinates and normals that don't exist from corners. Returns the line of the first such corner, and their
/// number.
fn check_corners(obj: &mut ObjText) -> Result<Option<(usize, usize)>, Problem> {
    let (vertices, others) = (obj.positions.len(), [obj.uvs.len(), obj.normals.len()]);
    let mut start = 0;
    let mut absent: Option<(usize, usize)> = None;
    for face in &obj.faces {
        for [vertex, own @ ..] in &mut obj.corners[start..face.end as usize] {
            if *vertex as usize >= vertices {
                let found = u64::from(*vertex) + 1;
                return Err(Problem::new(place(face.line as usize), format!("one of the {vertices} vertices"), found));
            }
            let mut is_whole = true;
            for (index, count) in own.iter_mut().zip(others) {
                if *index as usize >= count && *index != NONE {
                    *index = NONE;
                    is_whole = false;
                }
            }
            if !is_whole {
                absent = Some(absent.map_or((face.line as usize, 1), |(line, count)| (line, count + 1)));
            }
        }
        start = face.end as usize;
    }
    Ok(absent)
}

impl ObjText {
    /// Iterates over the faces with their corners.
    pub fn faces(&self) -> impl Iterator<Item = (&Face, &[Corner])> {
        let mut start = 0;
        self.faces.iter().map(move |face| {
            let corners = &self.corners[start..face.end as usize];
            start = face.end as usize;
            (face, corners)
        })
    }

    /// The position of a corner.
    pub fn point(&self, corner: &Corner) -> DVec3 {
        self.positions[corner[0] as usize].as_dvec3()
    }
}

impl Group {
    /// Joins the names that the file gives, most general first.
    pub fn name(&self) -> String {
        let names = [&self.object, &self.group, &self.material];
        names.into_iter().filter(|name| !name.is_empty()).map(String::as_str).collect::<Vec<_>>().join(" / ")
    }
}
