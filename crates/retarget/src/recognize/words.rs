//! What the words in a joint's name say about its place in a body, in any vocabulary.

use super::names::{Name, is_number};

/// A part of the body as names describe it: less exact than a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Word {
    Pelvis,
    Torso,
    Neck,
    Head,
    Jaw,
    Eye,
    Clavicle,
    /// The collar bone in some vocabularies, the upper arm in others.
    Shoulder,
    UpperArm,
    /// The upper arm, unless another joint has a better word for it.
    Arm,
    LowerArm,
    Hand,
    /// The thigh in some vocabularies, a joint before it in others.
    Hip,
    UpperLeg,
    /// The thigh, or the shin below it.
    Leg,
    LowerLeg,
    Foot,
    Toes,
    /// Thumb 0 to little finger 4.
    Finger(u8),
    /// Nothing that moves by itself: helpers, tips, twist joints, props.
    Aside,
}

/// Words by part, without numbers, separators and noise.
const WORDS: &[(Word, &[&str])] = &[
    (Word::Pelvis, &["hips", "hip", "pelvis"]),
    (
        Word::Torso,
        &[
            "spine",
            "abdomen",
            "belly",
            "waist",
            "chest",
            "torso",
            "ab",
            "lowerback",
            "upperback",
            "midback",
            "thorax",
            "ribcage",
            "upperchest",
            "upchest",
            "abdomenlower",
            "abdomenupper",
            "chestlower",
            "chestupper",
            "lowerspine",
            "midspine",
            "upperspine",
            "spinelower",
            "spinemid",
            "spineupper",
            "stomach",
            "bust",
        ],
    ),
    (Word::Neck, &["neck", "necklower"]),
    (Word::Head, &["head", "neckhead", "skull"]),
    (Word::Jaw, &["jaw", "lowerjaw", "jawroot", "mandible"]),
    (Word::Eye, &["eye", "eyeball"]),
    (Word::Clavicle, &["clavicle", "clav", "collar", "collarbone", "scapula", "shoulderblade"]),
    (Word::Shoulder, &["shoulder", "shldr", "sholda"]),
    (Word::UpperArm, &["upperarm", "uparm", "uarm", "humerus", "bicep", "armupper", "armup", "shldrbend"]),
    (Word::Arm, &["arm"]),
    (Word::LowerArm, &["forearm", "lowerarm", "lowarm", "elbow", "elbo", "armlower", "armlow", "forearmbend"]),
    (Word::Hand, &["hand", "wrist", "fist", "palm"]),
    (Word::UpperLeg, &["thigh", "upleg", "upperleg", "legupper", "legup", "femur", "thighbend"]),
    (Word::Leg, &["leg"]),
    (Word::LowerLeg, &["shin", "calf", "knee", "lowerleg", "lowleg", "leglower", "leglow", "tibia"]),
    (Word::Foot, &["foot", "ankle"]),
    (Word::Toes, &["toe", "toes", "toebase", "ball"]),
    (Word::Finger(0), &["thumb", "thumbfinger"]),
    (Word::Finger(1), &["index", "pointer", "indexfinger", "findex", "fore"]),
    (Word::Finger(2), &["middle", "mid", "middlefinger", "fmiddle"]),
    (Word::Finger(3), &["ring", "ringfinger", "fring"]),
    (Word::Finger(4), &["pinky", "pinkie", "little", "littlefinger", "fpinky"]),
];

/// Words that may go with any part.
const NOISE: [&str; 18] = [
    "bind", "jnt", "joint", "bone", "c", "m", "x", "center", "ctr", "def", "jt", "bn", "bnd", "skn", "skin", "env",
    "shj", "deform",
];

/// Words of joints that only show where a chain ends.
const ENDS: [&str; 4] = ["end", "leaf", "tip", "nub"];

const ASIDE: [&str; 43] = [
    "twist",
    "roll",
    "ik",
    "fk",
    "pole",
    "target",
    "control",
    "ctrl",
    "ctl",
    "helper",
    "dummy",
    "site",
    "endsite",
    "effector",
    "socket",
    "slot",
    "handslot",
    "weapon",
    "attach",
    "prop",
    "pad",
    "hair",
    "cape",
    "skirt",
    "cloth",
    "breast",
    "tail",
    "ear",
    "wing",
    "brow",
    "lid",
    "eyelid",
    "mouth",
    "lip",
    "tongue",
    "teeth",
    "share",
    "corrective",
    "orient",
    "tracker",
    "null",
    "mesh",
    "geo",
];

/// Segments of fingers, ignored when the finger is looked up.
const SEGMENTS: [&str; 6] = ["proximal", "intermediate", "medial", "distal", "hand", "finger"];

/// Bones inside the palm, which have no slot except the thumb's.
const PALM: [&str; 5] = ["metacarpal", "carpal", "meta", "palm", "in"];

