//! The built-in pairs, stored as pictures with their exact geometry.

use nalgebra::Matrix3x4;
use serde::{Deserialize, Serialize};

use crate::geometry::{Camera, Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;

named! {
    fn name;
    /// A built-in image pair.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Sample {
        /// A sideways motion, with both epipoles far outside the image.
        #[default]
        Courtyard = "courtyard",
        /// A forward motion, with both epipoles inside the image.
        Alley = "alley",
    }
}

/// A built-in pair with its ground truth.
#[derive(Debug, Clone)]
pub struct SamplePair {
    /// The two pictures.
    pub pictures: [Picture; 2],
    /// Exact fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Cameras of the two pictures.
    pub cameras: [Camera; 2],
    /// Exact matches at corners, most distinctive first.
    pub matches: Vec<PointPair>,
    /// Two matches suitable as first clicks.
    pub show_me: [PointPair; 2],
    /// A match suitable as third click.
    pub third: PointPair,
    /// Title for display.
    pub title: String,
    /// Description in one sentence.
    pub description: String,
}

/// The ground-truth file of a built-in pair. Points are rows `x1 y1 x2 y2`, px.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SampleFile {
    /// Name on the command line.
    pub name: String,
    /// Title for display.
    pub title: String,
    /// Description in one sentence.
    pub description: String,
    /// Fundamental matrix `F` as nested rows.
    pub fundamental: FundamentalMatrix,
    /// Projection matrix `P1` as nested rows.
    pub camera1: [[f64; 4]; 3],
    /// Projection matrix `P2` as nested rows.
    pub camera2: [[f64; 4]; 3],
    /// Exact matches at corners.
    pub matches: Vec<[f64; 4]>,
    /// Two matches suitable as first clicks.
    pub show_me: [[f64; 4]; 2],
    /// A match suitable as third click.
    pub third: [f64; 4],
}

/// Size of the built-in pictures.
pub const SAMPLE_FRAME: Frame = Frame { width: 768, height: 576 };

impl Sample {
    /// Returns the sample of the given name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// Decodes the pictures and their ground truth.
    ///
    /// # Panics
    /// Panics if the embedded files are damaged. A test loads each of them.
    pub fn load(self) -> SamplePair {
        let (first, second, description) = self.files();
        let picture = |which: usize, bytes: &[u8]| {
            Picture::from_bytes(&format!("{}-{which}.png", self.name()), bytes)
                .expect("an embedded sample picture is a valid PNG file")
        };
        let file: SampleFile =
            serde_json::from_str(description).expect("an embedded sample description is valid JSON");
        let camera = |rows: &[[f64; 4]; 3]| {
            Camera::from_matrix(Matrix3x4::from_fn(|r, c| rows[r][c]))
                .expect("the cameras of an embedded sample have rank 3")
        };
        SamplePair {
            pictures: [picture(1, first), picture(2, second)],
            fundamental: file.fundamental,
            cameras: [camera(&file.camera1), camera(&file.camera2)],
            matches: file.matches.iter().map(pair).collect(),
            show_me: [pair(&file.show_me[0]), pair(&file.show_me[1])],
            third: pair(&file.third),
            title: file.title,
            description: file.description,
        }
    }

    fn files(self) -> (&'static [u8], &'static [u8], &'static str) {
        macro_rules! files {
            ($name:literal) => {
                (
                    include_bytes!(concat!("../../assets/", $name, "-1.png")),
                    include_bytes!(concat!("../../assets/", $name, "-2.png")),
                    include_str!(concat!("../../assets/", $name, ".json")),
                )
            };
        }
        match self {
            Self::Courtyard => files!("courtyard"),
            Self::Alley => files!("alley"),
        }
    }
}

fn pair(row: &[f64; 4]) -> PointPair {
    PointPair::new(row[0], row[1], row[2], row[3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{finite_point, symmetric_epipolar_distance};

    #[test]
    fn names_lead_back() {
        for sample in Sample::ALL {
            assert_eq!(Sample::from_name(sample.name()), Some(sample));
        }
        assert_eq!(Sample::from_name("no such sample"), None);
        assert_eq!(Sample::default(), Sample::ALL[0]);
    }

    #[test]
    fn files_are_exact_and_agree_with_each_other() {
        for sample in Sample::ALL {
            let s = sample.load();
            assert_eq!([s.pictures[0].frame(), s.pictures[1].frame()], [SAMPLE_FRAME; 2]);
            let f = Camera::fundamental(&s.cameras[0], &s.cameras[1]).unwrap();
            assert!((f.matrix() - s.fundamental.matrix()).norm() < 1e-9);
            assert!(s.matches.len() >= 30);
            for m in s.matches.iter().chain(&s.show_me).chain([&s.third]) {
                // Rounding leaves this distance for coordinates of 10³ px and entries of F known to
                // 10⁻¹⁶.
                assert!(symmetric_epipolar_distance(&s.fundamental, m) < 1e-6);
            }
        }
    }

    #[test]
    fn epipoles_are_where_the_descriptions_say() {
        let inside = |sample: Sample| {
            let f = sample.load().fundamental;
            [f.epipole1(), f.epipole2()].map(|e| finite_point(&e).is_some_and(|e| SAMPLE_FRAME.contains(e)))
        };
        assert_eq!(inside(Sample::Courtyard), [false, false]);
        assert_eq!(inside(Sample::Alley), [true, true]);
    }
}
