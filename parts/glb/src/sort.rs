//! Sorting in a few hundred bytes of code, where the standard library takes several thousand per type.

/// Sorts with heapsort: in place, with n log n comparisons at worst; not stable, but deterministic.
pub fn sort<T>(items: &mut [T], less: impl Fn(&T, &T) -> bool) {
    let count = items.len();
    for root in (0..count / 2).rev() {
        sink(items, root, &less);
    }
    for end in (1..count).rev() {
        items.swap(0, end);
        sink(&mut items[..end], 0, &less);
    }
}

/// Moves an item down until no child is greater.
fn sink<T>(heap: &mut [T], mut root: usize, less: &impl Fn(&T, &T) -> bool) {
    loop {
        let mut child = 2 * root + 1;
        if child >= heap.len() {
            return;
        }
        if child + 1 < heap.len() && less(&heap[child], &heap[child + 1]) {
            child += 1;
        }
        if !less(&heap[root], &heap[child]) {
            return;
        }
        heap.swap(root, child);
        root = child;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_as_the_standard_library_does() {
        for count in 0..60_u32 {
            let mut items: Vec<u32> = (0..count).map(|i| i.wrapping_mul(2_654_435_761) % 17).collect();
            let mut expected = items.clone();
            expected.sort_unstable();
            sort(&mut items, |a, b| a < b);
            assert_eq!(items, expected);
        }
    }
}
