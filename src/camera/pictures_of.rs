//! The pictures that the coordinates of a geometry belong to.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::view_pair::ViewPair;

/// The pictures that the coordinates of a geometry belong to. With a lens, `F`, maps and matches hold
/// between views without distortion, and are some pixels off in the pictures themselves. Everything that
/// leaves the program therefore names its pictures.
#[derive(Debug, Clone, PartialEq)]
pub enum PicturesOf {
    /// A file of another program does not tell.
    Untold,
    /// The pictures as they are.
    Original,
    /// Views without distortion; `None` if a file does not describe them.
    Undistorted(Option<Box<ViewPair>>),
}

impl From<Option<&ViewPair>> for PicturesOf {
    /// Returns the pictures of a computation on these views, or on the pictures without any.
    fn from(views: Option<&ViewPair>) -> Self {
        match views.filter(|views| views.is_undistorted()) {
            Some(views) => Self::Undistorted(Some(Box::new(*views))),
            None => Self::Original,
        }
    }
}

impl PicturesOf {
    /// Name of views without distortion in files.
    pub const UNDISTORTED: &'static str = "undistorted";
    /// Name of the pictures as they are in files.
    pub const ORIGINAL: &'static str = "original";

    /// Returns the name in files; `None` if it is not known.
    pub fn name(&self) -> Option<&'static str> {
        match self {
            Self::Untold => None,
            Self::Original => Some(Self::ORIGINAL),
            Self::Undistorted(_) => Some(Self::UNDISTORTED),
        }
    }

    /// Returns whether the coordinates belong to views without distortion.
    pub fn is_undistorted(&self) -> bool {
        matches!(self, Self::Undistorted(_))
    }

    /// Returns the views without distortion, if they are known.
    pub fn views(&self) -> Option<&ViewPair> {
        match self {
            Self::Undistorted(views) => views.as_deref(),
            Self::Untold | Self::Original => None,
        }
    }
}

impl Serialize for PicturesOf {
    /// Writes the fields `pictures` and `views`, to be flattened into an object. Unknown ones are left out.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut state = serializer.serialize_struct("PicturesOf", 2)?;
        if let Some(name) = self.name() {
            state.serialize_field("pictures", name)?;
        }
        if let Some(views) = self.views() {
            state.serialize_field("views", &views.views)?;
        }
        state.end()
    }
}
