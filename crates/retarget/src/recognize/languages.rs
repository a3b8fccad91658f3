//! Translates joint names to English, the language of vocabularies and words. Each skeleton is in one language: the one
//! with the most matching words. Languages without spaces are split into the longest known words.

use std::collections::BTreeSet;

use super::names::Name;

/// Words of a language, each with its English translation, in any order: the longest match wins.
type Words = &'static [(&'static str, &'static str)];

/// Fewer different words may be coincidence: “hand” is also German, “main” also French.
const MIN_WORDS: usize = 5;

const GERMAN: Words = &[
    ("links", "left"),
    ("rechts", "right"),
    ("hüfte", "hips"),
    ("huefte", "hips"),
    ("becken", "hips"),
    ("wirbelsäule", "spine"),
    ("wirbelsaeule", "spine"),
    ("rücken", "spine"),
    ("ruecken", "spine"),
    ("bauch", "belly"),
    ("brust", "chest"),
    ("brustkorb", "chest"),
    ("hals", "neck"),
    ("nacken", "neck"),
    ("kopf", "head"),
    ("kiefer", "jaw"),
    ("auge", "eye"),
    ("schlüsselbein", "clavicle"),
    ("schluesselbein", "clavicle"),
    ("schulter", "shoulder"),
    ("oberarm", "upperarm"),
    ("unterarm", "forearm"),
    ("ellbogen", "elbow"),
    ("hand", "hand"),
    ("handgelenk", "wrist"),
    ("daumen", "thumb"),
    ("zeigefinger", "index"),
    ("mittelfinger", "middle"),
    ("ringfinger", "ring"),
    ("kleinerfinger", "pinky"),
    ("oberschenkel", "thigh"),
    ("unterschenkel", "shin"),
    ("knie", "knee"),
    ("knöchel", "ankle"),
    ("fuß", "foot"),
    ("fuss", "foot"),
    ("zehe", "toe"),
    ("zehen", "toes"),
];

const SPANISH: Words = &[
    ("izquierda", "left"),
    ("izquierdo", "left"),
    ("izq", "left"),
    ("derecha", "right"),
    ("derecho", "right"),
    ("der", "right"),
    ("cadera", "hips"),
    ("caderas", "hips"),
    ("pelvis", "hips"),
    ("columna", "spine"),
    ("espalda", "spine"),
    ("pecho", "chest"),
    ("cuello", "neck"),
    ("cabeza", "head"),
    ("mandíbula", "jaw"),
    ("ojo", "eye"),
    ("clavícula", "clavicle"),
    ("clavicula", "clavicle"),
    ("hombro", "shoulder"),
    ("brazo", "upperarm"),
    ("antebrazo", "forearm"),
    ("codo", "elbow"),
    ("mano", "hand"),
    ("muñeca", "wrist"),
    ("pulgar", "thumb"),
    ("índice", "index"),
    ("indice", "index"),
    ("medio", "middle"),
    ("anular", "ring"),
    ("meñique", "pinky"),
    ("muslo", "thigh"),
    ("pierna", "leg"),
    ("pantorrilla", "shin"),
    ("rodilla", "knee"),
    ("tobillo", "ankle"),
    ("pie", "foot"),
    ("dedos", "toes"),
];

const FRENCH: Words = &[
    ("gauche", "left"),
    ("droite", "right"),
    ("droit", "right"),
    ("hanche", "hips"),
    ("hanches", "hips"),
    ("bassin", "hips"),
    ("colonne", "spine"),
    ("dos", "spine"),
    ("ventre", "belly"),
    ("poitrine", "chest"),
    ("torse", "chest"),
    ("cou", "neck"),
    ("tête", "head"),
    ("tete", "head"),
    ("mâchoire", "jaw"),
    ("œil", "eye"),
    ("clavicule", "clavicle"),
    ("épaule", "shoulder"),
    ("epaule", "shoulder"),
    ("bras", "upperarm"),
    ("avantbras", "forearm"),
    ("coude", "elbow"),
    ("main", "hand"),
    ("poignet", "wrist"),
    ("pouce", "thumb"),
    ("majeur", "middle"),
    ("annulaire", "ring"),
    ("auriculaire", "pinky"),
    ("cuisse", "thigh"),
    ("jambe", "leg"),
    ("mollet", "shin"),
    ("tibia", "shin"),
    ("genou", "knee"),
    ("cheville", "ankle"),
    ("pied", "foot"),
    ("orteil", "toe"),
    ("orteils", "toes"),
];

/// As used by MikuMikuDance: 足 is the thigh.
const JAPANESE: Words = &[
    ("左", "left"),
    ("右", "right"),
    ("上半身", "spine"),
    ("下半身", "pelvis"),
    ("首", "neck"),
    ("頭", "head"),
    ("あご", "jaw"),
    ("目", "eye"),
    ("肩", "clavicle"),
    ("腕捩", "twist"),
    ("手捩", "twist"),
    ("腕", "upperarm"),
    ("ひじ", "elbow"),
    ("肘", "elbow"),
    ("手首", "wrist"),
    ("親指", "thumb"),
    ("人差し指", "index"),
    ("人差指", "index"),
    ("人指", "index"),
    ("中指", "middle"),
    ("薬指", "ring"),
    ("小指", "pinky"),
    ("足首", "ankle"),
    ("つま先", "toes"),
    ("足先", "toes"),
    ("足", "thigh"),
    ("ひざ", "knee"),
    ("膝", "knee"),
    ("先", "tip"),
    ("髪", "hair"),
];

