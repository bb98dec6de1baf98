#!/usr/bin/env python3
"""How often results are right that the program calls likely to be right.

    python3 lab/trust.py collect PROGRAM TABLE DATA [MADE...]
    python3 lab/trust.py report TABLE [FIGURES]

`collect` runs PROGRAM, the command-line program, and adds one line of JSON for each result to TABLE. Results
that TABLE has are not computed again; the most telling come first. With SHARE=0/2 in the environment, half of
them are computed. DATA holds house/, pairs/, wide/ and real/; each MADE is a folder of pairs without parallax
with its meta.json. `report` takes several tables, separated by commas. `report` fits the probability on one half of the scenes and tests it
on the other, both ways. It prints the constants of `estimate/verdict/trust/probability.rs`, and draws the
reliability diagram into FIGURES.

A result is right if its lines are within 1 % of the longer side: the mean symmetric epipolar distance of the
true matches, or for laser-scanned cameras the mean distance from the true lines all over the pictures.
Without parallax nothing determines the epipole. A result there is wrong unless it says so (`determined` is
`lines`) and its lines hold at the true matches: those of the made pair, or the inliers of one homography of
SIFT features. With fewer than 30 inliers this is not known, and the result counts for the verdict alone.
Made pairs without true matches have no right result.
Needs NumPy, SciPy and OpenCV; the diagram needs matplotlib.
"""

import collections
import glob
import json
import os
import subprocess
import sys
import zlib

import numpy as np

from coverage import pairs as known_pairs

LIMIT = 0.01  # Largest error of a right result, as a share of the longer side.


# --- Collection ------------------------------------------------------------------------------------------


def picture(stem):
    return next(f for f in sorted(glob.glob(glob.escape(stem) + ".*")) if not f.endswith(".txt"))


def distances(f, matches):
    """Returns the symmetric epipolar distances of matches, px."""
    x1, x2 = (np.c_[matches[:, k : k + 2], np.ones(len(matches))] for k in (0, 2))
    l2, l1 = x1 @ f.T, x2 @ f
    off = np.abs((l2 * x2).sum(1))
    return (off / np.hypot(l2[:, 0], l2[:, 1]) + off / np.hypot(l1[:, 0], l1[:, 1])) / 2


def between_lines(f, truth, frames):
    """Returns the mean distance between estimated and true lines of a grid all over both pictures, px. A line
    outside its picture does not count; a distance counts up to a tenth of the longer side."""
    found = []
    for a, b, (w, h), (w2, h2) in ((f, truth, *frames), (f.T, truth.T, *frames[::-1])):
        x, y = np.meshgrid((np.arange(12) + 0.5) / 12 * w, (np.arange(12) + 0.5) / 12 * h)
        points = np.c_[x.ravel(), y.ravel(), np.ones(144)]
        for line, true in zip(points @ a.T, points @ b.T):
            along = np.linspace(0, 1, 40)
            if abs(true[1]) > abs(true[0]):
                at = np.c_[along * (w2 - 1), -(true[0] * along * (w2 - 1) + true[2]) / true[1]]
            else:
                at = np.c_[-(true[1] * along * (h2 - 1) + true[2]) / true[0], along * (h2 - 1)]
            at = at[np.all((at >= 0) & (at < (w2, h2)), axis=1)]
            if len(at) > 2:
                off = np.abs(at @ line[:2] + line[2]) / np.hypot(line[0], line[1])
                found.append(min(0.1 * max(w, w2), off.mean()))
    return float(np.mean(found)) if found else None


def clicks_of(matches, count, random, wrong=0, noise=1.0, apart=0.12):
    """Returns true matches as clicks, far from each other, with Gaussian noise; the last `wrong` mismatched."""
    size = np.ptp(matches[:, :2], axis=0).max()
    for attempt in range(200):
        chosen = matches[random.permutation(len(matches))[:count]].copy()
        gaps = [np.linalg.norm(a[:2] - b[:2]) for k, a in enumerate(chosen) for b in chosen[:k]]
        if min(gaps) > max(30, (1 - attempt / 200) * 3 * apart * size):
            break
    for k in range(wrong):
        own = chosen[-1 - k]
        far = np.linalg.norm(matches[:, 2:] - own[2:], axis=1) > 0.1 * size
        others = matches[far] if far.any() else matches
        own[2:] = others[random.integers(len(others))][2:]
    return chosen + random.normal(0, noise, chosen.shape)


