//! A scene: shapes with materials, found quickly along a ray.
//!
//! The shapes hang in a binary tree of bounding boxes, cut by the surface area heuristic (Pharr, Jakob &
//! Humphreys, *Physically Based Rendering*, chapter on intersection acceleration).

use nalgebra::{Point3, Vector3};

use super::light::Light;
use super::ray::Ray;
use super::shape::{Bounds, Shape, Surface};
use super::texture::Material;

/// A shape with what it is made of.
#[derive(Debug, Clone)]
pub struct Object {
    /// Its surface.
    pub shape: Shape,
    /// Index into the scene's materials.
    pub material: usize,
    /// Makes the texture of equal objects differ.
    pub seed: u32,
}

/// Where a ray meets the scene.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Distance along the ray, m.
    pub distance: f64,
    /// The point.
    pub point: Point3<f64>,
    /// The surface there; its normal faces the ray's origin.
    pub surface: Surface,
    /// Which object.
    pub object: usize,
}

/// Objects, materials and light.
#[derive(Debug, Clone)]
pub struct Scene {
    objects: Vec<Object>,
    materials: Vec<Material>,
    nodes: Vec<Node>,
    /// Sun, sky and exposure.
    pub light: Light,
}

/// A node of the tree: either a run of objects or two children, the first of which follows at once.
#[derive(Debug, Clone)]
struct Node {
    bounds: Bounds,
    /// First object and number of objects for a leaf; second child and 0 otherwise.
    first: usize,
    count: usize,
}

const LEAF_SIZE: usize = 3;
/// From this depth on the tree is cut in halves, so that its depth is bounded.
const EVEN_BELOW: usize = 30;
/// Distance below which a surface does not see itself, m.
const SKIN: f64 = 1e-6;

impl Scene {
    /// Builds the tree. Material indices that do not exist take the last material.
    pub fn new(mut objects: Vec<Object>, materials: Vec<Material>, light: Light) -> Self {
        let last = materials.len().saturating_sub(1);
        for object in &mut objects {
            object.material = object.material.min(last);
        }
        let mut nodes = Vec::new();
        let end = objects.len();
        if materials.is_empty() {
            objects.clear();
        } else if end > 0 {
            split(&mut objects, 0, end, 0, &mut nodes);
        }
        Self { objects, materials, nodes, light }
    }

    /// The first surface along the ray.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let (distance, object) = self.nearest(ray, f64::INFINITY, false)?;
        let point = ray.at(distance);
        let mut surface = self.objects[object].shape.surface(&point);
        if surface.normal.dot(&ray.direction) > 0.0 {
            surface.normal = -surface.normal;
        }
        Some(Hit { distance, point, surface, object })
    }

    /// Whether anything lies along the ray within `limit` m.
    pub fn blocked(&self, ray: &Ray, limit: f64) -> bool {
        self.nearest(ray, limit, true).is_some()
    }

    /// Material of an object.
    pub fn material(&self, object: usize) -> &Material {
        &self.materials[self.objects[object].material]
    }

    /// An object.
    pub fn object(&self, index: usize) -> &Object {
        &self.objects[index]
    }

    /// All objects.
    #[cfg(test)]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Nearest object, or with `any` the first one found.
    fn nearest(&self, ray: &Ray, limit: f64, any: bool) -> Option<(f64, usize)> {
        let inverse = ray.direction.map(|c| 1.0 / c);
        let mut best = (limit, usize::MAX);
        // 30 uneven levels and at most 32 even ones: more objects than memory holds.
        let mut stack = [0usize; 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let node = &self.nodes[index];
            if node.bounds.entry(&ray.origin, &inverse, best.0).is_none() {
                continue;
            }
            if node.count == 0 {
                let (near, far) = self.ordered(index + 1, node.first, &ray.direction);
                stack[depth] = far;
                stack[depth + 1] = near;
                depth += 2;
                continue;
            }
            for object in node.first..node.first + node.count {
                if let Some(t) = self.objects[object].shape.intersect(ray, SKIN, best.0) {
                    best = (t, object);
                    if any {
                        return Some(best);
                    }
                }
            }
        }
        (best.1 != usize::MAX).then_some(best)
    }

    /// The two children, the one the ray meets first before the other.
    fn ordered(&self, a: usize, b: usize, direction: &Vector3<f64>) -> (usize, usize) {
        let apart = self.nodes[b].bounds.centre() - self.nodes[a].bounds.centre();
        if apart.dot(direction) >= 0.0 { (a, b) } else { (b, a) }
    }
}

fn split(objects: &mut [Object], start: usize, end: usize, depth: usize, nodes: &mut Vec<Node>) {
    let run = &mut objects[start..end];
    let bounds = run.iter().fold(Bounds::EMPTY, |b, o| b.joined(&o.shape.bounds()));
    let index = nodes.len();
    nodes.push(Node { bounds, first: start, count: run.len() });
    if run.len() <= LEAF_SIZE {
        return;
    }
    let middle = start + if depth < EVEN_BELOW { cheapest_split(run) } else { run.len() / 2 };
    split(objects, start, middle, depth + 1, nodes);
    let second = nodes.len();
    split(objects, middle, end, depth + 1, nodes);
    nodes[index].first = second;
    nodes[index].count = 0;
}

/// Orders a run of objects and says where to cut it: the cut of least expected cost, where a box costs its
/// surface times the objects in it, among all cuts along the three axes.
fn cheapest_split(run: &mut [Object]) -> usize {
    let mut best = (f64::INFINITY, 0, run.len() / 2);
    for axis in 0..3 {
        sort_along(run, axis);
        let boxes: Vec<Bounds> = run.iter().map(|o| o.shape.bounds()).collect();
        let mut after = vec![0.0; run.len()];
        let mut sum = Bounds::EMPTY;
        for k in (1..run.len()).rev() {
            sum = sum.joined(&boxes[k]);
            after[k] = sum.surface() * (run.len() - k) as f64;
        }
        let mut sum = Bounds::EMPTY;
        for k in 1..run.len() {
            sum = sum.joined(&boxes[k - 1]);
            let cost = sum.surface() * k as f64 + after[k];
            if cost < best.0 {
                best = (cost, axis, k);
            }
        }
    }
    sort_along(run, best.1);
    best.2
}

fn sort_along(run: &mut [Object], axis: usize) {
    run.sort_by_cached_key(|o| {
        // An order-preserving integer of the coordinate, 1 µm fine.
        (o.shape.bounds().centre()[axis] * 1e6) as i64
    });
}
