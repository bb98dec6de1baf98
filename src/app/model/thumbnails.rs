//! Small pictures of the views of the folder that is open.

use std::collections::HashMap;
use std::sync::Arc;

use super::pair_folder::PairFolder;
use super::picture::multiplied;
use crate::image::Picture;

/// Longest side of a small picture, px.
const SIDE: u32 = 160;
/// Small pictures that are kept: about 20 MB.
const KEPT: usize = 256;

/// One view, small.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Thumbnail {
    /// Width and height, px.
    pub size: [usize; 2],
    /// Red, green, blue and alpha of each pixel, the colours multiplied by alpha.
    pub pixels: Vec<u8>,
}

impl Thumbnail {
    /// Reduces a picture.
    pub fn new(picture: &Picture) -> Self {
        let pixels = &picture.pixels;
        let longer = pixels.width().max(pixels.height());
        let reduced = |v: u32| (u64::from(v) * u64::from(SIDE) / u64::from(longer)).max(1) as u32;
        let small = match longer {
            0..=SIDE => multiplied(pixels),
            _ => multiplied(&pixels.thumbnail_exact(reduced(pixels.width()), reduced(pixels.height()))),
        };
        let size =
            [pixels.width(), pixels.height()].map(|v| if longer <= SIDE { v } else { reduced(v) } as usize);
        Self { size, pixels: small }
    }
}

/// Which small pictures are wanted.
#[derive(Debug, Clone)]
pub struct ThumbnailQuestion {
    /// The folder.
    pub folder: Arc<PairFolder>,
    /// Views of the folder, by their numbers.
    pub views: Vec<usize>,
}

/// One that was made; `None` where the image cannot be read.
pub type MadeThumbnail = (Arc<PairFolder>, usize, Option<Arc<Thumbnail>>);

/// Small pictures that have been made.
#[derive(Debug, Clone, Default)]
pub struct Thumbnails {
    folder: Option<Arc<PairFolder>>,
    made: HashMap<usize, Option<Arc<Thumbnail>>>,
    /// Numbers of the views in the order in which they were made.
    order: Vec<usize>,
}

impl Thumbnails {
    /// Begins anew where another folder is open.
    pub fn follow(&mut self, folder: Option<&Arc<PairFolder>>) {
        let same = match (&self.folder, folder) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (None, None) => true,
            _ => false,
        };
        if !same {
            *self = Self { folder: folder.cloned(), ..Self::default() };
        }
    }

    /// Takes in one that was made.
    pub fn take(&mut self, (folder, view, thumbnail): MadeThumbnail) {
        if !self.folder.as_ref().is_some_and(|own| Arc::ptr_eq(own, &folder)) {
            return;
        }
        if self.made.insert(view, thumbnail).is_none() {
            self.order.push(view);
        }
        if self.order.len() > KEPT {
            self.made.remove(&self.order.remove(0));
        }
    }

    /// That of a view: `None` while it has not been made, `Some(None)` where its image cannot be read.
    pub fn of(&self, view: usize) -> Option<Option<&Arc<Thumbnail>>> {
        self.made.get(&view).map(Option::as_ref)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(folder: &Arc<PairFolder>, view: usize) -> MadeThumbnail {
        let pixels = image::DynamicImage::new_luma8(1000, 10);
        let picture = Picture::from_pixels("a".into(), None, pixels).unwrap();
        (Arc::clone(folder), view, Some(Arc::new(Thumbnail::new(&picture))))
    }

    #[test]
    fn they_are_small_few_and_of_one_folder() {
        let files = tempfile::tempdir().unwrap();
        for name in ["a.png", "b.png"] {
            std::fs::write(files.path().join(name), "").unwrap();
        }
        let folder = || Arc::new(PairFolder::open(files.path()).unwrap());
        let (one, other) = (folder(), folder());
        let mut thumbnails = Thumbnails::default();
        thumbnails.follow(Some(&one));
        for view in 0..2 * KEPT {
            thumbnails.take(made(&one, view));
        }
        assert_eq!(thumbnails.made.len(), KEPT);
        assert!(thumbnails.of(0).is_none());
        let kept = thumbnails.of(2 * KEPT - 1).unwrap().unwrap();
        assert_eq!((kept.size, kept.pixels.len()), ([160, 1], 640));
        thumbnails.follow(Some(&other));
        thumbnails.take(made(&one, 3));
        assert!(thumbnails.of(3).is_none(), "of a folder that is not open any more");
    }
}
