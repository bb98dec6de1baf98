"""Arrays in the forms that the extension takes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError


def on_host(value: Any) -> Any:
    """Return tensors, and lists of tensors, as arrays in the memory of the processor."""
    if hasattr(value, "detach"):
        return value.detach().cpu().numpy()
    if isinstance(value, (tuple, list)) and value and hasattr(value[0], "detach"):
        return [on_host(each) for each in value]
    return value


def numbers(value: Any, name: str) -> NDArray[np.float64]:
    """Return an array of float64 of anything that NumPy or a tensor library holds."""
    try:
        return np.asarray(on_host(value), dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is no array of numbers: {error}") from None


def points(value: Any, name: str) -> NDArray[np.float64]:
    """Return an array of shape (N, 2)."""
    array = numbers(value, name)
    if array.ndim == 3 and array.shape[0] == 1:
        array = array[0]
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"{name} has the shape {array.shape}, and (N, 2) is needed")
    return array


def matrix(value: Any, shape: tuple[int, int], name: str) -> NDArray[np.float64]:
    """Return an array of this shape."""
    array = numbers(value, name)
    if array.shape != shape:
        raise InputError(f"{name} has the shape {array.shape}, and {shape} is needed")
    return array


def shift(origin: str | None) -> float:
    """Return the coordinate of the centre of the upper left pixel in the convention `origin`."""
    if origin is None:
        return 0.0
    if origin == "colmap":
        return 0.5
    raise InputError(f'origin is None or "colmap", not {origin!r}')


def rows(value: Any, name: str, origin: str | None = None) -> NDArray[np.float64]:
    """Return pairs as an array of shape (N, 4): from one of (N, 4), or from two of (N, 2)."""
    if isinstance(value, (tuple, list)) and len(value) == 2 and np.ndim(value[0]) >= 2:
        first, second = points(value[0], f"{name}[0]"), points(value[1], f"{name}[1]")
        if len(first) != len(second):
            raise InputError(f"{name} has {len(first)} points in image 1 and {len(second)} in image 2")
        array = np.hstack([first, second])
    else:
        array = numbers(value, name)
        if array.size == 0:
            array = array.reshape(0, 4)
        if array.ndim != 2 or array.shape[1] != 4:
            raise InputError(
                f"{name} has the shape {array.shape}. (N, 4) with rows x1 y1 x2 y2 is needed, or two arrays (N, 2)"
            )
    return array - shift(origin)


def named_arrays(value: Any, origin: str | None = None) -> dict[str, NDArray[np.float64] | None]:
    """Return matches as a dictionary of arrays: of a matcher as they are, or of rows.

    What is no array is `None`. It keeps its name: beside `matches`, keypoints are not matched row by row.
    """
    found: dict[str, NDArray[np.float64] | None] = {}
    if isinstance(value, Mapping):
        if shift(origin):
            raise InputError("matches of a dictionary are in the convention of their matcher, so origin must be None")
        for name, content in value.items():
            if content is None and ("score" in str(name) or "conf" in str(name)):
                continue
            try:
                found[str(name)] = None if content is None else np.ascontiguousarray(numbers(content, name))
            except InputError:
                found[str(name)] = None
        return found
    confidences = None
    if isinstance(value, (tuple, list)) and len(value) == 3 and np.ndim(value[0]) >= 2:
        *value, confidences = value
    both = rows(value, "matches", origin)
    if not len(both):
        raise InputError("there are no matches")
    found["matches"] = both
    if confidences is not None:
        scores = numbers(confidences, "confidences").ravel()
        if len(scores) != len(both):
            raise InputError(f"confidences has {len(scores)} numbers for {len(both)} matches")
        found["matching_scores"] = scores
    return found


def vector(value: Any, length: int, name: str) -> list[float]:
    """Return this many numbers."""
    array = numbers(value, name)
    if array.shape != (length,):
        raise InputError(f"{name} has the shape {array.shape}, and {length} numbers are needed")
    found: list[float] = array.tolist()
    return found


def size(value: Any, name: str) -> list[int]:
    """Return height and width of the shape of an image."""
    array = numbers(value, name)
    if array.ndim != 1 or len(array) not in (2, 3) or not (array[:2] >= 1).all() or (array[:2] > 1e6).any():
        raise InputError(f"{name} is the shape (height, width) of an image, px, not {value!r}")
    return [int(array[0]), int(array[1])]


def sizes(value: Any) -> list[list[int]] | None:
    """Return the sizes of both images. `None` without any."""
    if value is None:
        return None
    if len(value) != 2:
        raise InputError("sizes has the shape of each image")
    return [size(value[0], "sizes[0]"), size(value[1], "sizes[1]")]


def camera(value: Any, number: int) -> tuple[NDArray[np.float64], Sequence[float]]:
    """Return a calibration matrix and the coefficients of a lens."""
    coefficients: Sequence[float] = []
    if isinstance(value, (tuple, list)) and len(value) == 2 and np.ndim(value[0]) == 2:
        value, coefficients = value
        coefficients = [] if coefficients is None else numbers(coefficients, f"lens of camera {number}").ravel().tolist()
    return matrix(value, (3, 3), f"the matrix K of camera {number}"), coefficients


def is_path(value: Any) -> bool:
    """Return whether this is the path of a file."""
    return isinstance(value, (str, os.PathLike))


def cameras(value: Any) -> Sequence[tuple[NDArray[np.float64], Sequence[float]]] | list[Any] | None:
    """Return both cameras, or the paths of a calibration. `None` without any."""
    if value is None:
        return None
    if is_path(value):
        return [value]
    if not hasattr(value, "__len__") or len(value) != 2:
        raise InputError("cameras has one camera for each image, or is the path of a calibration")
    paths = [is_path(each) for each in value]
    if all(paths):
        return list(value)
    if any(paths):
        raise InputError("cameras are two matrices K or files of a calibration, not one of each")
    return [camera(value[0], 1), camera(value[1], 2)]


def judged_cameras(value: Any) -> Sequence[NDArray[np.float64]] | list[Any] | None:
    """Return both projection matrices, or the paths of a calibration. `None` without any."""
    if value is None:
        return None
    if is_path(value):
        return [value]
    words = "cameras are two projection matrices, or the path of a calibration"
    if not hasattr(value, "__len__") or len(value) != 2:
        raise InputError(words)
    paths = [is_path(each) for each in value]
    if all(paths):
        return list(value)
    if any(paths):
        raise InputError(words)
    return [matrix(P, (3, 4), "a projection matrix") for P in value]


def image(value: Any) -> Any:
    """Return a path, or an array in native byte order."""
    if is_path(value):
        return value
    value = on_host(value)
    if isinstance(value, np.ndarray) and not value.dtype.isnative:
        value = value.astype(value.dtype.newbyteorder("="))
    return value


def frames(value: Any, name: str) -> Any:
    """Return a path, or an iterator over images."""
    if is_path(value):
        return value
    value = on_host(value)
    is_one_image = isinstance(value, np.ndarray) and (value.ndim < 3 or value.ndim == 3 and value.shape[2] <= 4)
    if is_one_image:
        raise InputError(f"{name} has the shape {value.shape}. (N, H, W) or (N, H, W, 3) is needed, or a list of images")
    try:
        return map(image, value)
    except TypeError:
        raise InputError(f"{name} is a path, an array or a list of images, not {type(value).__name__}") from None


def changes(parameters: Mapping[str, Any] | None) -> list[str]:
    """Return changed parameters as `name=value`, with values in JSON."""
    changed = []
    for name, value in (parameters or {}).items():
        if name in ("seed", "preset"):
            raise InputError(f"{name} is an argument of its own")
        if name == "method":
            raise InputError("the method follows from the number of pairs")
        try:
            changed.append(f"{name}={json.dumps(value.item() if isinstance(value, np.generic) else value)}")
        except TypeError:
            raise InputError(f"the parameter {name} is no number, text or truth value: {value!r}") from None
    return changed
