//! Intersections against closed forms, and visibility.

use nalgebra::{Point3, Vector2, Vector3};

use super::build::{Axes, Builder};
use super::landmarks::{SEPARATION, separation};
use super::light::Light;
use super::matches::true_match;
use super::ray::Ray;
use super::render::render;
use super::scene::Scene;
use super::shape::{Opening, Outline, Shape};
use super::texture::{Pattern, srgb};
use super::{courtyard, setting};
use epiline::geometry::{Camera, Frame, Point};
use epiline::synthetic::{SAMPLE_FRAME, Sample};

fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray { origin: Point3::from(origin), direction: Vector3::from(direction).normalize() }
}

fn patch(outline: Outline) -> Shape {
    Shape::Patch {
        corner: Point3::new(-1.0, 5.0, -1.0),
        u: Vector3::x(),
        v: Vector3::z(),
        width: 2.0,
        height: 2.0,
        outline,
    }
}

fn hit(shape: &Shape, ray: &Ray) -> Option<f64> {
    shape.intersect(ray, 1e-9, f64::INFINITY)
}

#[test]
fn a_patch_is_hit_at_its_plane_and_only_inside_its_outline() {
    let slanted = ray([0.0, 0.0, 0.0], [0.1, 1.0, -0.1]);
    let t = hit(&patch(Outline::Rectangle), &slanted).unwrap();
    assert!((slanted.at(t) - Point3::new(0.5, 5.0, -0.5)).norm() < 1e-12);
    let corner = ray([0.95, 0.0, 0.95], [0.0, 1.0, 0.0]);
    assert!(hit(&patch(Outline::Rectangle), &corner).is_some());
    assert!(hit(&patch(Outline::Ellipse), &corner).is_none());
    assert!(hit(&patch(Outline::Rectangle), &ray([1.1, 0.0, 0.0], [0.0, 1.0, 0.0])).is_none());
    assert!(hit(&patch(Outline::Rectangle), &ray([0.0, 6.0, 0.0], [0.0, 1.0, 0.0])).is_none());
}

#[test]
fn openings_and_arches_let_rays_through() {
    let door = Opening { left: 0.5, bottom: 0.0, width: 1.0, height: 1.0, arched: true };
    let wall = patch(Outline::Openings(vec![door]));
    let through = |x: f64, z: f64| hit(&wall, &ray([x, 0.0, z], [0.0, 1.0, 0.0])).is_none();
    assert!(through(0.0, -0.5) && through(0.0, 0.45) && through(0.49, -0.01));
    // Beside the springing the half circle leaves wall.
    assert!(!through(0.49, 0.3) && !through(0.0, 0.51) && !through(0.6, -0.5));
}

#[test]
fn a_sphere_is_hit_outside_and_inside() {
    let sphere = Shape::Sphere { centre: Point3::new(0.0, 10.0, 0.0), radius: 2.0 };
    assert!((hit(&sphere, &ray([0.0, 0.0, 0.0], [0.0, 1.0, 0.0])).unwrap() - 8.0).abs() < 1e-12);
    assert!((hit(&sphere, &ray([0.0, 10.0, 0.0], [0.3, 0.2, 0.9])).unwrap() - 2.0).abs() < 1e-12);
    // At height h above the axis the chord starts √(r² − h²) before the middle.
    let t = hit(&sphere, &ray([0.0, 0.0, 1.2], [0.0, 1.0, 0.0])).unwrap();
    assert!((t - (10.0 - (4.0f64 - 1.44).sqrt())).abs() < 1e-12);
    assert!(hit(&sphere, &ray([0.0, 0.0, 2.01], [0.0, 1.0, 0.0])).is_none());
}

#[test]
fn cylinders_and_cones_are_hit_at_their_radius() {
    let frustum = |radii| Shape::Frustum {
        base: Point3::new(0.0, 10.0, 0.0),
        axis: Vector3::z(),
        height: 2.0,
        radii,
        keep: None,
    };
    let level = |z: f64| ray([0.0, 0.0, z], [0.0, 1.0, 0.0]);
    assert!((hit(&frustum([1.0, 1.0]), &level(1.5)).unwrap() - 9.0).abs() < 1e-12);
    assert!((hit(&frustum([1.0, 0.0]), &level(1.5)).unwrap() - 9.75).abs() < 1e-12);
    assert!(hit(&frustum([1.0, 1.0]), &level(2.1)).is_none());
    // Down inside the tube and out through its side.
    let t = hit(&frustum([1.0, 1.0]), &ray([0.0, 10.0, 1.5], [1.0, 0.0, -1.0])).unwrap();
    assert!((t - 2f64.sqrt()).abs() < 1e-12);
}

