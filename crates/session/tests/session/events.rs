//! The texts of events, which web/shell/session.js writes.

use gaitway_session::{By, EntryState, Event, FileId, Item, NamedFile, RequestId, Role};

fn check(text: &str, expected: &Event) {
    let event: Event = serde_json::from_str(text).unwrap();
    assert_eq!(event, *expected);
}

#[test]
fn an_event_is_its_name_or_an_object_under_it() {
    check(r#""tryAgain""#, &Event::TryAgain);
    check(r#"{"imagesFailed":{"problem":"no network"}}"#, &Event::ImagesFailed { problem: "no network".to_owned() });
    let (link, state) = ("model=fox".to_owned().into(), EntryState { number: Some(3), own: true });
    check(r#"{"moved":{"link":"model=fox","state":{"number":3,"own":true}}}"#, &Event::Moved { link, state });
    let file = NamedFile { id: FileId(7), name: "Fox.glb".to_owned() };
    let items = vec![Item::Address("walker".to_owned()), Item::File(file)];
    let open = Event::Open { request: Some(RequestId(1)), by: By::Hand, items, role: Role::Any };
    check(r#"{"open":{"request":1,"by":"hand","items":["walker",{"id":7,"name":"Fox.glb"}],"role":"any"}}"#, &open);
}