def homography_matches(left, right):
    """Returns matches of a plane or a turned camera: the inliers of one homography between SIFT features. None if
    they are too few to be trusted."""
    import cv2

    cv2.setNumThreads(1)
    found = [cv2.SIFT_create(4000).detectAndCompute(cv2.imread(path, 0), None) for path in (left, right)]
    (k1, d1), (k2, d2) = found
    likely = [a for a, b in cv2.BFMatcher().knnMatch(d1, d2, 2) if a.distance < 0.8 * b.distance]
    matches = np.array([[*k1[m.queryIdx].pt, *k2[m.trainIdx].pt] for m in likely])
    _, inside = cv2.findHomography(matches[:, :2], matches[:, 2:], cv2.USAC_MAGSAC, 3.0)
    return matches[inside.ravel() > 0] if inside.sum() >= 30 else None


def source_scene(meta):
    """Returns the scene of the photograph that a pair without parallax was made of."""
    source = meta["params"].get("source") or (meta["params"].get("backgrounds") or [None])[0]
    if not source:
        return "wall" if meta["kind"] == "foliage" else meta["id"]
    name = os.path.basename(source)
    return name.split("-")[0] if "-" in name else name.split("A.")[0]


def known(data):
    """Yields set, scene, name, pictures, true matches (or None) and true F (or None) of pairs with truth."""
    tracks = [line.split() for line in open(f"{data}/house/house.nview-corners", encoding="utf-8")]
    for name, left, right, truth in known_pairs(f"{data}/house"):
        k = int(name.split(".")[1])
        corners = [np.loadtxt(f"{data}/house/house.{i:03}.corners")[:, :2] for i in (k, k + 1)]
        both = [row for row in tracks if "*" not in (row[k], row[k + 1])]
        matches = np.array([[*corners[0][int(row[k])], *corners[1][int(row[k + 1])]] for row in both])
        yield "house", "house", name, left, right, matches, truth
    for folder in ("pairs", "wide"):
        for path in sorted(glob.glob(f"{data}/{folder}/*.txt")):
            stem = path[:-4]
            if not glob.glob(glob.escape(stem) + "A.*"):
                continue
            name = os.path.basename(stem)
            truth = np.loadtxt(stem + "_F.txt") if os.path.exists(stem + "_F.txt") else None
            matches = np.loadtxt(path, ndmin=2)[:, :4]
            yield folder, name.split("-")[0], name, picture(stem + "A"), picture(stem + "B"), matches, truth
    for path in sorted(glob.glob(f"{data}/real/strecha/*_F.txt")):
        stem = path[: -len("_F.txt")]
        name = os.path.basename(stem)
        scene = name.split("-")[0]
        yield "strecha", scene, name, picture(stem + "A"), picture(stem + "B"), None, np.loadtxt(path)


def tasks(data, made):
    """Returns what to run: rank, key, set, scene, pictures, clicks, seed, true matches, true F."""
    found = []

    def add(rank, kind, scene, name, left, right, matches, truth, mode, clicks, seed=0):
        key = f"{kind}/{name}/{mode}/{seed}"
        found.append((rank, zlib.crc32(key.encode()), key, kind, scene, mode, left, right, clicks, seed, matches, truth))

    for kind, scene, name, left, right, matches, truth in known(data):
        pair = (kind, scene, name, left, right, matches, truth)
        add(0, *pair, "none", [])
        add(3, *pair, "none", [], 1)
        if matches is None:
            continue
        random = np.random.default_rng(zlib.crc32(name.encode()))
        for trial in range(3):
            for rank, mode, count, wrong in ((1, "two", 2, 0), (2, "two-wrong", 2, 1), (2, "three", 3, 0), (2, "three-wrong", 3, 1)):
                clicks = clicks_of(matches, count, random, wrong)
                add(rank + trial, *pair, f"{mode}-{trial}", clicks)
    for kind in ("planes", "turns"):
        for left in sorted(glob.glob(f"{data}/real/{kind}/*A.*")):
            stem = os.path.splitext(left)[0][:-1]
            name = os.path.basename(stem)
            pair = (kind, name.split("-")[0], name, left, picture(stem + "B"))
            add(0, *pair, "homography", None, "none", [])
            add(3, *pair, "homography", None, "none", [], 1)
            for trial in range(2):
                add(1 + trial, *pair, "homography", None, f"two-{trial}", "homography")
    for k, folder in enumerate(made):
        for meta in json.load(open(f"{folder}/meta.json", encoding="utf-8")):
            matches = np.array(meta["matches"]) if len(meta["matches"]) > 7 else None
            pair = ("made", source_scene(meta), f"{os.path.basename(folder)}-{meta['id']}", meta["A"], meta["B"], matches, None)
            add(2 * k, *pair, "none", [])
            add(2 * k + 1, *pair, "two-0", meta["clicks"]["2"])
            add(2 * k + 2, *pair, "five-0", meta["clicks"]["5"])
    return sorted(found, key=lambda task: task[:2])


