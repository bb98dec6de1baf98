//! The clicked point pairs and what each of them is for.

use super::Method;
use crate::geometry::PointPair;

/// What a clicked pair is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClickRole {
    /// Pencils of lines pass through it, and it takes part in every fit.
    Anchor,
    /// It takes part in every fit, and gives κ where a search needs it.
    Observed,
    /// It is only measured.
    Check,
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
    /// The roles that a method gives to pairs: the first two are anchors, the others it needs are observed, the rest
    /// is only measured.
    pub fn for_method(pairs: &[PointPair], method: Method) -> Self {
        let role = |k: usize| match k {
            0 | 1 => ClickRole::Anchor,
            k if k < method.pairs_needed() => ClickRole::Observed,
            _ => ClickRole::Check,
        };
        Self(pairs.iter().enumerate().map(|(k, pair)| Click { pair: *pair, role: role(k) }).collect())
    }

    /// All of them.
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

    /// The pairs that pencils pass through.
    pub fn anchors(&self) -> Vec<PointPair> {
        self.with_role(|role| role == ClickRole::Anchor)
    }

    /// The pairs that take part in fits: the anchors and the observed ones.
    pub fn observed(&self) -> Vec<PointPair> {
        self.with_role(|role| role != ClickRole::Check)
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
    fn pairs_beyond_those_a_method_needs_are_only_measured() {
        let pairs: Vec<PointPair> = (0..4).map(|k| PointPair::new(f64::from(k), 0.0, 0.0, 0.0)).collect();
        let two = Clicks::for_method(&pairs, Method::TwoPoint);
        assert_eq!((two.len(), two.anchors(), two.observed()), (4, pairs[..2].to_vec(), pairs[..2].to_vec()));
        assert_eq!(two.third(), None);
        let three = Clicks::for_method(&pairs, Method::ThreePoint);
        assert_eq!((three.anchors(), three.observed()), (pairs[..2].to_vec(), pairs[..3].to_vec()));
        assert_eq!(three.third(), Some(pairs[2]));
        assert!(Clicks::for_method(&[], Method::TwoPoint).is_empty());
    }
}
