//! Shapes a ray can hit, with metric surface coordinates for textures.

use std::f64::consts::PI;

use nalgebra::{Point3, Vector2, Vector3};

use super::ray::Ray;

/// What part of a [`Shape::Patch`] is there. Coordinates are metres from its corner.
#[derive(Debug, Clone, PartialEq)]
pub enum Outline {
    /// All of it.
    Rectangle,
    /// The inscribed ellipse.
    Ellipse,
    /// A pointed oval along the first axis.
    Leaf,
    /// A triangle that hangs from the far edge of the second axis.
    Pennant,
    /// Half a ring standing on its ends; the inner radius as a fraction of the outer one.
    Arch(f64),
    /// A wall with doors, windows and arches cut out.
    Openings(Vec<Opening>),
}

/// A hole in a wall, metres from the wall's lower left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Left edge.
    pub left: f64,
    /// Lower edge.
    pub bottom: f64,
    /// Width.
    pub width: f64,
    /// Height, up to the springing of the arch if there is one.
    pub height: f64,
    /// Whether a half circle tops it.
    pub arched: bool,
}

impl Opening {
    fn contains(&self, p: Vector2<f64>) -> bool {
        let (x, y) = (p.x - self.left, p.y - self.bottom);
        if x < 0.0 || x > self.width || y < 0.0 {
            return false;
        }
        let r = self.width / 2.0;
        y <= self.height || (self.arched && (x - r).hypot(y - self.height) <= r)
    }
}

impl Outline {
    fn contains(&self, p: Vector2<f64>, width: f64, height: f64) -> bool {
        let (s, t) = (p.x / width, p.y / height);
        match self {
            Self::Rectangle => true,
            Self::Ellipse => (2.0 * s - 1.0).hypot(2.0 * t - 1.0) <= 1.0,
            Self::Leaf => (2.0 * t - 1.0).abs() <= (PI * s.powf(0.8)).sin().max(0.0).powf(0.85),
            Self::Pennant => (2.0 * s - 1.0).abs() <= t,
            Self::Arch(inner) => {
                let r = (2.0 * s - 1.0).hypot(t);
                r <= 1.0 && r >= *inner
            }
            Self::Openings(openings) => !openings.iter().any(|o| o.contains(p)),
        }
    }
}

/// A surface. Lengths are metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A flat piece spanned from `corner` along two orthogonal unit vectors.
    Patch {
        /// Where both surface coordinates are zero.
        corner: Point3<f64>,
        /// First axis.
        u: Vector3<f64>,
        /// Second axis.
        v: Vector3<f64>,
        /// Extent along `u`.
        width: f64,
        /// Extent along `v`.
        height: f64,
        /// What part of the rectangle is there.
        outline: Outline,
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: Point3<f64>,
        /// Its radius.
        radius: f64,
    },
    /// The side of a cylinder or of a truncated cone.
    Frustum {
        /// Centre of the lower end.
        base: Point3<f64>,
        /// Unit vector towards the other end.
        axis: Vector3<f64>,
        /// Distance of the two ends.
        height: f64,
        /// Radii at the base and at the other end.
        radii: [f64; 2],
        /// Only the part whose offset from the base has a positive product with this is there.
        keep: Option<Vector3<f64>>,
    },
}

/// The surface at a point: geometry for shading and coordinates for textures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Unit normal, not yet turned to the viewer.
    pub normal: Vector3<f64>,
    /// Unit tangents along the two surface coordinates.
    pub tangents: [Vector3<f64>; 2],
    /// Surface coordinates, metres.
    pub uv: Vector2<f64>,
}

/// An axis-parallel box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub low: Point3<f64>,
    /// Largest coordinates.
    pub high: Point3<f64>,
}