def run(program, task):
    """Returns the record of one result."""
    _, _, key, kind, scene, mode, left, right, clicks, seed, matches, truth = task
    if isinstance(matches, str):
        matches = homography_matches(left, right)
    if isinstance(clicks, str) and matches is None:
        return {"key": key, "set": kind, "scene": scene, "mode": mode, "verdict": None, "said": "no true matches"}
    if isinstance(clicks, str):
        clicks = clicks_of(matches, 2, np.random.default_rng(zlib.crc32(key.encode())))
    command = [program, "estimate", left, right, "--json", "-", "--threads", "1", "--seed", str(seed)]
    command += ["--pair=" + ",".join(f"{v:.3f}" for v in click) for click in clicks]
    done = subprocess.run(command, capture_output=True, check=False)
    record = {"key": key, "set": kind, "scene": scene, "mode": mode}
    if not done.stdout:
        return record | {"verdict": None, "said": done.stderr.decode()[-200:]}
    found = json.loads(done.stdout)
    f = np.array(found["fundamental"], float)
    frames = [(image["width"], image["height"]) for image in found["images"]]
    side = max(max(frame) for frame in frames)
    at_matches = None if matches is None else float(np.mean(distances(f, matches)) / side)
    everywhere = None if truth is None else between_lines(f, truth, frames) / side
    parts = ("verdict", "failed_tests", "reasons", "determined", "margin", "refined_margin", "support", "noise", "seconds", "epipole_bearings", "pair_distances")
    record |= {part: found.get(part) for part in parts}
    record |= {"matches": len(found["matches"]), "side": side, "at_matches": at_matches, "everywhere": everywhere}
    return record


def collect(program, table, data, *made):
    have = set()
    if os.path.exists(table):
        with open(table, encoding="utf-8") as file:
            have = {json.loads(line)["key"] for line in file}
    share = [int(v) for v in os.environ.get("SHARE", "0/1").split("/")]
    todo = [task for k, task in enumerate(tasks(data, made)) if task[2] not in have and task[1] % share[1] == share[0]]
    for number, task in enumerate(todo):
        line = json.dumps(run(program, task)) + "\n"
        with open(table, "a", encoding="utf-8") as file:
            file.write(line)
        print(f"{number + 1} of {len(todo)}: {task[2]}", file=sys.stderr)



# --- Report ----------------------------------------------------------------------------------------------

# Scenes of the first half; all others are in the second. Pairs made of a photograph go with its scene.
FIRST_HALF = {
    "house", "kermit", "brighton", "castle", "library", "Dresden", "corr", "graff", "kampa", "plant", "wall",
    "BruggeSquare", "LePoint1", "adam", "city", "ev_cafe", "ev_graf",
}
GROUPS = ["nothing", "click", "epipole", "support", "unreliable"]
OF_EPIPOLE = {"one-plane", "no-relief", "only-turned", "behind-cameras", "bent", "pattern", "mirrored"}


def load(tables):
    """Returns the results with a verdict, the first of each key."""
    found = {}
    for table in tables:
        with open(table, encoding="utf-8") as file:
            for record in map(json.loads, file):
                if record["verdict"]:
                    found.setdefault(record["key"], record)
    return list(found.values())


