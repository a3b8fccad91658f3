//! The objects of a file and how they are connected.

use std::collections::BTreeMap;

use crate::record::Record;

/// The number of an object in its file. The root of the scene is 0.
pub type Id = i64;

/// The scene's root.
pub const ROOT: Id = 0;
/// Autodesk's SDK takes small numbers for those of its own.
const FIRST_ID: Id = 1_000_000;

/// Objects and connections under construction.
#[derive(Debug, Default)]
pub struct Objects {
    pub objects: Vec<Record>,
    pub connections: Vec<Record>,
    /// Number of objects of each type.
    pub counts: BTreeMap<&'static str, i32>,
    ids: Id,
}

impl Objects {
    /// Returns a number that no other object has.
    pub fn id(&mut self) -> Id {
        self.ids += 1;
        FIRST_ID + self.ids
    }

    /// Adds an object with what `fill` adds to it and returns its number.
    pub fn add(
        &mut self,
        record: &'static str,
        (name, class, kind): (&str, &str, &str),
        fill: impl FnOnce(Record) -> Record,
    ) -> Id {
        let id = self.id();
        self.add_as(id, record, (name, class, kind), fill);
        id
    }

    /// The same for a number that was given out before.
    pub fn add_as(
        &mut self,
        id: Id,
        record: &'static str,
        (name, class, kind): (&str, &str, &str),
        fill: impl FnOnce(Record) -> Record,
    ) {
        *self.counts.entry(record).or_default() += 1;
        self.objects.push(fill(Record::new(record).i64(id).object_name(name, class).text(kind)));
    }

    /// Puts an object below another one.
    pub fn connect(&mut self, child: Id, parent: Id) {
        self.connections.push(Record::new("C").text("OO").i64(child).i64(parent));
    }

    /// Makes an object the source of a property of another one.
    pub fn connect_property(&mut self, child: Id, parent: Id, property: &str) {
        self.connections.push(Record::new("C").text("OP").i64(child).i64(parent).text(property));
    }
}
