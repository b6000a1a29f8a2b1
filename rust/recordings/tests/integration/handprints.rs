//! Images of prints: ink told from paper at every depth, scales that agree, cells where they lie, refusals in a sentence, damaged files.

use crate::folders;
use crate::inked;

use folders::Folder;
use image::{DynamicImage, GrayImage, ImageFormat, Luma, LumaA, Rgb, RgbaImage};
use inked::{DISC, PIXEL_MM, SHEET, bytes, drawn, is_inked};
use proptest::prelude::*;
use std::f64::consts::PI;
use thenar_recordings::handprint::{Handprint, Ink, PrintOptions, Scale, TOUCHED_FROM};

const OPTIONS: PrintOptions = PrintOptions {
    scale: Scale::MmPerPixel(PIXEL_MM),
    cell_mm: 1.0,
    threshold: None,
    ink: None,
    paper_px: None,
    is_mirrored: false,
};

fn read(bytes: &[u8], options: &PrintOptions) -> Result<Handprint, String> {
    let folder = Folder::new();
    folder.write("a.png", bytes);
    let read = Handprint::read(&folder.path().join("a.png"), options);
    read.map_err(|error| {
        let text = error.to_string();
        text.rsplit_once("a.png: ")
            .map_or(text.clone(), |(_, told)| told.to_string())
    })
}

fn png(image: DynamicImage, options: &PrintOptions) -> Handprint {
    read(&bytes(&image, ImageFormat::Png), options).unwrap()
}

/// Area of the disc in every format and depth, dark on light and light on dark: pi r^2, within what pixels and cells resolve.
#[test]
fn a_disc_of_ink_has_its_area_in_every_kind_of_image() {
    let dark = drawn(30, 220);
    let gray = DynamicImage::ImageLuma8(dark.clone());
    let rgba = RgbaImage::from_fn(SHEET.0, SHEET.1, |x, y| {
        let blue = if is_inked(x, y) {
            [20, 40, 160, 255]
        } else {
            [240, 235, 220, 255]
        };
        image::Rgba(blue)
    });
    let deep = image::ImageBuffer::from_fn(SHEET.0, SHEET.1, |x, y| {
        Luma([u16::from(dark.get_pixel(x, y).0[0]) * 257])
    });
    let color = image::ImageBuffer::from_fn(SHEET.0, SHEET.1, |x, y| {
        Rgb([u16::from(dark.get_pixel(x, y).0[0]) * 256; 3])
    });
    let seen = [
        ("gray", bytes(&gray, ImageFormat::Png), Ink::Dark),
        (
            "light",
            bytes(&DynamicImage::ImageLuma8(drawn(200, 20)), ImageFormat::Png),
            Ink::Light,
        ),
        (
            "rgba",
            bytes(&DynamicImage::ImageRgba8(rgba), ImageFormat::Png),
            Ink::Dark,
        ),
        (
            "16 bit",
            bytes(&DynamicImage::ImageLuma16(deep), ImageFormat::Png),
            Ink::Dark,
        ),
        (
            "16 bit color",
            bytes(&DynamicImage::ImageRgb16(color), ImageFormat::Tiff),
            Ink::Dark,
        ),
        ("tiff", bytes(&gray, ImageFormat::Tiff), Ink::Dark),
        ("jpeg", bytes(&gray, ImageFormat::Jpeg), Ink::Dark),
    ];
    let area = PI * DISC.2 * DISC.2;
    for (name, bytes, ink) in seen {
        let print = read(&bytes, &OPTIONS).unwrap();
        assert_eq!((print.cells, print.ink), ([24, 40], ink), "{name}");
        assert!(
            (print.inked_mm2 / area - 1.0).abs() < 0.005,
            "{name}: {}",
            print.inked_mm2
        );
        let touched = print.inked.iter().filter(|share| **share >= TOUCHED_FROM);
        let touched = touched.count() as f64;
        assert!((touched / area - 1.0).abs() < 0.05, "{name}: {touched}");
        let sum: f64 = print.inked.iter().sum();
        assert!((sum / area - 1.0).abs() < 0.005, "{name}: {sum}");
    }
}

/// Middle of the ink, in cells from the lower left corner.
fn center(print: &Handprint) -> [f64; 2] {
    let (mut sum, mut all) = ([0.0; 2], 0.0);
    for (k, share) in print.inked.iter().enumerate() {
        let at = [k % print.cells[1], k / print.cells[1]].map(|number| number as f64 + 0.5);
        sum = [sum[0] + share * at[0], sum[1] + share * at[1]];
        all += share;
    }
    sum.map(|s| s / all)
}

