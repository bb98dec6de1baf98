"""Epipolar geometry of two images that says how far it can be trusted.

Points are pixels ``x, y``; the centre of the upper left pixel is (0, 0). ``F`` maps image 1 to image 2:
``x2.T @ F @ x1 == 0``. The same input and seed give the same result on any number of threads.

>>> import epiline, numpy as np
>>> F = np.array([[0, 0, 0], [0, 0, -1], [0, 1, 0.0]])
>>> epiline.epipolar_distance(F, [[10, 20]], [[40, 23]]).round(9).tolist()
[3.0]
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _epiline, _inputs
from ._epiline import (
    Estimate,
    Judgement,
    LineMatch,
    Reading,
    Rectification,
    Suggestion,
    __version__,
)
from ._errors import EpilineError, InputError, NoGeometryError

__all__ = [
    "EpilineError",
    "Estimate",
    "InputError",
    "Judgement",
    "LineMatch",
    "NoGeometryError",
    "Reading",
    "Rectification",
    "Suggestion",
    "__version__",
    "check_convention",
    "epilines",
    "epipolar_distance",
    "estimate",
    "estimate_fundamental",
    "estimate_relative_pose",
    "judge",
    "line_similarity",
    "rectify",
    "suggest",
]

Image: TypeAlias = "str | PathLike[str] | NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]"
Points: TypeAlias = Annotated[ArrayLike, "float64", "[n, 2]"]
Rows: TypeAlias = "Annotated[ArrayLike, 'float64', '[n, 4]'] | tuple[ArrayLike, ArrayLike]"
Matches: TypeAlias = "Rows | tuple[ArrayLike, ArrayLike, ArrayLike] | Mapping[str, Any]"
Matrix: TypeAlias = Annotated[ArrayLike, "float64", "[3, 3]"]
Camera: TypeAlias = "Matrix | tuple[Matrix, ArrayLike | None]"
Origin: TypeAlias = "Literal['colmap'] | None"


def estimate(
    image1: Image,
    image2: Image,
    pairs: Rows | None = None,
    *,
    matches: Matches | None = None,
    cameras: Sequence[Camera] | None = None,
    preset: Literal["robust", "paper"] = "robust",
    seed: int = 0,
    threads: int | None = None,
    parameters: Mapping[str, Any] | None = None,
    progress: Callable[[str, float], object] | None = None,
    origin: Origin = None,
) -> Estimate:
    """Find the fundamental matrix of two images, from clicked pairs or without any.

    Parameters
    ----------
    image1, image2 : path or array of shape (H, W), (H, W, 3) or (H, W, 4)
        uint8, uint16 or float32; colours are red, green, blue. Arrays of 16 bits and of floats are read as files of
        such numbers are: their range is found in the picture.
    pairs : array of shape (N, 4) with rows x1 y1 x2 y2, or two arrays of shape (N, 2), optional
        Clicked pairs, px. Two are enough.
    matches : as `pairs`, three arrays with confidences last, or the dictionary of a matcher, optional
        Matches of another program. Dictionaries of LightGlue, LoFTR, kornia and others are read by the names of their
        arrays; `remarks` of the result says how.
    cameras : two calibration matrices K, or two tuples (K, distortion), optional
        Distortion as OpenCV has it: 4, 5, 8 or 12 coefficients. With distortion, the result belongs to the images
        without it (`is_undistorted`).
    preset : {"robust", "paper"}
    seed : int
        Seed of the random numbers.
    threads : int, optional
        Number of threads, by default one for each core.
    parameters : mapping of names to values, optional
        Changed parameters by their names in result files.
    progress : callable, optional
        Called with the name of each stage and the seconds until it began.
    origin : {None, "colmap"}
        "colmap" if the centre of the upper left pixel is (0.5, 0.5) in `pairs` and `matches`.

    Returns
    -------
    Estimate
        The matrix, its evidence and its verdict.

    Raises
    ------
    InputError
        If an image, an array or a parameter is wrong.
    NoGeometryError
        If no geometry was found.
    """
    return _epiline.estimate(
        _inputs.image(image1),
        _inputs.image(image2),
        None if pairs is None else _inputs.rows(pairs, "pairs", origin),
        None if matches is None else _inputs.named_arrays(matches, origin),
        _inputs.cameras(cameras),
        preset,
        seed,
        threads,
        _inputs.changes(parameters),
        progress,
    )


def estimate_fundamental(
    points1: Points,
    points2: Points,
    *,
    sigma: ArrayLike | None = None,
    confidences: ArrayLike | None = None,
    sizes: Sequence[tuple[int, int]] | None = None,
    seed: int = 0,
    origin: Origin = None,
) -> Estimate:
    """Fit a fundamental matrix to matches without images.

    The verdict is never "reliable", since nothing confirms that the points of a match show the same scene point.

    Parameters
    ----------
    points1, points2 : arrays of shape (N, 2)
        Row k of both is a match, px.
    sigma : float or array of shape (N,), optional
        Standard deviation of a coordinate relative to the other matches. One number weights all alike.
    confidences : array of shape (N,), optional
        Probability that a match is right, above 0 and at most 1.
    sizes : two shapes (H, W), optional
        Sizes of the images, as their arrays have them. Without them, the extents of the points take their place.
    seed : int
    origin : {None, "colmap"}

    Returns
    -------
    Estimate
        `inliers` and `inlier_probabilities` are in the order of the points.

    Examples
    --------
    >>> import epiline, numpy as np
    >>> rng = np.random.default_rng(1)
    >>> scene = np.c_[rng.uniform(-1, 1, (60, 2)), rng.uniform(3, 6, 60)]
    >>> points1 = 500 * scene[:, :2] / scene[:, 2:] + 320
    >>> points2 = 500 * (scene[:, :2] + [0.5, 0.1]) / scene[:, 2:] + 320
    >>> found = epiline.estimate_fundamental(points1, points2, sizes=[(640, 640), (640, 640)])
    >>> int(found.inliers.sum())
    60
    """
    return _points(points1, points2, sigma, confidences, sizes, None, seed, origin, [])


def estimate_relative_pose(
    points1: Points,
    points2: Points,
    camera1: Camera,
    camera2: Camera,
    *,
    sizes: Sequence[tuple[int, int]] | None = None,
    sigma: ArrayLike | None = None,
    confidences: ArrayLike | None = None,
    seed: int = 0,
    origin: Origin = None,
) -> Estimate:
    """Fit an essential matrix to matches of calibrated cameras, without images.

    Parameters
    ----------
    points1, points2 : arrays of shape (N, 2)
        Row k of both is a match, px of the images as they are.
    camera1, camera2 : matrix K of shape (3, 3), or tuple (K, distortion)
    sizes : two shapes (H, W), optional
        By default twice the principal point, which is the middle of most images, and more if points lie beyond.
    sigma, confidences, seed, origin
        As for `estimate_fundamental`.

    Returns
    -------
    Estimate
        `R`, `t` and `pose_covariance` are `None` where the matches do not determine them: ``x2 ~ K2 (R X + t)``.
    """
    both = [_inputs.camera(camera1, 1), _inputs.camera(camera2, 2)]
    remarks = []
    if sizes is None:
        sizes = []
        for (K, _), points in zip(both, (points1, points2)):
            reach = np.max(_inputs.points(points, "points"), axis=0, initial=0.0)
            width, height = np.fmax(2 * np.array([K[0, 2], K[1, 2]]), np.where(np.isfinite(reach), reach, 0))
            sizes.append((int(height) + 1, int(width) + 1))
        remarks.append("the sizes of the images follow from the principal points")
    return _points(points1, points2, sigma, confidences, sizes, both, seed, origin, remarks)


def _points(
    points1: Points,
    points2: Points,
    sigma: ArrayLike | None,
    confidences: ArrayLike | None,
    sizes: Sequence[tuple[int, int]] | None,
    cameras: Any,
    seed: int,
    origin: Origin,
    remarks: list[str],
) -> Estimate:
    rows = _inputs.rows((_inputs.points(points1, "points1"), _inputs.points(points2, "points2")), "points", origin)

    def each(value: ArrayLike | None, name: str) -> NDArray[np.float64] | None:
        if value is None:
            return None
        array = _inputs.numbers(value, name)
        return np.full(len(rows), float(array)) if array.ndim == 0 else array.ravel()

    return _epiline.estimate_points(
        rows, each(sigma, "sigma"), each(confidences, "confidences"), _inputs.sizes(sizes), cameras, seed, remarks
    )


def judge(
    image1: Image,
    image2: Image,
    F: Matrix | None = None,
    *,
    cameras: Sequence[Annotated[ArrayLike, "float64", "[3, 4]"]] | None = None,
    matches: Matches | None = None,
    covariance: Annotated[ArrayLike, "float64", "[9, 9]"] | None = None,
    rectified: bool = False,
    limit: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: Callable[[str, float], object] | None = None,
    origin: Origin = None,
) -> Judgement:
    """Say whether a geometry from elsewhere fits two images, and what is wrong if not.

    Parameters
    ----------
    image1, image2 : path or array
    F : array of shape (3, 3), optional
        The matrix to judge.
    cameras : two projection matrices of shape (3, 4), optional
        The cameras to judge, in place of `F`.
    matches : as for `estimate`, optional
        Matches to judge by, in place of those that the images show.
    covariance : array of shape (9, 9), optional
        Covariance of the entries of `F`, row by row.
    rectified : bool
        Judge whether matching points lie in the same row, in place of `F`.
    limit : float, optional
        Largest median distance between the lines of a geometry that fits, px: 1, or 0.5 for rows.

    Returns
    -------
    Judgement
        `finding` is "fits", "does-not-fit" or "undecided"; `message` says why.
    """
    return _epiline.judge(
        _inputs.image(image1),
        _inputs.image(image2),
        None if F is None else _inputs.matrix(F, (3, 3), "F"),
        None if cameras is None else [_inputs.matrix(P, (3, 4), "a projection matrix") for P in cameras],
        None if matches is None else _inputs.named_arrays(matches, origin),
        None if covariance is None else _inputs.matrix(covariance, (9, 9), "the covariance"),
        rectified,
        limit,
        seed,
        threads,
        progress,
    )


def epilines(
    points: Points, F: Matrix, *, image: Literal[1, 2] = 1
) -> Annotated[NDArray[np.float64], "[n, 3]"]:
    """Return the epipolar lines of points of one image in the other.

    Parameters
    ----------
    points : array of shape (N, 2)
        Points of image 1 or 2, px.
    F : array of shape (3, 3)
    image : {1, 2}
        The image of the points.

    Returns
    -------
    array of shape (N, 3)
        Rows a b c with ``a x + b y + c == 0`` and a unit normal; NaN for a point at the epipole.

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
    F : array of shape (3, 3)
    points1, points2 : arrays of shape (N, 2)
    kind : {"symmetric", "sampson", "algebraic"}
        Mean distance in both images, px; Sampson distance, px; or ``x2.T @ F @ x1`` with ``F`` of norm 1.

    Returns
    -------
    array of shape (N,)
    """
    rows = _inputs.rows((_inputs.points(points1, "points1"), _inputs.points(points2, "points2")), "points")
    return _epiline.epipolar_distance(_inputs.matrix(F, (3, 3), "F"), rows, kind)


def rectify(
    F: Matrix,
    size1: tuple[int, int],
    size2: tuple[int, int],
    *,
    matches: Rows | None = None,
    cameras: Sequence[Camera] | None = None,
    method: Literal["auto", "planar", "polar"] = "auto",
    max_pixels: int | None = None,
) -> Rectification:
    """Bring matching points of two images into the same row.

    Parameters
    ----------
    F : array of shape (3, 3)
    size1, size2 : shapes (H, W)
        Sizes of the images: ``image.shape``.
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
    F : array of shape (3, 3)
    points1, points2 : arrays of shape (N, 2)
        At least 8 matches.

    Returns
    -------
    list of Reading
        The most credible first. `told_apart` says whether the matches distinguish a reading from the first.
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
    image1, image2 : path or array
    at : (x, y)
        The point, px.
    F : array of shape (3, 3), optional
        Only the epipolar line of the point is searched.
    image : {1, 2}
        The image of the point.

    Returns
    -------
    list of Suggestion
        The best first. `is_clear` says whether it has no rival and leads back to the point.
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
    image1, image2 : path or array
    line1, line2 : (x, y, dx, dy)
        An anchor, px, and a direction. The anchors show the same scene point.

    Returns
    -------
    LineMatch
        The cost, the disparities, and profile 2 warped onto profile 1.
    """
    return _epiline.line_similarity(
        _inputs.image(image1),
        _inputs.image(image2),
        _inputs.vector(line1, 4, "line1"),
        _inputs.vector(line2, 4, "line2"),
    )
