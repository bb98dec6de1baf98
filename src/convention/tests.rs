use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use nalgebra::{Matrix3, Point3, Vector3};

use super::*;
use crate::geometry::{Camera, FundamentalMatrix, Point, PointPair};
use crate::skipping;

/// Returns F and `count` matches of two cameras 0.9 apart. The second camera is rotated about its
/// axis by `roll`; the points are 4 to 9 away, over 768×576 px. Noise is 0.3 px and every fifth
/// match is wrong.
fn truth(roll: f64, count: usize, seed: u64) -> (FundamentalMatrix, Vec<PointPair>) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let principal = Point::new(383.5, 287.5);
    let camera = |x: f64, roll: f64| {
        let up = Vector3::new(roll.sin(), -roll.cos(), 0.05);
        Camera::looking_at(Point3::new(x, 0.1 * x, 0.2 * x), Point3::new(0.2, 0.1, 6.0), up, 700.0, principal)
            .unwrap()
    };
    let (camera1, camera2) = (camera(-0.4, 0.0), camera(0.5, roll));
    let mut noise = |sigma: f64| {
        let radius = sigma * (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
        let angle = std::f64::consts::TAU * random.random::<f64>();
        Vector3::new(radius * angle.cos(), radius * angle.sin(), random.random())
    };
    let matches = (0..count)
        .map(|k| {
            let place = noise(1.0);
            let x = Point3::new(1.2 * place.x, place.y, 4.0 + 5.0 * place.z);
            let [a, b] = [camera1, camera2].map(|c| c.project(&x).unwrap() + noise(0.3).xy());
            let wrong = if k % 5 == 4 { noise(150.0).xy() } else { noise(0.0).xy() };
            PointPair { point1: a, point2: b + wrong }
        })
        .collect();
    (Camera::fundamental(&camera1, &camera2).unwrap(), matches)
}

/// Returns the matrix that a program with this convention would write.
fn written(f: &FundamentalMatrix, reading: &Reading) -> FundamentalMatrix {
    let (s, o) = (reading.scale, 0.5 * reading.scale - 0.5 + reading.origin);
    let swap = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let axes = if reading.axes_exchanged { swap } else { Matrix3::identity() };
    let theirs_from_ours = axes * crate::geometry::scaling(s, o, o);
    let ours_from_theirs = theirs_from_ours.try_inverse().unwrap();
    let matrix = ours_from_theirs.transpose() * f.matrix() * ours_from_theirs;
    FundamentalMatrix::from_rank_two(if reading.transposed { matrix.transpose() } else { matrix }).unwrap()
}

fn readings() -> Vec<Reading> {
    let sizes = |reading| [1.0, 0.5, 4.0, 0.71].map(|scale| Reading { scale, ..reading });
    Reading::of_same_size().flat_map(sizes).collect()
}

/// With the second camera upside down, an offset of half a pixel is measurable.
#[test]
fn every_reading_is_found_where_it_matters() {
    for (seed, reading) in readings().into_iter().enumerate() {
        let (f, matches) = truth(2.8, 400, seed as u64);
        let check = check_convention(&written(&f, &reading), &matches).unwrap();
        let best = check.best();
        let found = &best.reading;
        let sentence = check.sentence();
        assert_eq!(
            (found.transposed, found.axes_exchanged),
            (reading.transposed, reading.axes_exchanged),
            "{sentence}"
        );
        assert!((found.scale / reading.scale).ln().abs() < 0.01, "{reading:?}: {sentence}");
        // In images four times as large, half a pixel of origin shifts points by an eighth of a
        // pixel here. In images of unknown scale, the scale partly compensates the origin.
        let is_credible = |r: &RankedReading| r.reading.origin.to_bits() == reading.origin.to_bits();
        if reading.scale > 1.0 || (reading.scale - 0.71).abs() < 0.01 {
            assert!(is_credible(best) || check.alike().any(is_credible), "{reading:?}: {sentence}");
        } else {
            assert!(is_credible(best), "{reading:?}: {sentence}");
        }
        assert!(check.fits() && best.median < 0.5 && (0.75..0.9).contains(&best.within), "{sentence}");
        assert!(check.next().unwrap().median > best.median);
        // The best reading gives the true matrix.
        let exact = crate::geometry::epipolar_difference(
            &best.fundamental,
            &f,
            [crate::geometry::Frame::new(768, 576); 2],
            99.0,
        );
        assert!(exact < 1.5, "{reading:?}: {exact} px, {sentence}");
    }
}