/// Rows count from the lower edge and columns from the left; an image from behind is turned about.
#[test]
fn cells_lie_where_the_ink_does() {
    let image = || DynamicImage::ImageLuma8(drawn(30, 220));
    let [x, y] = center(&png(image(), &OPTIONS));
    assert!(
        (x - DISC.0).abs() < 0.02 && (y - DISC.1).abs() < 0.02,
        "{x}, {y}"
    );
    let behind = PrintOptions {
        is_mirrored: true,
        ..OPTIONS
    };
    let [x, y] = center(&png(image(), &behind));
    assert!(
        (x - 27.0).abs() < 0.02 && (y - DISC.1).abs() < 0.02,
        "{x}, {y}"
    );
}

#[test]
fn scales_agree() {
    let (a, b) = ([10.0, 20.0], [40.0, 60.0]);
    for scale in [
        Scale::Dpi(254.0),
        Scale::MmPerPixel(0.1),
        Scale::Marks([a, b], 5.0),
    ] {
        assert!((scale.mm_per_px() - 0.1).abs() < 1e-15, "{scale:?}");
    }
}

/// What is transparent, or outside of the sheet that the user gives, is not "no ink" but nothing known.
#[test]
fn what_is_no_paper_is_not_known() {
    let drawn = drawn(30, 220);
    let torn = |until: u32| {
        let torn = image::ImageBuffer::from_fn(SHEET.0, SHEET.1, |x, y| {
            LumaA([drawn.get_pixel(x, y).0[0], if x < until { 0 } else { 255 }])
        });
        png(DynamicImage::ImageLumaA8(torn), &OPTIONS)
    };
    let known = |print: &Handprint| -> Vec<usize> {
        (0..40)
            .filter(|column| !print.inked[9 * 40 + column].is_nan())
            .collect()
    };
    // Of the eleventh column of cells six tenths are paper, then four.
    assert_eq!(known(&torn(104)), (10..40).collect::<Vec<_>>());
    assert_eq!(known(&torn(106)), (11..40).collect::<Vec<_>>());
    // On a dark table, with the sheet said.
    let table = GrayImage::from_fn(SHEET.0, SHEET.1, |x, y| match (50..300).contains(&x) {
        true => *drawn.get_pixel(x, y),
        false => Luma([10]),
    });
    let sheet = PrintOptions {
        paper_px: Some([50.0, 0.0, 300.0, 240.0]),
        ..OPTIONS
    };
    let print = png(DynamicImage::ImageLuma8(table.clone()), &sheet);
    assert_eq!((known(&print), print.ink), ((5..30).collect(), Ink::Dark));
    assert!((print.inked_mm2 / (PI * 36.0) - 1.0).abs() < 0.005 && print.warnings.is_empty());
    // Without it the user is told that the edge decides.
    let lid = GrayImage::from_fn(SHEET.0, SHEET.1, |x, y| {
        match x > 20 && x < 380 && y > 20 && y < 220 {
            true => *drawn.get_pixel(x, y),
            false => Luma([10]),
        }
    });
    let print = png(DynamicImage::ImageLuma8(lid.clone()), &OPTIONS);
    assert!(
        print.warnings[0].contains("give paper_px or ink"),
        "{:?}",
        print.warnings
    );
    let print = png(
        DynamicImage::ImageLuma8(lid),
        &PrintOptions {
            ink: Some(Ink::Dark),
            ..OPTIONS
        },
    );
    assert!(print.warnings[0].starts_with("ink lies along 100 % of the paper's edge"));
}

