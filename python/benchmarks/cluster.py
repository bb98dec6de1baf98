#!/usr/bin/env python3
"""Runs many pairs on threads, on Dask and on Ray, kills a worker, and compares with one process.

    pip install dask distributed "ray[data]" psutil
    python python/benchmarks/cluster.py [--pairs 500] [--json FILE]

The pairs are textures with steps of depth, drawn by NumPy, seen by a camera that moves to the side: matching points are
in the same row. Dask and Ray run all pairs on one worker and on two, with one search at a time each. In the run of
two, a worker is killed after a third of the results. The program fails unless each pair has exactly one result, all
results equal those of one process, and the memory of no worker grows.

The figures are pairs a second, seconds of processor time a pair, the resident memory of a worker, and for three image
sizes the processor time of a pair and the bytes of its row and of its result. On a machine with other work, processor
time is the fair figure.
"""

import argparse
import contextlib
import json
import logging
import os
import pickle
import statistics
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import psutil

import epiline

SIZE = (120, 160)  # px
DEPTHS = 4  # steps of depth
WARM = 0.3  # share of a run after which the memory of a worker must not grow
GROWTH = 32e6  # bytes
MISSES = 0.02  # share of pairs whose lines may be off


def texture(height, width, rng):
    """Return a smooth random picture with values from 0 to 255."""
    total = np.zeros((height, width))
    for side in (5, 11, 23, 47, 95):
        coarse = rng.random((side + 2, side + 2))
        y, x = np.meshgrid(np.linspace(0, side, height), np.linspace(0, side, width), indexing="ij")
        i, j = y.astype(int), x.astype(int)
        v, u = y - i, x - j
        upper = coarse[i, j] * (1 - u) + coarse[i, j + 1] * u
        lower = coarse[i + 1, j] * (1 - u) + coarse[i + 1, j + 1] * u
        total += upper * (1 - v) + lower * v
    total -= total.min()
    return total * (255 / total.max())


