//! Words for the origin of a geometry.

use crate::estimate::{Origin, ProposedBy, Resampling};

/// Describes from what a geometry was proposed, after "proposed by".
pub fn origin_in_words(origin: &Origin) -> String {
    let first = proposer_in_words(origin.source);
    match origin.then {
        None => first,
        Some(then) => format!("{first}, then by {}", resampling_in_words(then)),
    }
}

/// Names the data of a first proposal in a few words, after "proposed by".
pub fn proposer_in_words(source: ProposedBy) -> String {
    match source {
        ProposedBy::LinePairs { ranks: [p, q] } => format!("candidates {p} and {q}"),
        ProposedBy::Features => "matches of features".into(),
        ProposedBy::KnownCameras => "features, known cameras".into(),
        ProposedBy::GivenMatches => "the given matches".into(),
        ProposedBy::AllLines => "lines of the pictures".into(),
        ProposedBy::Clicks => "the clicks alone".into(),
    }
}

/// Describes the sampling that led from a first proposal to a geometry, after "by".
pub fn resampling_in_words(resampling: Resampling) -> &'static str {
    match resampling {
        Resampling::SupportingMatches => "samples of its matches",
        Resampling::Parallax => "parallax beside its plane",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_told_from_its_beginning() {
        let origin = Origin::from(ProposedBy::LinePairs { ranks: [6, 8] });
        assert_eq!(origin_in_words(&origin), "candidates 6 and 8");
        let then = Origin { then: Some(Resampling::Parallax), ..ProposedBy::Features.into() };
        assert_eq!(origin_in_words(&then), "matches of features, then by parallax beside its plane");
    }
}
