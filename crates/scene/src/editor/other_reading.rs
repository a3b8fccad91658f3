//! Files that could have been meant in two ways are opened in the likelier one. The other one is kept until something else is opened.

use super::{Editor, Event, OpenedModel, Reading};
use crate::library::ModelId;

/// Another [`Reading`], with what it takes.
#[derive(Debug)]
pub(super) enum OtherReading {
    Models(Vec<OpenedModel>),
    Both(ModelId),
}

impl Editor {
    pub(super) fn offer(&mut self, other: OtherReading) {
        self.events.push(Event::OtherReading(match other {
            OtherReading::Models(_) => Reading::Models,
            OtherReading::Both(_) => Reading::Both,
        }));
        self.other_reading = Some(other);
    }

    /// Takes the last opened files as [`Event::OtherReading`] offered. Does nothing if it was not, or something else was opened since.
    pub fn read_otherwise(&mut self) {
        match self.other_reading.take() {
            Some(OtherReading::Models(models)) => self.open_as_models(models),
            Some(OtherReading::Both(older)) => self.list_older_version(older),
            None => {}
        }
    }
}
