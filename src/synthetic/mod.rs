//! Ray-cast scenes with exact cameras, for the built-in samples, for tests and for benchmarks.
//!
//! Everything a picture shows follows from a [`Scene`] and a [`Camera`](crate::geometry::Camera), so the
//! fundamental matrix and the matches of a pair are known to rounding:
//! - [`render`] casts a grid of rays through every pixel and shades what they meet;
//! - [`true_matches`] casts one ray in image 1, projects what it meets into image 2 and casts a second ray
//!   back to see that nothing hides it;
//! - [`Sample`] holds the pairs that come with the program, [`test_pair`] makes small and large ones.
//!
//! Source: textbook ray casting (Pharr, Jakob & Humphreys, *Physically Based Rendering*) and the pinhole
//! camera of Hartley & Zisserman, chapter 6.
//!
//! # Pitfalls
//! - Mirrors and glass would show things that obey another geometry; surfaces here are diffuse with slight
//!   highlights.
//! - The sky is infinitely far: it has matches in the pictures but [`true_matches`] reports none there.

mod alley;
mod build;
mod courtyard;
mod furnish;
mod landmarks;
mod light;
mod matches;
mod noise;
mod ray;
mod render;
mod sample;
mod scene;
mod shape;
mod test_scene;
#[cfg(test)]
mod tests;
mod texture;

pub use light::Light;
pub use matches::{true_match, true_matches};
pub use ray::{Eye, Ray};
pub use render::{Quality, render, render_with};
pub use sample::{SAMPLE_FRAME, Sample, SampleFile, SamplePair};
pub use scene::{Hit, Object, Scene};
pub use shape::{Bounds, Opening, Outline, Shape, Surface};
pub use test_scene::{Motion, TestPair, test_pair, test_scene};
pub use texture::{Material, Pattern};
