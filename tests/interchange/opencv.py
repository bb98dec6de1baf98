"""Reads and writes geometry files with OpenCV, for the test interchange.

    opencv.py read FILE      reads a FileStorage and prints its content and OpenCV's epipolar distances as JSON
    opencv.py write FOLDER   writes one geometry in every FileStorage format, and prints it as JSON
"""

import json
import sys

import cv2
import numpy

MATRICES = ["F", "e1", "e2", "P1", "P2", "H1", "H2", "points1", "points2"]


def read(path):
    storage = cv2.FileStorage(path, cv2.FILE_STORAGE_READ)
    assert storage.isOpened(), path
    found = {name: storage.getNode(name).mat() for name in MATRICES}
    fundamental, points1, points2 = found["F"], found["points1"], found["points2"]
    # Lines a x + b y + c = 0 with a² + b² = 1: inserting a point gives its distance.
    lines2 = cv2.computeCorrespondEpilines(points1.reshape(-1, 1, 2), 1, fundamental).reshape(-1, 3)
    lines1 = cv2.computeCorrespondEpilines(points2.reshape(-1, 1, 2), 2, fundamental).reshape(-1, 3)
    distance = lambda lines, points: abs((lines[:, :2] * points).sum(axis=1) + lines[:, 2])
    distances = 0.5 * (distance(lines2, points2) + distance(lines1, points1))
    check, image = storage.getNode("self_check"), storage.getNode("image1")
    print(json.dumps({
        "version": cv2.__version__,
        "matrices": {name: None if m is None else m.tolist() for name, m in found.items()},
        "mean": float(distances.mean()),
        "max": float(distances.max()),
        "stated_pairs": check.getNode("pairs").real(),
        "stated_mean": check.getNode("mean_distance").real(),
        "stated_max": check.getNode("max_distance").real(),
        "image1": [image.getNode("name").string(), image.getNode("width").real(), image.getNode("height").real()],
        "annihilated": [
            float(numpy.linalg.norm(fundamental @ found["e1"])),
            float(numpy.linalg.norm(fundamental.T @ found["e2"])),
        ],
    }))


def write(folder):
    random = numpy.random.default_rng(7)
    # Rank 2 and Frobenius norm 1, so that reading changes only the sign.
    a, b = random.normal(size=(3, 2)), random.normal(size=(2, 3))
    fundamental = (a @ b) * numpy.array([[1e-6, 1e-5, 1e-3], [1e-5, 1e-6, 1e-2], [1e-3, 1e-2, 1.0]])
    u, s, v = numpy.linalg.svd(fundamental)
    fundamental = u @ numpy.diag([s[0], s[1], 0.0]) @ v
    fundamental /= numpy.linalg.norm(fundamental)
    homography = numpy.eye(3) + 0.01 * random.normal(size=(3, 3))
    points1, points2 = random.uniform(0, 800, size=(2, 12, 2))
    for extension in ["yml", "xml", "json", "yml.gz"]:
        storage = cv2.FileStorage(f"{folder}/written.{extension}", cv2.FILE_STORAGE_WRITE)
        storage.writeComment("a comment: of OpenCV")
        storage.write("title", "text with: \"quotes\" & <brackets>")
        storage.write("F", fundamental)
        storage.write("H1", homography)
        storage.write("H2", homography.T)
        # Common representations of points: N×1 with two channels, and single precision.
        storage.write("points1", points1.reshape(-1, 1, 2))
        storage.write("points2", points2.astype(numpy.float32))
        storage.write("unknown", numpy.array([[numpy.nan, numpy.inf]]))
        storage.release()
    print(json.dumps({
        "F": fundamental.tolist(),
        "H1": homography.tolist(),
        "H2": homography.T.tolist(),
        "points1": points1.tolist(),
        "points2": points2.astype(numpy.float32).astype(float).tolist(),
    }))


{"read": read, "write": write}[sys.argv[1]](sys.argv[2])
