//! The image of a disc of ink on a sheet of 40 x 24 mm, 254 dpi.
#![allow(clippy::unwrap_used, dead_code)]

use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use std::io::Cursor;

/// Size of the sheet, pixels, and of a pixel, mm: 40 x 24 mm.
pub const SHEET: (u32, u32) = (400, 240);
pub const PIXEL_MM: f64 = 0.1;
/// A disc: its center from the lower left corner and its radius, mm.
pub const DISC: (f64, f64, f64) = (13.0, 9.0, 6.0);

pub fn is_inked(x: u32, y: u32) -> bool {
    let (across, up) = (
        (f64::from(x) + 0.5) * PIXEL_MM,
        (f64::from(SHEET.1 - y) - 0.5) * PIXEL_MM,
    );
    (across - DISC.0).hypot(up - DISC.1) < DISC.2
}

/// The disc in two shades, paper uneven by 5 %.
pub fn drawn(ink: u8, paper: u8) -> GrayImage {
    GrayImage::from_fn(SHEET.0, SHEET.1, |x, y| {
        let shade = if is_inked(x, y) { ink } else { paper };
        Luma([shade.saturating_add(((x * 7 + y * 13) % 13) as u8)])
    })
}

pub fn bytes(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}
