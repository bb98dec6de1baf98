#!/usr/bin/env python3
"""How often true geometries are found sound, and common mistakes are found and named.

    python3 lab/judge.py PROGRAM FOLDER...

PROGRAM is the command-line program; the folders are those of coverage.py. Every true matrix is
judged as it is and with each mistake of MISTAKES. A mistake counts if the images call the truth
sound and it moves half of the lines by more than 1 px. Needs NumPy.
"""

import collections
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

from coverage import pairs


def affine(scale, x, y):
    return np.array([[scale, 0, x], [0, scale, y], [0, 0, 1.0]])


def flip(size, horizontally, vertically):
    (w, h), sign = size, (lambda flipped: -1 if flipped else 1)
    return np.array([
        [sign(horizontally), 0, (w - 1) * horizontally],
        [0, sign(vertically), (h - 1) * vertically],
        [0, 0, 1.0],
    ])


SAME = np.eye(3)
EXCHANGED = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1.0]])
HALF = affine(0.5, -0.25, -0.25)
# Name, maps of the pixels of both images (None: transposed), kinds of change that name it.
MISTAKES = [
    ("transposed", None, ["convention"]),
    ("x and y exchanged", lambda s: (EXCHANGED, EXCHANGED), ["convention"]),
    ("half size", lambda s: (HALF, HALF), ["resized", "focal-length"]),
    ("right image at half size", lambda s: (SAME, HALF), ["resized"]),
    ("cropped", lambda s: (affine(1, -0.06 * s[0][0], 0.04 * s[0][1]),) * 2, ["moved"]),
    ("left image cropped", lambda s: (affine(1, -0.05 * s[0][0], -0.05 * s[0][1]), SAME), ["moved"]),
    ("mirrored", lambda s: (flip(s[0], 1, 0), flip(s[1], 1, 0)), ["mirrored"]),
    ("y from the bottom", lambda s: (flip(s[0], 0, 1), flip(s[1], 0, 1)), ["mirrored"]),
    ("right image turned by 180°", lambda s: (SAME, flip(s[1], 1, 1)), ["mirrored"]),
]


def judged(program, folder, left, right, f):
    """Returns the exit status and the judgement of a matrix."""
    path, result = os.path.join(folder, "f.txt"), os.path.join(folder, "judgement.json")
    np.savetxt(path, f / np.linalg.norm(f), fmt="%.17g")
    command = [program, "judge", left, right, "--fundamental", path, "--json", result]
    status = subprocess.run(command, capture_output=True, check=False).returncode
    with open(result, encoding="utf-8") as file:
        return status, json.load(file)


def size(path, program, folder):
    """Returns width and height, by way of the program's own reader."""
    result = os.path.join(folder, "estimate.json")
    subprocess.run([program, "estimate", *path, "--json", result], capture_output=True, check=False)
    with open(result, encoding="utf-8") as file:
        return [(image["width"], image["height"]) for image in json.load(file)["images"]]


def main(program, folders):
    statuses, counts = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        for name, left, right, truth in (pair for f in folders for pair in pairs(f)):
            status, found = judged(program, folder, left, right, truth)
            statuses[status] += 1
            if status:
                print(f"{name}: the truth {found['message']}")
                continue
            sizes = size((left, right), program, folder)
            for mistake, maps, kinds in MISTAKES:
                wrong = truth.T
                if maps:
                    m1, m2 = (np.linalg.inv(m) for m in maps(sizes))
                    wrong = m2.T @ truth @ m1
                status, found = judged(program, folder, left, right, wrong)
                if found["lines_apart"]["median"] > 1:
                    kind = (found["change"] or {}).get("kind")
                    counts[mistake, "all"] += 1
                    counts[mistake, "found"] += status == 1
                    counts[mistake, "named"] += kind in kinds
    print("true matrices: sound {}, not sound {}, undecided {}".format(*(statuses[k] for k in range(3))))
    for mistake, *_ in MISTAKES:
        found, named, all_ = (counts[mistake, k] for k in ("found", "named", "all"))
        print(f"{mistake:28} found {found}, named {named} of {all_}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
