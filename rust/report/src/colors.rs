//! Colors of figures, safe for color-blind eyes and for print.

/// Points of what was read.
pub const MEASURED: &str = "#222222";
/// Simulation at the estimates; blue of Okabe & Ito 2008.
pub const SIMULATED: &str = "#0072b2";
/// Simulation with the parameters at which the fit began.
pub const BEFORE: &str = "#9aa5ad";
/// What stands out; vermillion of Okabe & Ito 2008.
pub const STANDS_OUT: &str = "#d55e00";
/// What does not.
pub const QUIET: &str = "#a9bccb";
/// Apart, load, hold, unload, slide: gray, and blue, orange, green and purple of Okabe & Ito 2008.
pub const PHASES: [&str; 5] = ["#888888", "#0072b2", "#e69f00", "#009e73", "#cc79a7"];

/// Viridis at 17 even places (van der Walt & Smith 2015, CC0).
const VIRIDIS: [u32; 17] = [
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c,
    0x1fa088, 0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
];
/// RdBu of ColorBrewer (Brewer 2003), from blue over white to red.
const BLUE_RED: [u32; 11] = [
    0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d,
    0xb2182b, 0x67001f,
];

/// Viridis at a share of its range.
pub fn viridis(share: f64) -> String {
    hex(between(&VIRIDIS, share))
}

/// Blue at -1, white at 0, red at 1.
pub fn diverging(share: f64) -> String {
    hex(between(&BLUE_RED, 0.5 + 0.5 * share))
}

fn between(stops: &[u32], share: f64) -> [f64; 3] {
    let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let low = (place as usize).min(stops.len() - 2);
    let part = place - low as f64;
    let channel = |stop: u32, shift: u32| f64::from((stop >> shift) & 255);
    [16, 8, 0].map(|shift| {
        channel(stops[low], shift) * (1.0 - part) + channel(stops[low + 1], shift) * part
    })
}

fn hex(color: [f64; 3]) -> String {
    let [red, green, blue] = color.map(|part| part.round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_run_from_end_to_end() {
        assert_eq!(viridis(-1.0), "#440154");
        assert_eq!(viridis(1.0), "#fde725");
        assert_eq!(diverging(0.0), "#f7f7f7");
        assert_eq!(diverging(-1.0), "#053061");
        assert_eq!(diverging(f64::from(7)), "#67001f");
    }

    /// Relative luminance (WCAG) grows along viridis, and falls from white to both ends of the diverging map.
    #[test]
    fn lightness_is_in_order() {
        let luminance = |color: String| {
            let linear = |at: usize| {
                let part =
                    f64::from(u8::from_str_radix(&color[at..at + 2], 16).expect("hex")) / 255.0;
                if part <= 0.04045 {
                    part / 12.92
                } else {
                    ((part + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * linear(1) + 0.7152 * linear(3) + 0.0722 * linear(5)
        };
        for k in 0..50 {
            let (low, high) = (f64::from(k) / 50.0, f64::from(k + 1) / 50.0);
            assert!(luminance(viridis(low)) < luminance(viridis(high)));
            assert!(luminance(diverging(low)) > luminance(diverging(high)));
            assert!(luminance(diverging(-low)) > luminance(diverging(-high)));
        }
    }
}
