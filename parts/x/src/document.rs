//! The file's objects, whatever their templates are.

use gaitway_glb::Warnings;

use crate::container::Contents;
use crate::token::{Token, Tokens};
use crate::{damaged, too_large};

const MAX_OBJECTS: usize = 1 << 19;
/// Maximum count of numbers in all objects.
const MAX_NUMBERS: usize = 1 << 25;
/// Maximum nesting of objects.
const MAX_DEPTH: usize = 1000;
/// Maximum length of a name in messages, in bytes.
const MAX_SHOWN: usize = 60;

/// Templates that are read, or that contain nothing glTF needs.
const KNOWN: [&str; 21] = [
    "AnimTicksPerSecond",
    "Animation",
    "AnimationKey",
    "AnimationOptions",
    "AnimationSet",
    "DeclData",
    "FaceAdjacency",
    "Frame",
    "FrameTransformMatrix",
    "Header",
    "Material",
    "Mesh",
    "MeshFaceWraps",
    "MeshMaterialList",
    "MeshNormals",
    "MeshTextureCoords",
    "MeshVertexColors",
    "SkinWeights",
    "TextureFilename",
    "VertexDuplicationIndices",
    "XSkinMeshHeader",
];

/// An object, or a reference to one.
pub struct Object<'a> {
    /// Empty for references and for the file itself.
    template: &'a [u8],
    pub name: &'a [u8],
    pub parent: usize,
    pub numbers: Vec<f64>,
    pub strings: Vec<&'a [u8]>,
    pub children: Vec<usize>,
    /// Where it starts: see [`Contents::name`].
    place: usize,
}

impl<'a> Object<'a> {
    fn new(template: &'a [u8], name: &'a [u8], parent: usize, place: usize) -> Object<'a> {
        Object { template, name, parent, numbers: Vec::new(), strings: Vec::new(), children: Vec::new(), place }
    }

    /// Exporters disagree about capitals (`TextureFileName`).
    pub fn is(&self, template: &str) -> bool {
        self.template.eq_ignore_ascii_case(template.as_bytes())
    }

    pub fn is_reference(&self) -> bool {
        self.template.is_empty()
    }
}

/// All objects; the first stands for the file itself, and each comes after its parent.
pub struct Document<'a> {
    contents: &'a Contents<'a>,
    pub objects: Vec<Object<'a>>,
    /// Numbers that are not finite in 32 bits, replaced by 0.
    not_finite: usize,
}

impl<'a> Document<'a> {
    pub fn read(contents: &'a Contents<'a>) -> Result<Document<'a>, String> {
        let mut reader = Reader {
            tokens: Tokens::new(contents),
            document: Document { contents, objects: vec![Object::new(b"", b"", 0, 0)], not_finite: 0 },
            open: vec![0],
            reached: (0, contents.first()),
            numbers: 0,
        };
        while reader.step()? {}
        Ok(reader.document)
    }

    /// Warns about contents of the objects that are not converted.
    pub fn warn(&self, warnings: &mut Warnings) {
        let is_known = |object: &Object| KNOWN.iter().any(|template| object.is(template));
        for object in self.objects.iter().skip(1).filter(|object| !object.is_reference() && !is_known(object)) {
            // What is inside is left out with it.
            if object.parent == 0 || is_known(&self.objects[object.parent]) {
                warnings.add(format!("Objects of the kind \"{}\" left out.", short(object.template)));
            }
        }
        if self.not_finite > 0 {
            warnings.add(format!("Numbers that are not finite, read as 0: {}.", self.not_finite));
        }
    }

    /// Returns the children of an object that have a template.
    pub fn children(&self, of: usize, template: &'static str) -> impl Iterator<Item = (usize, &Object<'a>)> {
        let children = self.objects[of].children.iter().map(|&child| (child, &self.objects[child]));
        children.filter(move |(_, object)| object.is(template))
    }

    /// Returns all objects that have a template.
    pub fn all(&self, template: &'static str) -> impl Iterator<Item = (usize, &Object<'a>)> {
        self.objects.iter().enumerate().filter(move |(_, object)| object.is(template))
    }

    /// Returns the label of an object in messages.
    pub fn label(&self, object: usize) -> String {
        let Object { template, name, place, .. } = self.objects[object];
        let name = if name.is_empty() { String::new() } else { format!(" \"{}\"", short(name)) };
        format!("{}{name} ({})", short(template), self.contents.name(place))
    }

    /// Reads the numbers of an object.
    pub fn numbers(&self, object: usize) -> Numbers<'_> {
        Numbers { document: self, object, left: &self.objects[object].numbers }
    }
}

