#!/usr/bin/env python3
"""Draws the figures of a report written by `epiline-lab ... --json`, or of a table of `measure-barcodes`.

    cargo run --release -p epiline-lab -- vgg HOUSE --methods two-point,seven-point --json report.json
    python3 lab/plot.py report.json FIGURES
    cargo run --release -p epiline-lab --example measure-barcodes > table.md
    python3 lab/plot.py table.md lab

Writes one SVG for each figure into the folder and prints the worst trials. Needs matplotlib 3.10 or later.
"""

import json
import re
import statistics
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
# The same report gives the same files.
matplotlib.rcParams["svg.hashsalt"] = "epiline"
import matplotlib.pyplot as plt  # noqa: E402

FAR = 100.0  # Larger errors, and trials without a geometry, are drawn here, px.
WORST = 12  # Number of trials printed.


def save(figure, folder, name):
    figure.tight_layout()
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
    plt.close(figure)
    print(folder / f"{name}.svg")


def label(record):
    return " ".join(filter(None, [record["method"], record["preset"]]))


def error_of(trial):
    """The mean symmetric epipolar distance of all true matches, px. JSON has no infinity: null is a failure."""
    return FAR if trial["mean"] is None else min(trial["mean"], FAR)


def by_method(report):
    """Trials of each method in the order of the report, with the limit of a good error of their pair, px."""
    methods = {}
    for record in report["records"]:
        limit = 0.01 * max(max(size) for size in record["image_sizes"])
        methods.setdefault(label(record), []).extend((trial, limit) for trial in record["trials"])
    return methods


def cumulative(report, folder):
    figure, axes = plt.subplots(figsize=(7, 4))
    for name, trials in by_method(report).items():
        errors = sorted(error_of(trial) for trial, _ in trials)
        shares = [(k + 1) / len(errors) for k in range(len(errors))]
        axes.step(errors, shares, where="post", label=f"{name} ({len(errors)} trials)")
    axes.set(xscale="log", xlim=(0.05, FAR), ylim=(0, 1), ylabel="fraction of trials")
    axes.set_xlabel(f"error, px (mean distance of all true matches; {FAR:.0f} is more, or no geometry)")
    axes.grid(alpha=0.3)
    axes.legend()
    save(figure, folder, "errors")


def pairs(report, folder):
    records = report["records"]
    names = list(dict.fromkeys(record["pair"] for record in records))
    methods = list(dict.fromkeys(label(record) for record in records))
    figure, axes = plt.subplots(figsize=(8, 1.2 + 0.22 * len(names) * len(methods)))
    for record in records:
        m = methods.index(label(record))
        y = names.index(record["pair"]) + 0.8 * (m + 0.5) / len(methods) - 0.4
        color = f"C{m}"
        axes.plot([error_of(t) for t in record["trials"]], [y] * len(record["trials"]), "|", color=color, alpha=0.6)
        if record["median"] is not None:
            axes.plot(min(record["median"], FAR), y, "o", color=color, markersize=5)
        if record["printed"] is not None:
            axes.plot(record["printed"], y, "x", color="black", markersize=5)
    for m, name in enumerate(methods):
        axes.plot([], [], "o", color=f"C{m}", label=name)
    axes.plot([], [], "x", color="black", label="printed in the paper")
    axes.set(xscale="log", yticks=range(len(names)), yticklabels=names, ylim=(-0.5, len(names) - 0.5))
    axes.set_xlabel("error, px: every trial, and the median of each pair")
    axes.invert_yaxis()
    axes.grid(axis="x", alpha=0.3)
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, folder, "pairs")


def times(report, folder):
    methods = by_method(report)
    figure, axes = plt.subplots(figsize=(7, 1.2 + 0.4 * len(methods)))
    seconds = [[trial["seconds"] for trial, _ in trials] for trials in methods.values()]
    axes.boxplot(seconds, orientation="horizontal", whis=(5, 95), showfliers=False)
    axes.set(yticks=range(1, len(methods) + 1), yticklabels=list(methods))
    plan = report["parameters"]
    axes.set_xlabel(f"s per trial on {plan['threads_per_trial']} thread(s), {plan['trials_at_once']} at a time")
    axes.invert_yaxis()
    save(figure, folder, "times")


def verdicts(report, folder):
    """Errors of each verdict, relative to the limit of a good error."""
    judged = [(name, t["verdict"], error_of(t) / limit)
              for name, trials in by_method(report).items() for t, limit in trials if t["verdict"]]
    if not judged:
        return
    kinds = list(dict.fromkeys((name, verdict) for name, verdict, _ in sorted(judged)))
    figure, axes = plt.subplots(figsize=(7, 1.2 + 0.35 * len(kinds)))
    for y, kind in enumerate(kinds):
        own = [ratio for name, verdict, ratio in judged if (name, verdict) == kind]
        axes.plot(own, [y] * len(own), "|", color=f"C{y}", markersize=10)
        good = sum(ratio < 1 for ratio in own)
        axes.annotate(f"{good} of {len(own)} good", (1.01, y), xycoords=("axes fraction", "data"), va="center")
    axes.axvline(1, color="black", linewidth=0.8)
    axes.set(xscale="log", yticks=range(len(kinds)), ylim=(-0.5, len(kinds) - 0.5))
    axes.set_yticklabels([f"{name}: {verdict}" for name, verdict in kinds])
    axes.set_xlabel("error / 1 % of the longer side")
    axes.invert_yaxis()
    save(figure, folder, "verdicts")


def worst(report):
    trials = [(error_of(t), r["pair"], label(r), t) for r in report["records"] for t in r["trials"]]
    print("error px | pair | method | trial | verdict | reasons")
    for error, pair, method, trial in sorted(trials, key=lambda t: -t[0])[:WORST]:
        reasons = trial["failure"] or "; ".join(trial["warnings"])
        print(f"{error:.2f} | {pair} | {method} | {trial['trial']} | {trial['verdict']} | {reasons}")


def barcodes(text, folder):
    """Errors without clicks and with two clicks. A row begins with the recording, its error is the second cell of each."""
    most = 4.0
    for file, across, unit, usual in [
        ("barcodes-frames", "frames, with 8 balls", " frames", 300),
        ("barcodes-balls", "balls, in 300 frames", " balls", 8),
        ("barcodes-noise", "pixels of the exact masks that are flipped, %", " % of the pixels flipped", None),
    ]:
        errors = {}
        for line in text.splitlines():
            cells = [cell.strip() for cell in line.split("|")]
            if len(cells) < 6:
                continue
            number = re.fullmatch(r"(?:exact masks, )?(\d+)" + re.escape(unit), cells[1])
            number = int(number[1]) if number else usual if cells[1] == "as it is" else None
            if number is not None:
                values = [float(c) if re.fullmatch(r"[\d.]+", c) else float("inf") for c in (cells[3], cells[5])]
                errors.setdefault(number, []).append(values)
        figure, axes = plt.subplots(figsize=(7, 3.5))
        for k, name in enumerate(["no clicks", "two clicks"]):
            medians = [min(statistics.median(v[k] for v in errors[n]), most) for n in sorted(errors)]
            axes.plot(sorted(errors), medians, "o-", label=name)
        axes.set(xlabel=across, ylim=(0, most), ylabel=f"median error, px ({most:.0f} is more)")
        axes.legend()
        save(figure, folder, file)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    text = source.read_text()
    if source.suffix == ".md":
        barcodes(text, folder)
        return
    report = json.loads(text)
    for draw in (cumulative, pairs, times, verdicts):
        draw(report, folder)
    worst(report)


if __name__ == "__main__":
    main()
