//! An open picture: its pixels, a reduced copy for the screen, and its sequence if it is a first
//! frame.

use std::borrow::Cow;
use std::sync::Arc;

use image::DynamicImage;

use super::recording::Recording;
use super::shared::Shared;
use crate::camera::{FocalLength, UndistortedView};
use crate::geometry::Point;
use crate::image::Picture;
use crate::io::{focal_length_from_exif, sha256_of};
use crate::study::{assumed_camera, undistorted};

pub type Pictures = [Shared<Picture>; 2];

/// Longest side of an overview, px. All supported graphics systems allow textures of this size.
const OVERVIEW_SIDE: u32 = 2048;

/// A picture, ready for the screen.
#[derive(Debug, Clone)]
pub struct Opened {
    /// Pixels and grey plane.
    pub picture: Shared<Picture>,
    /// A reduced copy for the screen.
    pub overview: Arc<Overview>,
    /// SHA-256 of the file, hexadecimal; `None` without a file.
    pub sha256: Option<String>,
    /// Focal length guessed from the EXIF data of the file.
    pub focal_guess: Option<FocalLength>,
    /// The sequence of which this is the first frame.
    pub recording: Option<Shared<Recording>>,
    /// The calibrated camera, if a calibration was given. `picture` is then the view without
    /// distortion, and so are all coordinates of the window.
    pub lens: Option<Arc<LensPicture>>,
}

/// A picture with the distortion of its lens, as it is shown.
#[derive(Debug)]
pub struct LensPicture {
    pub original: Shared<Picture>,
    pub view: UndistortedView,
}

impl Opened {
    /// Prepares a picture for the screen. This takes a while.
    pub fn new(picture: Picture) -> Self {
        let overview = Arc::new(Overview::new(&picture));
        let sha256 = picture.path.as_deref().and_then(|path| sha256_of(path).ok());
        let frame = picture.frame();
        let focal_guess = picture.path.as_deref().and_then(|path| focal_length_from_exif(path, frame));
        Self { picture: Shared::new(picture), overview, sha256, focal_guess, recording: None, lens: None }
    }

    /// Prepares a picture of a calibrated camera, which is shown as it is and computed on in its view without
    /// distortion. This takes a while.
    #[must_use]
    pub fn drawn_in(self, view: UndistortedView) -> Self {
        let original = self.picture;
        let picture = undistorted(&view, &original.clone().into()).into();
        Self { picture, lens: Some(Arc::new(LensPicture { original, view })), ..self }
    }

    /// Returns the picture with a focal length. All coordinates stay. `None` for an impossible focal length,
    /// and where a calibration tells another one.
    #[must_use]
    pub fn with_focal_length(self, focal: FocalLength) -> Option<Self> {
        let Some(lens) = &self.lens else {
            let frame = self.picture.frame();
            let camera = assumed_camera(None, Some(focal), frame)?;
            return Some(self.drawn_in(UndistortedView::new(&camera, frame)?));
        };
        let (original, view) = (lens.original.clone(), lens.view.with_focal_length(focal)?);
        Some(Self { lens: Some(Arc::new(LensPicture { original, view })), ..self })
    }

    /// Returns the picture of the camera without its calibration.
    #[must_use]
    pub fn without_calibration(self) -> Self {
        let picture = self.shown().clone();
        Self { picture, lens: None, ..self }
    }

    pub fn shown(&self) -> &Shared<Picture> {
        self.lens.as_ref().map_or(&self.picture, |lens| &lens.original)
    }

    /// Returns the view without distortion, if the picture on the screen is distorted.
    pub fn distortion(&self) -> Option<&UndistortedView> {
        self.lens.as_ref().map(|lens| &lens.view).filter(|view| !view.is_original())
    }

    /// Returns the place on the screen's picture of a point of the window's coordinates.
    pub fn pixel(&self, point: Point) -> Option<Point> {
        self.distortion().map_or(Some(point), |view| view.original_from_undistorted(point))
    }

    /// Returns the point in the window's coordinates of a place on the screen's picture.
    pub fn point(&self, pixel: Point) -> Option<Point> {
        self.distortion().map_or(Some(pixel), |view| view.undistorted_from_original(pixel))
    }

    /// Prepares the first frame of a sequence for the screen. This takes a while.
    pub fn recorded(first: Picture, recording: Recording) -> Self {
        Self { recording: Some(Shared::new(recording)), ..Self::new(first) }
    }
}

/// A reduced copy of a picture. Making it takes a while, so a task does it.
#[derive(Debug)]
pub struct Overview {
    /// Width and height, px.
    pub size: [usize; 2],
    /// Red, green, blue and alpha of each pixel, with premultiplied colours.
    pub pixels: Vec<u8>,
    /// Overview pixels per picture pixel; 1 for small pictures.
    pub scale: f64,
    /// The reduced picture in the depth of the file, as it is shown; `None` if it is not reduced.
    pub reduced: Option<DynamicImage>,
}

impl Overview {
    /// Reduces a picture to the size of a texture.
    pub fn new(picture: &Picture) -> Self {
        let whole = &picture.pixels;
        let scale = (f64::from(OVERVIEW_SIDE) / f64::from(whole.width().max(whole.height()))).min(1.0);
        let reduced = |v: u32| ((f64::from(v) * scale).round() as u32).clamp(1, OVERVIEW_SIDE);
        let reduced =
            (scale < 1.0).then(|| whole.thumbnail_exact(reduced(whole.width()), reduced(whole.height())));
        let reduced = reduced.map(|reduced| picture.displayed(&reduced).into_owned());
        let pixels = reduced.as_ref().map_or_else(|| picture.displayed(whole), Cow::Borrowed);
        let size = [pixels.width(), pixels.height()].map(|v| v as usize);
        let pixels = multiplied(&pixels);
        Self { size, pixels, scale, reduced }
    }
}

/// Returns the pixels with colours premultiplied by alpha.
pub fn multiplied(pixels: &DynamicImage) -> Vec<u8> {
    let mut bytes = pixels.to_rgba8().into_raw();
    if pixels.color().has_alpha() {
        for [colors @ .., alpha] in bytes.as_chunks_mut::<4>().0 {
            let share = u32::from(*alpha);
            for color in colors.iter_mut().filter(|_| share < 255) {
                *color = ((u32::from(*color) * share + 127) / 255) as u8;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overview(width: u32, height: u32) -> Overview {
        Overview::new(
            &Picture::from_pixels("test".into(), None, DynamicImage::new_luma8(width, height)).unwrap(),
        )
    }

    #[test]
    fn overviews_fit_a_texture_and_small_pictures_are_not_reduced() {
        assert_eq!(overview(1, 1).size, [1, 1]);
        assert_eq!(overview(2048, 3).size, [2048, 3]);
        assert_eq!(overview(12_000, 200).size, [2048, 34]);
        assert_eq!(overview(1, 9_000).size, [1, 2048]);
    }

    #[test]
    fn transparent_pixels_have_no_colour() {
        let pixels =
            image::RgbaImage::from_raw(3, 1, vec![200, 100, 50, 0, 200, 100, 50, 255, 200, 100, 50, 51]);
        let bytes = multiplied(&pixels.unwrap().into());
        assert_eq!(bytes, [0, 0, 0, 0, 200, 100, 50, 255, 40, 20, 10, 51]);
    }
}
