#!/usr/bin/env python3
"""How often the true epipolar geometry lies in the 95 % regions that a result states.

    python3 lab/coverage.py PROGRAM FOLDER... [--all]

PROGRAM is the command-line program. Each FOLDER has pairs NAMEA.*, NAMEB.* with the true matrix in
NAME_F.txt, or numbered pictures with camera matrices (NAME.pgm, NAME.P). Only reliable results
count, unless --all is given. Needs NumPy.
"""

import glob
import json
import os
import subprocess
import sys

import numpy as np


def pairs(folder):
    """Yields the name, both pictures and the true F of each pair of a folder."""
    for truth in sorted(glob.glob(f"{folder}/*_F.txt")):
        name = truth[: -len("_F.txt")]
        left, right = (glob.glob(f"{name}{letter}.*")[0] for letter in "AB")
        yield os.path.basename(name), left, right, np.loadtxt(truth)
    cameras = sorted(glob.glob(f"{folder}/*.P"))
    for first, second in zip(cameras, cameras[1:]):
        p1, p2 = np.loadtxt(first), np.loadtxt(second)
        x, y, z = p2 @ np.linalg.svd(p1)[2][3]
        f = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ p2 @ np.linalg.pinv(p1)
        yield os.path.basename(first), *(glob.glob(f"{c[:-2]}.p[gn]*")[0] for c in (first, second)), f


def lines_inside(f, covariance, truth, matches, frame2):
    """Returns the share of the true lines in image 2 that lie in their 95 % bands, where they pass
    nearest to the matches, their median error and their median deviation."""
    ones = np.ones(len(matches))
    x1, x2 = np.c_[matches[:, :2], ones], np.c_[matches[:, 2:], ones]
    line, true_line = x1 @ f.T, x1 @ truth.T
    norm = np.hypot(line[:, 0], line[:, 1])
    foot = x2.copy()
    foot[:, :2] -= line[:, :2] * ((x2 * line).sum(1) / norm**2)[:, None]
    in_image = np.all((foot[:, :2] >= 0) & (foot[:, :2] < frame2), axis=1)
    x1, foot, line, true_line, norm = (a[in_image] for a in (x1, foot, line, true_line, norm))
    error = (foot * true_line).sum(1) / np.hypot(true_line[:, 0], true_line[:, 1])
    rows = (foot[:, :, None] * x1[:, None, :]).reshape(-1, 9)
    deviation = np.sqrt(np.maximum(0, np.einsum("ij,jk,ik->i", rows, covariance, rows))) / norm
    return np.mean(np.abs(error) < 1.96 * deviation), np.median(np.abs(error)), np.median(deviation)


def everywhere(frame1, frame2):
    """Returns a grid of points of image 1, each with the middle of image 2."""
    x, y = np.meshgrid(*((np.arange(10) + 0.5) / 10 * side for side in frame1))
    middle = np.array(frame2) / 2
    return np.c_[x.ravel(), y.ravel(), np.tile(middle, (100, 1))]


def epipole_inside(f, covariance, truth, frame, second):
    """Returns whether the true epipole lies in its 95 % ellipse, and its direction and its inverse
    distance from the middle of the image in their 95 % intervals."""
    order = np.arange(9).reshape(3, 3)
    if second:
        f, truth = f.T, truth.T
        covariance = covariance[np.ix_(order.T.ravel(), order.T.ravel())]
    # The origin in the middle of the image, and the longer side as the unit.
    side = max(frame)
    to_pixels = np.array([[side, 0, (frame[0] - 1) / 2], [0, side, (frame[1] - 1) / 2], [0, 0, 1]])
    # Epipoles in these units: F e = 0 becomes (F T) e = 0.
    f, truth = f @ to_pixels, truth @ to_pixels
    e, true_e = np.linalg.svd(f)[2][2], np.linalg.svd(truth)[2][2]
    true_e = true_e * (np.sign(e @ true_e) or 1)
    inverse = np.linalg.pinv(f, 1e-9)
    change = np.zeros((3, 9))
    for k in range(9):
        entry = np.zeros((3, 3))
        entry[k // 3, k % 3] = 1
        change[:, k] = -inverse @ entry @ to_pixels @ e
    spread = change @ covariance @ change.T
    plane = np.linalg.svd(e[None])[2][1:]
    off = plane @ (true_e / (true_e @ e) - e)
    squared = off @ np.linalg.solve(plane @ spread @ plane.T, off)
    along = np.hypot(e[0], e[1])
    turn = np.arctan2(e[0] * true_e[1] - e[1] * true_e[0], e[:2] @ true_e[:2])
    by_turn = np.array([-e[1], e[0], 0]) / along**2
    by_inverse = np.array([-e[2] * e[0], -e[2] * e[1], along**2]) / along**3
    nearness = true_e[2] / np.hypot(true_e[0], true_e[1]) - e[2] / along
    inside = [abs(value) < 1.96 * np.sqrt(by @ spread @ by) for value, by in ((turn, by_turn), (nearness, by_inverse))]
    return [squared < 5.99, *inside]


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--all"]
    if len(arguments) < 2:
        sys.exit(__doc__)
    program, *folders = arguments
    for folder in folders:
        lines, grids, epipoles = [], [], []
        for name, left, right, truth in pairs(folder):
            run = subprocess.run([program, "estimate", left, right, "--json", "-"], capture_output=True)
            if not run.stdout:
                continue
            found = json.loads(run.stdout)
            if found["covariance"] is None or found["verdict"] != "reliable" and "--all" not in sys.argv:
                continue
            f, covariance = np.array(found["fundamental"], float), np.array(found["covariance"], float)
            f /= np.linalg.norm(f)
            truth = truth / np.linalg.norm(truth) * (np.sign((f * truth).sum()) or 1)
            matches = np.array([m["pair"] for m in found["matches"]])
            frames = [(image["width"], image["height"]) for image in found["images"]]
            lines.append(lines_inside(f, covariance, truth, matches, frames[1]))
            grids.append(lines_inside(f, covariance, truth, everywhere(*frames), frames[1])[0])
            for second in (False, True):
                epipoles.append(epipole_inside(f, covariance, truth, frames[second], second))
        if not lines:
            print(f"{folder}: no results with a covariance; are there pairs with NAME_F.txt or NAME.P?")
            continue
        share, error, deviation = np.mean(lines, axis=0)
        ellipse, direction, distance = np.mean(epipoles, axis=0)
        print(
            f"{os.path.basename(os.path.abspath(folder))}: {len(lines)} results; inside 95 %: lines {share:.0%}, "
            f"lines of a grid {np.nanmean(grids):.0%}, epipoles {ellipse:.0%}, their direction {direction:.0%}, their inverse distance {distance:.0%}; "
            f"mean of the median error {error:.3f} px, of the deviation {deviation:.3f} px"
        )


if __name__ == "__main__":
    main()