/// Between cameras that look the same way the origin hardly shows; all other changes do.
#[test]
fn origins_that_cannot_be_told_are_named() {
    let mut untold = 0;
    for (seed, reading) in readings().into_iter().enumerate() {
        let (f, matches) = truth(0.1, 60, seed as u64);
        let check = check_convention(&written(&f, &reading), &matches).unwrap();
        let sentence = check.sentence();
        let credible: Vec<_> =
            std::iter::once(check.best()).chain(check.alike()).map(|r| r.reading).collect();
        assert!(
            credible.iter().any(|r| r.transposed == reading.transposed
                && r.axes_exchanged == reading.axes_exchanged
                && (r.scale / reading.scale).ln().abs() < 0.05),
            "{reading:?}: {sentence}"
        );
        assert!(check.fits());
        untold += usize::from(sentence.contains("matches cannot tell whether"));
    }
    assert!(untold > 20, "{untold}");
}

#[test]
fn as_read_is_said_plainly() {
    let (f, matches) = truth(2.8, 100, 1);
    let check = check_convention(&f, &matches).unwrap();
    assert_eq!(check.best().reading.changes(), 0);
    let sentence = check.sentence();
    assert!(
        sentence.starts_with("The geometry fits as read. Half of the 100 matches lie within 0."),
        "{sentence}"
    );
    let wrong = check.readings.iter().find(|r| r.reading.changes() == 1 && r.reading.transposed).unwrap();
    assert!(wrong.told_apart && wrong.reading.to_string().starts_with("transposed"));
}

/// Among nine matches, one that happens to fit a wrong reading must not make that reading credible.
#[test]
fn few_matches_tell_what_fits_from_what_is_far_off() {
    for seed in 0..40 {
        let (f, matches) = truth(2.8, 9, seed);
        let check = check_convention(&f, &matches).unwrap();
        let best = check.best();
        assert!(check.fits(), "{}", check.sentence());
        for other in &check.readings {
            let is_far = other.median > check.limit && other.median > 4.0 * best.median;
            assert!(other.told_apart || !is_far, "seed {seed}: {} px, {}", other.median, check.sentence());
        }
        assert!(check.readings[1..].is_sorted_by_key(|r| r.median), "seed {seed}: {}", check.sentence());
    }
}

/// The matches detect half a pixel of offset, but still fit within the limit.
#[test]
fn what_fits_worse_is_not_said_not_to_fit() {
    let (f, matches) = truth(2.8, 400, 3);
    let corner = written(&f, &Reading { origin: 1.0, ..Reading::AS_READ });
    let check = check_convention(&corner, &matches).unwrap();
    let (as_read, sentence) = (check.as_read().unwrap(), check.sentence());
    assert!(as_read.told_apart && as_read.median < check.limit, "{sentence}");
    assert!(sentence.starts_with("The geometry fits worse as read ("), "{sentence}");
}

#[test]
fn nothing_fits_matches_of_other_images() {
    let (f, _) = truth(2.8, 8, 1);
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut next = || 700.0 * random.random::<f64>();
    let matches: Vec<_> = (0..200).map(|_| PointPair::new(next(), next(), next(), next())).collect();
    let check = check_convention(&f, &matches).unwrap();
    assert!(!check.fits());
    let sentence = check.sentence();
    assert!(sentence.starts_with("No reading fits. Under each of them, half"), "no name: {sentence}");
    assert!(sentence.contains("y pointing up, or only one of the images resized"), "{sentence}");
}