impl Bounds {
    /// Contains nothing.
    pub const EMPTY: Self = Self {
        low: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// Both boxes and what lies between.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The middle.
    pub fn centre(&self) -> Point3<f64> {
        nalgebra::center(&self.low, &self.high)
    }

    /// Area of its six sides.
    pub fn surface(&self) -> f64 {
        let d = self.high - self.low;
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// Distance at which a ray enters, if it does so before `limit`. `inverse` holds the reciprocals of
    /// the direction.
    pub fn entry(&self, origin: &Point3<f64>, inverse: &Vector3<f64>, limit: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0f64, limit);
        for k in 0..3 {
            let a = (self.low[k] - origin[k]) * inverse[k];
            let b = (self.high[k] - origin[k]) * inverse[k];
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near <= far).then_some(near)
    }
}

impl Shape {
    /// Distance along the ray of the nearest intersection in `from ..to`.
    pub fn intersect(&self, ray: &Ray, from: f64, to: f64) -> Option<f64> {
        let inside = |t: &f64| *t > from && *t < to;
        match self {
            Self::Patch { corner, u, v, width, height, outline } => {
                let normal = u.cross(v);
                let t = (corner - ray.origin).dot(&normal) / ray.direction.dot(&normal);
                if !inside(&t) {
                    return None;
                }
                let offset = ray.at(t) - corner;
                let p = Vector2::new(offset.dot(u), offset.dot(v));
                let within = p.x >= 0.0 && p.y >= 0.0 && p.x <= *width && p.y <= *height;
                (within && outline.contains(p, *width, *height)).then_some(t)
            }
            Self::Sphere { centre, radius } => {
                let offset = ray.origin - centre;
                let b = offset.dot(&ray.direction);
                let root = (b * b - offset.norm_squared() + radius * radius).sqrt();
                // A miss makes the root NaN, which lies in no range.
                [-b - root, -b + root].into_iter().find(inside)
            }
            Self::Frustum { base, axis, height, radii, keep } => {
                let offset = ray.origin - base;
                let (oz, dz) = (offset.dot(axis), ray.direction.dot(axis));
                let (o, d) = (offset - axis * oz, ray.direction - axis * dz);
                let slope = (radii[1] - radii[0]) / height;
                let (r, dr) = (radii[0] + slope * oz, slope * dz);
                let (a, b, c) = (d.dot(&d) - dr * dr, o.dot(&d) - r * dr, o.dot(&o) - r * r);
                let roots = if a.abs() < 1e-14 {
                    [-c / (2.0 * b), f64::NAN]
                } else {
                    let root = (b * b - a * c).sqrt() * a.signum();
                    [(-b - root) / a, (-b + root) / a]
                };
                roots.into_iter().find(|t| {
                    let z = oz + t * dz;
                    inside(t)
                        && (0.0..=*height).contains(&z)
                        && keep.is_none_or(|k| (ray.at(*t) - base).dot(&k) > 0.0)
                })
            }
        }
    }

    /// Normal, tangents and surface coordinates at a point on the shape.
    pub fn surface(&self, point: &Point3<f64>) -> Surface {
        match self {
            Self::Patch { corner, u, v, .. } => {
                let offset = point - corner;
                let uv = Vector2::new(offset.dot(u), offset.dot(v));
                Surface { normal: u.cross(v), tangents: [*u, *v], uv }
            }
            Self::Sphere { centre, radius } => {
                let normal = (point - centre) / *radius;
                let east = Vector3::z().cross(&normal).try_normalize(1e-9).unwrap_or_else(Vector3::x);
                let longitude = normal.y.atan2(normal.x);
                let latitude = normal.z.clamp(-1.0, 1.0).asin();
                let uv = Vector2::new(longitude, latitude) * *radius;
                Surface { normal, tangents: [east, normal.cross(&east)], uv }
            }
            Self::Frustum { base, axis, height, radii, .. } => {
                let offset = point - base;
                let z = offset.dot(axis);
                let outward = (offset - axis * z).try_normalize(1e-12).unwrap_or_else(Vector3::x);
                let normal = (outward + axis * ((radii[0] - radii[1]) / height)).normalize();
                let [x, y] = across(axis);
                let angle = outward.dot(&y).atan2(outward.dot(&x));
                let around = axis.cross(&outward);
                let radius = f64::midpoint(radii[0], radii[1]);
                // Scene heights, so that the texture runs on over the pieces of a turned profile.
                let uv = Vector2::new(angle * radius, base.coords.dot(axis) + z);
                Surface { normal, tangents: [around, normal.cross(&around)], uv }
            }
        }
    }

    /// A box around it.
    pub fn bounds(&self) -> Bounds {
        let (low, high) = match self {
            Self::Patch { corner, u, v, width, height, .. } => {
                let (a, b) = (u * *width, v * *height);
                let corners = [*corner, corner + a, corner + b, corner + a + b];
                let low = corners.iter().fold(*corner, |m, p| m.inf(p));
                (low, corners.iter().fold(*corner, |m, p| m.sup(p)))
            }
            Self::Sphere { centre, radius } => {
                let r = Vector3::repeat(*radius);
                (centre - r, centre + r)
            }
            Self::Frustum { base, axis, height, radii, .. } => {
                let across = axis.map(|c| (1.0 - c * c).max(0.0).sqrt());
                let top = base + axis * *height;
                let (a, b) = (across * radii[0], across * radii[1]);
                ((base - a).inf(&(top - b)), (base + a).sup(&(top + b)))
            }
        };
        // Flat boxes get a little thickness, so that rounding cannot make a ray miss them.
        let margin = Vector3::repeat(1e-6);
        Bounds { low: low - margin, high: high + margin }
    }
}

/// Two unit vectors orthogonal to an axis and to each other.
pub fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if axis.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let x = other.cross(axis).normalize();
    [x, axis.cross(&x)]
}