#[test]
fn normals_and_tangents_are_orthonormal_and_follow_the_coordinates() {
    let shapes = [
        Shape::Sphere { centre: Point3::new(0.0, 10.0, 0.0), radius: 2.0 },
        Shape::Frustum {
            base: Point3::new(0.0, 10.0, -1.0),
            axis: Vector3::z(),
            height: 2.0,
            radii: [1.5, 1.0],
            keep: None,
        },
        patch(Outline::Rectangle),
    ];
    for shape in &shapes {
        let r = ray([0.2, 0.0, 0.3], [0.0, 1.0, 0.0]);
        let p = r.at(hit(shape, &r).unwrap());
        let s = shape.surface(&p);
        for tangent in s.tangents {
            assert!(tangent.dot(&s.normal).abs() < 1e-9 && (tangent.norm() - 1.0).abs() < 1e-9);
        }
        assert!((s.normal.norm() - 1.0).abs() < 1e-9);
        let moved = shape.surface(&(p + s.tangents[1] * 1e-5)).uv - s.uv;
        assert!((moved.normalize() - Vector2::new(0.0, 1.0)).norm() < 1e-2, "{shape:?}");
    }
}

/// A wall 10 m away and, in front of it, a small screen 5 m away.
fn wall_and_screen() -> Scene {
    let mut b = Builder::new(1);
    let stone = b.material(Pattern::Stone(srgb(0xB0_A890)));
    b.patch(&Axes::facing(-10.0, 10.0, -10.0, 0.0), [20.0, 20.0], Outline::Rectangle, stone);
    b.patch(&Axes::facing(-0.5, 5.0, -0.5, 0.0), [1.0, 1.0], Outline::Rectangle, stone);
    b.finish(Light::day(Vector3::new(0.3, -1.0, 1.0)))
}

fn camera(x: f64) -> Camera {
    Camera::looking_at(
        Point3::new(x, 0.0, 0.0),
        Point3::new(x, 8.0, 0.0),
        Vector3::z(),
        400.0,
        Point::new(199.5, 149.5),
    )
    .unwrap()
}

#[test]
fn hidden_points_are_not_matches() {
    let (scene, frame) = (wall_and_screen(), Frame::new(400, 300));
    let (c1, c2) = (camera(0.0), camera(1.0));
    let matched = |x: f64, y: f64| true_match(&scene, &c1, &c2, frame, Point::new(x, y));
    // On the screen: f·B/Z = 80 px.
    let on_screen = matched(199.5, 149.5).unwrap();
    assert!((on_screen.point2 - Point::new(119.5, 149.5)).norm() < 1e-9);
    // On the wall: 40 px. From camera 2 the screen covers wall points projected to x = 79.5 .. 159.5.
    assert!((matched(260.0, 40.0).unwrap().point2 - Point::new(220.0, 40.0)).norm() < 1e-9);
    assert!(matched(150.0, 149.5).is_none(), "behind the screen for camera 2");
    assert!(matched(30.0, 149.5).is_none(), "left of image 2");
    for k in 0..200u32 {
        let Some(m) = matched(f64::from(k % 20) * 20.0, f64::from(k / 20) * 30.0) else { continue };
        let disparity = m.point1.x - m.point2.x;
        let wall = (disparity - 40.0).abs() < 1e-9;
        assert!(wall || (disparity - 80.0).abs() < 1e-9);
        let covered = (m.point1.y - 149.5).abs() < 40.0 && (80.0..159.0).contains(&m.point2.x);
        assert!(!(wall && covered));
    }
}

#[test]
fn the_tree_finds_what_trying_every_object_finds() {
    let scene = courtyard::scene();
    for k in 0..400 {
        let t = f64::from(k);
        let r = ray([0.0, 0.0, 1.5], [(t * 0.7).sin() * 0.6, 1.0, (t * 1.1).cos() * 0.4]);
        let nearest = scene
            .objects()
            .iter()
            .filter_map(|o| o.shape.intersect(&r, 1e-6, f64::INFINITY))
            .min_by(f64::total_cmp);
        assert_eq!(scene.intersect(&r).map(|h| h.distance), nearest);
    }
}

#[test]
fn an_empty_scene_is_all_sky() {
    let scene = Scene::new(Vec::new(), Vec::new(), Light::day(Vector3::z()));
    assert!(scene.intersect(&ray([0.0; 3], [0.0, 1.0, 0.1])).is_none());
    let frame = Frame::new(20, 15);
    assert!(true_match(&scene, &camera(0.0), &camera(1.0), frame, Point::new(10.0, 7.0)).is_none());
    assert!(render(&scene, &camera(0.0), frame, 1).is_some());
    assert!(render(&scene, &camera(0.0), Frame::new(0, 0), 1).is_some());
}

#[test]
fn rendering_is_repeatable_on_any_number_of_threads() {
    let picture = || render(&courtyard::scene(), &camera(0.0), Frame::new(12, 9), 9).unwrap();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(picture);
    assert!(picture() == alone);
}

#[test]
fn the_shipped_files_belong_to_the_scenes() {
    for sample in Sample::ALL {
        let shipped = sample.load();
        let (scene, [camera1, camera2], _) = setting(sample, SAMPLE_FRAME).unwrap();
        for m in &shipped.matches {
            let again = true_match(&scene, &camera1, &camera2, SAMPLE_FRAME, m.point1).unwrap();
            assert!((again.point2 - m.point2).norm() < 1e-6);
        }
        let [p, q] = shipped.show_me;
        for (a, b) in [(p, q), (p, shipped.third), (q, shipped.third)] {
            assert!(separation(&shipped.fundamental, &a, &b) > SEPARATION * SAMPLE_FRAME.longer_side());
        }
    }
}
