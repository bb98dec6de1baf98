#!/usr/bin/env python3
"""Compares the time of this program with that of OpenCV's SIFT and MAGSAC++ on the same pair.

    cargo build --release -p epiline
    python3 lab/compare-speed.py LEFT RIGHT --pair X1,Y1,X2,Y2 --pair X1,Y1,X2,Y2 [--runs 9]

Both are whole processes, from two files to F, and run in turns, so that whatever else the machine does meets both alike.
What is printed: the median wall-clock and processor time of each, the ratios of these medians (ours over OpenCV's), and
what our program says of itself: until the first and until the final F, images read already. Needs numpy and opencv-python;
the OpenCV side is this file itself, started with --opencv. It reads both images in grey, finds SIFT features (with
OpenCV's own settings), matches them with the ratio test, and calls cv2.findFundamentalMat with cv2.USAC_MAGSAC. Its
processes spend some time on importing these modules; that is measured by itself (an empty run) and told, and it is taken
off OpenCV's times where a line says so. With --threads 1 both use one thread.
"""

import argparse
import json
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path


def opencv(left, right, threads):
    """F by SIFT, the ratio test and MAGSAC++, as JSON to standard output."""
    import cv2
    import numpy as np

    if threads:
        cv2.setNumThreads(threads)
    if left == "-":
        return
    begun = time.perf_counter()
    planes = [cv2.imread(name, cv2.IMREAD_GRAYSCALE) for name in (left, right)]
    if any(plane is None for plane in planes):
        sys.exit("OpenCV cannot read the images")
    sift = cv2.SIFT_create()
    (points1, one), (points2, two) = (sift.detectAndCompute(plane, None) for plane in planes)
    near = cv2.BFMatcher().knnMatch(one, two, k=2)
    good = [pair[0] for pair in near if len(pair) == 2 and pair[0].distance < 0.8 * pair[1].distance]
    x1 = np.float64([points1[m.queryIdx].pt for m in good])
    x2 = np.float64([points2[m.trainIdx].pt for m in good])
    found, inliers = cv2.findFundamentalMat(x1, x2, cv2.USAC_MAGSAC, 1.0, 0.999, 10000)
    count = 0 if inliers is None else int(inliers.sum())
    seconds = time.perf_counter() - begun
    matrix = None if found is None else found[:3].tolist()
    print(json.dumps({"fundamental": matrix, "matches": len(good), "inliers": count, "seconds": seconds}))


def timed(command):
    """Wall-clock and processor seconds of a process, and what it printed."""
    begun, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    wall, after = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{command[0]} failed: {done.stderr.strip()}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def main():
    program = Path(__file__).resolve().parent.parent / "target" / "release" / "epiline"
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("left")
    parser.add_argument("right")
    parser.add_argument("--pair", action="append", default=[], metavar="X1,Y1,X2,Y2", help="a clicked point pair")
    parser.add_argument("--runs", type=int, default=9, help="runs of each (default 9)")
    parser.add_argument("--program", default=str(program), help="the program (default target/release/epiline)")
    parser.add_argument("--threads", type=int, default=0, help="threads of both (default: all)")
    parser.add_argument("--opencv", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.opencv:
        return opencv(arguments.left, arguments.right, arguments.threads)

    threads = ["--threads", str(arguments.threads)] if arguments.threads else []
    theirs = [sys.executable, __file__, "--opencv", *threads]
    ours = [arguments.program, "estimate", arguments.left, arguments.right, "--json", "-", *threads]
    ours += [word for pair in arguments.pair for word in ("--pair", pair)]
    commands = {"ours": ours, "OpenCV": [*theirs, arguments.left, arguments.right], "imports": [*theirs, "-", "-"]}
    runs = {name: [] for name in commands}
    # The first round brings programs and pictures into memory and does not count.
    for number in range(arguments.runs + 1):
        for name, command in commands.items():
            run = timed(command)
            if number:
                runs[name].append(run)
    wall, processor = (
        {name: statistics.median(run[kind] for run in list_) for name, list_ in runs.items()} for kind in (0, 1)
    )
    results = {name: [json.loads(run[2]) for run in runs[name]] for name in ("ours", "OpenCV")}
    inner = {name: statistics.median(result["seconds"] for result in results[name]) for name in results}
    first = statistics.median(result["first_seconds"] for result in results["ours"])
    print(f"{arguments.runs} runs in turns, medians, s")
    for name in commands:
        print(f"{name:8} wall clock {wall[name]:7.3f}   processor {processor[name]:7.3f}")
    print(f"ours: first F after {first:.3f}, final F after {inner['ours']:.3f} with the images read")
    print(f"OpenCV: F after {inner['OpenCV']:.3f}, reading included")
    print("ratio, ours over OpenCV:")
    print(f"  processes without imports: wall clock {wall['ours'] / (wall['OpenCV'] - wall['imports']):.2f},", end=" ")
    print(f"processor {processor['ours'] / max(processor['OpenCV'] - processor['imports'], 1e-9):.2f}")
    print(f"  whole processes: wall clock {wall['ours'] / wall['OpenCV']:.2f},", end=" ")
    print(f"processor {processor['ours'] / processor['OpenCV']:.2f}")
    print(f"our verdict: {results['ours'][0]['verdict']}; inliers of MAGSAC++: {results['OpenCV'][0]['inliers']}")


if __name__ == "__main__":
    main()
