"""Pictures of results, and the window."""

from __future__ import annotations

import base64
import html as escape
import importlib
import io
import shutil
import subprocess
import sys
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _epiline
from ._errors import InputError

# Columns of a drawing that are resampled.
MOST_COLUMNS = 1600
# Opens the window, and removes its files afterwards.
WINDOW = """
import shutil, sys
from epiline import InputError
from epiline._epiline import show
try:
    show(sys.argv[2])
except InputError as problem:
    sys.exit(f"epiline: {problem}")
finally:
    shutil.rmtree(sys.argv[1], ignore_errors=True)
"""
COLOURS = {"reliable": "#1FC798", "doubtful": "#F0A320", "unreliable": "#F0655B", "different scenes": "#B871F2"}


def _pictures(found: _epiline.Estimate) -> list[NDArray[np.uint8]]:
    pictures = found._pictures()
    if pictures is None:
        raise InputError("the result is of points without images, so there is nothing to draw")
    return [np.frombuffer(data, np.uint8).reshape(height, width, 3) for height, width, data in pictures]


def plot(found: _epiline.Estimate, ax: Any = None) -> Any:
    """Draw both images side by side, with numbered lines, matches, epipoles and the verdict."""
    left, right = _pictures(found)
    if ax is None:
        ax = importlib.import_module("matplotlib.pyplot").subplots(figsize=(12, 5))[1]
    height, offset = max(left.shape[0], right.shape[0]), left.shape[1]
    canvas = np.zeros((height, offset + right.shape[1], 3), np.uint8)
    canvas[: left.shape[0], :offset] = left
    canvas[: right.shape[0], offset:] = right
    # Matplotlib resamples all pixels at each drawing.
    step = max(1, canvas.shape[1] // MOST_COLUMNS)
    ax.imshow(canvas[::step, ::step], extent=(-0.5, canvas.shape[1] - 0.5, height - 0.5, -0.5))
    colour = COLOURS.get(found.verdict or "", "#B871F2")
    shapes, shifts = (left.shape, right.shape), (0, offset)
    for points, shift in zip((found.points1, found.points2), shifts):
        ax.plot(points[:, 0] + shift, points[:, 1], ".", color=colour, markersize=2)
    # Lines of an unreliable geometry would be taken for an answer.
    if found.verdict not in ("unreliable", "different scenes"):
        for number, parts in found._lines():
            for part, shift in zip(parts, shifts):
                if part is not None:
                    _draw(ax, np.array(part) + [shift, 0], colour, number)
        for epipole, shape, shift in zip(found.epipoles, shapes, shifts):
            _mark(ax, epipole, shape, shift)
    ax.set_title(f"{found.verdict or 'not judged'}, {len(found.points1)} matches", loc="left")
    ax.set_xlim(-0.5, canvas.shape[1] - 0.5)
    ax.set_ylim(height - 0.5, -0.5)
    ax.set_axis_off()
    return ax


def _draw(ax: Any, ends: NDArray[np.float64], colour: str, number: int) -> None:
    """Draw a part of a line, with its number at the second end."""
    ax.plot(*ends.T, color=colour, linewidth=1)
    place = 0.05 * ends[0] + 0.95 * ends[1]
    label = {"facecolor": "black", "alpha": 0.75, "edgecolor": "none", "pad": 1.5}
    ax.text(*place, str(number), color="white", fontsize=8, ha="center", va="center", bbox=label)


def _mark(ax: Any, epipole: NDArray[np.float64], shape: tuple[int, ...], shift: int) -> None:
    """Draw an epipole that is inside its image."""
    if abs(epipole[2]) < 1e-12:
        return
    x, y = epipole[:2] / epipole[2]
    if -0.5 <= x < shape[1] - 0.5 and -0.5 <= y < shape[0] - 0.5:
        style = {"markersize": 9, "markerfacecolor": "none", "markeredgecolor": "white", "markeredgewidth": 1.5}
        ax.plot([x + shift], [y], "o", **style)


def png(found: _epiline.Estimate) -> bytes | None:
    """Return the drawing of a result as a PNG. `None` without images or without matplotlib."""
    if found._pictures() is None:
        return None
    try:
        figure = importlib.import_module("matplotlib.figure")
        agg = importlib.import_module("matplotlib.backends.backend_agg")
    except ImportError:
        return None
    # A figure beside pyplot is freed with its last reference.
    drawn = figure.Figure(figsize=(10, 4.2), dpi=90, layout="constrained")
    agg.FigureCanvasAgg(drawn)
    plot(found, drawn.add_subplot())
    data = io.BytesIO()
    drawn.savefig(data, format="png", bbox_inches="tight", pad_inches=0.05)
    return data.getvalue()


def html(found: _epiline.Estimate) -> str:
    """Return the verdict, the figures and the drawing for notebooks."""
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
    picture = png(found)
    if picture is None:
        return f"<table>{cells}</table>"
    words = "Both images with numbered epipolar lines and matches"
    source = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
    return f'<table>{cells}</table><img alt="{words}" src="{source}">'


def show(found: _epiline.Estimate) -> None:
    """Open the window on a result, in a process of its own."""
    folder = tempfile.mkdtemp(prefix="epiline-")
    try:
        session = found._hand_over(folder)
    except Exception:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    subprocess.Popen([sys.executable, "-c", WINDOW, folder, session], start_new_session=True)
