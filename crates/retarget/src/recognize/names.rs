//! Reads a joint's name: undoes what exporters did to it, splits it into words at separators, case changes and digits, and
//! takes out the word for the side. `mixamorig1:LeftUpLeg`, `Left_UpLeg` and `UpLeg.L` read the same.

use gaitway_character::asset::Side;

/// A name split into words.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Name {
    pub side: Option<Side>,
    /// Lower case, numbers separate, without the side and the rig's prefix.
    pub words: Vec<String>,
}

const LEFT: [&str; 4] = ["left", "l", "lft", "lt"];
const RIGHT: [&str; 4] = ["right", "r", "rgt", "rt"];

/// Prefixes of rigs, as words. A number that follows belongs to the prefix.
const PREFIXES: [&[&str]; 21] = [
    &["mixamorig"],
    &["cc", "base"],
    &["j", "bip"],
    &["j", "sec"],
    &["valve", "biped"],
    &["bip"],
    &["biped"],
    &["character"],
    &["armature"],
    &["skeleton"],
    &["def"],
    &["org"],
    &["b"],
    &["bn"],
    &["bone"],
    &["jnt"],
    &["jt"],
    &["joint"],
    &["sk"],
    &["skel"],
    &["rig"],
];

/// Words that a one-letter side may be attached to: `lhip`, `rshldr`.
const WORDS_AFTER_SIDE: [&str; 29] = [
    "hip", "thigh", "upleg", "leg", "knee", "shin", "calf", "ankle", "foot", "toe", "toes", "collar", "clavicle",
    "shoulder", "sholda", "shldr", "arm", "uparm", "upperarm", "elbow", "elbo", "forearm", "lowerarm", "wrist", "hand",
    "thumb", "eye", "buttock", "fingers",
];

impl Name {
    pub fn read(raw: &str) -> Self {
        let mut words = words(&without_exporter_marks(raw));
        drop_prefix(&mut words);
        let mut name = Self { side: None, words };
        name.take_side();
        name
    }

    /// The words as one, for lookup: `handthumb1`.
    pub fn key(&self) -> String {
        self.words.concat()
    }

    /// As [`Name::key`], with numbers without leading zeros.
    pub fn short_key(&self) -> String {
        self.words.iter().map(|word| without_zeros(word)).collect()
    }

    pub fn has(&self, word: &str) -> bool {
        self.words.iter().any(|other| other == word)
    }

    /// Removes a last word that the joints of a rig share, such as the kind of node.
    pub fn drop_last(&mut self, word: &str) {
        if self.words.len() > 1 && self.words.last().is_some_and(|last| last == word) {
            self.words.pop();
        }
    }

    /// Removes a first word that the joints of a rig share, such as the character's name.
    pub fn drop_first(&mut self, word: &str) {
        if self.words.len() > 1 && self.words[0] == word {
            self.words.remove(0);
        }
    }

    /// Removes the word for the side and keeps what it says.
    pub fn take_side(&mut self) {
        // `LUArm`, `RFArm`: the side and one letter for upper or fore.
        if let [letters, arm, ..] = self.words.as_mut_slice()
            && matches!(letters.as_str(), "lu" | "lf" | "ru" | "rf")
            && arm == "arm"
        {
            self.side = Some(if letters.starts_with('l') { Side::Left } else { Side::Right });
            letters.remove(0);
            return;
        }
        let side = |word: &str| {
            if LEFT.contains(&word) {
                Some(Side::Left)
            } else if RIGHT.contains(&word) {
                Some(Side::Right)
            } else {
                None
            }
        };
        if let Some(at) = self.words.iter().position(|word| side(word).is_some()) {
            self.side = side(&self.words[at]);
            self.words.remove(at);
            return;
        }
        for word in &mut self.words {
            for (long, short, side) in [("left", "l", Side::Left), ("right", "r", Side::Right)] {
                let rest = match word.strip_prefix(long).or_else(|| word.strip_suffix(long)) {
                    Some(rest) if rest.len() >= 3 => Some(rest),
                    _ => word.strip_prefix(short).filter(|rest| WORDS_AFTER_SIDE.contains(rest)),
                };
                if let Some(rest) = rest {
                    *word = rest.to_owned();
                    self.side = Some(side);
                    return;
                }
            }
        }
    }
}

