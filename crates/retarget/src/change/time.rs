//! Retimes clips: trims, reverses, speeds up and slows down.

use gaitway_character::anim::Interpolation;

use super::track::{Track, Tracks};

/// Keeps the part from `start` to `end` in seconds. Keys are inserted at both ends, so that the curves stay the same.
pub fn trim(tracks: &mut Tracks, start: f32, end: f32) {
    let start = start.clamp(0.0, tracks.duration_secs);
    let end = end.clamp(start, tracks.duration_secs);
    for track in &mut tracks.tracks {
        if track.times.len() > 1 {
            for time in [start, end] {
                if track.times[0] < time && track.times.last().is_some_and(|&last| time < last) {
                    track.insert(time);
                }
            }
        }
        let first = track.times.partition_point(|&time| time < start);
        let last = track.times.partition_point(|&time| time <= end);
        if first == last {
            // All keys lie outside, so the value is constant.
            let key = track.key_at(start);
            (track.times, track.values) = (vec![0.0], key);
            continue;
        }
        let stride = track.stride();
        track.values = track.values[first * stride..last * stride].to_vec();
        track.times = track.times[first..last].iter().map(|time| time - start).collect();
        separate(&mut track.times);
    }
    tracks.duration_secs = end - start;
}

/// Keeps times strictly ascending after rounding.
fn separate(times: &mut [f32]) {
    for key in 1..times.len() {
        if times[key] <= times[key - 1] {
            times[key] = times[key - 1].next_up();
        }
    }
}

/// Reverses a clip.
pub fn reverse(tracks: &mut Tracks) {
    let duration_secs = tracks.duration_secs;
    for track in &mut tracks.tracks {
        if track.interpolation == Interpolation::Step {
            reverse_steps(track, duration_secs);
            continue;
        }
        track.times = track.times.iter().rev().map(|time| duration_secs - time).collect();
        separate(&mut track.times);
        let (width, is_spline) = (track.width, track.is_spline());
        // Reversing the entries also swaps a spline's in- and out-tangents.
        let reversed = track.values.chunks_exact(width).rev().enumerate();
        track.values = reversed
            .flat_map(|(index, entry)| {
                let sign = if is_spline && index % 3 != 1 { -1.0 } else { 1.0 };
                entry.iter().map(move |number| sign * number)
            })
            .collect();
    }
}

/// Each value holds until the next key, so reversed it starts where that key was.
fn reverse_steps(track: &mut Track, duration_secs: f32) {
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for key in (0..track.times.len()).rev() {
        let begin = track.times.get(key + 1).map_or(0.0, |next| duration_secs - next);
        // A value that holds for no time is dropped.
        if times.last().is_none_or(|&last| begin > last) {
            times.push(begin);
            values.extend_from_slice(track.value(key));
        } else {
            let at = values.len() - track.width;
            values.truncate(at);
            values.extend_from_slice(track.value(key));
        }
    }
    (track.times, track.values) = (times, values);
    let start = track.last_value().to_vec();
    if track.times.last().is_some_and(|&last| last < duration_secs) && track.times.len() > 1 {
        track.times.push(duration_secs);
        track.values.extend(start);
    }
}

/// Multiplies the speed.
pub fn set_speed(tracks: &mut Tracks, factor: f64) {
    let scaled = |secs: f32| (f64::from(secs) / factor) as f32;
    for track in &mut tracks.tracks {
        track.times.iter_mut().for_each(|time| *time = scaled(*time));
        separate(&mut track.times);
        if track.is_spline() {
            // Tangents are per second.
            for (index, entry) in track.values.chunks_exact_mut(track.width).enumerate() {
                if index % 3 != 1 {
                    entry.iter_mut().for_each(|number| *number *= factor as f32);
                }
            }
        }
    }
    tracks.duration_secs = scaled(tracks.duration_secs);
}
