//! Throughput of the stereo kernel in GCUPS: 10⁹ dynamic-programming cells (line sample ×
//! disparity) per second on one core. Run with `cargo bench --bench kernel`.

use std::hint::black_box;
use std::time::Instant;

use epiline::image::Profile;
use epiline::similarity::{DisparityRange, Kernel, LANES, LaneBlock, StereoParameters, match_cost};

/// Returns a textured profile. Texture does not affect the speed, but gives realistic costs.
fn profile(length: usize, seed: u32) -> Profile {
    let values = (0..length as u32)
        .map(|k| (k.wrapping_mul(2_654_435_761).wrapping_add(seed.wrapping_mul(40_503)) >> 24) as u8)
        .collect();
    Profile { first: -(length as i32) / 2, values }
}

/// Returns the median GCUPS over repeated runs of about 30 ms each.
fn gcups(cells_per_run: f64, mut run: impl FnMut()) -> f64 {
    run();
    let mut rates: Vec<f64> = (0..15)
        .map(|_| {
            let start = Instant::now();
            let mut runs = 0.0;
            while start.elapsed().as_secs_f64() < 0.03 {
                run();
                runs += 1.0;
            }
            runs * cells_per_run / start.elapsed().as_secs_f64() / 1e9
        })
        .collect();
    rates.sort_by(f64::total_cmp);
    rates[rates.len() / 2]
}

fn main() {
    let robust = StereoParameters { lambda: 400, alpha: 2000, ..StereoParameters::PAPER };
    println!("{:<34} {:>8} {:>12} {:>8}", "kernel (one core)", "samples", "disparities", "GCUPS");
    for (length, reach) in [(192, 24), (384, 48), (768, 48), (768, 96), (3072, 384)] {
        let range = DisparityRange::symmetric(reach);
        let lines: Vec<Profile> = (0..LANES as u32).map(|k| profile(length, k)).collect();
        let block = LaneBlock::new(&lines);
        let cells = (length * range.len() * LANES) as f64;
        for (name, parameters) in [("λ = 2, α = 3", StereoParameters::PAPER), ("λ = 400, α = 2000", robust)]
        {
            let mut kernel = Kernel::new(range, parameters);
            let one = gcups(cells, || {
                black_box(kernel.match_one(black_box(&lines[0]), black_box(&block)));
            });
            let lanes = gcups(cells, || {
                black_box(kernel.match_lanes(black_box(&block), black_box(&block)));
            });
            println!("{:<34} {length:>8} {:>12} {one:>8.2}", format!("one against 32, {name}"), range.len());
            println!("{:<34} {length:>8} {:>12} {lanes:>8.2}", format!("32 pairs, {name}"), range.len());
        }
    }
    let range = DisparityRange::symmetric(24);
    let (a, b) = (profile(192, 1), profile(192, 2));
    let scalar = gcups((192 * range.len()) as f64, || {
        black_box(match_cost(black_box(&a), black_box(&b), range, &StereoParameters::PAPER));
    });
    println!("{:<34} {:>8} {:>12} {scalar:>8.3}", "scalar reference", 192, range.len());
}
