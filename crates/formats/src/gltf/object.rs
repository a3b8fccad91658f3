//! JSON of which only some members are parsed: the rest keeps its text.

use std::fmt;

use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use serde_json::value::{RawValue, to_raw_value};

/// An object's members in order, values as text. If several members have the same name, the last one counts, as in the
/// reader.
#[derive(Debug, Default, Clone)]
pub struct Object(Vec<(String, Box<RawValue>)>);

/// An array's elements as text.
pub type Array = Vec<Box<RawValue>>;

impl Object {
    /// Parses a member. `None` if it is missing or of another type.
    pub fn read<'a, T: Deserialize<'a>>(&'a self, key: &str) -> Option<T> {
        serde_json::from_str(self.text(key)?).ok()
    }

    // What doesn't depend on a type is a function of its own: the others are compiled for many.
    fn text(&self, key: &str) -> Option<&str> {
        self.0.iter().rfind(|(other, _)| other == key).map(|(_, value)| value.get())
    }

    /// Parses all members of one type, skipping the others.
    pub fn values<'a, T: Deserialize<'a>>(&'a self) -> impl Iterator<Item = T> {
        self.0.iter().filter_map(|(_, value)| serde_json::from_str(value.get()).ok())
    }

    /// Parses all members.
    pub fn members(&self) -> impl Iterator<Item = (&str, Value)> {
        self.0.iter().filter_map(|(key, value)| Some((&**key, serde_json::from_str(value.get()).ok()?)))
    }

    /// Changes all members that are objects.
    pub fn change_objects(&mut self, change: fn(&mut Self)) {
        for (_, value) in &mut self.0 {
            if let Ok(mut object) = serde_json::from_str::<Self>(value.get()) {
                change(&mut object);
                *value = raw(&object);
            }
        }
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Replaces a member in place, or appends it.
    pub fn set(&mut self, key: &str, value: &impl Serialize) {
        self.set_raw(key, raw(value));
    }

    fn set_raw(&mut self, key: &str, value: Box<RawValue>) {
        match self.0.iter_mut().rfind(|(other, _)| other == key) {
            Some((_, old)) => *old = value,
            None => self.0.push((key.to_owned(), value)),
        }
    }

    pub fn remove(&mut self, key: &str) {
        self.0.retain(|(other, _)| other != key);
    }

    /// Replaces the member `key` by others.
    pub fn replace(&mut self, key: &str, members: Vec<(&str, Box<RawValue>)>) {
        if let Some(at) = self.0.iter().rposition(|(other, _)| other == key) {
            self.0.splice(at..=at, members.into_iter().map(|(key, value)| (key.to_owned(), value)));
        }
    }

    /// Appends to the array `key`, creating it if needed.
    pub fn extend(&mut self, key: &str, elements: Array) {
        if !elements.is_empty() {
            let mut array: Array = self.read(key).unwrap_or_default();
            array.extend(elements);
            self.set(key, &array);
        }
    }

    /// Removes strings from the array `key`, and the array itself if that leaves it empty. Returns the strings removed.
    pub fn remove_strings(&mut self, key: &str, strings: &[&str]) -> Vec<String> {
        let Some(array) = self.read::<Vec<String>>(key) else { return Vec::new() };
        let (removed, kept): (Vec<_>, Vec<_>) = array.into_iter().partition(|text| strings.contains(&text.as_str()));
        match kept.is_empty() {
            true => self.remove(key),
            false => self.set(key, &kept),
        }
        removed
    }

    /// Removes extensions from the member `extensions`, and that member if none are left.
    pub fn remove_extensions(&mut self, names: &[&str]) {
        let Some(mut extensions) = self.read::<Self>("extensions") else { return };
        names.iter().for_each(|name| extensions.remove(name));
        match extensions.is_empty() {
            true => self.remove("extensions"),
            false => self.set("extensions", &extensions),
        }
    }

    /// The number of elements of the array `key`.
    pub fn count(&self, key: &str) -> usize {
        self.read::<Array>(key).map_or(0, |array| array.len())
    }
}

/// Serializes a value. Cannot fail for the values that are written here: no maps with keys other than strings, no streams.
pub fn raw(value: &impl Serialize) -> Box<RawValue> {
    to_raw_value(value).unwrap_or_else(|_| RawValue::NULL.to_owned())
}

impl Serialize for Object {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (key, value) in &self.0 {
            map.serialize_entry(key, value)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Object {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Members;
        impl<'de> Visitor<'de> for Members {
            type Value = Object;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Object, A::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry()? {
                    members.push(member);
                }
                Ok(Object(members))
            }
        }
        deserializer.deserialize_map(Members)
    }
}
