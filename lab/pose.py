#!/usr/bin/env python3
"""Relative poses of calibrated pairs against the truth.

    python3 lab/pose.py PROGRAM FOLDER [--seeds N]

PROGRAM is the command-line program. FOLDER has pairs NAMEA.*, NAMEB.* with NAME_K.txt: the
calibrations K1 and K2, the rotation and the translation, row by row. Prints the errors of rotation and
direction of the translation with the stated deviations, the areas under the curve (AUC) of the larger
error, and how often the truth lies in the 95 % regions. Needs NumPy.
"""

import argparse
import glob
import json
import os
import subprocess
import tempfile

import numpy as np


def angle(cosine):
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def pose(program, name, seed, folder):
    """Returns the verdict, both errors and both deviations, degrees; None without a result."""
    numbers = [float(n) for line in open(f"{name}_K.txt") for n in line.split()]
    k1, k2, rotation = (np.reshape(numbers[9 * i : 9 * i + 9], (3, 3)) for i in range(3))
    translation = np.array(numbers[27:30])
    calibration, result = os.path.join(folder, "k.json"), os.path.join(folder, "result.json")
    with open(calibration, "w") as file:
        json.dump({"K1": k1.tolist(), "D1": [], "K2": k2.tolist(), "D2": []}, file)
    pictures = [glob.glob(f"{name}{letter}.*")[0] for letter in "AB"]
    command = [program, "estimate", *pictures, "--calibration", calibration, "--json", result, "--seed", str(seed)]
    if subprocess.run(command, capture_output=True).returncode != 0:
        return None
    result = json.load(open(result))
    found = result["calibrated"].get("pose")
    if found is None:
        return None
    turn = angle((np.trace(np.array(found["rotation"]).T @ rotation) - 1) / 2)
    shift = angle(np.array(found["translation"]) @ translation / np.linalg.norm(translation))
    deviations = [np.degrees(found[f"{part}_deviation"] or np.nan) for part in ("rotation", "translation")]
    return result["verdict"], turn, shift, *deviations


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--seeds", type=int, default=1)
    arguments = parser.parse_args()
    names = [path[: -len("_K.txt")] for path in sorted(glob.glob(f"{arguments.folder}/*_K.txt"))]
    errors, inside = [], []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.seeds):
            for name in names:
                found = pose(arguments.program, name, seed, folder)
                if found is None:
                    errors.append(180.0)
                    print(f"{os.path.basename(name):24} no pose")
                    continue
                verdict, turn, shift, turn_dev, shift_dev = found
                errors.append(max(turn, shift))
                # 95 % quantiles of three and of two equal components.
                if verdict == "reliable":
                    inside.append((turn < 2.80 * turn_dev, shift < 2.45 * shift_dev))
                print(
                    f"{os.path.basename(name):24} {verdict:10} rotation {turn:.3f}° ± {turn_dev:.3f}°  "
                    f"translation {shift:.3f}° ± {shift_dev:.3f}°",
                    flush=True,
                )
    areas = [100 * np.mean(np.maximum(0, 1 - np.array(errors) / limit)) for limit in (1, 5, 10)]
    print("AUC at 1, 5, 10°: " + ", ".join(f"{area:.1f}" for area in areas), f"median {np.median(errors):.3f}°")
    turns, shifts = 100 * np.mean(inside, axis=0)
    print(f"in the 95 % regions of {len(inside)} reliable results: rotation {turns:.0f} %, translation {shifts:.0f} %")


if __name__ == "__main__":
    main()
