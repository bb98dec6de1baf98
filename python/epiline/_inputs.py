"""Arrays in the forms that the extension takes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError


def numbers(value: Any, name: str) -> NDArray[np.float64]:
    """Return an array of float64 of anything that NumPy or a tensor library holds."""
    if hasattr(value, "detach"):
        value = value.detach().cpu().numpy()
    try:
        return np.asarray(value, dtype=np.float64)
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


def named_arrays(value: Any, origin: str | None = None) -> dict[str, NDArray[np.float64]]:
    """Return matches as a dictionary of arrays: of a matcher as they are, or of rows."""
    if isinstance(value, Mapping):
        found = {}
        for name, content in value.items():
            if isinstance(content, (str, bytes)) or content is None:
                continue
            try:
                found[str(name)] = np.ascontiguousarray(numbers(content, name))
            except InputError:
                continue
        if shift(origin):
            raise InputError("matches of a dictionary are in the convention of their matcher, so origin must be None")
        return found
    confidences = None
    if isinstance(value, (tuple, list)) and len(value) == 3:
        *value, confidences = value
    found = {"matches": rows(value, "matches", origin)}
    if confidences is not None:
        found["matching_scores"] = numbers(confidences, "confidences").ravel()
    if not len(found["matches"]):
        raise InputError("there are no matches")
    return found


def camera(value: Any, number: int) -> tuple[NDArray[np.float64], Sequence[float]]:
    """Return a calibration matrix and the coefficients of a lens."""
    coefficients: Sequence[float] = []
    if isinstance(value, (tuple, list)) and len(value) == 2 and np.ndim(value[0]) == 2:
        value, coefficients = value
        coefficients = [] if coefficients is None else numbers(coefficients, f"lens of camera {number}").ravel().tolist()
    return matrix(value, (3, 3), f"the matrix K of camera {number}"), coefficients


def cameras(value: Sequence[Any] | None) -> list[tuple[NDArray[np.float64], Sequence[float]]] | None:
    """Return both cameras. `None` without any."""
    if value is None:
        return None
    if len(value) != 2:
        raise InputError("cameras has one camera for each image")
    return [camera(value[0], 1), camera(value[1], 2)]


def image(value: Any) -> Any:
    """Return a path, or an array in native byte order."""
    if isinstance(value, (str, os.PathLike)):
        return value
    if hasattr(value, "detach"):
        value = value.detach().cpu().numpy()
    if isinstance(value, np.ndarray) and not value.dtype.isnative:
        value = value.astype(value.dtype.newbyteorder("="))
    return value


def changes(parameters: Mapping[str, Any] | None) -> list[str]:
    """Return changed parameters as `name=value`, with values in JSON."""
    return [f"{name}={json.dumps(value)}" for name, value in (parameters or {}).items()]
