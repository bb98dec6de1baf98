#!/usr/bin/env python3
"""Compares robust fits of F to the same matches: OpenCV, PoseLib, pycolmap, pydegensac, pymagsac, kornia-rs and this package.

    python python/benchmarks/compare.py DATA [--matches DIR] [--sets A,B] [--seeds 5] [--json FILE]

DATA holds folders of pairs with known cameras: NAMEA.*, NAMEB.*, and NAME_K.txt with the rows of K1, K2, R and t; or with
known matches: NAME.txt with rows x1 y1 x2 y2. The matches are RootSIFT's with the ratio test, and those of DIR, files
SET_NAME.txt with rows x1 y1 x2 y2 and perhaps a score. Each method runs with every seed at four thresholds, and stands
at its best threshold; this package has none. Packages that are not installed are left out.

The table has the pose error, the larger of rotation and direction of the baseline in degrees, as AUC up to 1°, 5° and 10°
through the true K; for known matches the mean share within 1 to 10 px (mAA), and the share of fits whose mean distance is
below 1 px. Seconds are medians of a fit. A second table has what this package says of its fits, and how many of these are
right: a pose within 5°, or a mAA above one half.
Needs NumPy and OpenCV.
"""

import argparse
import collections
import glob
import importlib
import json
import os
import statistics
import time

import cv2
import numpy as np

import epiline

THRESHOLDS = (0.5, 1.0, 2.0, 4.0)  # px
LIMITS = (1, 5, 10)  # degrees


