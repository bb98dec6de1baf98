//! Rectification with the true F of real pairs: matches must be in the same row.

use epiline::rectify::{Limits, RectifyMethod, rectify};
use epiline::synthetic::Sample;
use epiline_lab::{KnownScene, pair_scenes, vgg_scenes};

use crate::skipping::shared;

/// Returns the mean vertical distance of the true matches, px of the rectified picture.
fn rows(scene: &KnownScene, method: RectifyMethod) -> f64 {
    let frames = [scene.images[0].frame(), scene.images[1].frame()];
    let found = rectify(&scene.truth, frames, &scene.matches, method, &Limits::default()).unwrap();
    let rows = found.measures.rows.unwrap();
    assert_eq!(rows.outside, 0, "{} {method:?}", scene.name);
    println!("{} {method:?}: {rows:?}", scene.name);
    rows.mean
}

/// The true matrices fit their matches to 0.2 to 0.5 px themselves.
#[test]
fn house_pairs_come_into_rows() {
    let Some(folder) = shared("data/house") else { return };
    for scene in vgg_scenes(&folder, 1, &[]).unwrap() {
        assert!(rows(&scene, RectifyMethod::Planar) <= 0.5, "{}", scene.name);
        assert!(rows(&scene, RectifyMethod::Polar) <= 0.7, "{}", scene.name);
    }
}

#[test]
fn a_step_forward_comes_into_rows_by_half_lines() {
    let alley = Sample::Alley.load();
    let frames = [alley.pictures[0].frame(), alley.pictures[1].frame()];
    let found =
        rectify(&alley.fundamental, frames, &alley.matches, RectifyMethod::Auto, &Limits::default()).unwrap();
    assert_eq!(found.method, RectifyMethod::Polar);
    assert!(found.measures.rows.unwrap().mean < 0.02);
    let Some(folder) = shared("data/pairs") else { return };
    for scene in pair_scenes(&folder, &["corr".to_owned()]).unwrap() {
        assert!(rows(&scene, RectifyMethod::Polar) <= 0.7);
    }
}