/// Removes namespaces and paths (`Armature|rig:Hips`) and decodes characters written as `FBXASC046`.
fn without_exporter_marks(raw: &str) -> String {
    let mut text = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(at) = rest.find("FBXASC") {
        text.push_str(&rest[..at]);
        let code = rest.get(at + 6..at + 9).and_then(|digits| digits.parse::<u8>().ok()).filter(u8::is_ascii);
        match code {
            Some(code) => {
                text.push(char::from(code));
                rest = &rest[at + 9..];
            }
            None => {
                text.push_str("FBXASC");
                rest = &rest[at + 6..];
            }
        }
    }
    text.push_str(rest);
    match text.rsplit(['|', ':']).find(|part| !part.is_empty()) {
        Some(part) => part.to_owned(),
        None => text,
    }
}

/// The ASCII form of a full-width letter or digit, as Japanese programs write them.
fn narrow(char: char) -> char {
    let is_wide = ('\u{ff01}'..='\u{ff5e}').contains(&char);
    let narrow = u32::from(char).checked_sub(0xfee0).filter(|_| is_wide).and_then(char::from_u32);
    narrow.unwrap_or(char)
}

/// Splits at anything but letters and digits, between letters and digits, before a capital that follows a small letter, and
/// before the last capital of a run that a small letter follows (`LLeg` is `L`, `Leg`).
pub fn words(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().map(narrow).collect();
    let mut words = Vec::new();
    let mut word = String::new();
    for (at, &here) in chars.iter().enumerate() {
        let before = at.checked_sub(1).map(|at| chars[at]);
        let cut = before.is_some_and(|before| {
            let capital_starts = here.is_uppercase()
                && (before.is_lowercase()
                    || before.is_uppercase() && chars.get(at + 1).is_some_and(|next| next.is_lowercase()));
            capital_starts || here.is_ascii_digit() != before.is_ascii_digit()
        });
        if (cut || !here.is_alphanumeric()) && !word.is_empty() {
            words.push(std::mem::take(&mut word));
        }
        if here.is_alphanumeric() {
            word.extend(here.to_lowercase());
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words
}

/// Drops up to two prefixes, as in `Armature_mixamorig`, but never the whole name: `Bip01` and `Character1` stay.
fn drop_prefix(words: &mut Vec<String>) {
    for _ in 0..2 {
        let leaves_a_word = |prefix: &[&str]| words.iter().skip(prefix.len()).any(|word| !is_number(word));
        let Some(prefix) = PREFIXES
            .iter()
            .find(|prefix| leaves_a_word(prefix) && words.iter().zip(**prefix).all(|(word, part)| word == part))
        else {
            return;
        };
        let numbered = prefix.len() == 1 && words.len() > 2 && is_number(&words[1]);
        words.drain(..prefix.len() + usize::from(numbered));
    }
}

pub fn is_number(word: &str) -> bool {
    word.bytes().all(|byte| byte.is_ascii_digit())
}

fn without_zeros(word: &str) -> &str {
    let short = word.trim_start_matches('0');
    if is_number(word) && short.is_empty() {
        "0"
    } else if is_number(word) {
        short
    } else {
        word
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(raw: &str, side: Option<Side>, words: &str) {
        let name = Name::read(raw);
        assert_eq!((name.side, name.words.join(" ").as_str()), (side, words), "{raw}");
    }

    #[test]
    fn separators_prefixes_and_sides_are_read() {
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        check("mixamorig:LeftUpLeg", left, "up leg");
        check("mixamorig12:RightHandThumb1", right, "hand thumb 1");
        check("mixamorigLeftToeBase", left, "toe base");
        check("f_indexFBXASC04601FBXASC046L", left, "f index 01");
        check("Bip01 R Finger01", right, "finger 01");
        check("Bip001", None, "bip 001");
        check("LLegUpper", left, "leg upper");
        check("RArmForearm1", right, "arm forearm 1");
        check("rShldr", right, "shldr");
        check("LUArm", left, "u arm");
        check("lhip", left, "hip");
        check("J_Bip_C_UpperChest", None, "c upper chest");
        check("J_Bip_L_UpperArm", left, "upper arm");
        check("CC_Base_R_Thigh", right, "thigh");
        check("DEF-upper_arm.L.001", left, "upper arm 001");
        check("Left knee", left, "knee");
        check("leftupleg", left, "upleg");
        check("Armature|Skeleton:Spine_02", None, "spine 02");
    }

    #[test]
    fn letters_within_words_are_not_sides() {
        for raw in ["tail", "shoulder", "lower", "rear", "leg", "Roll", "neckDummy", "hair", "Lid"] {
            assert_eq!(Name::read(raw).side, None, "{raw}");
        }
    }
}
