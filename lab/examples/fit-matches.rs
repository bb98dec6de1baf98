//! Fits a fundamental matrix to given matches and prints it, the noise and the number of inliers.
//!
//!     fit-matches WIDTH HEIGHT < MATCHES
//!
//! Each line of the input has `x1 y1 x2 y2`, and optionally the ratio of the distances to the nearest and to the next
//! descriptor. The output is one line: nine entries of F row by row, noise in px, inliers.

use std::io::Read;

use epiline::estimate::{Match, estimate_fundamental};
use epiline::geometry::{Frame, PointPair};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sizes: Vec<usize> = std::env::args().skip(1).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let [width, height] = sizes[..] else { return Err("usage: fit-matches WIDTH HEIGHT < MATCHES".into()) };
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let mut matches: Vec<Match> = Vec::new();
    for line in text.lines() {
        let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [x1, y1, x2, y2, ref ratio @ ..] = numbers[..] else {
            return Err("a match has four numbers".into());
        };
        let prior = ratio.first().map_or(1.0, |ratio| 1.0 / (1.0 + ratio.powi(4)));
        matches.push(Match { prior, ..PointPair::new(x1, y1, x2, y2).into() });
    }
    let fit = estimate_fundamental(&matches, [Frame::new(width, height); 2], 0)?;
    let entries: Vec<String> = fit.fundamental.rows().iter().flatten().map(ToString::to_string).collect();
    let inliers = fit.inlier_probabilities.iter().filter(|p| **p > 0.5).count();
    println!("{} {} {inliers}", entries.join(" "), fit.noise.scale);
    Ok(())
}
