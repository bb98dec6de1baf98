"""Lines, distances, conventions, rectification, and matches of points and of lines."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from . import _epiline, _inputs
from ._epiline import LineMatch, Reading, Rectification, Suggestion
from ._types import Cameras, Image, Matrix, Points, Rows


def epilines(
    points: Points, F: Matrix, *, image: Literal[1, 2] = 1
) -> Annotated[NDArray[np.float64], "[n, 3]"]:
    """Return the epipolar lines of points of one image in the other.

    Parameters
    ----------
    points : array of shape (N, 2), float64
        Points of image 1 or 2, px.
    F : array of shape (3, 3), float64
    image : {1, 2}
        The image of the points.

    Returns
    -------
    array of shape (N, 3), float64
        Rows a b c with ``a x + b y + c == 0`` and a unit normal, px; NaN for a point at the epipole.

    Raises
    ------
    InputError
        If an array has another shape, or F is no fundamental matrix.

    Examples
    --------
    >>> import epiline
    >>> epiline.epilines([[10, 20]], [[0, 0, 0], [0, 0, -1], [0, 1, 0]]).tolist()
    [[0.0, -1.0, 20.0]]
    """
    return _epiline.epilines(_inputs.points(points, "points"), _inputs.matrix(F, (3, 3), "F"), image)


def epipolar_distance(
    F: Matrix,
    points1: Points,
    points2: Points,
    kind: Literal["symmetric", "sampson", "algebraic"] = "symmetric",
) -> Annotated[NDArray[np.float64], "[n]"]:
    """Return the distances of matches from their epipolar lines.

    Parameters
    ----------
    F : array of shape (3, 3), float64
    points1, points2 : arrays of shape (N, 2), float64
        Row k of both is a match, px.
    kind : {"symmetric", "sampson", "algebraic"}
        Mean distance in both images, px; Sampson distance, px; or ``x2.T @ F @ x1`` with ``F`` of norm 1.

    Returns
    -------
    array of shape (N,), float64

    Raises
    ------
    InputError
        If an array has another shape, or F is no fundamental matrix.

    Examples
    --------
    >>> import epiline
    >>> F = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
    >>> epiline.epipolar_distance(F, [[10, 20]], [[40, 22]], "sampson").round(3).tolist()
    [1.414]
    """
    rows = _inputs.rows((_inputs.points(points1, "points1"), _inputs.points(points2, "points2")), "points")
    return _epiline.epipolar_distance(_inputs.matrix(F, (3, 3), "F"), rows, kind)


def rectify(
    F: Matrix,
    size1: tuple[int, int],
    size2: tuple[int, int],
    *,
    matches: Rows | None = None,
    cameras: Cameras | None = None,
    method: Literal["auto", "planar", "polar"] = "auto",
    max_pixels: int | None = None,
) -> Rectification:
    """Bring matching points of two images into the same row.

    Parameters
    ----------
    F : array of shape (3, 3), float64
    size1, size2 : shapes (H, W)
        Sizes of the images, px: ``image.shape``.
    matches : as `pairs` of `estimate`, optional
        They measure the rows. With an epipole inside an image or with cameras they are needed.
    cameras : as for `estimate`, optional
        Both cameras turn about their centres, and `Q` is known.
    method : {"auto", "planar", "polar"}
    max_pixels : int, optional
        Largest number of pixels of a rectified picture.

    Returns
    -------
    Rectification
        ``cv2.remap(image1, *found.maps(1), cv2.INTER_LINEAR)`` draws a picture.

    Raises
    ------
    InputError
        If an array, a size, a camera or the method is wrong, or if the images cannot be rectified.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> found = epiline.rectify(pair.F, pair.image1.shape, pair.image2.shape, matches=pair.matches)
    >>> found.method, [map.shape == (*found.size,) for map in found.maps(1)]
    ('planar', [True, True])
    """
    return _epiline.rectify(
        _inputs.matrix(F, (3, 3), "F"),
        _inputs.size(size1, "size1"),
        _inputs.size(size2, "size2"),
        None if matches is None else _inputs.rows(matches, "matches"),
        _inputs.cameras(cameras),
        method,
        max_pixels,
    )


def check_convention(F: Matrix, points1: Points, points2: Points) -> list[Reading]:
    """Test under which convention a matrix fits matches: transposed, x and y exchanged, another origin, another size.

    Parameters
    ----------
    F : array of shape (3, 3), float64
    points1, points2 : arrays of shape (N, 2), float64
        Row k of both is a match, px. At least 8.

    Returns
    -------
    list of Reading
        The most credible first. `told_apart` says whether the matches distinguish a reading from the first.

    Raises
    ------
    InputError
        If an array is wrong, or the matches are fewer than 8.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> epiline.check_convention(pair.F.T, pair.matches[:, :2], pair.matches[:, 2:])[0].transposed
    True
    """
    rows = _inputs.rows((_inputs.points(points1, "points1"), _inputs.points(points2, "points2")), "points")
    return _epiline.check_convention(_inputs.matrix(F, (3, 3), "F"), rows)


def suggest(
    image1: Image,
    image2: Image,
    at: tuple[float, float],
    *,
    F: Matrix | None = None,
    image: Literal[1, 2] = 1,
    threads: int | None = None,
) -> list[Suggestion]:
    """Suggest the match of a point of one image in the other.

    Parameters
    ----------
    image1, image2 : path or array of shape (H, W), (H, W, 3) or (H, W, 4)
        uint8, uint16 or float32.
    at : (x, y)
        The point, px.
    F : array of shape (3, 3), float64, optional
        Only the epipolar line of the point is searched.
    image : {1, 2}
        The image of the point.

    Returns
    -------
    list of Suggestion
        The best first. `is_clear` says whether it has no rival and leads back to the point.

    Raises
    ------
    InputError
        If an image, the point or the matrix is wrong.
    NoGeometryError
        If nothing in the other image looks like the surroundings of the point.

    Examples
    --------
    >>> import epiline, numpy as np
    >>> pair = epiline.sample()
    >>> x1, y1, *match = pair.clicks[0]
    >>> best = epiline.suggest(pair.image1, pair.image2, (x1, y1), F=pair.F)[0]
    >>> bool(np.hypot(*(np.array(best.position) - match)) < 2)
    True
    """
    return _epiline.suggest(
        _inputs.image(image1),
        _inputs.image(image2),
        _inputs.vector(at, 2, "at"),
        None if F is None else _inputs.matrix(F, (3, 3), "F"),
        image,
        threads,
    )


def line_similarity(
    image1: Image,
    image2: Image,
    line1: tuple[float, float, float, float],
    line2: tuple[float, float, float, float],
) -> LineMatch:
    """Match the intensities along two lines by dynamic programming.

    Parameters
    ----------
    image1, image2 : path or array of shape (H, W), (H, W, 3) or (H, W, 4)
        uint8, uint16 or float32.
    line1, line2 : (x, y, dx, dy)
        An anchor, px, and a direction. The anchors show the same scene point.

    Returns
    -------
    LineMatch
        The cost, the disparities, and profile 2 warped onto profile 1.

    Raises
    ------
    InputError
        If an image is wrong, or a line is none or does not cross its image.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> x1, y1, x2, y2 = pair.clicks[0]
    >>> a, b, _ = epiline.epilines([[x1, y1]], pair.F)[0]
    >>> c, d, _ = epiline.epilines([[x2, y2]], pair.F, image=2)[0]
    >>> right = epiline.line_similarity(pair.image1, pair.image2, (x1, y1, d, -c), (x2, y2, b, -a))
    >>> wrong = epiline.line_similarity(pair.image1, pair.image2, (x1, y1, d, -c), (x2, y2, a, b))
    >>> right.cost < wrong.cost
    True
    """
    return _epiline.line_similarity(
        _inputs.image(image1),
        _inputs.image(image2),
        _inputs.vector(line1, 4, "line1"),
        _inputs.vector(line2, 4, "line2"),
    )
