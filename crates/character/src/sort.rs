//! Sorting that is compiled only once. The standard library's sort is compiled for every type and every order, and for every map
//! that is collected, and takes four kilobytes of the page's program each time. Lists that are sorted every frame still use it.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Sorts like [`slice::sort_by`]: equal items keep their order.
pub fn sort_by<T>(items: &mut [T], mut order: impl FnMut(&T, &T) -> Ordering) {
    let mut from = sorted_indices(items.len(), &mut |a, b| order(&items[a], &items[b]));
    for to in 0..items.len() {
        // The item that belongs here may have been swapped for one that belonged to its place.
        while from[to] < to {
            from[to] = from[from[to]];
        }
        items.swap(to, from[to]);
    }
}

/// Sorts like [`slice::sort_by_key`].
pub fn sort_by_key<T, K: Ord>(items: &mut [T], key: impl Fn(&T) -> K) {
    sort_by(items, |a, b| key(a).cmp(&key(b)));
}

/// Sorts numbers with the standard library's sort, since there may be many.
pub fn sort_floats(numbers: &mut [f32]) {
    numbers.sort_by(f32::total_cmp);
}

/// Collects a map: of several values for a key, the last.
pub fn collect_map<K: Ord, V>(entries: impl IntoIterator<Item = (K, V)>) -> BTreeMap<K, V> {
    let mut map = BTreeMap::new();
    map.extend(entries);
    map
}

/// Collects a set.
pub fn collect_set<T: Ord>(items: impl IntoIterator<Item = T>) -> BTreeSet<T> {
    let mut set = BTreeSet::new();
    set.extend(items);
    set
}

/// Returns the places of the items in their order.
fn sorted_indices(count: usize, order: &mut dyn FnMut(usize, usize) -> Ordering) -> Vec<usize> {
    let mut places: Vec<usize> = (0..count).collect();
    places.sort_by(|&a, &b| order(a, b));
    places
}

#[cfg(test)]
mod tests {
    use crate::sort::{sort_by, sort_by_key};

    #[test]
    fn sorts_like_the_standard_library() {
        let mut state = 1_u32;
        for count in 0..200 {
            let mut items: Vec<(u32, usize)> = (0..count)
                .map(|place| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 28, place)
                })
                .collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| item.0);
            sort_by_key(&mut items, |item| item.0);
            assert_eq!(items, expected);
            expected.sort_by(|a, b| b.cmp(a));
            sort_by(&mut items, |a, b| b.cmp(a));
            assert_eq!(items, expected);
        }
    }
}
