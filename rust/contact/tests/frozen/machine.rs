//! What the bits of a result depend on besides the input: instructions chosen at run time, and the system's elementary functions.
//!
//! The loops of `thenar-contact` are compiled for several processors and chosen when they run; those that multiply and add round
//! once where the processor can (`fma`), twice where it cannot. `exp`, `sin` and their like are the C library's, which
//! chooses by processor as well and changes from version to version: they are known by what they answer.

use std::hint::black_box;

use crate::bits::Bits;

/// The kind of this machine, in words.
pub fn kind() -> String {
    let features = features().join(" ");
    format!(
        "{} {features}, elementary functions {:016x}",
        std::env::consts::ARCH,
        elementary_functions()
    )
}

#[cfg(target_arch = "x86_64")]
fn features() -> Vec<&'static str> {
    let all = [
        ("avx2", std::arch::is_x86_feature_detected!("avx2")),
        ("fma", std::arch::is_x86_feature_detected!("fma")),
        ("avx512f", std::arch::is_x86_feature_detected!("avx512f")),
        ("avx512vl", std::arch::is_x86_feature_detected!("avx512vl")),
    ];
    let there = all.iter().filter(|(_, is_there)| *is_there);
    there.map(|(name, _)| *name).collect()
}

#[cfg(not(target_arch = "x86_64"))]
fn features() -> Vec<&'static str> {
    Vec::new()
}

/// A hash over what the functions that the library calls answer at many places.
fn elementary_functions() -> u64 {
    let mut bits = Bits::default();
    for k in 1..20_000u32 {
        let x = black_box(f64::from(k) * 7.3e-4);
        for value in [
            x.exp(),
            (-x).exp(),
            x.exp_m1(),
            x.ln(),
            x.log10(),
            x.powf(1.37),
            x.powf(-0.62),
            x.cbrt(),
            x.sin(),
            x.cos(),
            x.tanh(),
            x.atan2(1.9),
            x.hypot(2.1),
            (x / 15.0).asin(),
        ] {
            bits.number(value);
        }
    }
    bits.hash()
}
