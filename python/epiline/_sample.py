"""The built-in pairs."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _epiline


class Sample(NamedTuple):
    """Two drawn pictures with their exact geometry."""

    image1: Annotated[NDArray[np.uint8], "[h, w, 3]"]
    """Image 1 of shape (H, W, 3): red, green, blue."""
    image2: Annotated[NDArray[np.uint8], "[h, w, 3]"]
    """Image 2 of shape (H, W, 3)."""
    F: Annotated[NDArray[np.float64], "[3, 3]"]
    """Fundamental matrix of shape (3, 3): ``x2.T @ F @ x1 == 0``."""
    P1: Annotated[NDArray[np.float64], "[3, 4]"]
    """Projection matrix of image 1, of shape (3, 4)."""
    P2: Annotated[NDArray[np.float64], "[3, 4]"]
    """Projection matrix of image 2, of shape (3, 4)."""
    K1: Annotated[NDArray[np.float64], "[3, 3]"]
    """Calibration matrix of image 1, of shape (3, 3)."""
    K2: Annotated[NDArray[np.float64], "[3, 3]"]
    """Calibration matrix of image 2, of shape (3, 3)."""
    matches: Annotated[NDArray[np.float64], "[n, 4]"]
    """Exact matches at corners, rows x1 y1 x2 y2 of shape (N, 4), px, the most distinctive first."""
    clicks: Annotated[NDArray[np.float64], "[2, 4]"]
    """Two matches for a search from clicks, of shape (2, 4), px."""


def sample(name: Literal["courtyard", "alley"] = "courtyard") -> Sample:
    """Return a built-in pair with its exact geometry.

    Parameters
    ----------
    name : {"courtyard", "alley"}
        A camera that moves to the side, or one that moves forwards, with both epipoles inside the pictures.

    Returns
    -------
    Sample
        Both pictures, the matrix, the cameras, and matches.

    Raises
    ------
    InputError
        If there is no pair of this name.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample("alley")
    >>> pair.image1.shape, pair.matches.shape[1]
    ((576, 768, 3), 4)
    >>> bool(epiline.epipolar_distance(pair.F, pair.matches[:, :2], pair.matches[:, 2:]).max() < 1e-6)
    True
    """
    (image1, image2), F, (P1, P2), (K1, K2), (matches, clicks) = _epiline.sample(name)
    return Sample(image1, image2, F, P1, P2, K1, K2, matches, clicks)
