//! Putting a scene together: placed boxes, walls, turned profiles and windows.

use nalgebra::{Point3, Vector3};

use super::light::Light;
use super::noise::hash;
use super::scene::{Object, Scene};
use super::shape::{Opening, Outline, Shape};
use super::texture::{Material, Pattern};

/// A local frame: `right` and `up` in the plane of a wall, `out` towards the viewer.
#[derive(Debug, Clone, Copy)]
pub struct Axes {
    /// Where the coordinates are zero.
    pub origin: Point3<f64>,
    /// First axis.
    pub right: Vector3<f64>,
    /// Second axis.
    pub up: Vector3<f64>,
    /// Third axis, `right × up`.
    pub out: Vector3<f64>,
}

impl Axes {
    /// Upright at `(x, y, z)`, facing −y, then turned about the vertical by `yaw` radians.
    pub fn facing(x: f64, y: f64, z: f64, yaw: f64) -> Self {
        let (sin, cos) = yaw.sin_cos();
        let (right, up) = (Vector3::new(cos, sin, 0.0), Vector3::z());
        Self { origin: Point3::new(x, y, z), right, up, out: right.cross(&up) }
    }

    /// A point by its local coordinates.
    pub fn at(&self, right: f64, up: f64, out: f64) -> Point3<f64> {
        self.origin + self.right * right + self.up * up + self.out * out
    }

    /// The same directions elsewhere, by local coordinates.
    #[must_use]
    pub fn moved(&self, right: f64, up: f64, out: f64) -> Self {
        Self { origin: self.at(right, up, out), ..*self }
    }

    /// Tilted about `right`, so that `up` leans towards −`out` by `angle` radians.
    #[must_use]
    pub fn leaning(&self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let up = self.up * cos - self.out * sin;
        Self { up, out: self.right.cross(&up), ..*self }
    }
}

/// A material of the scene under construction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MaterialId(usize);

/// A scene under construction.
#[derive(Debug)]
pub struct Builder {
    objects: Vec<Object>,
    materials: Vec<Material>,
    seed: u32,
}

impl Builder {
    /// An empty scene; the seed changes every texture.
    pub fn new(seed: u32) -> Self {
        Self { objects: Vec::new(), materials: Vec::new(), seed }
    }

    /// The scene.
    pub fn finish(self, light: Light) -> Scene {
        Scene::new(self.objects, self.materials, light)
    }

    /// Adds a material.
    pub fn material(&mut self, pattern: Pattern) -> MaterialId {
        self.materials.push(Material::new(pattern));
        MaterialId(self.materials.len() - 1)
    }

    /// Adds a shape.
    pub fn add(&mut self, shape: Shape, material: MaterialId) {
        let seed = hash(self.objects.len() as i32, 17, self.seed);
        self.objects.push(Object { shape, material: material.0, seed });
    }

    /// Adds a shape whose texture goes on where that of another shape with the same seed ends.
    pub fn add_seeded(&mut self, shape: Shape, material: MaterialId, seed: u32) {
        self.objects.push(Object { shape, material: material.0, seed: hash(0, 23, self.seed ^ seed) });
    }

    /// A rectangle in the plane of `right` and `up`, from the origin of the axes.
    pub fn patch(&mut self, axes: &Axes, size: [f64; 2], outline: Outline, material: MaterialId) {
        let [width, height] = size;
        self.add(
            Shape::Patch { corner: axes.origin, u: axes.right, v: axes.up, width, height, outline },
            material,
        );
    }

    /// A level rectangle from `(x, y)` to the right and away.
    pub fn floor(&mut self, corner: Point3<f64>, size: [f64; 2], material: MaterialId) {
        let [width, height] = size;
        let outline = Outline::Rectangle;
        self.add(Shape::Patch { corner, u: Vector3::x(), v: Vector3::y(), width, height, outline }, material);
    }