def optional(name):
    """Return a module, or None if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


poselib, pycolmap, pydegensac, pymagsac, kornia_rs = map(
    optional, ("poselib", "pycolmap", "pydegensac", "pymagsac", "kornia_rs")
)


def of_opencv(method):
    def fit(points1, points2, sizes, scores, threshold, seed):
        cv2.setRNGSeed(seed)
        found, _ = cv2.findFundamentalMat(points1, points2, method, threshold, 0.9999, 10000)
        return None if found is None else found[:3]

    return fit


def of_poselib(points1, points2, sizes, scores, threshold, seed):
    options = {"max_epipolar_error": threshold, "max_iterations": 20000, "success_prob": 0.9999, "seed": seed}
    return poselib.estimate_fundamental(points1, points2, options, {})[0]


def of_pycolmap(points1, points2, sizes, scores, threshold, seed):
    options = pycolmap.RANSACOptions()
    options.max_error = threshold
    pycolmap.set_random_seed(seed)
    found = pycolmap.estimate_fundamental_matrix(points1 + 0.5, points2 + 0.5, options)
    if found is None:
        return None
    shift = np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1]])
    return shift.T @ found["F"] @ shift


def of_pydegensac(points1, points2, sizes, scores, threshold, seed):
    return pydegensac.findFundamentalMatrix(points1, points2, threshold, 0.9999, 10000)[0]


def of_pymagsac(points1, points2, sizes, scores, threshold, seed):
    (h1, w1), (h2, w2) = (size[:2] for size in sizes)
    rows = np.ascontiguousarray(np.hstack([points1, points2]))
    found, _ = pymagsac.findFundamentalMatrix(rows, w1, h1, w2, h2, [], 0, True, threshold, 0.9999, 50, 10000)
    return found


def of_kornia(points1, points2, sizes, scores, threshold, seed):
    rows = np.ascontiguousarray(np.hstack([points1, points2]))
    try:
        found = kornia_rs.ransac.fundamental(rows, threshold, 10000, 0.9999, seed)
    except ValueError:
        return None
    return None if found is None else np.reshape(found.model, (3, 3))


# Results of this package by verdict and by what the matches determine.
said = collections.defaultdict(list)


def of_epiline(points1, points2, sizes, scores, threshold, seed):
    try:
        found = epiline.estimate_fundamental(points1, points2, sizes=sizes, confidences=scores, seed=seed)
    except epiline.EpilineError:
        return None
    # The one that says how sure it is.
    said[found.verdict, found.determined].append(found.F)
    return found.F


METHODS = {
    f"OpenCV {cv2.__version__} RANSAC": (of_opencv(cv2.FM_RANSAC), THRESHOLDS),
    f"OpenCV {cv2.__version__} LMedS": (of_opencv(cv2.FM_LMEDS), (None,)),
    f"OpenCV {cv2.__version__} MAGSAC++": (of_opencv(cv2.USAC_MAGSAC), THRESHOLDS),
    "PoseLib": (of_poselib, THRESHOLDS) if poselib else None,
    "pycolmap": (of_pycolmap, THRESHOLDS) if pycolmap else None,
    "pydegensac": (of_pydegensac, THRESHOLDS) if pydegensac else None,
    "pymagsac": (of_pymagsac, THRESHOLDS) if pymagsac else None,
    "kornia-rs": (of_kornia, THRESHOLDS) if kornia_rs else None,
    "Epiline": (of_epiline, (None,)),
}


def root_sift(image1, image2):
    """Return matches of RootSIFT features with the ratio test, and no scores."""
    sift = cv2.SIFT_create(8000)
    found = []
    for image in (image1, image2):
        keypoints, descriptors = sift.detectAndCompute(image, None)
        descriptors /= np.maximum(descriptors.sum(1, keepdims=True), 1e-9)
        found.append((np.array([k.pt for k in keypoints]), np.sqrt(descriptors)))
    (points1, first), (points2, second) = found
    pairs = cv2.BFMatcher().knnMatch(first, second, 2)
    good = [a for a, b in pairs if a.distance < 0.8 * b.distance]
    indices = np.array([(m.queryIdx, m.trainIdx) for m in good]).reshape(-1, 2)
    return points1[indices[:, 0]], points2[indices[:, 1]], None


def pose_error(F, K1, K2, R, t):
    """Return the larger error of rotation and direction of the baseline, degrees."""
    if F is None or np.shape(F) != (3, 3) or not np.isfinite(F).all():
        return 180.0
    turn1, turn2, direction = cv2.decomposeEssentialMat(K2.T @ F @ K1)
    off = abs(direction.ravel() @ t) / np.linalg.norm(t)
    turned = [np.clip((np.trace(turn.T @ R) - 1) / 2, -1, 1) for turn in (turn1, turn2)]
    return float(np.degrees(max(np.arccos(min(off, 1.0)), min(np.arccos(v) for v in turned))))


def auc(errors, limit):
    errors = np.sort(errors)
    recall = np.arange(1, len(errors) + 1) / len(errors)
    below = errors < limit
    last = recall[below][-1] if below.any() else 0.0
    return 100 * np.trapezoid(np.r_[0, recall[below], last], np.r_[0, errors[below], limit]) / limit


def accuracy(F, rows):
    """Return the mean share of known matches within 1 to 10 px of their lines, and whether their mean is below 1 px."""
    if F is None or np.shape(F) != (3, 3) or not np.isfinite(F).all():
        return 0.0, False
    # Some methods return matrices of rank 3.
    left, right = np.c_[rows[:, :2], np.ones(len(rows))], np.c_[rows[:, 2:4], np.ones(len(rows))]
    lines2, lines1 = left @ F.T, right @ F
    off = np.abs((lines2 * right).sum(1))
    distances = 0.5 * off * (1 / np.hypot(*lines1[:, :2].T) + 1 / np.hypot(*lines2[:, :2].T))
    within = [(2 * distances <= limit).mean() for limit in range(1, 11)]
    return float(np.mean(within)), bool(distances.mean() < 1)


def is_right(truth, value):
    """Return whether a pose is right to 5°, or half of the share of known matches within 1 to 10 px is there."""
    return value < 5 if truth == "pose" else value[0] > 0.5


def figures(truth, results):
    """Return the figures of a method at its best threshold: results by threshold, a list of one number for each fit."""
    score = (lambda values: auc(values, 5)) if truth == "pose" else (lambda values: np.mean(values, axis=0)[0])
    threshold = max(results, key=lambda key: score(results[key]))
    values = results[threshold]
    made = [auc(values, limit) for limit in LIMITS] if truth == "pose" else (100 * np.mean(values, axis=0)).tolist()
    return threshold, made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    parser.add_argument("--matches")
    parser.add_argument("--sets")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--every", type=int, default=1, help="one pair of so many")
    parser.add_argument("--json")
    arguments = parser.parse_args()
    sets = arguments.sets.split(",") if arguments.sets else sorted(os.listdir(arguments.data))
    written = []
    for folder in sets:
        stems = [path.rsplit("A.", 1)[0] for path in sorted(glob.glob(f"{arguments.data}/{folder}/*A.*"))]
        stems = [stem for stem in stems if os.path.exists(stem + "_K.txt") or os.path.exists(stem + ".txt")]
        results = collections.defaultdict(lambda: collections.defaultdict(list))
        seconds = collections.defaultdict(list)
        certainty = collections.defaultdict(lambda: collections.defaultdict(list))
        truth = None
        for stem in stems[:: arguments.every]:
            images = [cv2.imread(next(iter(glob.glob(glob.escape(stem) + side + ".*"))), 0) for side in "AB"]
            sizes = [image.shape for image in images]
            kinds = {"RootSIFT": root_sift(*images)}
            path = f"{arguments.matches}/{folder}_{os.path.basename(stem)}.txt"
            if arguments.matches and os.path.exists(path):
                rows = np.loadtxt(path, ndmin=2)
                scores = np.clip(rows[:, 4], 0.01, 1.0) if rows.shape[1] > 4 else None
                kinds["given"] = (rows[:, :2].copy(), rows[:, 2:4].copy(), scores)
            if os.path.exists(stem + "_K.txt"):
                truth, numbers = "pose", np.loadtxt(stem + "_K.txt")
                check = lambda F: pose_error(F, numbers[:3], numbers[3:6], numbers[6:9], numbers[9])
            else:
                truth, known = "matches", np.loadtxt(stem + ".txt", ndmin=2)
                check = lambda F: accuracy(F, known)
            for kind, (points1, points2, scores) in kinds.items():
                said.clear()
                for method, found in METHODS.items():
                    for threshold in found[1] if found else ():
                        for seed in range(arguments.seeds):
                            begun = time.perf_counter()
                            F = found[0](points1, points2, sizes, scores, threshold, seed) if len(points1) > 8 else None
                            seconds[kind, method].append(time.perf_counter() - begun)
                            results[kind, method][threshold].append(check(F))
                for words, matrices in said.items():
                    certainty[kind][words] += [is_right(truth, check(F)) for F in matrices]
        columns = ["AUC@1°", "@5°", "@10°"] if truth == "pose" else ["mAA 10 px", "below 1 px, %"]
        print(f"\n{folder}, {len(stems[:: arguments.every])} pairs\n")
        print("| matches | method | threshold, px | " + " | ".join(columns) + " | s |")
        print("|---" * (4 + len(columns)) + "|")
        for (kind, method), by_threshold in sorted(results.items()):
            threshold, made = figures(truth, by_threshold)
            time_ = statistics.median(seconds[kind, method])
            numbers = " | ".join(f"{value:.1f}" for value in made)
            print(f"| {kind} | {method} | {threshold or ''} | {numbers} | {time_:.3f} |", flush=True)
            written.append({"set": folder, "matches": kind, "method": method, "threshold": threshold,
                            "figures": dict(zip(columns, made)), "seconds": time_})
        print("\n| matches | verdict of Epiline | determined | fits | right |\n|---|---|---|---|---|")
        for kind, by_words in sorted(certainty.items()):
            for (verdict, determined), right in sorted(by_words.items(), key=str):
                share = f"{100 * np.mean(right):.0f} %"
                print(f"| {kind} | {verdict} | {determined or 'nothing'} | {len(right)} | {share} |", flush=True)
                written.append({"set": folder, "matches": kind, "verdict": verdict, "determined": determined,
                                "fits": len(right), "right": float(np.mean(right))})
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(written, file, indent=1)


if __name__ == "__main__":
    main()
