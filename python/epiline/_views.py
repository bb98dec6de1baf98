"""Pictures of results, and the window."""

from __future__ import annotations

import html as escape
import importlib
import json
import os
import subprocess
import sys
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _epiline
from ._errors import InputError

# Number of lines drawn, evenly spaced down the middle of image 1.
LINES = 9
# Opens the window, and removes its files afterwards.
WINDOW = """
import shutil, sys
from epiline._epiline import run
status = run(["epiline", *sys.argv[2:]])
shutil.rmtree(sys.argv[1], ignore_errors=True)
sys.exit(status)
"""
COLOURS = {"reliable": "#1FC798", "doubtful": "#F0A320", "unreliable": "#F0655B", "different scenes": "#B871F2"}


def _pictures(found: _epiline.Estimate) -> list[NDArray[np.uint8]]:
    pictures = found._pictures()
    if pictures is None:
        raise InputError("the result is of points without images, so there is nothing to draw")
    return [np.frombuffer(data, np.uint8).reshape(height, width, 3) for height, width, data in pictures]


def plot(found: _epiline.Estimate, ax: Any = None) -> Any:
    """Draw both images side by side, with numbered lines, matches and the verdict."""
    left, right = _pictures(found)
    plt = importlib.import_module("matplotlib.pyplot")

    ax = plt.subplots(figsize=(12, 5))[1] if ax is None else ax
    height = max(left.shape[0], right.shape[0])
    canvas = np.zeros((height, left.shape[1] + right.shape[1], 3), np.uint8)
    canvas[: left.shape[0], : left.shape[1]] = left
    canvas[: right.shape[0], left.shape[1] :] = right
    ax.imshow(canvas)
    colour = COLOURS.get(found.verdict or "", "#B871F2")
    offset = left.shape[1]
    ax.plot(*found.points1.T, ".", color=colour, markersize=2)
    ax.plot(found.points2[:, 0] + offset, found.points2[:, 1], ".", color=colour, markersize=2)
    if found.verdict not in ("unreliable", "different scenes"):
        middle = left.shape[1] / 2
        places = np.c_[np.full(LINES, middle), np.linspace(0, left.shape[0], LINES + 2)[1:-1]]
        second = _epiline.epilines(places, found.F, 1)
        for number, (place, line2) in enumerate(zip(places, second), 1):
            if not np.isfinite(line2).all():
                continue
            foot = -line2[2] * line2[:2]
            line1 = _epiline.epilines(foot[None], found.F, 2)[0]
            _draw(ax, line1, left.shape, 0, colour, number)
            _draw(ax, line2, right.shape, offset, colour, number)
    ax.set_title(f"{found.verdict or 'not judged'}, {len(found.points1)} matches", loc="left")
    ax.set_axis_off()
    return ax


def _draw(
    ax: Any, line: NDArray[np.float64], shape: tuple[int, ...], offset: int, colour: str, number: int
) -> None:
    """Draw a line where it crosses an image."""
    height, width = shape[0] - 1, shape[1] - 1
    a, b, c = line
    ends = []
    if abs(b) > 1e-12:
        ends += [(x, -(a * x + c) / b) for x in (0, width)]
    if abs(a) > 1e-12:
        ends += [(-(b * y + c) / a, y) for y in (0, height)]
    inside = sorted(
        {
            (round(x, 6), round(y, 6))
            for x, y in ends
            if -1e-6 <= x <= width + 1e-6 and -1e-6 <= y <= height + 1e-6
        }
    )
    if len(inside) < 2:
        return
    (x1, y1), (x2, y2) = inside[0], inside[-1]
    ax.plot([x1 + offset, x2 + offset], [y1, y2], color=colour, linewidth=1)
    label = {"facecolor": "black", "alpha": 0.75, "edgecolor": "none", "pad": 1.5}
    place = (0.95 * x1 + 0.05 * x2 + offset, 0.95 * y1 + 0.05 * y2)
    ax.text(*place, str(number), color="white", fontsize=8, ha="center", va="center", bbox=label)


def html(found: _epiline.Estimate) -> str:
    """Return the verdict and the figures as a table for notebooks."""
    rows: list[tuple[str, str]] = [("Verdict", found.verdict or "not judged")]
    if found.probability is not None:
        rows.append(("Lines within 1 % of the side", f"{100 * found.probability:.0f} %"))
    if found.determined:
        rows.append(("Determined", found.determined))
    rows.append(("Matches", str(len(found.points1))))
    if len(found.residuals):
        rows.append(("Typical distance of a match", f"{np.median(found.residuals):.2f} px"))
    rows += [("", reason) for reason in found.reasons]
    cells = "".join(f"<tr><th>{escape.escape(a)}</th><td>{escape.escape(b)}</td></tr>" for a, b in rows)
    return f"<table>{cells}</table>"


def show(found: _epiline.Estimate) -> None:
    """Open the window on the images and clicks of a result, in a process of its own."""
    pictures = _pictures(found)
    if found.is_undistorted:
        raise InputError("the window opens images as they are, and this result belongs to images without distortion")
    folder = tempfile.mkdtemp(prefix="epiline-")
    paths = []
    for name, picture, path in zip(("left", "right"), pictures, found._paths()):
        if path is None:
            path = os.path.join(folder, f"{name}.ppm")
            height, width = picture.shape[:2]
            with open(path, "wb") as file:
                file.write(f"P6 {width} {height} 255\n".encode() + picture.tobytes())
        paths.append(os.fspath(path))
    pairs = json.loads(found.to_json())["pairs"]
    clicks = [f"--pair={','.join(map(repr, pair))}" for pair in pairs]
    subprocess.Popen([sys.executable, "-c", WINDOW, folder, *paths, *clicks], start_new_session=True)
