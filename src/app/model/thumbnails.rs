//! Small pictures of the views of the open folder.

use std::collections::HashMap;
use std::sync::Arc;

use super::picture::Overview;
use crate::io::PictureFolder;

/// Longest side of a small picture, px.
pub const SIDE: u32 = 160;
/// Maximum number of kept pictures, about 20 MB.
const KEPT: usize = 256;

#[derive(Debug, Clone)]
pub struct ThumbnailQuestion {
    pub folder: Arc<PictureFolder>,
    pub views: Vec<usize>,
}

/// A finished picture, with folder and view; `None` for an unreadable image.
pub type MadeThumbnail = (Arc<PictureFolder>, usize, Option<Arc<Overview>>);

/// The finished small pictures.
#[derive(Debug, Clone, Default)]
pub struct Thumbnails {
    folder: Option<Arc<PictureFolder>>,
    made: HashMap<usize, Option<Arc<Overview>>>,
    /// Numbers of the views in the order of their pictures.
    order: Vec<usize>,
}

impl Thumbnails {
    /// Starts over when another folder is open.
    pub fn follow(&mut self, folder: Option<&Arc<PictureFolder>>) {
        if self.folder.as_ref().map(Arc::as_ptr) != folder.map(Arc::as_ptr) {
            *self = Self { folder: folder.cloned(), ..Self::default() };
        }
    }

    /// Adds a finished picture.
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

    /// Returns the picture of a view: `None` while it is missing, `Some(None)` for an unreadable
    /// image.
    pub fn of(&self, view: usize) -> Option<Option<&Arc<Overview>>> {
        self.made.get(&view).map(Option::as_ref)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Picture;

    fn made(folder: &Arc<PictureFolder>, view: usize) -> MadeThumbnail {
        let pixels = image::DynamicImage::new_luma8(1000, 10);
        let picture = Picture::from_pixels("a".into(), None, pixels).unwrap();
        (Arc::clone(folder), view, Some(Arc::new(Overview::within(&picture, SIDE))))
    }

    #[test]
    fn pictures_are_small_few_and_of_one_folder() {
        let files = tempfile::tempdir().unwrap();
        for name in ["a.png", "b.png"] {
            std::fs::write(files.path().join(name), "").unwrap();
        }
        let folder = || Arc::new(PictureFolder::open(files.path()).unwrap());
        let (one, other) = (folder(), folder());
        let mut thumbnails = Thumbnails::default();
        thumbnails.follow(Some(&one));
        for view in 0..2 * KEPT {
            thumbnails.take(made(&one, view));
        }
        assert_eq!(thumbnails.made.len(), KEPT);
        assert!(thumbnails.of(0).is_none());
        let kept = thumbnails.of(2 * KEPT - 1).unwrap().unwrap();
        assert_eq!((kept.size, kept.pixels.len()), ([160, 2], 1280));
        thumbnails.follow(Some(&other));
        thumbnails.take(made(&one, 3));
        assert!(thumbnails.of(3).is_none(), "its folder is no longer open");
    }
}