def is_right(record):
    """Returns whether a result is right, as the head of this file says, or None if that is not known."""
    if record["set"] in ("planes", "turns", "made"):
        if record["determined"] != "lines":
            return False
        if record["at_matches"] is None:
            return False if record["set"] == "made" else None
        return record["at_matches"] <= LIMIT
    error = record["everywhere"] if record["at_matches"] is None else record["at_matches"]
    return error is not None and error <= LIMIT


def group(record):
    """Returns what speaks against a result."""
    kinds = {test["kind"] for test in record["failed_tests"]}
    if record["verdict"] != "doubtful":
        return "nothing" if record["verdict"] == "reliable" else "unreliable"
    if kinds == {"click-off"}:
        return "click"
    return "epipole" if kinds - {"click-off"} <= OF_EPIPOLE else "support"


def half_of(record):
    scene = record["scene"]
    if scene in FIRST_HALF:
        return 0
    return 1 if record["set"] != "made" or not scene.split("-")[-1].isdigit() else zlib.crc32(scene.encode()) % 2


class Frequencies:
    """Share of right results for each value of `of`, by the rule of succession."""

    def __init__(self, records, of):
        self.of = of
        self.counts = collections.defaultdict(lambda: [0, 0])
        for record in records:
            self.counts[of(record)][not is_right(record)] += 1

    def __call__(self, record):
        right, wrong = self.counts[self.of(record)]
        return (right + 1) / (right + wrong + 2)


class Ordered(Frequencies):
    """Frequencies of the groups of failed tests, where a worse group never has a larger share: groups that have are
    counted together (pooled adjacent violators)."""

    def __init__(self, records):
        super().__init__(records, group)
        pools = []
        for name in GROUPS:
            pools.append(([name], *self.counts[name]))
            while len(pools) > 1 and self.share(*pools[-1][1:]) > self.share(*pools[-2][1:]):
                (names, right, wrong), (before, right0, wrong0) = pools.pop(), pools.pop()
                pools.append((before + names, right + right0, wrong + wrong0))
        for names, *counts in pools:
            self.counts.update(dict.fromkeys(names, counts))

    @staticmethod
    def share(right, wrong):
        return (right + 1) / (right + wrong + 2)


def figures_of(record):
    """Returns the figures of the logistic model: whether each group applies, the matches, and the margin."""
    margin = record["margin"] if record["refined_margin"] is None else record["refined_margin"]
    margin = 1.0 if margin is None else min(max(margin, 0), 1)
    return [*(float(group(record) == name) for name in GROUPS), np.log(max(record["matches"], 1) / 300), margin - 0.5]


class Logistic:
    """Logistic function of a few figures, with a Gaussian prior of deviation `spread` on each weight."""

    def __init__(self, records, spread=2.0):
        from scipy.optimize import minimize

        x = np.array([figures_of(r) for r in records])
        sign = np.array([1.0 if is_right(r) else -1.0 for r in records])
        cost = lambda w: np.logaddexp(0, -sign * (x @ w)).sum() + (w @ w) / (2 * spread**2)
        self.weights = minimize(cost, np.zeros(x.shape[1])).x

    def __call__(self, record):
        return 1 / (1 + np.exp(-np.dot(self.weights, figures_of(record))))


def brier(chances, right):
    return float(np.mean((chances - right) ** 2))


def risk_coverage(chances, right):
    """Returns the area under the share of wrong results among the surest ones, over how many are taken. Results
    of equal probability count in the mean of all orders."""
    risks, wrong, taken = [], 0.0, 0
    for chance in sorted(set(chances), reverse=True):
        tied = right[chances == chance]
        share = 1 - tied.mean()
        for _ in tied:
            wrong, taken = wrong + share, taken + 1
            risks.append(wrong / taken)
    return float(np.mean(risks))


def interval(right, of):
    """Returns Wilson's 95 % interval of a share."""
    z, share = 1.96, right / of
    middle, spread = share + z * z / (2 * of), z * np.sqrt(share * (1 - share) / of + z * z / (4 * of * of))
    return (middle - spread) / (1 + z * z / of), (middle + spread) / (1 + z * z / of)


def reliability(chances, right):
    """Returns the rows of a reliability diagram: told, measured, its interval, number of results."""
    rows = []
    bins = np.minimum((chances * 10).astype(int), 9) + (chances >= 0.98)
    for k in np.unique(bins):
        own = bins == k
        rows.append((chances[own].mean(), right[own].mean(), *interval(right[own].sum(), own.sum()), int(own.sum())))
    return rows


