//! Clicked point pairs and their roles.

use super::SearchPlan;
use crate::geometry::PointPair;

/// Role of a clicked pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClickRole {
    /// Pencils pass through the pair, and the pair takes part in every fit.
    Anchor,
    /// The pair takes part in every fit, and gives κ where a search needs it.
    Observed,
    /// The pair is only measured.
    Check,
    /// Pencils pass through the pair, a match of the program that replaces a click. No fit and no
    /// verdict counts it.
    Chosen,
}

/// A clicked pair with its role.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Click {
    /// The clicked points, full-size pixels.
    pub pair: PointPair,
    /// Role of the pair.
    pub role: ClickRole,
}

/// Any number of clicks, in the order in which they were made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Clicks(Vec<Click>);

impl Clicks {
    /// Assigns the roles of a search. A search that takes a limited number of pairs anchors its
    /// pencils at the first two, and only measures the pairs beyond its limit. A search in which
    /// all pairs take part anchors its pencils at two that are far enough from each other.
    pub fn for_plan(pairs: &[PointPair], plan: SearchPlan) -> Self {
        let most = plan.most_clicks();
        let anchors = if most.is_none() { apart(pairs) } else { [0, 1] };
        let role = |k: usize| match most {
            _ if anchors.contains(&k) => ClickRole::Anchor,
            Some(most) if k >= most => ClickRole::Check,
            _ => ClickRole::Observed,
        };
        Self(pairs.iter().enumerate().map(|(k, pair)| Click { pair: *pair, role: role(k) }).collect())
    }

    /// Returns the indices of the clicks that a search cannot do without: the anchors, and the
    /// observed clicks of a search that takes a limited number.
    pub fn indispensable(&self, plan: SearchPlan) -> Vec<usize> {
        let is_needed = |click: &Click| match click.role {
            ClickRole::Anchor => true,
            ClickRole::Observed => plan.most_clicks().is_some(),
            ClickRole::Check | ClickRole::Chosen => false,
        };
        (0..self.len()).filter(|k| is_needed(&self.0[*k])).collect()
    }

    /// Returns the clicks in their order.
    pub fn iter(&self) -> impl Iterator<Item = &Click> {
        self.0.iter()
    }

    /// Returns the number of clicks.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether there are no clicks.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the clicks with two matches that replace the anchors. Clicked anchors become
    /// observed pairs.
    #[must_use]
    pub fn with_chosen(&self, chosen: [PointPair; 2]) -> Self {
        let observed = self.0.iter().map(|click| match click.role {
            ClickRole::Anchor => Click { role: ClickRole::Observed, ..*click },
            _ => *click,
        });
        let chosen = chosen.map(|pair| Click { pair, role: ClickRole::Chosen });
        Self(observed.chain(chosen).collect())
    }

    /// Returns the pairs through which pencils pass: clicks, or the matches that replace them.
    pub fn anchors(&self) -> Vec<PointPair> {
        self.with_role(|role| matches!(role, ClickRole::Anchor | ClickRole::Chosen))
    }

    /// Returns the numbers of the anchors, from 1, in the order of [`Clicks::anchors`]; `None` for
    /// a match that replaces a click.
    pub fn anchor_numbers(&self) -> Vec<Option<usize>> {
        let number = |(click, number): (&Click, usize)| match click.role {
            ClickRole::Anchor => Some(Some(number)),
            ClickRole::Chosen => Some(None),
            ClickRole::Observed | ClickRole::Check => None,
        };
        self.0.iter().zip(1..).filter_map(number).collect()
    }

    /// Returns the pairs that take part in fits: clicked anchors and observed pairs.
    pub fn observed(&self) -> Vec<PointPair> {
        self.with_role(|role| matches!(role, ClickRole::Anchor | ClickRole::Observed))
    }

    /// Returns the matches that replace clicks.
    pub fn chosen(&self) -> Vec<PointPair> {
        self.with_role(|role| role == ClickRole::Chosen)
    }

    /// Returns the observed pair that gives κ, if a search has both epipoles from two anchors.
    pub fn third(&self) -> Option<PointPair> {
        self.with_role(|role| role == ClickRole::Observed).first().copied()
    }

