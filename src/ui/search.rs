//! How the panels' searches compare names.

/// Whether a search finds a name, whatever their case and what separates their words: `left hand` finds `mixamorig:LeftHand` and
/// `left_hand`.
pub fn finds(search: &str, name: &str) -> bool {
    let wanted = letters(search);
    // Of signs alone, exactly these.
    if wanted.is_empty() { name.contains(search.trim()) } else { letters(name).contains(&wanted) }
}

fn letters(text: &str) -> String {
    text.chars().filter(|letter| letter.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::finds;

    #[test]
    fn words_are_found_however_they_are_separated() {
        for name in ["mixamorig:LeftHand", "left_hand.001", "LEFT HAND"] {
            assert!(finds("left hand", name), "{name}");
            assert!(finds("LeftHand", name), "{name}");
            assert!(finds("", name), "{name}");
            assert!(!finds("left foot", name), "{name}");
        }
        assert!(finds("_", "left_hand") && !finds("_", "LeftHand"));
        assert!(finds("hand.l", "Hand_L"));
    }
}