def models(fit):
    return {
        "base rate": Frequencies(fit, lambda _: "all"),
        "word": Frequencies(fit, lambda record: record["verdict"]),
        "group of failed tests": Ordered(fit),
        "logistic": Logistic(fit),
    }


def counts(records):
    label = lambda record: "one click mismatched" if "wrong" in record["mode"] else record["set"]
    print("| set | results | right | reliable | wrong among these | right ones called reliable | " + " | ".join(f"{g}: right of" for g in GROUPS) + " |")
    print("|" + "---|" * (6 + len(GROUPS)))
    for kind in [*sorted({label(r) for r in records}), "all"]:
        own = [r for r in records if kind in (label(r), "all")]
        reliable = [r for r in own if r["verdict"] == "reliable"]
        right = [r for r in own if is_right(r)]
        cells = [len(own), len(right), len(reliable), sum(is_right(r) is False for r in reliable)]
        cells.append(f"{sum(r['verdict'] == 'reliable' for r in right)} of {len(right)}")
        for name in GROUPS:
            grouped = [is_right(r) for r in own if group(r) == name and is_right(r) is not None]
            cells.append(f"{sum(grouped)} of {len(grouped)}")
        print(f"| {kind} | " + " | ".join(map(str, cells)) + " |")


def draw(curves, folder):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "epiline"
    import matplotlib.pyplot as plt

    os.makedirs(folder, exist_ok=True)
    figure, axes = plt.subplots(figsize=(4.5, 4.5))
    axes.plot([0, 1], [0, 1], color="gray", linewidth=0.8)
    for name, rows in curves:
        told, measured, low, high, _ = map(np.array, zip(*rows))
        axes.errorbar(told, measured, [measured - low, high - measured], fmt="o", capsize=3, label=name)
    axes.set(xlim=(0, 1.02), ylim=(0, 1.02), xlabel="stated probability", ylabel="share of right results (95 % interval)")
    axes.legend()
    figure.tight_layout()
    figure.savefig(os.path.join(folder, "reliability.svg"), metadata={"Date": None})


def report(table, figures=None):
    records = load(table.split(","))
    counts(records)
    records = [r for r in records if is_right(r) is not None]
    halves = [[r for r in records if half_of(r) == k] for k in (0, 1)]
    curves = []
    for k in (0, 1):
        fit, test = halves[k], halves[1 - k]
        right = np.array([float(is_right(r)) for r in test])
        print(f"\nFitted to half {k + 1} ({len(fit)} results), tested on half {2 - k} ({len(test)}, {right.mean():.1%} right):")
        ideal = np.arange(1, len(right) + 1) - right.sum()
        ideal = float(np.mean(np.maximum(ideal, 0) / np.arange(1, len(right) + 1)))
        for name, model in models(fit).items():
            chances = np.array([model(r) for r in test])
            print(f"  {name:22} Brier {brier(chances, right):.4f}, area under risk-coverage {risk_coverage(chances, right):.4f} (ideal {ideal:.4f})")
            if name in ("group of failed tests", "logistic"):
                rows = reliability(chances, right)
                print("    told → measured: " + "; ".join(f"{t:.1%} → {m:.1%} ({lo:.1%} to {hi:.1%}) of {n}" for t, m, lo, hi, n in rows))
                if name == "group of failed tests":
                    curves.append((f"half {2 - k}, fitted to half {k + 1}", rows))
    print("\nProbability by group: half 1, half 2, both")
    fits = [Ordered(part) for part in (*halves, records)]
    for name in GROUPS:
        cells = [f.counts[name] for f in fits]
        print(f"  {name:10} " + ", ".join(f"{(r + 1) / (r + w + 2):.4f} ({r} of {r + w} right)" for r, w in cells))
    print("weights of the logistic model:", *(np.round(Logistic(part).weights, 2) for part in halves))
    print("\nReliable and wrong:", *(r["key"] for r in records if r["verdict"] == "reliable" and not is_right(r)))
    if figures:
        draw(curves, figures)


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] not in ("collect", "report"):
        sys.exit(__doc__)
    {"collect": collect, "report": report}[sys.argv[1]](*sys.argv[2:])