/// Returns the part that a name describes; None for unknown words.
pub(super) fn read(name: &Name) -> Option<Word> {
    let words: Vec<&str> = name.words.iter().map(String::as_str).filter(|word| !is_number(word)).collect();
    // Numbered palms are the bones in one.
    let is_metacarpal = words == ["palm"] && name.words.len() > 1;
    if is_metacarpal || words.iter().any(|word| ASIDE.contains(word) || ENDS.contains(word)) {
        return Some(Word::Aside);
    }
    let words: Vec<&str> =
        if words.len() > 1 { words.into_iter().filter(|word| !NOISE.contains(word)).collect() } else { words };
    let word = look_up(&words.concat()).or_else(|| within_limb(&words));
    match (word, name.side) {
        (Some(Word::Pelvis), Some(_)) => Some(Word::Hip),
        (Some(Word::Finger(_)), None) => None,
        (Some(word), _) => Some(word),
        (None, Some(_)) => finger(&words).or_else(|| (words == ["buttock"]).then_some(Word::Hip)),
        (None, None) => None,
    }
}

fn look_up(letters: &str) -> Option<Word> {
    WORDS.iter().find(|(_, texts)| texts.contains(&letters)).map(|(word, _)| *word)
}

/// The limb before its part: `ArmCollarbone`, `LegCalf`.
fn within_limb(words: &[&str]) -> Option<Word> {
    match words {
        ["arm" | "leg", rest @ ..] if !rest.is_empty() => look_up(&rest.concat()).or_else(|| finger(rest)),
        _ => None,
    }
}

fn finger(words: &[&str]) -> Option<Word> {
    let palm = words.iter().any(|word| PALM.contains(word));
    let rest: Vec<&str> =
        words.iter().copied().filter(|word| !SEGMENTS.contains(word) && !PALM.contains(word)).collect();
    match look_up(&rest.concat()) {
        Some(Word::Finger(0)) => Some(Word::Finger(0)),
        Some(Word::Finger(_)) if palm => Some(Word::Aside),
        Some(word @ Word::Finger(_)) => Some(word),
        _ => None,
    }
}

/// Whether a name only says that a chain ends.
pub(super) fn is_end(name: &Name) -> bool {
    name.words.iter().any(|word| ENDS.contains(&word.as_str()))
}

/// Whether a name mentions what a human body does not have.
pub(super) fn is_of_creature(name: &Name) -> bool {
    const PARTS: [&str; 13] = [
        "tail", "wing", "fin", "paw", "hoof", "beak", "snout", "muzzle", "feather", "fang", "antenna", "tentacle",
        "claw",
    ];
    const PLACES: [&str; 6] = ["front", "back", "fore", "hind", "rear", "middle"];
    let leg = name.has("leg") || name.has("legs") || name.has("foot");
    name.words.iter().any(|word| PARTS.contains(&word.trim_end_matches('s')))
        || leg && name.words.iter().any(|word| PLACES.contains(&word.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(raw: &str, expected: Option<Word>) {
        assert_eq!(read(&Name::read(raw)), expected, "{raw}");
    }

    #[test]
    fn parts_are_found_in_many_spellings() {
        check("LLegUpper", Some(Word::UpperLeg));
        check("LLegCalf", Some(Word::LowerLeg));
        check("LLegAnkle", Some(Word::Foot));
        check("RArmCollarbone", Some(Word::Clavicle));
        check("RArmForearm1", Some(Word::LowerArm));
        check("RArmHand", Some(Word::Hand));
        check("RArmMid2", Some(Word::Finger(2)));
        check("NeckHead", Some(Word::Head));
        check("LHipJoint", Some(Word::Hip));
        check("rButtock", Some(Word::Hip));
        check("L_handPointer0002_bind_JNT", Some(Word::Finger(1)));
        check("IndexFinger1_L", Some(Word::Finger(1)));
        check("LeftHandRing2", Some(Word::Finger(3)));
        check("f_pinky.01.L", Some(Word::Finger(4)));
        check("thumb.proximal.L", Some(Word::Finger(0)));
        check("leftThumbMetacarpal", Some(Word::Finger(0)));
    }

    #[test]
    fn helpers_and_unknown_words_are_not_parts() {
        check("LeftInHandIndex", Some(Word::Aside));
        check("index_metacarpal_l", Some(Word::Aside));
        check("upperarm_twist_01_l", Some(Word::Aside));
        check("neckDummy", Some(Word::Aside));
        check("Bip01 HeadNub", Some(Word::Aside));
        check("kneeIK.l", Some(Word::Aside));
        check("Joint75", None);
        check("ToSpine", None);
        check("middle", None);
        check("headtracker", None);
        check("LFingers", None);
    }
}
