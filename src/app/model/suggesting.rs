//! The suggestion of a match while the second click of a pair is due.

use super::document::HalfPair;
use super::picture::Pictures;
use crate::geometry::FundamentalMatrix;
use crate::suggest::{SuggestError, Suggestions};

/// What a match is to be suggested for.
#[derive(Clone, PartialEq)]
pub struct SuggestQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The first click.
    pub half: HalfPair,
    /// The geometry, when it is known: then only the epipolar line is searched.
    pub fundamental: Option<FundamentalMatrix>,
}

/// Places that look like the first click, or why there are none.
pub type Suggested = Result<Suggestions, SuggestError>;
