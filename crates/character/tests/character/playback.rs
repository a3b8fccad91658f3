//! Mapping the playhead to clip time.

use gaitway_character::anim::{LoopMode, TimeRange, clip_time};

fn check(range: (f64, f64), mode: LoopMode, cases: &[(f64, f64)]) {
    let range = TimeRange { start_secs: range.0, end_secs: range.1 };
    for &(playhead, expected) in cases {
        let found = clip_time(playhead, range, mode);
        assert!((found - expected).abs() < 1e-9, "{mode:?} in {range:?} at {playhead}: {found}, expected {expected}");
    }
}

#[test]
fn a_non_finite_playhead_gives_the_start() {
    for mode in [LoopMode::Once, LoopMode::Loop, LoopMode::PingPong] {
        check((1.0, 3.0), mode, &[(f64::NAN, 1.0), (f64::INFINITY, 1.0), (f64::NEG_INFINITY, 1.0)]);
    }
}

#[test]
fn an_empty_range_gives_its_start() {
    for mode in [LoopMode::Once, LoopMode::Loop, LoopMode::PingPong] {
        check((1.5, 1.5), mode, &[(0.0, 1.5), (1.5, 1.5), (7.0, 1.5)]);
        check((0.0, 0.0), mode, &[(-1.0, 0.0), (0.0, 0.0), (1.0, 0.0)]);
    }
}

#[test]
fn once_holds_at_both_ends() {
    check((1.0, 3.0), LoopMode::Once, &[(-5.0, 1.0), (1.0, 1.0), (2.25, 2.25), (3.0, 3.0), (99.0, 3.0)]);
}

#[test]
fn a_loop_wraps_but_includes_its_out_point() {
    check((0.0, 2.0), LoopMode::Loop, &[(0.0, 0.0), (0.5, 0.5), (2.0, 2.0), (2.5, 0.5), (21.0, 1.0)]);
    check((1.0, 3.0), LoopMode::Loop, &[(1.0, 1.0), (3.0, 3.0), (3.5, 1.5), (5.5, 1.5)]);
}

#[test]
fn a_loop_also_runs_backwards() {
    check((0.0, 2.0), LoopMode::Loop, &[(-0.5, 1.5), (-2.0, 0.0), (-3.5, 0.5)]);
    // The playhead may be before the in point.
    check((1.0, 3.0), LoopMode::Loop, &[(0.5, 2.5), (-1.5, 2.5)]);
}

#[test]
fn ping_pong_reverses_at_both_ends() {
    check((0.0, 2.0), LoopMode::PingPong, &[(0.5, 0.5), (2.0, 2.0), (2.5, 1.5), (4.0, 0.0), (4.5, 0.5), (6.5, 1.5)]);
    check((0.0, 2.0), LoopMode::PingPong, &[(-0.5, 0.5), (-2.0, 2.0), (-3.5, 0.5)]);
    check((1.0, 3.0), LoopMode::PingPong, &[(1.0, 1.0), (3.5, 2.5), (5.0, 1.0), (0.5, 1.5)]);
}

#[test]
fn the_result_never_leaves_the_range() {
    for mode in [LoopMode::Once, LoopMode::Loop, LoopMode::PingPong] {
        let range = TimeRange { start_secs: 0.3, end_secs: 1.1 };
        for step in -1000..1000 {
            let time = clip_time(f64::from(step) * 0.037, range, mode);
            assert!((range.start_secs..=range.end_secs).contains(&time), "{mode:?}, step {step}: {time}");
        }
    }
}
