#!/usr/bin/env python3
"""How often true geometries are found sound, and common mistakes are found and named.

    python3 lab/judge.py PROGRAM FOLDER... [--every N]

PROGRAM is the command-line program; the folders are those of coverage.py. Every true matrix is
judged as it is, and every Nth (all by default, none with 0) with each mistake of MISTAKES, and of
CAMERA_MISTAKES where there are cameras. A mistake counts if the truth is found sound and the mistake
moves half of the lines by more than 1 px. Needs NumPy.
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


INVERTED = lambda r, t: (r.T, -r.T @ t)
OPENGL = np.diag([1, -1, -1.0])
# Name and wrong pose of a camera [R | t].
CAMERA_MISTAKES = [
    ("camera to world", INVERTED),
    ("axes of OpenGL", lambda r, t: (OPENGL @ r, OPENGL @ t)),
    ("position for translation", lambda r, t: (r, -r.T @ t)),
    ("rotation inverted", lambda r, t: (r.T, t)),
]


def taken_apart(camera):
    """Returns K, R and t of a camera, with positive focal lengths."""
    reverse = np.eye(3)[::-1]
    q, r = np.linalg.qr((reverse @ camera[:, :3]).T)
    k, rotation = reverse @ r.T @ reverse, reverse @ q.T
    signs = np.diag(np.sign(np.diag(k)))
    k, rotation = k @ signs, signs @ rotation
    t = np.linalg.solve(k, camera[:, 3]) * np.sign(np.linalg.det(rotation))
    return k / k[2, 2], rotation * np.sign(np.linalg.det(rotation)), t


def judged(program, folder, left, right, *matrices):
    """Returns the exit status and the judgement of a matrix, or of two cameras."""
    paths = [os.path.join(folder, f"{k}.txt") for k in range(len(matrices))]
    for path, matrix in zip(paths, matrices):
        np.savetxt(path, matrix / np.linalg.norm(matrix), fmt="%.17g")
    result = os.path.join(folder, "judgement.json")
    what = "--fundamental" if len(matrices) == 1 else "--cameras"
    command = [program, "judge", left, right, what, *paths, "--json", result]
    status = subprocess.run(command, capture_output=True, check=False).returncode
    with open(result, encoding="utf-8") as file:
        return status, json.load(file)


def size(path, program, folder):
    """Returns width and height, by way of the program's own reader."""
    result = os.path.join(folder, "estimate.json")
    subprocess.run([program, "estimate", *path, "--json", result], capture_output=True, check=False)
    with open(result, encoding="utf-8") as file:
        return [(image["width"], image["height"]) for image in json.load(file)["images"]]


def main(program, folders, every):
    statuses, counts = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        everything = [pair for f in folders for pair in pairs(f)]
        for number, (name, left, right, truth) in enumerate(everything):
            status, found = judged(program, folder, left, right, truth)
            statuses[status] += 1
            if status:
                print(f"{name}: the truth {found['message']}")
                continue
            if not every or number % every:
                continue
            sizes = size((left, right), program, folder)
            wrong = []
            for mistake, maps, kinds in MISTAKES:
                m1, m2 = (np.linalg.inv(m) for m in maps(sizes)) if maps else (SAME, SAME)
                wrong.append((mistake, kinds, [m2.T @ (truth if maps else truth.T) @ m1]))
            cameras = [os.path.splitext(path)[0] + ".P" for path in (left, right)]
            if all(map(os.path.exists, cameras)):
                parts = [taken_apart(np.loadtxt(camera)) for camera in cameras]
                for mistake, pose in CAMERA_MISTAKES:
                    mistaken = [k @ np.column_stack(pose(r, t)) for k, r, t in parts]
                    wrong.append((mistake, ["cameras"], mistaken))
            for mistake, kinds, matrices in wrong:
                status, found = judged(program, folder, left, right, *matrices)
                if found["lines_apart"]["median"] > 1:
                    kind = (found["change"] or {}).get("kind")
                    counts[mistake, "all"] += 1
                    counts[mistake, "found"] += status == 1
                    counts[mistake, "named"] += kind in kinds
                    if status != 1:
                        print(f"{name}: {mistake}: {found['message']}")
            print(f"{number + 1} of {len(everything)}: {name}", file=sys.stderr)
    print("true matrices: sound {}, not sound {}, undecided {}".format(*(statuses[k] for k in range(3))))
    for mistake, *_ in MISTAKES + CAMERA_MISTAKES:
        found, named, all_ = (counts[mistake, k] for k in ("found", "named", "all"))
        print(f"{mistake:28} found {found}, named {named} of {all_}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    arguments = sys.argv[2:]
    step = 1
    if "--every" in arguments:
        at = arguments.index("--every")
        step = int(arguments[at + 1])
        del arguments[at : at + 2]
    main(sys.argv[1], arguments, step)