/// A name for messages: in a damaged file, one may be as long as the file.
pub fn short(name: &[u8]) -> String {
    text(&name[..name.len().min(MAX_SHOWN)])
}

/// Decodes text of any code page: as UTF-8, or else as x-user-defined, whose characters stand for bytes, so that a caller with
/// encoding tables can decode it.
pub fn text(bytes: &[u8]) -> String {
    let character = |&byte: &u8| {
        let code = if byte.is_ascii() { u32::from(byte) } else { 0xF700 + u32::from(byte) };
        char::from_u32(code).unwrap_or_default()
    };
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(character).collect(), str::to_owned)
}

struct Reader<'a> {
    tokens: Tokens<'a>,
    document: Document<'a>,
    /// The objects that have not ended, outermost first.
    open: Vec<usize>,
    /// A place with its number.
    reached: (usize, usize),
    numbers: usize,
}

impl<'a> Reader<'a> {
    /// Reads what comes next. Returns false at the end.
    fn step(&mut self) -> Result<bool, String> {
        let token = self.tokens.next()?;
        let inside = self.open.len() > 1;
        match token {
            Token::End if inside => {
                let label = self.document.label(self.current());
                let found = "the end of the file (is it cut short?)";
                return Err(self.tokens.unexpected(&format!("\"}}\" at the end of {label}"), found));
            }
            Token::End => return Ok(false),
            Token::Template => self.skip_declaration()?,
            Token::Word(template) => self.begin(template)?,
            Token::Open if inside => self.refer()?,
            Token::Close if inside => drop(self.open.pop()),
            Token::Number(number) if inside => self.push(1, std::iter::once(number))?,
            Token::Integers(bytes) if inside => {
                let numbers = bytes.as_chunks().0;
                self.push(numbers.len(), numbers.iter().map(|word| f64::from(u32::from_le_bytes(*word))))?;
            }
            Token::Floats(bytes) if inside => self.push_floats(bytes)?,
            Token::Quoted(string) if inside => {
                let object = self.current();
                self.document.objects[object].strings.push(string);
            }
            Token::Guid if inside => {}
            other => return Err(self.tokens.unexpected("an object", &other.describe())),
        }
        Ok(true)
    }

    fn current(&self) -> usize {
        self.open.last().copied().unwrap_or_default()
    }

    fn skip_declaration(&mut self) -> Result<(), String> {
        loop {
            match self.tokens.next()? {
                Token::Close => return Ok(()),
                Token::End => {
                    return Err(self.tokens.unexpected("the end of a template, \"}\"", "the end of the file"));
                }
                _ => {}
            }
        }
    }

    /// Begins an object.
    fn begin(&mut self, template: &'a [u8]) -> Result<(), String> {
        let start = self.tokens.start;
        let mut name = &b""[..];
        let mut next = self.tokens.next_name()?;
        if let Token::Word(word) = next {
            name = word;
            next = self.tokens.next()?;
        }
        if !matches!(next, Token::Open) {
            let expected = format!("\"{{\" after \"{}\"", short(template));
            return Err(self.tokens.unexpected(&expected, &next.describe()));
        }
        if self.open.len() > MAX_DEPTH {
            return Err(too_large(MAX_DEPTH, "objects inside each other", self.open.len()));
        }
        let object = self.add(template, name, start)?;
        self.open.push(object);
        Ok(())
    }

    /// Reads a reference, after its brace: a name, a GUID or both.
    fn refer(&mut self) -> Result<(), String> {
        let start = self.tokens.start;
        let mut name = &b""[..];
        loop {
            match self.tokens.next_name()? {
                Token::Close => break,
                Token::Guid => {}
                Token::Word(word) if name.is_empty() => name = word,
                other => return Err(self.tokens.unexpected("a reference, \"{ name }\"", &other.describe())),
            }
        }
        self.add(b"", name, start).map(drop)
    }

    fn add(&mut self, template: &'a [u8], name: &'a [u8], at: usize) -> Result<usize, String> {
        let (index, parent) = (self.document.objects.len(), self.current());
        if index > MAX_OBJECTS {
            return Err(too_large(MAX_OBJECTS, "objects", index));
        }
        let place = self.document.contents.place_after(self.reached, at);
        self.reached = (at, place);
        self.document.objects.push(Object::new(template, name, parent, place));
        self.document.objects[parent].children.push(index);
        Ok(index)
    }

