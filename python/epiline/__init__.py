"""Epipolar geometry of two images that says how far it can be trusted.

Points are pixels ``x, y``; the centre of the upper left pixel is (0, 0). ``F`` maps image 1 to image 2:
``x2.T @ F @ x1 == 0``. The same input and seed give the same result on any number of threads.

>>> import epiline, numpy as np
>>> F = np.array([[0, 0, 0], [0, 0, -1], [0, 1, 0.0]])
>>> epiline.epipolar_distance(F, [[10, 20]], [[40, 23]]).round(9).tolist()
[3.0]
"""

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
from ._geometry import check_convention, epilines, epipolar_distance, line_similarity, rectify, suggest
from ._rows import PairResult, estimate_pairs, estimate_row
from ._sample import Sample, sample
from ._search import barcode, estimate, estimate_fundamental, estimate_relative_pose, judge

__all__ = [
    "EpilineError",
    "Estimate",
    "InputError",
    "Judgement",
    "LineMatch",
    "NoGeometryError",
    "PairResult",
    "Reading",
    "Rectification",
    "Sample",
    "Suggestion",
    "__version__",
    "barcode",
    "check_convention",
    "epilines",
    "epipolar_distance",
    "estimate",
    "estimate_fundamental",
    "estimate_pairs",
    "estimate_relative_pose",
    "estimate_row",
    "judge",
    "line_similarity",
    "rectify",
    "sample",
    "suggest",
]
