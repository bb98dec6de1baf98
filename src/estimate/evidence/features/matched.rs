//! Covariant features of two images and their matches, with or without features of slanted views.

use crate::estimate::evidence::patches::FeatureSupport;
use crate::features::{
    FeatureMatch, FeatureParameters, FeatureSet, KnownNeighbours, SIGMA_PER_SCALE, find_features,
    find_slanted_features, without_repeats,
};
use crate::image::PyramidPair;

/// Covariant features of both images and their mutual nearest neighbours.
#[derive(Debug)]
pub(in crate::estimate) struct MatchedFeatures {
    pub sets: [FeatureSet; 2],
    pub matches: Vec<FeatureMatch>,
    /// Neighbours of all features, from which the features of slanted views go on.
    neighbours: KnownNeighbours,
}

impl MatchedFeatures {
    /// Finds and matches the features of the images as they are.
    pub fn frontal(pyramids: &PyramidPair) -> Self {
        let parameters = FeatureParameters::default();
        let planes = pyramids.level(f64::INFINITY).planes;
        let (first, second) =
            rayon::join(|| find_features(planes[0], &parameters), || find_features(planes[1], &parameters));
        let sets = without_fixed([first, second], pyramids);
        let neighbours = KnownNeighbours::default().extended(&sets[0], &sets[1]);
        Self { matches: neighbours.matches(sets.each_ref()), sets, neighbours }
    }

    /// Adds the features of slanted views and matches all features.
    pub fn with_slanted(&self, pyramids: &PyramidPair) -> Self {
        let parameters = FeatureParameters::default();
        let planes = pyramids.level(f64::INFINITY).planes;
        // One image after the other, to hold the views of one image only.
        let slanted = planes.map(|plane| find_slanted_features(plane, &parameters));
        let mut sets = self.sets.clone();
        for (set, more) in sets.iter_mut().zip(without_fixed(slanted, pyramids)) {
            set.append(more);
        }
        let neighbours = self.neighbours.extended(&sets[0], &sets[1]);
        let mut matches = neighbours.matches(sets.each_ref());
        without_repeats(&mut matches, sets.each_ref());
        Self { sets, matches, neighbours }
    }

    /// Returns the weights of the matches as patch support.
    pub fn supports(&self) -> Vec<FeatureSupport> {
        let support = |m: &FeatureMatch| {
            let (a, b) = (&self.sets[0].features()[m.feature1], &self.sets[1].features()[m.feature2]);
            FeatureSupport::new(m.pair, SIGMA_PER_SCALE * a.scale, a.affine_to(b), m.ratio)
        };
        self.matches.iter().map(support).collect()
    }
}

/// Removes the features on fixed parts of the pictures, such as captions.
fn without_fixed(mut sets: [FeatureSet; 2], pyramids: &PyramidPair) -> [FeatureSet; 2] {
    if let Some(fixed) = pyramids.fixed() {
        for set in &mut sets {
            set.retain(|feature| !fixed.covers(feature.position));
        }
    }
    sets
}

#[cfg(test)]
mod tests {
    use crate::estimate::exact::ExactScene;
    use crate::features::FeatureViews;
    use crate::image::RelativeView;

    #[test]
    fn slanted_features_follow_the_frontal_ones_and_the_support_of_both_is_kept_apart() {
        let prepared = ExactScene::aside().prepared();
        let [frontal, slanted] =
            [FeatureViews::Frontal, FeatureViews::Slanted].map(|views| prepared.features(views));
        for (few, all) in frontal.sets.iter().zip(&slanted.sets) {
            assert!(all.len() > few.len() && all.features()[..few.len()] == *few.features());
        }
        assert!(slanted.matches.len() > frontal.matches.len());
        let of = |views| prepared.patches_with_features(RelativeView::UPRIGHT, views);
        assert_eq!(of(FeatureViews::Frontal).features(), Some(FeatureViews::Frontal));
        assert_eq!(of(FeatureViews::Slanted).features(), Some(FeatureViews::Slanted));
        assert_eq!(of(FeatureViews::Frontal).features(), Some(FeatureViews::Frontal), "kept or made again");
        assert_eq!(prepared.upright_patches().features(), None);
    }
}
