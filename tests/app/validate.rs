//! Validating a model's file: the host is asked once, and its report is shown for that model alone.

use gaitway::app::Message;
use gaitway::ui::{Tab, text};

use crate::desk::desk;

const REPORT: &str = r#"{ "counts": [1, 0, 0, 0], "isTruncated": false,
    "groups": [{ "severity": 0, "code": "BAD", "count": 1, "findings": [{ "text": "/nodes/1: bad", "place": "/nodes/1" }] }] }"#;

#[test]
fn a_report_is_shown_for_its_model_and_a_failure_can_be_retried() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let pilot = desk.library().active().expect("a model").id;
    desk.press(Tab::Info.label());
    desk.scroll_and_press(text::VALIDATE);
    desk.press(text::VALIDATING);
    assert_eq!(*desk.validated.borrow(), [pilot], "once, however often the button is pressed");
    desk.send(Message::Validated(pilot, Err("no connection".to_owned())));
    let failed = text::validator_failed("no connection");
    assert!(desk.shows(&failed) && desk.shows(&text::labelled(text::KHRONOS_VALIDATOR, &failed)), "and in a notice");
    desk.scroll_and_press(text::VALIDATE_AGAIN);
    assert_eq!(desk.validated.borrow().len(), 2);
    desk.open(&["sample:creature".into()]);
    desk.send(Message::Validated(pilot, Ok(REPORT.to_owned())));
    assert!(!desk.shows("/nodes/1: bad") && desk.shows(text::VALIDATE), "the other model hasn't been validated");
    desk.undo();
    assert!(desk.shows("/nodes/1: bad"));
    desk.scroll_and_press(text::VALIDATE_AGAIN);
    desk.send(Message::Validated(pilot, Ok("no JSON".to_owned())));
    assert!(desk.shows(&text::validator_failed("")) && !desk.shows("/nodes/1: bad"));
}

#[test]
fn a_model_without_a_gltf_is_not_validated() {
    let Some(mut desk) = desk("sample:walker") else { return };
    desk.press(Tab::Info.label());
    assert!(desk.shows(text::NO_GLTF) && !desk.shows(text::VALIDATE));
}
