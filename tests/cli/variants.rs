//! Material variants.

use crate::program::{check_fails, document};

#[test]
fn the_command_line_knows_variants() {
    assert_eq!(document(&["inspect", "sample:walker", "--json"])["variants"], serde_json::json!([]));
    // Without a renderer there is no `render`.
    if cfg!(feature = "render") {
        let expected = "expected the name of a material variant, found “Red”; there are no variants";
        check_fails(&["render", "sample:walker", "--out", "-", "--variant", "Red"], 1, expected);
    }
}
