#!/usr/bin/env python3
"""Compares the planar rectification with OpenCV's stereoRectifyUncalibrated on the same F and the same matches.

    cargo run --release -p epiline-lab --example measure-rectify -- HOUSE PAIRS FOLDER
    python3 lab/compare-rectify.py FOLDER [--pictures]

FOLDER holds what measure-rectify wrote: for each pair its two images, NAME.json with F, the matches and our
homographies. Needs numpy and opencv-python. Both are measured alike: both pairs of homographies are scaled so that the
two rectified images together have the area of the two originals. Then, over the matches, the mean of |y1 - y2|; over
both images, the worst angle between the middle lines, the worst ratio of the diagonals (given as 1 or more), the part
of the area that is drawn on less than half or more than twice its size, and the part that falls outside the picture
(OpenCV's is of the size of the image, ours is as large as it needs to be). With --pictures, NAME-compared.png shows
OpenCV's pair above ours.
"""

import json
import sys
from pathlib import Path

import cv2
import numpy as np

GRID = 48


def apply(h, points):
    """Points (n x 2) through a homography, and their third coordinate."""
    mapped = np.c_[points, np.ones(len(points))] @ h.T
    return mapped[:, :2] / mapped[:, 2:], mapped[:, 2]


def corners(size):
    right, bottom = size[0] - 1.0, size[1] - 1.0
    return np.array([[0, 0], [right, 0], [right, bottom], [0, bottom]])


def area(polygon):
    x, y = polygon.T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def normalised(homographies, sizes):
    """Scaled so that the rectified images have the area of the originals; None where one reaches infinity."""
    rectified = original = 0.0
    for h, size in zip(homographies, sizes):
        quad, w = apply(h, corners(size))
        if np.min(w) * np.max(w) <= 0:
            return None
        rectified += area(quad)
        original += area(corners(size))
    scale = np.sqrt(original / rectified)
    return [np.diag([scale, scale, 1.0]) @ h for h in homographies]


def measures(homographies, sizes, matches, cut):
    """What the table shows; None where an image is torn apart."""
    homographies = normalised(homographies, sizes)
    if homographies is None:
        return None
    left, _ = apply(homographies[0], matches[:, :2])
    right, _ = apply(homographies[1], matches[:, 2:])
    angle, diagonals, bent, mirrored = 0.0, 1.0, [], False
    for h, size in zip(homographies, sizes):
        (w, n) = size[0] - 1.0, size[1] - 1.0
        middles, _ = apply(h, np.array([[0, n / 2], [w, n / 2], [w / 2, 0], [w / 2, n]]))
        across, down = middles[1] - middles[0], middles[3] - middles[2]
        cosine = across @ down / np.linalg.norm(across) / np.linalg.norm(down)
        angle = max(angle, abs(np.degrees(np.arccos(cosine)) - 90.0))
        quad, _ = apply(h, corners(size))
        ratio = np.linalg.norm(quad[2] - quad[0]) / np.linalg.norm(quad[3] - quad[1])
        diagonals = max(diagonals, ratio, 1.0 / ratio)
        x, y = np.meshgrid((np.arange(GRID) + 0.5) / GRID * w, (np.arange(GRID) + 0.5) / GRID * n)
        third = np.c_[x.ravel(), y.ravel(), np.ones(GRID * GRID)] @ h[2]
        # The Jacobian determinant of a homography is det H over the third coordinate cubed.
        factor = np.linalg.det(h) / third**3
        mirrored |= bool(np.any(factor < 0))
        bent.append(np.mean((np.abs(factor) < 0.5) | (np.abs(factor) > 2.0)))
    return {
        "rows": float(np.mean(np.abs(left[:, 1] - right[:, 1]))),
        "angle": angle,
        "diagonals": diagonals,
        "bent": float(np.mean(bent)),
        "cut": cut,
        "mirrored": mirrored,
    }


def outside(homographies, sizes):
    """Part of the images that OpenCV's picture, of the size of the first image, leaves out."""
    parts = []
    for h, size in zip(homographies, sizes):
        x, y = np.meshgrid(
            (np.arange(GRID) + 0.5) / GRID * (size[0] - 1), (np.arange(GRID) + 0.5) / GRID * (size[1] - 1)
        )
        at, _ = apply(h, np.c_[x.ravel(), y.ravel()])
        inside = (at > -0.5).all(1) & (at[:, 0] < sizes[0][0] - 0.5) & (at[:, 1] < sizes[0][1] - 0.5)
        parts.append(1.0 - np.mean(inside))
    return float(np.mean(parts))


def row(name, which, m):
    if m is None:
        return f"| {name} | {which} | an image is torn apart | | | | |"
    note = " (mirrored)" if m["mirrored"] else ""
    return (
        f"| {name} | {which}{note} | {m['rows']:.3f} | {m['angle']:.1f}° | {m['diagonals']:.3f} "
        f"| {100 * m['bent']:.0f} % | {100 * m['cut']:.0f} % |"
    )


def picture(images, homographies, size):
    """Both images warped, side by side, with guide lines."""
    both = np.hstack([cv2.warpPerspective(i, h, tuple(size)) for i, h in zip(images, homographies)])
    both[20::40] = 255 - both[20::40] // 2
    return both


def main():
    folder = Path(sys.argv[1])
    print("| pair | by | mean \\|Δy\\|, px | off 90° | diagonals | area off by > 2 | cut |")
    print("|---|---|---:|---:|---:|---:|---:|")
    for file in sorted(folder.glob("*.json")):
        pair = json.loads(file.read_text())
        name, sizes, matches = file.stem, pair["sizes"], np.array(pair["matches"])
        f = np.array(pair["fundamental"])
        found, *theirs = cv2.stereoRectifyUncalibrated(
            matches[:, :2].copy(), matches[:, 2:].copy(), f, tuple(sizes[0]), threshold=0
        )
        ours = pair.get("homographies")
        if ours is None:
            print(f"| {name} | ours | impossible: {pair['reason']} | | | | |")
        else:
            ours = [np.array(h) for h in ours]
            print(row(name, "ours", measures(ours, sizes, matches, pair["cut"])))
        if found:
            print(row(name, "OpenCV", measures(theirs, sizes, matches, outside(theirs, sizes))))
        else:
            print(f"| {name} | OpenCV | none found | | | | |")
        if "--pictures" in sys.argv and found and ours is not None:
            images = [cv2.imread(str(folder / f"{name}-{k}.png"), cv2.IMREAD_GRAYSCALE) for k in (1, 2)]
            above = picture(images, theirs, sizes[0])
            below = picture(images, ours, pair["size"])
            width = max(above.shape[1], below.shape[1])
            pad = lambda p: np.pad(p, ((0, 8), (0, width - p.shape[1])), constant_values=128)
            cv2.imwrite(str(folder / f"{name}-compared.png"), np.vstack([pad(above), pad(below)]))


if __name__ == "__main__":
    main()
