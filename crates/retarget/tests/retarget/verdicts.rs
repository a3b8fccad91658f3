//! The verdicts on quality figures, against the limits that docs/retargeting.md states.

use gaitway_retarget::{Contacts, Figures, Verdict, Verdicts};

const DOCUMENT: &str = include_str!("../../../../docs/retargeting.md");
const PAIRS: &str = include_str!("../../../../docs/retargeting-pairs.tsv");
const SIZE_METRES: f64 = 1.8;

/// Figures with nothing but the one of a row in the document, at a value as the document writes it; the verdict on it; and what was
/// done about contacts.
type Row = (fn(f64) -> Figures, fn(&Verdicts) -> Option<Verdict>, Contacts);

/// As a share in percent.
fn metres(percent: f64) -> Option<f64> {
    Some(percent / 100.0 * SIZE_METRES)
}

/// In the order of the document.
const ROWS: [Row; 18] = [
    (
        |value| Figures { limb_direction_error_degrees_mean: Some(value), ..Figures::default() },
        |verdicts| verdicts.limb_direction_error_mean,
        Contacts::Off,
    ),
    (
        |value| Figures { limb_direction_error_degrees_max: Some(value), ..Figures::default() },
        |verdicts| verdicts.limb_direction_error_max,
        Contacts::Off,
    ),
    (
        |value| Figures { limb_direction_error_degrees_mean: Some(value), ..Figures::default() },
        |verdicts| verdicts.limb_direction_error_mean,
        Contacts::Keep,
    ),
    (
        |value| Figures { limb_direction_error_degrees_max: Some(value), ..Figures::default() },
        |verdicts| verdicts.limb_direction_error_max,
        Contacts::Keep,
    ),
    (
        |value| Figures { facing_error_degrees_mean: Some(value), ..Figures::default() },
        |verdicts| verdicts.facing_error_mean,
        Contacts::Off,
    ),
    (
        |value| Figures { facing_error_degrees_max: Some(value), ..Figures::default() },
        |verdicts| verdicts.facing_error_max,
        Contacts::Off,
    ),
    (
        |value| Figures { orientation_error_degrees_mean: Some(value), ..Figures::default() },
        |verdicts| verdicts.orientation_error_mean,
        Contacts::Off,
    ),
    (
        |value| Figures { orientation_error_degrees_max: Some(value), ..Figures::default() },
        |verdicts| verdicts.orientation_error_max,
        Contacts::Off,
    ),
    (
        |value| Figures {
            foot_slide_metres_per_sec: metres(value).map(|slide| slide + 0.5),
            foot_slide_source_metres_per_sec: Some(0.5),
            ..Figures::default()
        },
        |verdicts| verdicts.foot_slide,
        Contacts::Off,
    ),
    (
        |value| Figures { foot_hover_metres_mean: metres(-value), ..Figures::default() },
        |verdicts| verdicts.foot_hover,
        Contacts::Off,
    ),
    (
        |value| Figures { sole_penetration_metres_max: metres(value), ..Figures::default() },
        |verdicts| verdicts.sole_penetration,
        Contacts::Off,
    ),
    (
        |value| Figures { ground_penetration_metres_max: metres(value), ..Figures::default() },
        |verdicts| verdicts.ground_penetration,
        Contacts::Off,
    ),
    (
        |value| Figures { contact_error_metres_mean: metres(value), ..Figures::default() },
        |verdicts| verdicts.contact_error,
        Contacts::Keep,
    ),
    (
        |value| Figures { self_penetration_share: Some(value / 100.0), ..Figures::default() },
        |verdicts| verdicts.self_penetration,
        Contacts::Keep,
    ),
    (
        |value| Figures { facing_path_error_degrees_mean: Some(value), ..Figures::default() },
        |verdicts| verdicts.facing_path_error,
        Contacts::Off,
    ),
    (
        |value| Figures { skin_stretch_max: Some(value), ..Figures::default() },
        |verdicts| verdicts.skin_stretch_max,
        Contacts::Off,
    ),
    (
        |value| Figures { skin_stretch_mean: Some(value), ..Figures::default() },
        |verdicts| verdicts.skin_stretch_mean,
        Contacts::Off,
    ),
    (
        |value| Figures { coverage: Some(1.0 - value / 100.0), ..Figures::default() },
        |verdicts| verdicts.coverage,
        Contacts::Off,
    ),
];

