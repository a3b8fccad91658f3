//! Which of our own functions allocate. egui allocates in every frame: it copies each text that it is given, constant
//! or not, boxes closures and grows lists. An allocation is ours if, seen from the allocator, the first function
//! outside the standard library is one of ours: `format!`, `to_owned`, `collect`, `vec!`, `clone`.

use std::backtrace::Backtrace;
use std::cell::RefCell;
use std::collections::BTreeSet;

use crate::allocations::ON_ALLOCATION;

thread_local! {
    static TRACES: RefCell<Vec<Backtrace>> = const { RefCell::new(Vec::new()) };
}

/// Runs `work` and returns where code that is called by a function whose name contains `below` allocates, each place
/// once. Names for screen readers don't count: they are built in closures that egui calls only while there is one. Nor
/// do the points of a painted path, which egui takes as a vector.
pub fn own_allocations(below: &str, work: impl FnOnce()) -> BTreeSet<String> {
    ON_ALLOCATION.set(Some(|| TRACES.with_borrow_mut(|traces| traces.push(Backtrace::force_capture()))));
    work();
    ON_ALLOCATION.set(None);
    let traces = TRACES.take();
    assert!(traces.len() > 100, "egui allocates, so the hook must have been called: {}", traces.len());
    let texts: Vec<String> = traces.iter().map(ToString::to_string).collect();
    assert!(texts.iter().any(|text| text.contains(below)), "nothing below {below} allocates: is it called at all?");
    texts.iter().filter_map(|text| own_site(text, below)).collect()
}

/// The function and line of a trace if it is ours.
fn own_site(trace: &str, below: &str) -> Option<String> {
    const NOT_COUNTED: [&str; 3] = ["accesskit_node_builder", "widget_info", "icons::paint"];
    // "  12: gaitway::ui::motion::show", and on the next line "at ./src/ui/motion/mod.rs:250:5".
    let mut functions = Vec::new();
    for line in trace.lines().map(str::trim) {
        match line.split_once(": ") {
            Some((number, name)) if number.bytes().all(|byte| byte.is_ascii_digit()) => functions.push((name, "")),
            _ => functions.last_mut().into_iter().for_each(|(_, place)| *place = line),
        }
    }
    let end = functions.iter().position(|(name, _)| name.contains(below))?;
    // The hook and the allocator are the test's own.
    let is_of_test = |(name, _): &(&str, &str)| name.contains("allocations::") || name.contains("__rust");
    let start = functions[..end].iter().rposition(is_of_test)? + 1;
    let path = &functions[start..=end];
    let (name, place) = path.iter().find(|(name, _)| crate_of(name).is_some())?;
    let is_ours = crate_of(name).is_some_and(|name| name.starts_with("gaitway"));
    let is_counted = !path.iter().any(|(name, _)| NOT_COUNTED.iter().any(|part| name.contains(part)));
    (is_ours && is_counted).then(|| format!("{name} {place}"))
}

/// The crate of a function outside the standard library; `None` inside it, as for its traits on built-in types.
fn crate_of(name: &str) -> Option<&str> {
    let (name, _) = name.trim_start_matches(['<', '&', '[']).split_once("::")?;
    let is_name = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    (is_name && !["alloc", "core", "std", "hashbrown"].contains(&name)).then_some(name)
}