def row(number):
    """Return a pair: bands of rows shifted by the disparity of their depth."""
    rng = np.random.default_rng(number)
    height, width = SIZE
    wide = texture(height, width + 40, rng)
    left, right = np.empty(SIZE), np.empty(SIZE)
    for band in range(DEPTHS):
        rows = slice(band * height // DEPTHS, (band + 1) * height // DEPTHS)
        shift = int(rng.integers(4, 24))
        left[rows], right[rows] = wide[rows, 30 : 30 + width], wide[rows, 30 - shift : 30 - shift + width]
    images = [np.round(image + rng.normal(0, 1, SIZE)).clip(0, 255).astype(np.uint8) for image in (left, right)]
    return {"id": number, "image1": images[0], "image2": images[1]}


def is_right(result):
    """Return whether the lines of the centre and of the corners are within 2 px of their rows."""
    if result["F"] is None:
        return False
    height, width = SIZE
    places = np.array([[x, y] for x in (0, width / 2, width) for y in (0, height / 2, height)])
    lines = epiline.epilines(places, result["F"])
    y = -(lines[:, 0] * places[:, 0] + lines[:, 2]) / lines[:, 1]
    return bool(np.median(np.abs(y - places[:, 1])) < 2)


def plain(value):
    """Return arrays as lists. Arrow gives columns of lists back as arrays."""
    if isinstance(value, np.ndarray):
        return [plain(each) for each in value.tolist()]
    if isinstance(value, (list, tuple)):
        return [plain(each) for each in value]
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    return value


class Watch:
    """Memory and processor time of worker processes, sampled until the end of a run."""

    def __init__(self, workers):
        self._workers, self._ended = workers, threading.Event()
        self._memory, self._first, self._last = {}, {}, {}
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join()
        self._sample()

    def _watch(self):
        while not self._ended.wait(0.5):
            self._sample()

    def _sample(self):
        for process in self._workers():
            with contextlib.suppress(psutil.Error):
                self._memory.setdefault(process.pid, []).append(process.memory_info().rss)
                times = process.cpu_times()
                self._first.setdefault(process.pid, times.user + times.system)
                self._last[process.pid] = times.user + times.system

    def processor(self):
        """Return the seconds of processor time of all workers."""
        return sum(self._last.values()) - sum(self._first.values())

    def memory(self):
        """Return the largest memory of a worker, and the largest growth after the first part of the run, bytes."""
        growth = []
        for samples in self._memory.values():
            warm = int(WARM * len(samples)) + 1
            if len(samples) > 2 * warm:
                growth.append(max(samples[warm:]) - max(samples[:warm]))
        return max(max(samples) for samples in self._memory.values()), max(growth, default=0)


def run(name, workers, results, processes, kill):
    """Gather the results of a run; kill a worker after a third of them. Return them with the figures."""
    gathered, killed = [], None
    begun = first = time.perf_counter()
    with Watch(processes) as watch:
        for result in results:
            if not gathered:
                first = time.perf_counter()
            gathered.append(plain(result))
            if kill and killed is None and len(gathered) >= arguments.pairs // 3:
                killed = next(iter(processes()))
                killed.kill()
    seconds = time.perf_counter() - begun
    largest, growth = watch.memory()
    figures = {
        "run": name,
        "workers": workers,
        "pairs": len(gathered),
        "seconds": seconds,
        "pairs_per_second": len(gathered) / seconds,
        "seconds_to_first": first - begun,
        "processor_seconds_per_pair": watch.processor() / len(gathered),
        "worker_bytes": largest,
        "growth_bytes": growth,
        "killed": killed is not None,
    }
    print(
        f"{name}, {workers} worker{'s' if workers > 1 else ''}{', one killed' if killed else ''}: "
        f"{len(gathered)} pairs in {seconds:.1f} s, {len(gathered) / seconds:.2f}/s, "
        f"{watch.processor() / len(gathered):.2f} s of a processor a pair, "
        f"{largest / 1e6:.0f} MB a worker, growth {growth / 1e6:.0f} MB",
        flush=True,
    )
    return gathered, figures


def on_threads(rows, workers):
    own = psutil.Process()
    with ThreadPoolExecutor(workers) as executor:
        results = epiline.estimate_pairs(rows, executor=executor, in_flight=4 * workers)
        return run("threads", workers, results, lambda: [own], kill=False)


def on_dask(rows, workers, kill):
    # Workers import this file, so it does not import both systems.
    import dask.distributed

    options = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    with dask.distributed.LocalCluster(silence_logs=logging.CRITICAL, **options) as cluster:
        with dask.distributed.Client(cluster) as client:

            def processes():
                pids = [worker.pid for worker in cluster.workers.values() if worker.pid]
                return [psutil.Process(pid) for pid in pids if psutil.pid_exists(pid)]

            results = epiline.estimate_pairs(rows, executor=client.get_executor(), in_flight=4 * workers)
            return run("Dask", workers, results, processes, kill)


def on_ray(rows, workers, kill):
    import ray
    import ray.data

    ray.init(num_cpus=workers, include_dashboard=False, object_store_memory=2**28, log_to_driver=False)
    try:
        ray.data.DataContext.get_current().enable_progress_bars = False
        dataset = ray.data.from_items(list(rows), override_num_blocks=max(1, arguments.pairs // 10))

        def processes():
            found = []
            for process in psutil.Process().children(recursive=True):
                with contextlib.suppress(psutil.Error):
                    # Ray names its workers after their tasks.
                    if "estimate_row" in "".join(process.cmdline()[:1]):
                        found.append(process)
            return found

        return run("Ray", workers, dataset.map(epiline.estimate_row).iter_rows(), processes, kill)
    finally:
        ray.shutdown()


def smaller(image, factor):
    """Return a picture with the means of squares of pixels."""
    height, width = image.shape[0] // factor, image.shape[1] // factor
    parts = image[: height * factor, : width * factor].reshape(height, factor, width, factor, -1)
    return np.round(parts.mean(axis=(1, 3))).astype(np.uint8).squeeze()


def sizes():
    """Return the cost of a pair of photographs at three sizes."""
    found = []
    pair = epiline.sample()
    for factor in (4, 2, 1):
        images = [smaller(image, factor) for image in (pair.image1, pair.image2)]
        with tempfile.TemporaryDirectory() as folder:
            paths = [os.path.join(folder, f"{k}.ppm") for k in (1, 2)]
            for path, image in zip(paths, images):
                with open(path, "wb") as file:
                    file.write(f"P6 {image.shape[1]} {image.shape[0]} 255\n".encode() + image.tobytes())
            seconds = []
            for seed in range(5):
                begun = time.process_time()
                result = epiline.estimate_row({"image1": paths[0], "image2": paths[1], "seed": seed})
                seconds.append(time.process_time() - begun)
            matches = epiline.estimate_row({"image1": paths[0], "image2": paths[1], "keep_matches": True})
            of_paths = len(pickle.dumps({"id": 0, "image1": paths[0], "image2": paths[1]}))
        figures = {
            "size": [images[0].shape[1], images[0].shape[0]],
            "seconds": statistics.median(seconds),
            "matches": result["match_count"],
            "row_of_paths_bytes": of_paths,
            "row_of_arrays_bytes": len(pickle.dumps({"id": 0, "image1": images[0], "image2": images[1]})),
            "result_bytes": len(pickle.dumps(result)),
            "result_with_matches_bytes": len(pickle.dumps(matches)),
            "process_bytes": psutil.Process().memory_info().rss,
        }
        print(
            "{size[0]}×{size[1]} px: {seconds:.2f} s of a processor, {matches} matches; bytes: {row_of_paths_bytes} of paths, "
            "{row_of_arrays_bytes} of arrays, {result_bytes} of a result, {result_with_matches_bytes} with "
            "matches; process {megabytes:.0f} MB".format(**figures, megabytes=figures["process_bytes"] / 1e6),
            flush=True,
        )
        found.append(figures)
    return found


def main():
    # Before the runs: the memory is that of a process with single searches.
    record = {"version": epiline.__version__, "cores": os.cpu_count(), "image_sizes": sizes(), "runs": []}
    rows = [row(number) for number in range(arguments.pairs)]
    expected, figures = on_threads(rows, 1)
    record["runs"].append(figures)
    wrong = sum(not is_right(result) for result in expected)
    print(f"{wrong} of {len(expected)} geometries are off", flush=True)
    problems = [] if wrong <= MISSES * len(expected) else [f"{wrong} geometries are off"]
    for work in (lambda: on_threads(rows, 2), *(
        lambda on=on, workers=workers: on(rows, workers, kill=workers == 2) for on in (on_dask, on_ray) for workers in (1, 2)
    )):
        gathered, figures = work()
        record["runs"].append(figures)
        name = f"{figures['run']} with {figures['workers']} workers"
        if sorted(result["id"] for result in gathered) != list(range(arguments.pairs)):
            problems.append(f"{name}: a pair has no result, or two")
        if sorted(gathered, key=lambda result: result["id"]) != plain(expected):
            problems.append(f"{name}: results differ from those of one process")
        if figures["growth_bytes"] > GROWTH:
            problems.append(f"{name}: a worker grows by {figures['growth_bytes'] / 1e6:.0f} MB")
        if figures["workers"] == 2 and figures["run"] != "threads" and not figures["killed"]:
            problems.append(f"{name}: no worker was killed")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(record, file, indent=1)
    for problem in problems:
        print(f"error: {problem}")
    return 1 if problems else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=500)
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    sys.exit(main())