const CHINESE: Words = &[
    ("左", "left"),
    ("右", "right"),
    ("骨盆", "hips"),
    ("臀部", "hips"),
    ("髋", "hips"),
    ("脊柱", "spine"),
    ("脊椎", "spine"),
    ("腰", "waist"),
    ("胸", "chest"),
    ("脖子", "neck"),
    ("颈", "neck"),
    ("頸", "neck"),
    ("头发", "hair"),
    ("头", "head"),
    ("下巴", "jaw"),
    ("眼", "eye"),
    ("锁骨", "clavicle"),
    ("肩", "shoulder"),
    ("上臂", "upperarm"),
    ("大臂", "upperarm"),
    ("前臂", "forearm"),
    ("小臂", "forearm"),
    ("肘", "elbow"),
    ("手腕", "wrist"),
    ("拇指", "thumb"),
    ("食指", "index"),
    ("中指", "middle"),
    ("无名指", "ring"),
    ("小指", "pinky"),
    ("手", "hand"),
    ("大腿", "thigh"),
    ("小腿", "shin"),
    ("膝", "knee"),
    ("脚踝", "ankle"),
    ("脚趾", "toes"),
    ("脚尖", "toes"),
    ("脚", "foot"),
    ("足", "foot"),
];

const KOREAN: Words = &[
    ("왼쪽", "left"),
    ("왼", "left"),
    ("오른쪽", "right"),
    ("오른", "right"),
    ("골반", "hips"),
    ("엉덩이", "hips"),
    ("척추", "spine"),
    ("허리", "waist"),
    ("가슴", "chest"),
    ("손목", "wrist"),
    ("발목", "ankle"),
    ("목", "neck"),
    ("머리카락", "hair"),
    ("머리", "head"),
    ("턱", "jaw"),
    ("눈", "eye"),
    ("쇄골", "clavicle"),
    ("어깨", "shoulder"),
    ("위팔", "upperarm"),
    ("상완", "upperarm"),
    ("아래팔", "forearm"),
    ("전완", "forearm"),
    ("팔꿈치", "elbow"),
    ("팔", "arm"),
    ("엄지", "thumb"),
    ("검지", "index"),
    ("중지", "middle"),
    ("약지", "ring"),
    ("소지", "pinky"),
    ("손", "hand"),
    ("허벅지", "thigh"),
    ("종아리", "shin"),
    ("무릎", "knee"),
    ("다리", "leg"),
    ("발가락", "toes"),
    ("발", "foot"),
];

#[derive(Clone, Copy)]
struct Language {
    words: Words,
    /// Whether spaces separate words. Otherwise a name is a run of words.
    has_spaces: bool,
}

const LANGUAGES: [Language; 6] = [
    Language { words: GERMAN, has_spaces: true },
    Language { words: SPANISH, has_spaces: true },
    Language { words: FRENCH, has_spaces: true },
    Language { words: JAPANESE, has_spaces: false },
    Language { words: CHINESE, has_spaces: false },
    Language { words: KOREAN, has_spaces: false },
];

/// Translates names to English from the language of which they use most words, if these are at least [`MIN_WORDS`].
pub(super) fn translate(names: &mut [Name]) {
    let uses = |language: Language| {
        let words = names.iter().flat_map(|name| &name.words).filter_map(|word| cut(word, language)).flatten();
        words.map(|(word, _)| word).collect::<BTreeSet<&str>>().len()
    };
    let used = LANGUAGES.into_iter().map(|language| (uses(language), language));
    // The first wins a tie.
    let Some((count, language)) = used.rev().max_by_key(|(count, _)| *count) else { return };
    if count < MIN_WORDS {
        return;
    }
    for name in names {
        let words = std::mem::take(&mut name.words);
        for word in words {
            match cut(&word, language) {
                Some(parts) => name.words.extend(parts.into_iter().map(|(_, english)| english.to_owned())),
                None => name.words.push(word),
            }
        }
        if name.side.is_none() {
            name.take_side();
        }
    }
}

/// Splits a word into known words; None if that is impossible. Languages with spaces write each word separately.
fn cut(word: &str, language: Language) -> Option<Vec<(&'static str, &'static str)>> {
    let mut parts = Vec::new();
    let mut rest = word;
    while !rest.is_empty() {
        let starting = language.words.iter().filter(|(foreign, _)| rest.starts_with(foreign));
        let &longest = starting.max_by_key(|(foreign, _)| foreign.len())?;
        if language.has_spaces && longest.0.len() < word.len() {
            return None;
        }
        parts.push(longest);
        rest = &rest[longest.0.len()..];
    }
    Some(parts)
}
