//! Converts the values of other formats to glTF's.

use std::fmt::Write;

/// Maximum number of influences per vertex: four sets of four.
pub const MAX_INFLUENCES: usize = 16;

/// Returns the strongest influences of a vertex in that order, with sum 1; none if no weight is positive.
pub fn strongest(mut influences: Vec<(u16, f64)>) -> Vec<(u16, f32)> {
    influences.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    influences.truncate(MAX_INFLUENCES);
    let sum: f64 = influences.iter().map(|&(_, weight)| weight).sum();
    if sum > 0.0 && sum.is_finite() {
        influences.into_iter().map(|(joint, weight)| (joint, (weight / sum) as f32)).collect()
    } else {
        Vec::new()
    }
}

/// Returns the roughness whose highlight is as wide as that of Phong's exponent: sqrt(2 / (n + 2)), as in Walter et al. 2007.
pub fn roughness_of_exponent(exponent: f64) -> f64 {
    (2.0 / (exponent + 2.0)).sqrt()
}

/// Returns the linear value of an sRGB one.
pub fn linear(value: f64) -> f32 {
    let value = if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
    (if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }) as f32
}

/// Returns the last part of a path of any system.
pub fn base_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}

/// Encodes a file's name as a URI.
pub fn percent_encoded(name: &str) -> String {
    let mut uri = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            let _ = write!(uri, "%{byte:02X}");
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn influences_are_the_strongest_and_add_up_to_one() {
        let many = (0..20).map(|joint| (joint, f64::from(joint % 10))).collect();
        let kept = strongest(many);
        assert_eq!(kept.len(), MAX_INFLUENCES);
        assert_eq!((kept[0].0, kept[1].0, kept[2].0), (9, 19, 8));
        assert!((kept.iter().map(|(_, weight)| weight).sum::<f32>() - 1.0).abs() < 1e-6);
        assert_eq!(strongest(vec![(3, 0.0)]), []);
    }

    #[test]
    fn paths_of_any_system_have_a_base_name() {
        for path in ["C:\\a b\\skin.png", "../skin.png", "skin.png", "/x\\skin.png"] {
            assert_eq!(base_name(path), "skin.png", "{path}");
        }
    }

    #[test]
    fn uris_are_encoded() {
        assert_eq!(percent_encoded("a b#ü.png"), "a%20b%23%C3%BC.png");
    }
}
