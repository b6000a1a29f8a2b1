//! Decodes the image of a print: brightness by pixel, and which pixels are there at all.

use crate::fault::Fault;
use crate::{RecordingError, plain_file};
use image::error::{LimitError, LimitErrorKind};
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Most pixels along a side.
const LONGEST: u32 = 32_768;
/// Most memory that decoding may take, bytes.
const MOST_MEMORY: u64 = 1 << 30;
/// Most pixels: with what decoding and the copies take, 1 GiB.
const MOST_PIXELS: u64 = 80_000_000;
/// Transparency from which a pixel is none, of 65535.
const OPAQUE_FROM: u16 = 1 << 15;

/// An image as brightness.
pub struct Gray {
    /// Width and height.
    pub size: [usize; 2],
    /// Brightness, 0 to 1, row by row from the top; NaN for a pixel that is transparent.
    pub pixels: Vec<f32>,
}

/// Reads an image by what it holds, turned as a camera says it is to be seen.
///
/// # Errors
/// A file that cannot be read, is no PNG, JPEG or TIFF, is damaged, or too large.
pub fn read(file: &Path) -> Result<Gray, RecordingError> {
    let unreadable = |source| RecordingError::Unreadable {
        file: file.to_path_buf(),
        source,
    };
    // By what the file holds, whatever its name ends on.
    let reader = ImageReader::new(BufReader::new(plain_file::open(file)?.0));
    let mut reader = reader.with_guessed_format().map_err(unreadable)?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST);
    limits.max_image_height = Some(LONGEST);
    limits.max_alloc = Some(MOST_MEMORY);
    reader.limits(limits);
    let image = decode(reader).map_err(|error| fault(&error).in_file(file))?;
    Ok(gray(image))
}

fn decode(reader: ImageReader<BufReader<File>>) -> Result<DynamicImage, ImageError> {
    let mut decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(ImageError::Limits(LimitError::from_kind(
            LimitErrorKind::DimensionError,
        )));
    }
    let orientation = decoder.orientation()?;
    let mut image = DynamicImage::from_decoder(decoder)?;
    image.apply_orientation(orientation);
    Ok(image)
}

fn fault(error: &ImageError) -> Fault {
    match error {
        ImageError::Unsupported(_) => Fault::file(
            "it is no image that can be read".into(),
            "save the print as PNG, JPEG or TIFF",
        ),
        ImageError::Limits(_) => Fault::file(
            format!(
                "the image is longer than {LONGEST} pixels, has more than {MOST_PIXELS} of them, or takes more than 1 GiB"
            ),
            "save it with fewer dpi; 100 to 300 are enough",
        ),
        _ => Fault::file(
            "the image is damaged or cut off".into(),
            "scan it or save it again",
        ),
    }
}

fn gray(image: DynamicImage) -> Gray {
    let size = [image.width() as usize, image.height() as usize];
    let seen = image.into_luma_alpha16();
    let brightness = |pixel: &image::LumaA<u16>| match pixel.0 {
        [light, alpha] if alpha >= OPAQUE_FROM => f32::from(light) / f32::from(u16::MAX),
        _ => f32::NAN,
    };
    Gray {
        size,
        pixels: seen.pixels().map(brightness).collect(),
    }
}