#[test]
fn images_that_are_no_print_are_refused() {
    let plain = bytes(&DynamicImage::ImageLuma8(drawn(200, 200)), ImageFormat::Png);
    let good = bytes(&DynamicImage::ImageLuma8(drawn(30, 220)), ImageFormat::Png);
    let with = |change: &dyn Fn(&mut PrintOptions)| {
        let mut options = OPTIONS;
        change(&mut options);
        options
    };
    for (image, options, expected) in [
        (
            &plain,
            OPTIONS,
            "no ink stands out from the paper; scan it with more contrast, or give threshold",
        ),
        (
            &b"time_s,force_n".to_vec(),
            OPTIONS,
            "it is no image that can be read; save the print as PNG, JPEG or TIFF",
        ),
        (
            &good[..good.len() / 2].to_vec(),
            OPTIONS,
            "the image is damaged or cut off; scan it or save it again",
        ),
        (
            &good,
            with(&|o| o.cell_mm = 0.2),
            "a cell of 0.200 mm is 2.0 pixels wide, and 3 are needed; scan with more dpi",
        ),
        (
            &good,
            with(&|o| o.scale = Scale::MmPerPixel(10.0)),
            "a cell of 1.000 mm is 0.1 pixels wide",
        ),
        (
            &good,
            with(&|o| o.threshold = Some(128.0)),
            "the threshold is 128; give a brightness, 0 black to 1 white",
        ),
        (
            &large(),
            with(&|o| (o.scale, o.cell_mm) = (Scale::MmPerPixel(0.1), 0.3)),
            "the image is 90 x 90 mm, 300 x 300 cells, and 65536 cells are read; check the scale",
        ),
        (
            &good,
            with(&|o| o.scale = Scale::Marks([[3.0, 4.0]; 2], 10.0)),
            "the image has no scale: its marks lie on one pixel, or their distance is none; give dpi",
        ),
        (
            &good,
            with(&|o| o.paper_px = Some([500.0, 0.0, 600.0, 100.0])),
            "no pixel of the 400 x 240 is paper; check paper_px",
        ),
    ] {
        let told = read(image, &options).unwrap_err();
        assert!(told.starts_with(expected), "{told}");
    }
    // Three pixels across a cell are enough.
    let coarse = with(&|o| (o.scale, o.cell_mm) = (Scale::MmPerPixel(1.0), 3.0));
    assert_eq!(read(&good, &coarse).unwrap().cells, [80, 134]);
}

/// 900 x 900 pixels, half of them ink.
fn large() -> Vec<u8> {
    let halves = GrayImage::from_fn(900, 900, |x, _| Luma([if x < 450 { 30 } else { 220 }]));
    bytes(&DynamicImage::ImageLuma8(halves), ImageFormat::Png)
}

/// A JPEG whose Exif says that it is to be seen upside down (Exif 2.3, tag 0x0112 = 3): cells lie where a viewer shows the ink.
#[test]
fn an_image_is_turned_as_its_camera_says() {
    let jpeg = bytes(&DynamicImage::ImageLuma8(drawn(30, 220)), ImageFormat::Jpeg);
    let tiff = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x03\0\0\0\0\0\0\0";
    let exif = [&b"Exif\0\0"[..], tiff].concat();
    let length = (exif.len() as u16 + 2).to_be_bytes();
    let turned = [&jpeg[..2], &[0xff, 0xe1], &length, &exif, &jpeg[2..]].concat();
    let [x, y] = center(&read(&turned, &OPTIONS).unwrap());
    let wanted = [40.0 - DISC.0, 24.0 - DISC.1];
    assert!((x - wanted[0]).hypot(y - wanted[1]) < 0.03, "{x}, {y}");
}

/// Brightness that is spread as the sum of two even ones has no two kinds: the best threshold explains 2/3 of its variance, as is told.
#[test]
fn ink_that_runs_into_the_paper_is_told() {
    let warned = |shade: &dyn Fn(u32, u32) -> u32| {
        let image = GrayImage::from_fn(SHEET.0, SHEET.1, |x, y| Luma([shade(x, y) as u8]));
        png(DynamicImage::ImageLuma8(image), &OPTIONS).warnings
    };
    let told = "ink and paper run into one another: the threshold explains 67 %";
    let blurred = warned(&|x, y| 60 + x % 80 + y % 80);
    assert!(blurred.iter().any(|w| w.starts_with(told)), "{blurred:?}");
    let parted = warned(&|x, y| if is_inked(x, y) { 60 } else { 140 + y % 80 });
    assert!(parted.is_empty(), "{parted:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Damaged images of all three kinds: a print whose shares are shares, or one sentence.
    #[test]
    fn damaged_images_never_panic(kind in 0usize..3, changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in prop::option::of(any::<prop::sample::Index>())) {
        let small = DynamicImage::ImageLuma8(image::imageops::thumbnail(&drawn(30, 220), 40, 24));
        let format = [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Tiff][kind];
        let mut bytes = bytes(&small, format);
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        match read(&bytes, &PrintOptions { scale: Scale::MmPerPixel(0.3), ..OPTIONS }) {
            Ok(print) => prop_assert!(print.inked.iter().all(|share| share.is_nan() || (0.0..=1.0).contains(share))),
            Err(told) => prop_assert!(told.contains("; ") && !told.contains('\n'), "{}", told),
        }
    }
}
