//! The clicked point pairs and what each of them is for.

use super::SearchPlan;
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
    /// The roles that a search gives to pairs. One that takes no more than it needs passes its pencils through the first two
    /// and only measures those beyond; one in which each takes part passes them through two that are far enough from each
    /// other.
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

    /// Numbers of the clicks that a search cannot do without, from 0: those that pencils pass through, and the observed ones
    /// of a search that takes no more than it needs.
    pub fn indispensable(&self, plan: SearchPlan) -> Vec<usize> {
        let is_needed = |click: &Click| match click.role {
            ClickRole::Anchor => true,
            ClickRole::Observed => plan.most_clicks().is_some(),
            ClickRole::Check | ClickRole::Chosen => false,
        };
        self.0.iter().zip(0..).filter(|(click, _)| is_needed(click)).map(|(_, k)| k).collect()
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

    /// Numbers of the clicks that pencils pass through, from 1, in the order of [`Clicks::anchors`]; `None` for a match that
    /// stands in for one.
    pub fn anchor_numbers(&self) -> Vec<Option<usize>> {
        let number = |(click, number): (&Click, usize)| match click.role {
            ClickRole::Anchor => Some(Some(number)),
            ClickRole::Chosen => Some(None),
            ClickRole::Observed | ClickRole::Check => None,
        };
        self.0.iter().zip(1..).filter_map(number).collect()
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

/// Distance of the first two clicks, as a share of the largest distance between clicks, from which
/// they are the anchors. The order of clicks decides among well-separated pairs. Not measured.
const FAR_ENOUGH: f64 = 0.25;

/// Numbers of two pairs that are far from each other in both images, from 0: the first two, unless others are farther
/// apart by a multiple. An error of a click turns the lines through it and another the more, the nearer they are.
fn apart(pairs: &[PointPair]) -> [usize; 2] {
    let distance = |j: usize, k: usize| {
        let (a, b) = (&pairs[j], &pairs[k]);
        (a.point1 - b.point1).norm().min((a.point2 - b.point2).norm())
    };
    // What is no number is refused later, by its number.
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
    fn the_published_search_takes_what_its_method_needs_and_the_one_with_patches_takes_all() {
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
    fn pencils_pass_through_clicks_that_are_far_from_each_other() {
        let at = |x: f64, y: f64| PointPair::new(x, y, x + 9.0, y);
        let (published, by_patches) =
            (SearchPlan::Published { clicks: 2 }, SearchPlan::Patches { clicks: 2 });
        let anchors = |pairs: &[PointPair], plan| Clicks::for_plan(pairs, plan).anchors();
        let good = [at(10.0, 10.0), at(100.0, 10.0), at(300.0, 200.0)];
        assert_eq!(anchors(&good, by_patches), good[..2], "far enough, if not farthest");
        let near = [at(10.0, 10.0), at(11.0, 10.0), at(100.0, 10.0), at(300.0, 200.0)];
        assert_eq!(anchors(&near, by_patches), [near[0], near[3]]);
        assert_eq!(anchors(&near, published), near[..2], "as published");
        // In one image is enough.
        let merged = [good[0], PointPair { point2: good[0].point2, ..good[1] }, good[2]];
        assert_eq!(anchors(&merged, by_patches), [merged[0], merged[2]]);
        let clicks = Clicks::for_plan(&near, by_patches);
        assert_eq!(clicks.indispensable(by_patches), [0, 3]);
        let three = SearchPlan::Published { clicks: 3 };
        assert_eq!(Clicks::for_plan(&near, three).indispensable(three), [0, 1, 2]);
        assert_eq!(clicks.observed(), near, "each takes part");
    }
}