    fn push_floats(&mut self, bytes: &[u8]) -> Result<(), String> {
        if self.tokens.float_bytes() == 8 {
            let numbers = bytes.as_chunks().0;
            return self.push(numbers.len(), numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)));
        }
        let numbers = bytes.as_chunks().0;
        self.push(numbers.len(), numbers.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))))
    }

    fn push(&mut self, count: usize, numbers: impl Iterator<Item = f64>) -> Result<(), String> {
        self.numbers += count;
        if self.numbers > MAX_NUMBERS {
            return Err(too_large(MAX_NUMBERS, "numbers", self.numbers));
        }
        let object = self.current();
        let Document { objects, not_finite, .. } = &mut self.document;
        objects[object].numbers.extend(numbers.map(|number| {
            let finite = (number as f32).is_finite();
            *not_finite += usize::from(!finite);
            if finite { number } else { 0.0 }
        }));
        Ok(())
    }
}

/// The numbers of an object that have not been read yet.
pub struct Numbers<'a> {
    document: &'a Document<'a>,
    object: usize,
    left: &'a [f64],
}

impl<'a> Numbers<'a> {
    /// Takes numbers.
    pub fn take(&mut self, count: usize, what: &str) -> Result<&'a [f64], String> {
        let left = self.left.len();
        self.left
            .split_off(..count)
            .ok_or_else(|| self.damaged(&format!("{count} numbers for {what}"), &format!("{left} at its end")))
    }

    /// Takes an array.
    pub fn array<const COUNT: usize>(&mut self, what: &str) -> Result<[f64; COUNT], String> {
        let taken = self.take(COUNT, what)?;
        Ok(std::array::from_fn(|at| taken[at]))
    }

    /// Takes a whole number of at most `max`.
    pub fn index(&mut self, max: usize, what: &str) -> Result<usize, String> {
        let [number] = self.array(what)?;
        if number >= 0.0 && number <= max as f64 && number.fract() == 0.0 {
            return Ok(number as usize);
        }
        // Floats are not printed: their formatting would be a fifth of the wasm module.
        let found = match number {
            number if number < 0.0 => "a negative number".to_owned(),
            number if number.fract() != 0.0 => "a fraction".to_owned(),
            number => (number as u64).to_string(),
        };
        Err(self.damaged(&format!("{what}, a whole number of at most {max}"), &found))
    }

    /// Takes a count of items, of which each has at least `width` numbers.
    pub fn count(&mut self, width: usize, what: &str) -> Result<usize, String> {
        let count = self.index(u32::MAX as usize, &format!("the number of {what}"))?;
        if count.saturating_mul(width) > self.left.len() {
            let found = format!("{} numbers at its end", self.left.len());
            return Err(self.damaged(&format!("{count} {what}"), &found));
        }
        Ok(count)
    }

    /// Returns an error about the object.
    pub fn damaged(&self, expected: &str, found: &str) -> String {
        damaged(&self.document.label(self.object), expected, found)
    }
}

/// Finds objects by name.
pub struct Names<'a>(Vec<(&'a [u8], usize)>);

impl<'a> Names<'a> {
    /// Indexes the objects of a template. Of several with the same name, the first is found.
    pub fn of(document: &Document<'a>, template: &'static str) -> Names<'a> {
        let named = document.all(template).filter(|(_, object)| !object.name.is_empty());
        let mut names: Vec<_> = named.map(|(index, object)| (object.name, index)).collect();
        names.sort_unstable();
        Names(names)
    }

    /// Indexes the references of animations to the frames that they move.
    pub fn of_targets(document: &Document<'a>) -> Names<'a> {
        let animations = document.all("Animation").flat_map(|(_, animation)| &animation.children);
        let targets =
            animations.map(|&child| (&document.objects[child], child)).filter(|(child, _)| child.is_reference());
        let mut names: Vec<_> = targets.map(|(child, index)| (child.name, index)).collect();
        names.sort_unstable();
        names.dedup_by_key(|(name, _)| *name);
        Names(names)
    }

    /// Iterates over the objects.
    pub fn objects(&self) -> impl Iterator<Item = usize> {
        self.0.iter().map(|&(_, index)| index)
    }

    pub fn find(&self, name: &[u8]) -> Option<usize> {
        let at = self.0.partition_point(|(other, _)| *other < name);
        self.0.get(at).filter(|(other, _)| *other == name).map(|&(_, index)| index)
    }
}
