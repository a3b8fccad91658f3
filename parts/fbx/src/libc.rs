//! Replaces the parts of the C library that ufbx needs, where there is no C library or it isn't wanted.
//!
//! The math functions come from here on every target (`UFBX_EXTERNAL_MATH`, set in `.cargo/config.toml`), so that a
//! file gives the same bytes natively and on the page: C libraries differ in the last digit. On wasm32-unknown-unknown
//! there is no C library at all (`UFBX_NO_LIBC`), so memory and strings come from here too; it is compiled without
//! files (`UFBX_NO_STDIO`).
#![allow(unsafe_code)]

use std::ffi::c_int;

macro_rules! math {
    ($($name:ident($($argument:ident),+) = $function:path;)+) => {
        $(
            // SAFETY: the name is one that ufbx reserves for this function.
            #[unsafe(no_mangle)]
            extern "C" fn $name($($argument: f64),+) -> f64 {
                $function($($argument),+)
            }
        )+
    };
}

math! {
    ufbx_sqrt(x) = f64::sqrt;
    ufbx_sin(x) = libm::sin;
    ufbx_cos(x) = libm::cos;
    ufbx_tan(x) = libm::tan;
    ufbx_asin(x) = libm::asin;
    ufbx_acos(x) = libm::acos;
    ufbx_atan(x) = libm::atan;
    ufbx_atan2(y, x) = libm::atan2;
    ufbx_pow(x, y) = libm::pow;
    ufbx_fmin(a, b) = minimum;
    ufbx_fmax(a, b) = maximum;
    ufbx_fabs(x) = f64::abs;
    ufbx_copysign(x, y) = f64::copysign;
    ufbx_nextafter(x, y) = libm::nextafter;
    ufbx_rint(x) = f64::round_ties_even;
    ufbx_floor(x) = f64::floor;
    ufbx_ceil(x) = f64::ceil;
}

/// The smaller number; unlike `f64::min`, the same of two zeros on every target.
fn minimum(a: f64, b: f64) -> f64 {
    if a < b || b.is_nan() { a } else { b }
}

fn maximum(a: f64, b: f64) -> f64 {
    if a > b || b.is_nan() { a } else { b }
}

// SAFETY: as above.
#[unsafe(no_mangle)]
extern "C" fn ufbx_isnan(x: f64) -> c_int {
    c_int::from(x.is_nan())
}

#[cfg(target_arch = "wasm32")]
mod memory;
