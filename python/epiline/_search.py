"""Searches for the geometry of images and of points, and judgements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _epiline, _inputs
from ._epiline import Estimate, Judgement
from ._types import Calibration, Camera, Cameras, Frames, Image, Matches, Matrix, Origin, Path, Points, Rows


def estimate(
    image1: Image,
    image2: Image,
    pairs: Rows | None = None,
    *,
    matches: Matches | None = None,
    cameras: Cameras | None = None,
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
    cameras : two matrices K, two tuples (K, distortion), or the path of a calibration, optional
        Distortion as OpenCV has it: 4, 5, 8 or 12 coefficients. With distortion, the result belongs to the images
        without it (`is_undistorted`). A calibration is one file, or two in a tuple, of any program that the option
        ``--calibration`` of the command line reads.
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
        If an image, an array, a file or a parameter is wrong.
    NoGeometryError
        If no geometry was found.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> found = epiline.estimate(pair.image1, pair.image2)
    >>> found.verdict
    'reliable'
    >>> bool(epiline.epipolar_distance(found.F, pair.matches[:, :2], pair.matches[:, 2:]).max() < 3)
    True
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
    points1, points2 : arrays of shape (N, 2), float64
        Row k of both is a match, px. At least 8.
    sigma : float or array of shape (N,), float64, optional
        Standard deviation of a coordinate relative to the other matches. One number weights all alike.
    confidences : array of shape (N,), optional
        Probability that a match is right, above 0 and at most 1.
    sizes : two shapes (H, W), optional
        Sizes of the images, as their arrays have them. Without them, the extents of the points take their place.
    seed : int
        Seed of the random numbers.
    origin : {None, "colmap"}
        "colmap" if the centre of the upper left pixel is (0.5, 0.5).

    Returns
    -------
    Estimate
        `inliers` and `inlier_probabilities` are in the order of the points.

    Raises
    ------
    InputError
        If an array is wrong, or the points are fewer than 8.
    NoGeometryError
        If the points agree on no geometry, or on a homography alone.

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
    camera1: Camera | Path,
    camera2: Camera | Path,
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
    points1, points2 : arrays of shape (N, 2), float64
        Row k of both is a match, px of the images as they are. At least 6.
    camera1, camera2 : matrix K of shape (3, 3), tuple (K, distortion), or the path of a calibration
        Distortion as OpenCV has it: 4, 5, 8 or 12 coefficients. The path of a file with both cameras is given twice.
    sizes : two shapes (H, W), optional
        By default twice the principal point, which is the middle of most images, and more if points lie beyond. Files
        of a calibration need them.
    sigma, confidences, seed, origin
        As for `estimate_fundamental`.

    Returns
    -------
    Estimate
        `R`, `t` and `pose_covariance` are `None` where the matches do not determine them: ``x2 ~ K2 (R X + t)``.

    Raises
    ------
    InputError
        If an array or a camera is wrong.
    NoGeometryError
        If the points agree on no geometry.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> found = epiline.estimate_relative_pose(pair.matches[:, :2], pair.matches[:, 2:], pair.K1, pair.K2)
    >>> found.R.shape, found.t.shape
    ((3, 3), (3,))
    """
    are_paths = _inputs.is_path(camera1) and _inputs.is_path(camera2)
    both: Any = _inputs.cameras(camera1 if are_paths and camera1 == camera2 else (camera1, camera2))
    remarks: list[str] = []
    if sizes is None and not are_paths:
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
    cameras: Sequence[Annotated[ArrayLike, "float64", "[3, 4]"]] | Calibration | None = None,
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
    image1, image2 : path or array of shape (H, W), (H, W, 3) or (H, W, 4)
        uint8, uint16 or float32.
    F : array of shape (3, 3), float64, optional
        The matrix to judge: ``x2.T @ F @ x1 == 0``, px.
    cameras : two projection matrices of shape (3, 4), or the path of a stereo calibration, optional
        The cameras to judge, in place of `F`. With a calibration, matrices are those of the images without distortion.
    matches : as for `estimate`, optional
        Matches to judge by, in place of those that the images show.
    covariance : array of shape (9, 9), optional
        Covariance of the entries of `F`, row by row.
    rectified : bool
        Judge whether matching points lie in the same row, in place of `F`.
    limit : float, optional
        Largest median distance between the lines of a geometry that fits, px: 1, or 0.5 for rows.
    seed, threads, progress, origin
        As for `estimate`.

    Returns
    -------
    Judgement
        `finding` is "fits", "does-not-fit" or "undecided"; `message` says why.

    Raises
    ------
    InputError
        If there is not exactly one geometry to judge, or if an image or an array is wrong.
    NoGeometryError
        If the images show no geometry to judge by.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> epiline.judge(pair.image1, pair.image2, pair.F).finding
    'fits'
    >>> epiline.judge(pair.image1, pair.image2, pair.F.T).finding
    'does-not-fit'
    """
    return _epiline.judge(
        _inputs.image(image1),
        _inputs.image(image2),
        None if F is None else _inputs.matrix(F, (3, 3), "F"),
        _inputs.judged_cameras(cameras),
        None if matches is None else _inputs.named_arrays(matches, origin),
        None if covariance is None else _inputs.matrix(covariance, (9, 9), "the covariance"),
        rectified,
        limit,
        seed,
        threads,
        progress,
    )


def barcode(
    frames1: Frames,
    frames2: Frames,
    *,
    offset: int | None = None,
    pairs: Rows | None = None,
    preset: Literal["robust", "paper"] = "robust",
    seed: int = 0,
    threads: int | None = None,
    parameters: Mapping[str, Any] | None = None,
    progress: Callable[[str, float], object] | None = None,
    origin: Origin = None,
) -> Estimate:
    """Find the fundamental matrix of two stationary cameras from objects that move in both sequences.

    Motion barcodes tell in which frames a moving object crosses a line. Corresponding epipolar lines have similar
    barcodes, even where the views have no texture in common.

    Parameters
    ----------
    frames1, frames2 : array of shape (N, H, W) or (N, H, W, 3), iterable of images, or path
        Images as for `estimate`, all of one size; at least 16 and at most 2000 frames. A path is a folder of numbered
        pictures, or a video if ffmpeg is installed. An iterable is read once, frame by frame, and frames are kept at
        640 px or less.
    offset : int, optional
        Frame k of the first sequence and frame k + `offset` of the second are simultaneous. Without it, the offset is
        found within 50 frames in either direction; where none is clear, it is 0, and `remarks` of the result says so.
    pairs : array of shape (N, 4) with rows x1 y1 x2 y2, or two arrays of shape (N, 2), optional
        Clicked pairs of immobile points, px. Two are enough, and none are needed.
    preset, seed, threads, parameters, progress, origin
        As for `estimate`.

    Returns
    -------
    Estimate
        `offset` is the time offset.

    Raises
    ------
    InputError
        If a frame, an array or a parameter is wrong, if nothing moves, or if a camera moves.
    NoGeometryError
        If no geometry was found.

    Examples
    --------
    >>> import epiline, numpy as np
    >>> still = np.full((20, 60, 80), 90, np.uint8)
    >>> epiline.barcode(still, still)
    Traceback (most recent call last):
    ...
    epiline._errors.InputError: nothing moves in frames1. Motion barcodes need objects that move in front of a \
stationary camera
    """
    return _epiline.barcode(
        _inputs.frames(frames1, "frames1"),
        _inputs.frames(frames2, "frames2"),
        None if pairs is None else _inputs.rows(pairs, "pairs", origin),
        offset,
        preset,
        seed,
        threads,
        _inputs.changes(parameters),
        progress,
    )
