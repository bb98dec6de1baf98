//! Plots the table printed by `measure-barcodes`, with two clicks and without. The plots show the
//! error against the number of frames, the number of moving objects, and the noise in the masks.
//!
//! ```sh
//! cargo run --release --example measure-barcodes > table.md
//! cargo run --release --example plot-barcodes -- table.md lab
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use epiline::evaluate::median;
use epiline::publish::plot::{COLORS, Curve, Panel, Stroke, curves};

/// Errors above this are drawn at the upper edge, px.
const MOST: f64 = 4.0;

/// Plots, each with its file name, its axis label, and the suffix behind the number in a
/// recording's name.
const PLOTS: [(&str, &str, &str); 3] = [
    ("barcodes-frames", "frames, with 8 balls", " frames"),
    ("barcodes-balls", "balls, in 300 frames", " balls"),
    ("barcodes-noise", "pixels of the exact masks that are flipped, %", " % of the pixels flipped"),
];

/// Errors without clicks and with two clicks, for each number of frames, balls or per cent.
type Errors = BTreeMap<u64, [Vec<f64>; 2]>;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [table, folder] = &arguments[..] else {
        eprintln!("usage: plot-barcodes TABLE.md FOLDER");
        std::process::exit(2);
    };
    if let Err(problem) = draw(table, Path::new(folder)) {
        eprintln!("{problem}");
        std::process::exit(1);
    }
}

fn draw(table: &str, folder: &Path) -> Result<(), String> {
    let text = std::fs::read_to_string(table).map_err(|e| format!("{table}: {e}"))?;
    for (file, across, unit) in PLOTS {
        let mut errors = Errors::new();
        for line in text.lines() {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let [_, name, _, none, _, two, ..] = cells[..] else { continue };
            let Some(number) = number_of(name, unit) else { continue };
            let own = errors.entry(number).or_default();
            // A failed estimate is worse than any error.
            own[0].push(none.parse().unwrap_or(f64::INFINITY));
            own[1].push(two.parse().unwrap_or(f64::INFINITY));
        }
        let curve = |k: usize, name: &str| Curve {
            name: name.to_owned(),
            stroke: Stroke::solid(COLORS[k], 2.0),
            points: errors
                .iter()
                .map(|(number, own)| (*number as f64, Some(median(&own[k]).min(MOST))))
                .collect(),
        };
        let panel = Panel {
            title: format!(
                "Mean symmetric distance of 200 true matches, px (medians; {MOST} is {MOST} or more)"
            ),
            curves: vec![curve(0, "no clicks"), curve(1, "two clicks")],
        };
        let drawing = curves(&[panel], across, "px", [0.0, MOST]);
        let path = folder.join(format!("{file}.svg"));
        std::fs::write(&path, drawing.file(across)).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

/// Returns the number of frames, balls or per cent in the name of a recording.
fn number_of(name: &str, unit: &str) -> Option<u64> {
    match (name, unit) {
        ("as it is", " frames") => Some(300),
        ("as it is", " balls") => Some(8),
        _ => name.strip_prefix("exact masks, ").unwrap_or(name).strip_suffix(unit)?.parse().ok(),
    }
}
