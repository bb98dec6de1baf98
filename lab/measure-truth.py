#!/usr/bin/env python3
"""How far true matches that a person clicked lie from where the pictures agree, and what that does to the error of an F.

    epiline estimate LEFT RIGHT --pair X1,Y1,X2,Y2 --pair X1,Y1,X2,Y2 --json RESULT.json
    python3 lab/measure-truth.py LEFT RIGHT TRUTH.txt RESULT.json

An error of an F against true matches holds the error of these matches as well. Here each of them is aligned in the
pictures themselves: a patch of 17×17 pixels of the picture that shows it smaller is laid over the other one by an affine
map, which OpenCV's enhanced correlation (cv2.findTransformECC, Evangelidis and Psarakis 2008) refines from the place that
the truth gives. The map it starts from is fitted to the 25 nearest matches of the result; no F takes part, so where the
match comes to lie is no opinion of ours. A match counts as aligned where the correlation reaches 0.85 and it moved less
than 4 px.

What is printed: how far the aligned matches moved (in pixels of the picture that shows them smaller), and the symmetric
epipolar distance, mean over the same matches as given and aligned, of the result's F and of an F by OpenCV's SIFT and
MAGSAC++. TRUTH has a line `x1 y1 x2 y2` for each match. Needs numpy and opencv-python.
"""

import argparse
import json
import sys

import cv2
import numpy as np

from trust import distances

RADIUS = 8
LEAST_CORRELATION = 0.85
MOST_MOVED = 4.0
NEIGHBOURS = 25


def aligned(images, match, near):
    """The match where the pictures agree and how far it moved, px of the smaller view; None where they do not."""
    affinity, _ = cv2.estimateAffine2D(near[:, :2].copy(), near[:, 2:].copy())
    if affinity is None:
        return None
    linear = affinity[:, :2]
    scale = np.sqrt(abs(np.linalg.det(linear)))
    coarse_first = scale >= 1.0
    if not coarse_first:
        linear, scale = np.linalg.inv(linear), 1.0 / scale
    coarse, fine = images if coarse_first else images[::-1]
    in_coarse, in_fine = (match[:2], match[2:]) if coarse_first else (match[2:], match[:2])
    left, top = np.maximum(np.round(in_coarse).astype(int) - RADIUS, 0)
    patch = coarse[top : top + 2 * RADIUS + 1, left : left + 2 * RADIUS + 1]
    if scale > 1.05:
        fine = cv2.GaussianBlur(fine, (0, 0), 0.5 * np.sqrt(scale * scale - 1.0))
    offset = in_coarse - (left, top)
    warp = np.c_[linear, in_fine - linear @ offset].astype(np.float32)
    try:
        stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 200, 1e-6)
        correlation, warp = cv2.findTransformECC(patch, fine, warp, cv2.MOTION_AFFINE, stop, None, 1)
    except cv2.error:  # it did not settle
        return None
    moved_to = warp[:, :2] @ offset + warp[:, 2]
    moved = np.linalg.norm(moved_to - in_fine) / scale
    if correlation < LEAST_CORRELATION or moved > MOST_MOVED:
        return None
    return np.r_[in_coarse, moved_to] if coarse_first else np.r_[moved_to, in_coarse], moved


def by_magsac(left, right):
    """F by SIFT, the ratio test and MAGSAC++; None where there are too few matches."""
    sift = cv2.SIFT_create()
    (points1, one), (points2, two) = (sift.detectAndCompute(cv2.imread(f, cv2.IMREAD_GRAYSCALE), None) for f in (left, right))
    if one is None or two is None or min(len(one), len(two)) < 2:
        return None
    matches = [m for m, n in cv2.BFMatcher().knnMatch(one, two, k=2) if m.distance < 0.75 * n.distance]
    if len(matches) < 8:
        return None
    ends = [np.float64([p[i].pt for i in ids]) for p, ids in
            ((points1, [m.queryIdx for m in matches]), (points2, [m.trainIdx for m in matches]))]
    fundamental, _ = cv2.findFundamentalMat(*ends, cv2.USAC_MAGSAC, 1.0, 0.999, 10_000)
    return fundamental


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("left", "right", "truth", "result"):
        parser.add_argument(name)
    given = parser.parse_args()
    try:
        truth = np.loadtxt(given.truth, ndmin=2)[:, :4]
        with open(given.result) as file:
            result = json.load(file)
        ours = np.array(result["fundamental"], dtype=float).reshape(3, 3)
        matches = np.array([match["pair"] for match in result["matches"]], dtype=float).reshape(-1, 4)
    except (OSError, ValueError, KeyError, TypeError) as error:
        sys.exit(f"Cannot read the true matches or the result: {error}")
    if truth.shape[1] < 4:
        sys.exit("The true matches need four numbers a line: x1 y1 x2 y2")
    if len(matches) < 3:
        sys.exit("The result holds no matches to start from: it was not refined on patches")
    images = [cv2.imread(f, cv2.IMREAD_GRAYSCALE) for f in (given.left, given.right)]
    if any(image is None for image in images):
        sys.exit("OpenCV cannot read the images")
    images = [image.astype(np.float32) for image in images]
    theirs = by_magsac(given.left, given.right)

    kept, new, moved = [], [], []
    for match in truth:
        near = matches[np.argsort(np.linalg.norm(matches[:, :2] - match[:2], axis=1))[:NEIGHBOURS]]
        if found := aligned(images, match, near):
            kept.append(match)
            new.append(found[0])
            moved.append(found[1])
    if not kept:
        sys.exit("None of the true matches could be aligned")
    print(f"{len(kept)} of {len(truth)} true matches aligned; moved by {np.median(moved):.2f} px (median)")
    for name, fundamental in (("this program", ours), ("SIFT + MAGSAC++", theirs)):
        if fundamental is None:
            continue
        all_, as_given, after = (distances(fundamental, np.array(m)).mean() for m in (truth, kept, new))
        print(f"{name}: all as given {all_:.2f} px; those aligned: as given {as_given:.2f} px, aligned {after:.2f} px")


if __name__ == "__main__":
    main()