/// A pure sideways motion gives the same matrix under transposition and for every origin and scale.
#[test]
fn the_same_thing_is_listed_once() {
    let f = crate::geometry::random_scene::rows(0.0);
    let matches: Vec<_> = (0..30)
        .map(|k| {
            let (x, y) = (f64::from(k * 37 % 300), f64::from(k * 53 % 200));
            PointPair::new(x, y, x + 3.0 + f64::from(k % 7), y + 0.1 * f64::from(k % 3))
        })
        .collect();
    let check = check_convention(&f, &matches).unwrap();
    assert_eq!(
        check.readings.len(),
        2,
        "{:?}",
        check.readings.iter().map(|r| r.reading.to_string()).collect::<Vec<_>>()
    );
    assert_eq!(check.readings[0].reading.to_string(), "as read");
    assert_eq!(check.readings[1].reading.to_string(), "x and y exchanged");
}

#[test]
fn too_few_and_broken_matches_are_refused() {
    let (f, matches) = truth(0.1, 8, 1);
    assert!(check_convention(&f, &matches).is_ok());
    let error = check_convention(&f, &matches[..7]).unwrap_err();
    assert!(error.to_string().contains("at least 8 matches, 7 were given"), "{error}");
    let mut broken = matches;
    broken[3].point2.x = f64::NAN;
    assert_eq!(check_convention(&f, &broken).unwrap_err(), CheckError::NotFinite);
    // Squares of such numbers are infinite, and so is a limit in proportion to them.
    let far = [PointPair::new(1e300, -1e300, 1e300, 1e300); 9];
    assert_eq!(check_convention(&f, &far).unwrap_err(), CheckError::TooFar);
    // Matches at one point must give a verdict too.
    let _ = check_convention(&f, &[PointPair::new(1.0, 2.0, 3.0, 4.0); 9]).unwrap().sentence();
}

/// Tests the views of the VGG model house with their cameras, if present.
#[test]
fn the_cameras_of_the_house_are_as_read() {
    let Some(folder) = skipping::shared("data/house") else { return };
    let set = crate::io::VggFolder::open(&folder).unwrap();
    for view in 0..set.cameras.len() - 1 {
        let f = Camera::fundamental(&set.cameras[view], &set.cameras[view + 1]).unwrap();
        let check = check_convention(&f, &set.matches(view, view + 1)).unwrap();
        println!("{view}-{}: {}", view + 1, check.sentence());
        assert!(check.fits() && check.best().reading.changes() == 0, "{}", check.sentence());
        let turned = check_convention(&f.swapped(), &set.matches(view, view + 1)).unwrap();
        println!("  transposed: {}", turned.sentence());
        let found = turned.best().reading;
        assert!(found.transposed && found.changes() == 1, "{}", turned.sentence());
    }
}

/// A free scale brings a matrix whose lines are 5 px off nearer to the matches, but explains nothing.
#[test]
fn a_searched_scale_does_not_excuse_shifted_lines() {
    for seed in 0..10 {
        let (f, matches) = truth(2.8, 300, seed);
        let m = f.matrix();
        let shifted = Matrix3::from_fn(|row, column| {
            m[(row, column)] - if row == 2 { 5.0 * m[(1, column)] } else { 0.0 }
        });
        let check = check_convention(&FundamentalMatrix::from_rank_two(shifted).unwrap(), &matches).unwrap();
        assert!(!check.fits(), "seed {seed}: {}", check.sentence());
        // A matrix that is a little off fits as read, whatever a scale would gain.
        let near = Matrix3::from_fn(|row, column| {
            m[(row, column)] - if row == 2 { 1.2 * m[(1, column)] } else { 0.0 }
        });
        let check = check_convention(&FundamentalMatrix::from_rank_two(near).unwrap(), &matches).unwrap();
        assert!(check.fits(), "seed {seed}: {}", check.sentence());
    }
}