/// The two limits of each row in the document's table.
fn documented() -> Vec<[f64; 2]> {
    let (_, table) = DOCUMENT.split_once("| figure | good, up to | acceptable, up to |\n").expect("the table");
    let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
    let limit = |cell: &str| -> f64 {
        let number = cell.trim().split(['°', ' ']).next().unwrap_or_default();
        number.parse().unwrap_or_else(|_| panic!("{cell}: expected a number"))
    };
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').collect();
        [limit(cells[2]), limit(cells[3])]
    })
    .collect()
}

#[test]
fn limits_are_those_of_the_document() {
    let limits = documented();
    assert_eq!(limits.len(), ROWS.len());
    for ((figures, verdict, contacts), [good, acceptable]) in ROWS.into_iter().zip(limits) {
        let judged = |value: f64| {
            let verdicts = Verdicts::new(&figures(value), SIZE_METRES, contacts);
            let verdict = verdict(&verdicts);
            assert_eq!(verdicts.worst(), verdict, "there is no other figure");
            verdict
        };
        for (value, expected) in [
            (0.0, Verdict::Good),
            (good * 0.999, Verdict::Good),
            (good * 1.001, Verdict::Acceptable),
            (acceptable * 0.999, Verdict::Acceptable),
            (acceptable * 1.001, Verdict::NeedsReview),
            (f64::NAN, Verdict::NeedsReview),
        ] {
            assert_eq!(judged(value), Some(expected), "{value} with limits {good} and {acceptable}");
        }
    }
}

#[test]
fn what_cannot_be_measured_is_not_judged_and_the_worst_counts() {
    let nothing = Verdicts::new(&Figures::default(), SIZE_METRES, Contacts::Off);
    assert_eq!(nothing.worst(), None);
    let mixed = Figures { coverage: Some(1.0), facing_error_degrees_mean: Some(15.0), ..Figures::default() };
    assert_eq!(Verdicts::new(&mixed, SIZE_METRES, Contacts::Off).worst(), Some(Verdict::Acceptable));
    let still = Figures {
        foot_slide_metres_per_sec: Some(0.1),
        foot_slide_source_metres_per_sec: Some(0.4),
        ..Figures::default()
    };
    assert_eq!(
        Verdicts::new(&still, SIZE_METRES, Contacts::Off).foot_slide,
        Some(Verdict::Good),
        "less than its source"
    );
    let flat = Figures { foot_hover_metres_mean: Some(0.0), ..Figures::default() };
    assert_eq!(Verdicts::new(&flat, 0.0, Contacts::Off).foot_hover, Some(Verdict::Good), "a model without a size");
}

/// The limits on angles were chosen by the pairs of the test data, which are mapped correctly.
#[test]
fn real_pairs_are_as_good_as_the_document_says() {
    let mut lines = PAIRS.lines().map(|line| line.split('\t').collect::<Vec<_>>());
    let heads = lines.next().expect("column titles");
    let column = |name: &str| heads.iter().position(|head| *head == name).unwrap_or_else(|| panic!("no {name}"));
    let columns = ["limb_direction", "facing", "orientation"]
        .map(|angle| ["mean", "max"].map(|of| column(&format!("{angle}_error_{of}_deg"))));
    let worst = lines.map(|cells| {
        let number = |column: usize| cells[column].parse().ok();
        let [limb, facing, orientation] = columns.map(|angle| angle.map(number));
        let figures = Figures {
            limb_direction_error_degrees_mean: limb[0],
            limb_direction_error_degrees_max: limb[1],
            facing_error_degrees_mean: facing[0],
            facing_error_degrees_max: facing[1],
            orientation_error_degrees_mean: orientation[0],
            orientation_error_degrees_max: orientation[1],
            ..Figures::default()
        };
        Verdicts::new(&figures, SIZE_METRES, Contacts::Off).worst().expect("angles")
    });
    let worst: Vec<Verdict> = worst.collect();
    let percent = |limit| 100 * worst.iter().filter(|&&verdict| verdict <= limit).count() / worst.len();
    let stated = format!("{} in 100 of them are at least acceptable", percent(Verdict::Acceptable));
    assert!(DOCUMENT.contains(&stated), "{stated}");
    let stated = format!("{} in 100 are good", percent(Verdict::Good));
    assert!(DOCUMENT.contains(&stated), "{stated}");
}
