"""Many pairs: rows in and out are plain dictionaries, and any executor runs them."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

from ._epiline import Estimate
from ._errors import InputError, NoGeometryError
from ._search import estimate

Failure: TypeAlias = Literal["input", "no-geometry", "worker", "lost"]
Matrix: TypeAlias = "list[list[float]]"

# Names of a row that are arguments of `estimate`.
ARGUMENTS = ("pairs", "matches", "cameras", "preset", "seed", "threads", "parameters", "origin")
NAMES = ("id", "image1", "image2", *ARGUMENTS, "keep_matches")
# Searches that wait or run for each core. Fewer would leave a worker idle behind a slow pair.
IN_FLIGHT_PER_CORE = 4


class PairResult(TypedDict):
    """Result of one pair. All values are plain: numbers, texts, lists and None."""

    id: Any
    """`id` of the row."""
    image1: str | None
    """Path of image 1. None for an array."""
    image2: str | None
    F: Matrix | None
    """Fundamental matrix, three rows of three numbers, norm 1. None if there is no geometry."""
    verdict: str | None
    probability: float | None
    determined: str | None
    reasons: list[str]
    epipoles: Matrix | None
    """Epipoles of image 1 and image 2, homogeneous, of unit length."""
    homography: Matrix | None
    R: Matrix | None
    t: list[float] | None
    match_count: int | None
    """Number of matches that agree with F."""
    residual: float | None
    """Median Sampson distance of the matches, px."""
    points1: Matrix | None
    """Matches in image 1, rows x y, px. None unless the row has `keep_matches`."""
    points2: Matrix | None
    remarks: list[str]
    error: str | None
    """Why there is no result, in a sentence. None if there is one."""
    failure: Failure | None
    """Kind of the error: "input", "no-geometry", "worker" (the worker failed) or "lost" (its process ended)."""


def _result(row: Any) -> PairResult:
    """Return the result of a row without a geometry."""
    row = row if isinstance(row, Mapping) else {}

    def path(name: str) -> str | None:
        value = row.get(name)
        return os.fsdecode(value) if isinstance(value, (str, os.PathLike)) else None

    return {
        "id": row.get("id"),
        "image1": path("image1"),
        "image2": path("image2"),
        "F": None,
        "verdict": None,
        "probability": None,
        "determined": None,
        "reasons": [],
        "epipoles": None,
        "homography": None,
        "R": None,
        "t": None,
        "match_count": None,
        "residual": None,
        "points1": None,
        "points2": None,
        "remarks": [],
        "error": None,
        "failure": None,
    }


def _failed(row: Any, failure: Failure, sentence: str) -> PairResult:
    return {**_result(row), "error": sentence, "failure": failure}


def _plain(value: Any) -> Any:
    """Return columns of Arrow and pandas, which are arrays of arrays, as lists of arrays."""
    if isinstance(value, np.ndarray) and value.dtype == object:
        return [_plain(each) for each in value]
    return value


def _search(row: Mapping[str, Any]) -> Estimate:
    unknown = [str(name) for name in row if name not in NAMES]
    if unknown:
        raise InputError(f"a row has no value {', '.join(unknown)}. It may have {', '.join(NAMES)}")
    missing = [name for name in ("image1", "image2") if row.get(name) is None]
    if missing:
        raise InputError(f"the row has no {' and no '.join(missing)}")
    given = {name: _plain(row[name]) for name in ARGUMENTS if row.get(name) is not None}
    return estimate(row["image1"], row["image2"], **{"threads": 1, **given})


def estimate_row(row: Mapping[str, Any]) -> PairResult:
    """Find the fundamental matrix of one pair; the pair and its result are plain dictionaries.

    Tools that map a function over rows run it as it is: ``dataset.map(epiline.estimate_row)`` of Ray Data,
    ``client.map(epiline.estimate_row, rows)`` of Dask, ``rdd.map(epiline.estimate_row)`` of Spark.

    Parameters
    ----------
    row : mapping
        `image1` and `image2`, paths or arrays as for `estimate`, and perhaps its arguments `pairs`, `matches`,
        `cameras`, `preset`, `seed`, `threads`, `parameters` and `origin`. None counts as absent. A search uses one
        thread unless the row has `threads`. `id` is copied to the result. With a true `keep_matches`, the result has
        the matches.

    Returns
    -------
    PairResult
        A dictionary of plain values, always with the same keys. An error of the pair is its `error` and is not raised.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> found = epiline.estimate_row({"id": 7, "image1": pair.image1, "image2": pair.image2})
    >>> found["id"], found["verdict"], len(found["F"]), found["error"]
    (7, 'reliable', 3, None)
    >>> epiline.estimate_row({"image1": "no-such-file.png", "image2": pair.image2})["failure"]
    'input'
    """
    if not isinstance(row, Mapping):
        return _failed(row, "input", f"a row is a dictionary with image1 and image2, not {type(row).__name__}")
    try:
        found = _search(row)
    except InputError as error:
        return _failed(row, "input", str(error))
    except NoGeometryError as error:
        return _failed(row, "no-geometry", str(error))
    except (TypeError, ValueError, OverflowError) as error:
        return _failed(row, "input", f"a value of the row has the wrong kind: {error}")
    except Exception as error:  # One pair must not end the run of a million.
        return _failed(row, "worker", _of_worker(error))
    keeps = bool(row.get("keep_matches"))

    def numbers(array: NDArray[np.float64] | None) -> Any:
        return None if array is None else array.tolist()

    return {
        **_result(row),
        "F": numbers(found.F),
        "verdict": found.verdict,
        "probability": found.probability,
        "determined": found.determined,
        "reasons": found.reasons,
        "epipoles": numbers(found.epipoles),
        "homography": numbers(found.homography),
        "R": numbers(found.R),
        "t": numbers(found.t),
        "match_count": len(found.points1),
        "residual": float(np.median(found.residuals)) if len(found.residuals) else None,
        "points1": numbers(found.points1) if keeps else None,
        "points2": numbers(found.points2) if keeps else None,
        "remarks": found.remarks,
    }


def _of_worker(error: BaseException) -> str:
    """Return a sentence about an unexpected error of a worker."""
    return f"the worker failed: {type(error).__name__}: {error}"


def estimate_pairs(
    pairs: Iterable[Mapping[str, Any]],
    *,
    executor: Executor | Callable[[], Executor] | None = None,
    in_flight: int | None = None,
) -> Generator[PairResult, None, None]:
    """Find the fundamental matrices of many pairs, in parallel and in the order of the pairs.

    Parameters
    ----------
    pairs : iterable of mappings
        Rows of `estimate_row`. A generator is read as pairs are needed.
    executor : concurrent.futures.Executor, or function that makes one, optional
        By default one thread for each core. ``ProcessPoolExecutor``, ``Client.get_executor()`` of Dask and
        ``MPIPoolExecutor`` are others. An executor stays open; one of a function is closed.
    in_flight : int, optional
        Largest number of pairs that are submitted and not yet returned: their rows are in memory. By default four for
        each core of this machine. Give at least two for each worker of a cluster.

    Yields
    ------
    PairResult
        One for each pair, in order. An error of a pair is its `error`; the run goes on.

    Raises
    ------
    InputError
        If `in_flight` is below 1 or `executor` is no executor.
    concurrent.futures.BrokenExecutor
        If the process of a worker ended, and `executor` is an executor that does not start another one. All results
        before the lost pair have been returned. With a function that makes executors, a new one takes over: lost pairs
        are searched again, one at a time. A pair that loses its worker twice has the failure "lost".

    Notes
    -----
    Ctrl-C and `close` cancel the pairs that have not started. Searches on threads of this process are awaited.
    Dask and Ray themselves repeat the pairs of a lost worker.

    Examples
    --------
    >>> import epiline
    >>> pair = epiline.sample()
    >>> rows = [{"id": k, "image1": pair.image1, "image2": pair.image2, "pairs": pair.clicks} for k in range(2)]
    >>> [(found["id"], found["verdict"]) for found in epiline.estimate_pairs(rows)]
    [(0, 'reliable'), (1, 'reliable')]
    """
    if in_flight is None:
        in_flight = IN_FLIGHT_PER_CORE * (os.cpu_count() or 1)
    if in_flight < 1:
        raise InputError(f"in_flight is at least 1, not {in_flight}")
    if not (executor is None or isinstance(executor, Executor) or callable(executor)):
        raise InputError(f"executor is an executor of concurrent.futures, not {type(executor).__name__}")
    return _results(iter(pairs), executor, in_flight)


class _Task:
    """A pair that is submitted and not yet returned."""

    def __init__(self, row: Mapping[str, Any]) -> None:
        self.row = row
        self.future: Future[PairResult] | None = None
        self.losses = 0


class _Workers:
    """An executor, and its successors if a function makes them."""

    def __init__(self, given: Executor | Callable[[], Executor] | None) -> None:
        self._make: Callable[[], Executor] | None
        if isinstance(given, Executor):
            self._make, self._executor = None, given
        else:
            self._make = given or (lambda: ThreadPoolExecutor(os.cpu_count() or 1, "epiline"))
            self._executor = self._make()

    def submit(self, task: _Task) -> None:
        """Submit a pair. Without a future, its worker is lost."""
        try:
            task.future = self._executor.submit(estimate_row, task.row)
        except BrokenExecutor as error:
            task.future = Future()
            task.future.set_exception(error)

    def renew(self, error: BrokenExecutor) -> None:
        """Start another executor in place of a broken one, or raise the error."""
        if self._make is None:
            raise BrokenExecutor(
                "a worker process ended, and its executor takes no more pairs. The results so far are complete. "
                "Give a function that makes executors to go on in a new one"
            ) from error
        self._executor.shutdown(wait=False, cancel_futures=True)
        self._executor = self._make()

    def close(self) -> None:
        if self._make is not None:
            self._executor.shutdown(wait=True, cancel_futures=True)


def _results(
    rows: Iterator[Mapping[str, Any]], executor: Executor | Callable[[], Executor] | None, in_flight: int
) -> Generator[PairResult, None, None]:
    workers = _Workers(executor)
    waiting: deque[_Task] = deque()
    try:
        while True:
            # A pair that lost its worker runs alone, so that it takes no other pair with it.
            while len(waiting) < in_flight and not any(task.losses for task in waiting):
                try:
                    task = _Task(next(rows))
                except StopIteration:
                    break
                workers.submit(task)
                waiting.append(task)
            if not waiting:
                return
            result = _awaited(waiting, workers)
            if result is not None:
                waiting.popleft()
                yield result
    finally:
        for task in waiting:
            if task.future is not None:
                task.future.cancel()
        workers.close()


def _awaited(waiting: deque[_Task], workers: _Workers) -> PairResult | None:
    """Return the result of the first pair. None if the executor broke and the pair is to be searched again."""
    task = waiting[0]
    if task.future is None:
        workers.submit(task)
    assert task.future is not None
    try:
        return task.future.result()
    except BrokenExecutor as error:
        workers.renew(error)
        for lost in waiting:
            if lost.future is not None and _is_lost(lost.future):
                lost.future = None
                lost.losses += 1
        if task.losses < 2:
            return None
        return _failed(
            task.row,
            "lost",
            "the process of the worker ended twice during this pair. It may lack memory: use smaller images or "
            "fewer workers",
        )
    except Exception as error:  # The row cannot be sent, or the worker lacks the package.
        return _failed(task.row, "worker", _of_worker(error))


def _is_lost(future: Future[PairResult]) -> bool:
    """Return whether the executor broke before this pair was done."""
    return not future.done() or future.cancelled() or isinstance(future.exception(), BrokenExecutor)
