"""Measures lenses fitted to image pairs without a calibration (`estimate --division auto`).

    python3 lab/lens.py PROGRAM FOLDER …

A folder holds NAMEA.* and NAMEB.* with true matches NAME.txt as rows of x1 y1 x2 y2, in the pictures as they
are. For each pair the table has the mean first-order distance of the true matches from the epipolar lines without a
lens, and from the curves with the fitted one, px, with the coefficients.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np


def estimated(program, pictures, *options):
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.json"
        command = [program, "estimate", *map(str, pictures), "--json", str(result), *options]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        return json.loads(result.read_text()) if done.returncode == 0 else None


def undistorted(points, view):
    """Returns the places of points of a picture in its view without distortion (division model)."""
    if view is None or view["is_original"]:
        return points
    own, matrix = np.array(view["original_matrix"]), np.array(view["matrix"])
    focal = own[[0, 1], [0, 1]]
    flat = (points - own[:2, 2]) / focal
    coefficient = view["lens"]["radial"]["division"]["lambda"]
    flat = flat / (1 + coefficient * (flat**2).sum(1, keepdims=True))
    return flat * matrix[[0, 1], [0, 1]] + matrix[:2, 2]


def distances(result, matches):
    """Returns the first-order distances of matches from their lines or curves, in pixels of the pictures."""
    f = np.array(result["fundamental"])
    views = result.get("calibrated", {}).get("views", [None, None])

    def residual(at):
        ends = [undistorted(at[:, 2 * k : 2 * k + 2], views[k]) for k in (0, 1)]
        first, second = (np.c_[end, np.ones(len(end))] for end in ends)
        return (second * (first @ f.T)).sum(1)

    step = 0.01
    moves = step * np.eye(4)
    gradient = np.stack([(residual(matches + m) - residual(matches - m)) / (2 * step) for m in moves], 1)
    return np.abs(residual(matches)) / np.linalg.norm(gradient, axis=1)


def coefficients(result):
    views = result.get("calibrated", {}).get("views", [])
    return ", ".join(f"{view['lens']['radial']['division']['lambda']:.4f}" for view in views) or "none"


def main():
    program, *folders = sys.argv[1:]
    print("| pair | lines, px | curves, px | verdict | λ |\n|---|---|---|---|---|")
    gains = []
    for folder in map(Path, folders):
        for truth in sorted(folder.glob("*.txt")):
            pictures = [sorted(folder.glob(f"{truth.stem}{side}.*")) for side in "AB"]
            if not all(pictures):
                continue
            pictures = [found[0] for found in pictures]
            matches = np.loadtxt(truth, ndmin=2)[:, :4]
            straight, bent = estimated(program, pictures), estimated(program, pictures, "--division", "auto")
            if straight is None or bent is None:
                print(f"| {truth.stem} | no geometry | | | |")
                continue
            off = [distances(result, matches).mean() for result in (straight, bent)]
            if coefficients(bent) != "none":
                gains.append(off)
            print(f"| {truth.stem} | {off[0]:.3f} | {off[1]:.3f} | {bent['verdict']} | {coefficients(bent)} |", flush=True)
    if gains:
        means = np.exp(np.log(np.array(gains)).mean(0))
        print(f"\n{len(gains)} pairs with a lens, geometric mean: {means[0]:.3f} px from lines, {means[1]:.3f} px from curves")


if __name__ == "__main__":
    main()
