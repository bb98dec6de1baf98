//! A scene: shapes with materials, found quickly along a ray.
//!
//! The shapes hang in a binary tree of bounding boxes, split at the median centre along the longest
//! extent (Pharr, Jakob & Humphreys, *Physically Based Rendering*, chapter on intersection acceleration).

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
            split(&mut objects, 0, end, &mut nodes);
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
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Nearest object, or with `any` the first one found.
    fn nearest(&self, ray: &Ray, limit: f64, any: bool) -> Option<(f64, usize)> {
        let inverse = ray.direction.map(|c| 1.0 / c);
        let mut best = (limit, usize::MAX);
        // The tree is balanced: 64 levels hold more objects than memory does.
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

fn split(objects: &mut [Object], start: usize, end: usize, nodes: &mut Vec<Node>) {
    let run = &mut objects[start..end];
    let bounds = run.iter().fold(Bounds::EMPTY, |b, o| b.joined(&o.shape.bounds()));
    let index = nodes.len();
    nodes.push(Node { bounds, first: start, count: run.len() });
    if run.len() <= LEAF_SIZE {
        return;
    }
    let axis = (bounds.high - bounds.low).imax();
    let middle = run.len() / 2;
    let key = |o: &Object| o.shape.bounds().centre()[axis];
    run.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    split(objects, start, start + middle, nodes);
    let second = nodes.len();
    split(objects, start + middle, end, nodes);
    nodes[index].first = second;
    nodes[index].count = 0;
}
