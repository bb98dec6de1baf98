//! Geometries that follow moved clicks without a new search.

use epiline::estimate::{Estimate, Parameters, follow};
use epiline::geometry::{FundamentalMatrix, Vector, symmetric_epipolar_distance};
use nalgebra::Matrix3;

use crate::support::{both, mean_distance, paper};

#[test]
fn a_followed_geometry_stays_with_the_images_and_leaves_wrong_starts() {
    for known in both() {
        let parameters = Parameters::default();
        let found = known.estimate(&known.show_me, &parameters).unwrap();
        let rows = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 9.0);
        let wrong = Estimate::from(FundamentalMatrix::from_rank_two(rows).unwrap());
        let mut moved = known.show_me.to_vec();
        for step in [Vector::new(0.4, -0.3), Vector::new(6.0, 4.0)] {
            moved[0].point1 = known.show_me[0].point1 + step;
            let followed = follow(&known.prepared, [&found, &wrong], &moved, &parameters).unwrap();
            let error = mean_distance(followed.fundamental(), &known.scene.matches);
            // Patches are matched to a pixel at 768 px; the refinement of a search is more
            // accurate.
            assert!(error < 1.5, "{}: {error} px after {step}", known.name);
            assert!(followed.assessment.trust.is_none() && !followed.is_refined(), "it claims nothing");
            let assessment = &followed.assessment;
            assert!(followed.trace.is_none() && assessment.lines.is_none() && assessment.margin.is_none());
        }
        let lines_alone = follow(&known.prepared, [&wrong, &found], &moved, &paper()).unwrap();
        for click in &moved {
            let distance = symmetric_epipolar_distance(lines_alone.fundamental(), click);
            assert!(distance < 1e-6, "{}: a click {distance} px off", known.name);
        }
        let still = follow(&known.prepared, [&found], &known.show_me, &paper()).unwrap();
        let error = mean_distance(still.fundamental(), &known.scene.matches);
        // 0.01 and 0.18 px.
        assert!(error < 0.3, "{}: {error} px although nothing moved", known.name);
        assert!(follow(&known.prepared, [&found], &moved[..1], &parameters).is_none());
        assert!(follow(&known.prepared, [], &moved, &parameters).is_none());
    }
}
