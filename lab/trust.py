#!/usr/bin/env python3
"""How often results are right that the program calls likely to be right.

    python3 lab/trust.py collect PROGRAM TABLE DATA [MADE...]
    python3 lab/trust.py report TABLE [FIGURES]
    python3 lab/trust.py table TABLE STORED

`collect` runs PROGRAM, the command-line program, and adds one line of JSON for each result to TABLE. Results
that TABLE has are not computed again; the most telling come first. With SHARE=0/2 in the environment, half of
them are computed. DATA holds house/, pairs/, wide/, real/ and outside/; each MADE is a folder of pairs without
parallax with its meta.json. `report` takes several tables, separated by commas. It counts the verdicts, tests the
stated probability, and fits it on one half of the scenes and tests it on the other, both ways. It prints the
constants of `estimate/verdict/constants.rs`, and draws the reliability diagram into FIGURES. `table` stores the figures
and the truth of all results for the unit test of the verdict, `src/estimate/verdict/trust/table.jsonl`.

The lines of a result are right if they are within 1 % of the longer side: the mean symmetric epipolar distance of
the true matches, or for laser-scanned cameras the mean distance from the true lines all over the pictures. Those of
unrelated pictures are wrong. A result is right if its lines are and if it does not claim an epipole that nothing
determines (`determined` is `lines` without parallax). True matches of pairs without parallax are those of the made
pair, or the inliers of one homography of SIFT features. With fewer than 30 inliers, and for made pairs without true
matches, it is not known whether the lines are right.
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
UNRELATED = 26  # Number of pairs of pictures of different scenes.


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
    for path in sorted(glob.glob(f"{data}/outside/*/*A.*")):
        stem = os.path.splitext(path)[0][:-1]
        kind, name = stem.split("/")[-2:]
        given = f"{data}/outside/matches/{kind}_{name}.txt"
        if kind == "wxbs":
            matches = np.loadtxt(f"{stem}.txt", ndmin=2)[:, :4]
        elif os.path.exists(given):
            # Matches of another program that the true cameras confirm.
            matches = np.loadtxt(given, ndmin=2)[:, :4]
            matches = matches[distances(np.loadtxt(f"{stem}_F.txt"), matches) < 3]
        else:
            continue
        truth = np.loadtxt(f"{stem}_F.txt") if os.path.exists(f"{stem}_F.txt") else None
        yield kind, name if kind == "wxbs" else kind, name, path, picture(stem + "B"), matches, truth
    pictures = sorted(glob.glob(f"{data}/wide/*A.jpg")) + sorted(glob.glob(f"{data}/real/strecha/*A.*"))
    random = np.random.default_rng(7)
    for k in range(UNRELATED):
        scene_of = lambda path: os.path.basename(path).split("-")[0]
        left, right = (pictures[i] for i in random.integers(len(pictures), size=2))
        while scene_of(left) == scene_of(right):
            right = pictures[random.integers(len(pictures))]
        yield "unrelated", f"unrelated-{k}", f"{k:02}", left, right, None, None


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
    parts = ("verdict", "failed_tests", "figures", "determined", "line_evidence", "line_bands", "probability_within_one_percent", "noise", "seconds", "epipole_bearings", "pair_distances")
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


def load(tables):
    """Returns the results with a verdict, the first of each key."""
    found = {}
    for table in tables:
        with open(table, encoding="utf-8") as file:
            for record in map(json.loads, file):
                if record["verdict"]:
                    found.setdefault(record["key"], record)
    return list(found.values())


def lines_are_right(record):
    """Returns whether the lines of a result are right near the matches, or None if that is not known."""
    if record["set"] == "unrelated":
        return False
    error = record["everywhere"] if record["at_matches"] is None else record["at_matches"]
    return None if error is None else error <= LIMIT


def is_right(record):
    """Returns whether a result is right, as the head of this file says, or None if that is not known."""
    if record["set"] in ("planes", "turns", "made") and record["determined"] != "lines":
        return False
    return lines_are_right(record)


def short(value):
    """Returns a value of JSON with structures as lists of their fields, and numbers of four significant digits."""
    if isinstance(value, dict):
        return [short(part) for part in value.values()]
    if isinstance(value, list):
        return [short(part) for part in value]
    # The largest number must not be rounded up.
    return min(float(f"{value:.4g}"), 1.797e308) if isinstance(value, float) else value


def store(table, stored):
    """Writes what the pure verdict needs after a line of counts. What is null or as by default is left out."""
    records = sorted(load(table.split(",")), key=lambda r: r["key"])
    right = [r for r in records if lines_are_right(r) and r["set"] not in ("planes", "turns", "made")]
    unrelated = [r for r in records if r["set"] == "unrelated"]
    known = [r for r in records if r["line_evidence"] and lines_are_right(r) is not None]
    errors = [(stated(r) - lines_are_right(r)) ** 2 for r in known if stated(r) is not None]
    counts = {"right": len(right), "reliable": sum(r["verdict"] == "reliable" for r in right)}
    counts |= {"unrelated": len(unrelated), "named": sum(r["verdict"] == "different-scenes" for r in unrelated)}
    counts["brier"] = round(float(np.mean(errors)), 4)
    with open(stored, "w", encoding="utf-8") as file:
        file.write(json.dumps(counts) + "\n")
        for record in records:
            parallax = record["set"] not in ("planes", "turns", "made")
            figures = {k: v for k, v in record["figures"].items() if v is not None and v != []}
            case = {k: v if k == "refined_on" else short(v) for k, v in figures.items()}
            row = {"key": record["key"], "lines": lines_are_right(record), "parallax": parallax, "case": case}
            file.write(json.dumps(row, separators=(",", ":")) + "\n")


def half_of(record):
    scene = record["scene"]
    if scene in FIRST_HALF:
        return 0
    by_name = record["set"] in ("unrelated", "wxbs") or record["set"] == "made" and scene.split("-")[-1].isdigit()
    return zlib.crc32(scene.encode()) % 2 if by_name else 1


def stated(record):
    """Returns the probability that the program states."""
    return record["probability_within_one_percent"]


def grown(record):
    """Returns the lead of the lines as `estimate/verdict/trust/lines.rs` takes it."""
    found = record["line_evidence"]
    lead = min(found["likelihood"] - found["rival"], max(-found["log_false_alarms"], 0.0))
    return np.log1p(lead) if lead > 0 else lead / (1 - lead)


class LogOdds:
    """Log-odds that are a linear function of the grown lead."""

    def __init__(self, records):
        from scipy.optimize import minimize

        x = np.array([(1.0, grown(r)) for r in records])
        sign = np.array([1.0 if lines_are_right(r) else -1.0 for r in records])
        # The prior of deviation 5 decides only where all results are right.
        cost = lambda w: np.logaddexp(0, -sign * (x @ w)).sum() + (w @ w) / 50
        self.weights = minimize(cost, np.zeros(2)).x

    def __call__(self, record):
        return 1 / (1 + np.exp(-np.dot(self.weights, (1.0, grown(record)))))


class Word:
    """Share of right lines for each word of the verdict, by the rule of succession."""

    def __init__(self, records):
        self.counts = collections.defaultdict(lambda: [0, 0])
        for record in records:
            self.counts[record["verdict"]][not lines_are_right(record)] += 1

    def __call__(self, record):
        right, wrong = self.counts[record["verdict"]]
        return (right + 1) / (right + wrong + 2)


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


def counts(records):
    label = lambda record: "one click mismatched" if "wrong" in record["mode"] else record["set"]
    print("| set | results | right | reliable | wrong among these | right ones called reliable | right lines, of known |")
    print("|" + "---|" * 7)
    for kind in [*sorted({label(r) for r in records}), "all"]:
        own = [r for r in records if kind in (label(r), "all")]
        reliable = [r for r in own if r["verdict"] == "reliable"]
        right = [r for r in own if is_right(r)]
        cells = [len(own), len(right), len(reliable), sum(is_right(r) is False for r in reliable)]
        cells.append(f"{sum(r['verdict'] == 'reliable' for r in right)} of {len(right)}")
        known = [lines_are_right(r) for r in own if lines_are_right(r) is not None]
        cells.append(f"{sum(known)} of {len(known)}")
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


def described(name, chances, right):
    """Prints the scores of probabilities and returns the rows of their reliability diagram."""
    rows = reliability(chances, right)
    print(f"  {name:9} Brier {brier(chances, right):.4f}, area under risk-coverage {risk_coverage(chances, right):.4f}")
    print("    told → measured: " + "; ".join(f"{t:.1%} → {m:.1%} ({lo:.1%} to {hi:.1%}) of {n}" for t, m, lo, hi, n in rows))
    return rows


def report(table, figures=None):
    records = load(table.split(","))
    counts(records)
    print("\nReliable and wrong:", *(r["key"] for r in records if r["verdict"] == "reliable" and is_right(r) is False))
    records = [r for r in records if lines_are_right(r) is not None and r["line_evidence"] is not None]
    right_of = lambda own: np.array([float(lines_are_right(r)) for r in own])
    own = [r for r in records if stated(r) is not None]
    print(f"\nAll {len(own)} results with a probability, {right_of(own).mean():.1%} right:")
    curves = [("stated", described("stated", np.array([stated(r) for r in own]), right_of(own)))]
    halves = [[r for r in records if half_of(r) == k] for k in (0, 1)]
    crossed = []
    for k in (0, 1):
        fit, test = halves[k], halves[1 - k]
        right = right_of(test)
        print(f"\nFitted to half {k + 1} ({len(fit)} results), tested on half {2 - k} ({len(test)}, {right.mean():.1%} right):")
        for name, model in (("word", Word(fit)), ("log-odds", LogOdds(fit))):
            rows = described(name, np.array([model(r) for r in test]), right)
        curves.append((f"half {2 - k}, fitted to half {k + 1}", rows))
        crossed.append((np.array([model(r) for r in test]), right))
    chances, right = map(np.concatenate, zip(*crossed))
    print("\nBoth halves, each with the fit of the other:")
    described("log-odds", chances, right)
    print("constants of half 1, half 2, both:", *(np.round(LogOdds(part).weights, 2) for part in (*halves, records)))
    if figures:
        draw(curves, figures)


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] not in ("collect", "report", "table"):
        sys.exit(__doc__)
    {"collect": collect, "report": report, "table": store}[sys.argv[1]](*sys.argv[2:])