    fn with_role(&self, wanted: impl Fn(ClickRole) -> bool) -> Vec<PointPair> {
        self.0.iter().filter(|click| wanted(click.role)).map(|click| click.pair).collect()
    }
}

/// The first two clicks are the anchors if they are at least this far apart, as a share of the
/// largest distance between clicks. At this distance an error of a click turns a line four times as
/// far as at the largest.
const FAR_ENOUGH: f64 = 0.25;

/// Returns the indices of two pairs that are far from each other in both images: the first two, or
/// the farthest if the first two are too close. The closer two clicks are, the more their errors
/// turn the lines.
fn apart(pairs: &[PointPair]) -> [usize; 2] {
    let distance = |j: usize, k: usize| {
        let (a, b) = (&pairs[j], &pairs[k]);
        (a.point1 - b.point1).norm().min((a.point2 - b.point2).norm())
    };
    // Coordinates that are not finite are refused later, with the number of their pair.
    if pairs.len() < 3 || pairs.iter().any(|pair| !pair.is_finite()) {
        return [0, 1];
    }
    let mut farthest = [0, 1];
    for k in 0..pairs.len() {
        for j in 0..k {
            if distance(j, k) > distance(farthest[0], farthest[1]) {
                farthest = [j, k];
            }
        }
    }
    if distance(0, 1) < FAR_ENOUGH * distance(farthest[0], farthest[1]) { farthest } else { [0, 1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_search_takes_a_fixed_number_of_pairs_and_the_patch_search_all() {
        let pairs: Vec<PointPair> = (0..4).map(|k| PointPair::new(f64::from(k), 0.0, 0.0, 0.0)).collect();
        let two = Clicks::for_plan(&pairs, SearchPlan::Published { clicks: 2 });
        assert_eq!((two.len(), two.anchors(), two.observed()), (4, pairs[..2].to_vec(), pairs[..2].to_vec()));
        assert_eq!(two.third(), None);
        let three = Clicks::for_plan(&pairs, SearchPlan::Published { clicks: 3 });
        assert_eq!((three.anchors(), three.observed()), (pairs[..2].to_vec(), pairs[..3].to_vec()));
        assert_eq!(three.third(), Some(pairs[2]));
        let all = Clicks::for_plan(&pairs, SearchPlan::Patches { clicks: 2 });
        assert_eq!((all.anchors(), all.observed()), (pairs[..2].to_vec(), pairs.clone()));
        assert!(Clicks::for_plan(&[], SearchPlan::Published { clicks: 2 }).is_empty());
    }

    #[test]
    fn anchors_are_far_from_each_other() {
        let at = |x: f64, y: f64| PointPair::new(x, y, x + 9.0, y);
        let (published, by_patches) =
            (SearchPlan::Published { clicks: 2 }, SearchPlan::Patches { clicks: 2 });
        let anchors = |pairs: &[PointPair], plan| Clicks::for_plan(pairs, plan).anchors();
        let good = [at(10.0, 10.0), at(100.0, 10.0), at(300.0, 200.0)];
        assert_eq!(anchors(&good, by_patches), good[..2], "far enough, if not farthest");
        let near = [at(10.0, 10.0), at(11.0, 10.0), at(100.0, 10.0), at(300.0, 200.0)];
        assert_eq!(anchors(&near, by_patches), [near[0], near[3]]);
        assert_eq!(anchors(&near, published), near[..2], "as published");
        // Too close in one image counts.
        let merged = [good[0], PointPair { point2: good[0].point2, ..good[1] }, good[2]];
        assert_eq!(anchors(&merged, by_patches), [merged[0], merged[2]]);
        let clicks = Clicks::for_plan(&near, by_patches);
        assert_eq!(clicks.indispensable(by_patches), [0, 3]);
        let three = SearchPlan::Published { clicks: 3 };
        assert_eq!(Clicks::for_plan(&near, three).indispensable(three), [0, 1, 2]);
        assert_eq!(clicks.observed(), near, "each takes part");
    }
}
