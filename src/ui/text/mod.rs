//! Texts of controls that tests look for, so that each can change in one place. By subject; shared ones are here.

mod change;
mod clips;
mod header;
mod motion;
mod pin;
mod properties;
mod tabs;
mod viewport;

pub use change::*;
pub use clips::*;
pub use header::*;
pub use motion::*;
pub use pin::*;
pub use properties::*;
pub use tabs::*;
pub use viewport::*;

/// Returns a name and its value, or a choice and one of its options, as a screen reader reads them.
pub fn labelled(name: &str, value: &str) -> String {
    format!("{name}: {value}")
}

/// Returns an option or a heading with the number of things it stands for.
pub fn counted(what: &str, count: usize) -> String {
    format!("{what} ({})", grouped(count))
}

/// Returns the notice about a saved file.
pub fn saved(name: &str, remark: Option<&str>) -> String {
    let remark = remark.map_or_else(String::new, |remark| format!(" {remark}"));
    format!("Saved {name}.{remark}")
}

/// Returns a text without the keys in parentheses that it ends with.
pub fn without_key(label: &str) -> &str {
    label.rsplit_once(" (").map_or(label, |(label, _)| label)
}

/// Returns a message that begins with a capital, unless it begins with the name of a file, and ends with a full stop.
pub fn sentence(message: &str) -> String {
    let first = message.split(' ').next().unwrap_or_default();
    let is_word = first.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'\'') && first != message;
    let mut message = message.to_owned();
    if let Some(letter) = message.get_mut(..1).filter(|_| is_word) {
        letter.make_ascii_uppercase();
    }
    if !message.ends_with(['.', '!', '?', '…', ':']) {
        message.push('.');
    }
    message
}

/// Formats a share as a whole percentage.
pub fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// Formats a number with thin spaces between thousands.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// Returns the accessible name of the number field beside the slider `label`.
pub fn value_of(label: &str) -> String {
    format!("{label} value")
}
