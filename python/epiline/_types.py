"""Types of arguments, with shapes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Path: TypeAlias = "str | PathLike[str]"
Pixels: TypeAlias = "NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.float32]"
Image: TypeAlias = "Path | Pixels"
Frames: TypeAlias = "Path | Iterable[Image] | Pixels"
Points: TypeAlias = Annotated[ArrayLike, "float64", "[n, 2]"]
Rows: TypeAlias = "Annotated[ArrayLike, 'float64', '[n, 4]'] | tuple[ArrayLike, ArrayLike]"
Matches: TypeAlias = "Rows | tuple[ArrayLike, ArrayLike, ArrayLike] | Mapping[str, Any]"
Matrix: TypeAlias = Annotated[ArrayLike, "float64", "[3, 3]"]
Camera: TypeAlias = "Matrix | tuple[Matrix, ArrayLike | None]"
Calibration: TypeAlias = "Path | tuple[Path, Path]"
Cameras: TypeAlias = "Calibration | Sequence[Camera]"
Origin: TypeAlias = "Literal['colmap'] | None"
