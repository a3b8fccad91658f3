//! Pair kerning: the lookups of the `GPOS` table that the feature `kern` names, pair adjustment formats 1 and 2.

use std::cmp::Ordering;

use skrifa::raw::tables::gpos::{PairPos, PairSet, PositionSubtables, Value, ValueContext, ValueRecord};
use skrifa::raw::{FontRef, ReadError, TableProvider};
use skrifa::{GlyphId, Tag};

use crate::{GlyphInfo, GlyphPosition};

/// Returns the numbers of the font's kerning lookups in the order in which they apply.
pub fn lookups(font: &FontRef<'_>) -> Vec<u16> {
    let Ok(list) = font.gpos().and_then(|gpos| gpos.feature_list()) else { return Vec::new() };
    let kerning = list.feature_records().iter().filter(|record| record.feature_tag() == Tag::new(b"kern"));
    let features = kerning.filter_map(|record| record.feature(list.offset_data()).ok());
    let mut lookups: Vec<u16> =
        features.flat_map(|feature| feature.lookup_list_indices()).map(|index| index.get()).collect();
    lookups.sort_unstable();
    lookups.dedup();
    lookups
}

/// Applies each lookup to all adjacent glyphs. Lookups and pairs that can't be read are skipped.
pub fn apply(font: &FontRef<'_>, lookups: &[u16], infos: &[GlyphInfo], positions: &mut [GlyphPosition]) {
    let Ok(list) = font.gpos().and_then(|gpos| gpos.lookup_list()) else { return };
    for &index in lookups {
        let subtables = list.lookups().get(index.into()).and_then(|lookup| lookup.subtables());
        let Ok(PositionSubtables::Pair(subtables)) = subtables else { continue };
        let mut first = 0;
        while first + 1 < infos.len() {
            let [left, right] = [first, first + 1].map(|index| GlyphId::new(infos[index].glyph_id));
            let values = subtables.iter().find_map(|subtable| pair_values(&subtable.ok()?, left, right).ok().flatten());
            let [value, second_value] = values.unwrap_or_default();
            add(&mut positions[first], value);
            add(&mut positions[first + 1], second_value);
            // A pair that adjusts its second glyph is consumed as a whole.
            first += if second_value.format.is_empty() { 1 } else { 2 };
        }
    }
}

fn add(position: &mut GlyphPosition, value: Value) {
    position.x_advance += i32::from(value.x_advance);
    position.x_offset += i32::from(value.x_placement);
}

/// Returns what a subtable says about a pair, or `None` if the next subtable should be tried.
fn pair_values(subtable: &PairPos<'_>, left: GlyphId, right: GlyphId) -> Result<Option<[Value; 2]>, ReadError> {
    match subtable {
        PairPos::Format1(pairs) => match pairs.coverage()?.get(left) {
            Some(covered) => listed_values(&pairs.pair_sets().get(covered.into())?, right),
            None => Ok(None),
        },
        PairPos::Format2(classes) => {
            let (class1, class2) = (classes.class_def1()?.get(left), classes.class_def2()?.get(right));
            let applies = classes.coverage()?.get(left).is_some()
                && class1 < classes.class1_count()
                && class2 < classes.class2_count();
            applies.then(|| classes.values(class1, class2, &ValueContext::new())).transpose()
        }
    }
}

/// Finds a pair in the list of its first glyph, which is sorted by the second.
fn listed_values(set: &PairSet<'_>, right: GlyphId) -> Result<Option<[Value; 2]>, ReadError> {
    let records = set.pair_value_records();
    let (mut low, mut high) = (0, records.len());
    while low < high {
        let middle = low.midpoint(high);
        let record = records.get(middle)?;
        match GlyphId::from(record.second_glyph()).cmp(&right) {
            Ordering::Less => low = middle + 1,
            Ordering::Greater => high = middle,
            Ordering::Equal => {
                let value = |record: &ValueRecord| record.value(set.offset_data(), &ValueContext::new());
                return Ok(Some([value(record.value_record1())?, value(record.value_record2())?]));
            }
        }
    }
    Ok(None)
}
