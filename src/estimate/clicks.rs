//! The clicked point pairs and what each of them is for.

use super::{Method, Search};
use crate::geometry::PointPair;

/// What a clicked pair is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClickRole {
    /// A pair that pencils of lines pass through, and that takes part in every fit.
    Anchor,
    /// A pair that takes part in every fit, and gives κ where a search needs it.
    Observed,
    /// A pair that is only measured.
    Check,
    /// A match of the program's own that pencils pass through, for want of clicks; no fit and no verdict counts it.
    Chosen,
}

/// A clicked pair, full-size pixels, and its role.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Click {
    /// Where the scene point is seen.
    pub pair: PointPair,
    /// What it is for.
    pub role: ClickRole,
}

/// Any number of clicks in the order they were made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Clicks(Vec<Click>);

impl Clicks {
    /// The roles that a search gives to pairs: the first two are anchors. The published search takes as many more as its
    /// method needs and only measures the rest; the one with patches uses all of them.
    pub fn for_search(pairs: &[PointPair], method: Method, search: Search) -> Self {
        let role = |k: usize| match (k, search) {
            (0 | 1, _) => ClickRole::Anchor,
            (_, Search::Patches) => ClickRole::Observed,
            (k, Search::Lines) if k < method.pairs_needed() => ClickRole::Observed,
            (_, Search::Lines) => ClickRole::Check,
        };
        Self(pairs.iter().enumerate().map(|(k, pair)| Click { pair: *pair, role: role(k) }).collect())
    }

    /// The clicks in their order.
    pub fn iter(&self) -> impl Iterator<Item = &Click> {
        self.0.iter()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The same clicks, with two matches that stand in for anchors: a clicked anchor becomes an observed pair.
    #[must_use]
    pub fn with_chosen(&self, chosen: [PointPair; 2]) -> Self {
        let observed = self.0.iter().map(|click| match click.role {
            ClickRole::Anchor => Click { role: ClickRole::Observed, ..*click },
            _ => *click,
        });
        let chosen = chosen.map(|pair| Click { pair, role: ClickRole::Chosen });
        Self(observed.chain(chosen).collect())
    }

    /// The pairs that pencils pass through: clicked ones, or those that stand in for them.
    pub fn anchors(&self) -> Vec<PointPair> {
        self.with_role(|role| matches!(role, ClickRole::Anchor | ClickRole::Chosen))
    }

    /// The pairs that take part in fits: the clicked anchors and the observed ones.
    pub fn observed(&self) -> Vec<PointPair> {
        self.with_role(|role| matches!(role, ClickRole::Anchor | ClickRole::Observed))
    }

    /// The matches that stand in for clicks.
    pub fn chosen(&self) -> Vec<PointPair> {
        self.with_role(|role| role == ClickRole::Chosen)
    }

    /// The observed pair that gives κ to a search which has both epipoles from two anchors.
    pub fn third(&self) -> Option<PointPair> {
        self.with_role(|role| role == ClickRole::Observed).first().copied()
    }

    fn with_role(&self, wanted: impl Fn(ClickRole) -> bool) -> Vec<PointPair> {
        self.0.iter().filter(|click| wanted(click.role)).map(|click| click.pair).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_search_takes_what_its_method_needs_and_the_one_with_patches_takes_all() {
        let pairs: Vec<PointPair> = (0..4).map(|k| PointPair::new(f64::from(k), 0.0, 0.0, 0.0)).collect();
        let two = Clicks::for_search(&pairs, Method::TwoPoint, Search::Lines);
        assert_eq!((two.len(), two.anchors(), two.observed()), (4, pairs[..2].to_vec(), pairs[..2].to_vec()));
        assert_eq!(two.third(), None);
        let three = Clicks::for_search(&pairs, Method::ThreePoint, Search::Lines);
        assert_eq!((three.anchors(), three.observed()), (pairs[..2].to_vec(), pairs[..3].to_vec()));
        assert_eq!(three.third(), Some(pairs[2]));
        let all = Clicks::for_search(&pairs, Method::TwoPoint, Search::Patches);
        assert_eq!((all.anchors(), all.observed()), (pairs[..2].to_vec(), pairs.clone()));
        assert!(Clicks::for_search(&[], Method::TwoPoint, Search::Lines).is_empty());
    }
}