    /// A box: `size` along right, up and out from the origin of the axes.
    pub fn block(&mut self, axes: &Axes, size: [f64; 3], material: MaterialId) {
        let [w, h, d] = size;
        let Axes { right, up, out, .. } = *axes;
        let faces = [
            (axes.at(0.0, 0.0, d), right, up, w, h),
            (axes.at(w, 0.0, 0.0), -right, up, w, h),
            (axes.at(0.0, 0.0, 0.0), out, up, d, h),
            (axes.at(w, 0.0, d), -out, up, d, h),
            (axes.at(0.0, h, d), right, -out, w, d),
            (axes.at(0.0, 0.0, 0.0), right, out, w, d),
        ];
        for (corner, u, v, width, height) in faces {
            let outline = Outline::Rectangle;
            self.add(Shape::Patch { corner, u, v, width, height, outline }, material);
        }
    }

    /// A profile of `(radius, height)` turned about the vertical through `base`.
    pub fn lathe(&mut self, base: Point3<f64>, profile: &[(f64, f64)], material: MaterialId) {
        let seed = self.objects.len() as u32;
        for pair in profile.windows(2) {
            let [(r0, z0), (r1, z1)] = [pair[0], pair[1]];
            let (low, high) = if z0 <= z1 { ((r0, z0), (r1, z1)) } else { ((r1, z1), (r0, z0)) };
            let height = (high.1 - low.1).max(1e-4);
            let base = base + Vector3::z() * low.1;
            let radii = [low.0, high.0];
            let frustum = Shape::Frustum { base, axis: Vector3::z(), height, radii, keep: None };
            self.add_seeded(frustum, material, seed);
        }
    }

    /// A level disc.
    pub fn disc(&mut self, centre: Point3<f64>, radius: f64, material: MaterialId) {
        let corner = centre - Vector3::new(radius, radius, 0.0);
        let (width, outline) = (2.0 * radius, Outline::Ellipse);
        self.add(
            Shape::Patch { corner, u: Vector3::x(), v: Vector3::y(), width, height: width, outline },
            material,
        );
    }

    /// A rod between two points.
    pub fn rod(&mut self, from: Point3<f64>, to: Point3<f64>, radii: [f64; 2], material: MaterialId) {
        let along = to - from;
        let height = along.norm();
        if height > 0.0 {
            let axis = along / height;
            self.add(Shape::Frustum { base: from, axis, height, radii, keep: None }, material);
        }
    }

    /// A wall with openings; each gets sides of the given depth behind it.
    pub fn wall(
        &mut self,
        axes: &Axes,
        size: [f64; 2],
        openings: &[Opening],
        depth: f64,
        material: MaterialId,
    ) {
        self.patch(axes, size, Outline::Openings(openings.to_vec()), material);
        for o in openings {
            let inner = axes.moved(o.left, o.bottom, 0.0);
            let side = |a: &Axes, u: Vector3<f64>, v: Vector3<f64>, width: f64, height: f64| Shape::Patch {
                corner: a.origin,
                u,
                v,
                width,
                height,
                outline: Outline::Rectangle,
            };
            let back = -axes.out;
            if o.height > 0.0 {
                self.add(side(&inner, back, axes.up, depth, o.height), material);
                self.add(side(&inner.moved(o.width, 0.0, 0.0), back, axes.up, depth, o.height), material);
            }
            if o.bottom > 0.0 {
                self.add(side(&inner, axes.right, back, o.width, depth), material);
            }
            let top = inner.moved(0.0, o.height, 0.0);
            if o.arched {
                let radius = o.width / 2.0;
                self.add(
                    Shape::Frustum {
                        base: top.at(radius, 0.0, 0.0),
                        axis: back,
                        height: depth,
                        radii: [radius; 2],
                        keep: Some(axes.up),
                    },
                    material,
                );
            } else {
                self.add(side(&top, axes.right, back, o.width, depth), material);
            }
        }
    }

    /// A frame of four bars around a rectangle, standing out by `depth`.
    pub fn frame(&mut self, axes: &Axes, size: [f64; 2], bar: f64, depth: f64, material: MaterialId) {
        let [w, h] = size;
        for (x, y, width, height) in [
            (-bar, -bar, w + 2.0 * bar, bar),
            (-bar, h, w + 2.0 * bar, bar),
            (-bar, 0.0, bar, h),
            (w, 0.0, bar, h),
        ] {
            self.block(&axes.moved(x, y, 0.0), [width, height, depth], material);
        }
    }
}
