//! Choice of the search, made only here: by line measure, method, ranking evidence and number of
//! clicks.

use super::{Method, Parameters, Search};
use crate::similarity::LineMeasure;

/// Search with the number of pairs it needs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SearchPlan {
    /// Lines through two clicks propose, and lines over both images rank, as published. A third click can
    /// give κ. The search takes `clicks` pairs.
    Published { clicks: usize },
    /// Lines through two clicks propose, and patches rank. Where doubts remain, features and the views they
    /// suggest propose too. The search is refused with fewer than `clicks` pairs.
    Patches { clicks: usize },
    /// Features propose, and two of their matches replace the clicks.
    #[default]
    Unclicked,
    /// All lines of both images propose.
    LinesAlone { ranked_by: Search },
    /// Motion barcodes of lines propose and refine.
    Barcodes,
}

impl SearchPlan {
    /// Returns the search that the parameters choose for this number of pairs.
    pub fn of(parameters: &Parameters, pairs: usize) -> Self {
        let Parameters { method, search, .. } = *parameters;
        let clicks = method.pairs_needed();
        match (parameters.similarity.measure, method, search) {
            (LineMeasure::Barcodes, ..) => Self::Barcodes,
            (_, Method::LinesAlone, ranked_by) => Self::LinesAlone { ranked_by },
            (_, _, Search::Lines) => Self::Published { clicks },
            (_, Method::TwoPoint, Search::Patches) if pairs < clicks => Self::Unclicked,
            (_, _, Search::Patches) => Self::Patches { clicks },
        }
    }

    /// Returns the number of pairs without which the search is refused.
    pub fn least_clicks(self) -> usize {
        match self {
            Self::Published { clicks } | Self::Patches { clicks } => clicks,
            Self::Unclicked | Self::LinesAlone { .. } | Self::Barcodes => 0,
        }
    }

    /// Returns the largest number of pairs that the search takes, the first ones. Returns `None` if
    /// all pairs take part.
    pub fn most_clicks(self) -> Option<usize> {
        match self {
            Self::Published { clicks } => Some(clicks),
            Self::LinesAlone { ranked_by: Search::Lines } => Some(0),
            Self::LinesAlone { ranked_by: Search::Patches }
            | Self::Patches { .. }
            | Self::Unclicked
            | Self::Barcodes => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::*;

    #[test]
    fn parameters_and_clicks_determine_the_search() {
        let plan = |preset, method, measure, pairs| {
            let mut parameters = Parameters { method, ..Parameters::from(preset) };
            parameters.similarity.measure = measure;
            SearchPlan::of(&parameters, pairs)
        };
        let of_pictures = |preset, method, pairs| plan(preset, method, LineMeasure::Stereo, pairs);
        for pairs in 0..4 {
            for (method, clicks) in [(Method::TwoPoint, 2), (Method::ThreePoint, 3)] {
                assert_eq!(of_pictures(Preset::Paper, method, pairs), SearchPlan::Published { clicks });
            }
            let unclicked = of_pictures(Preset::Robust, Method::TwoPoint, pairs);
            assert_eq!(
                unclicked,
                if pairs < 2 { SearchPlan::Unclicked } else { SearchPlan::Patches { clicks: 2 } }
            );
            // If three pairs are asked for, none is not enough.
            let three = of_pictures(Preset::Robust, Method::ThreePoint, pairs);
            assert_eq!(three, SearchPlan::Patches { clicks: 3 });
            for (preset, ranked_by) in [(Preset::Paper, Search::Lines), (Preset::Robust, Search::Patches)] {
                let alone = of_pictures(preset, Method::LinesAlone, pairs);
                assert_eq!(alone, SearchPlan::LinesAlone { ranked_by });
                for method in Method::ALL {
                    assert_eq!(plan(preset, method, LineMeasure::Barcodes, pairs), SearchPlan::Barcodes);
                }
            }
        }
    }

    #[test]
    fn only_the_published_searches_ignore_clicks() {
        let taken = |plan: SearchPlan| (plan.least_clicks(), plan.most_clicks());
        assert_eq!(taken(SearchPlan::Published { clicks: 3 }), (3, Some(3)));
        assert_eq!(taken(SearchPlan::Patches { clicks: 2 }), (2, None));
        assert_eq!(taken(SearchPlan::LinesAlone { ranked_by: Search::Lines }), (0, Some(0)));
        for plan in [
            SearchPlan::Unclicked,
            SearchPlan::Barcodes,
            SearchPlan::LinesAlone { ranked_by: Search::Patches },
        ] {
            assert_eq!(taken(plan), (0, None));
        }
    }
}
