"""Tests of the package. They need NumPy alone, and the pictures that the program draws."""

import base64
import concurrent.futures
import contextlib
import doctest
import importlib.util
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock

import numpy as np

import epiline

RNG = np.random.default_rng(5)
SIZE = (240, 320)


def texture(height, width, seed=0):
    """Return a smooth random picture with values from 0 to 255."""
    rng = np.random.default_rng(seed)
    total = np.zeros((height, width))
    for side in (6, 14, 30, 60, 120):
        coarse = rng.random((side + 2, side + 2))
        y, x = np.meshgrid(np.linspace(0, side, height), np.linspace(0, side, width), indexing="ij")
        i, j = np.floor(y).astype(int), np.floor(x).astype(int)
        v, u = y - i, x - j
        total += (
            coarse[i, j] * (1 - v) * (1 - u)
            + coarse[i + 1, j] * v * (1 - u)
            + coarse[i, j + 1] * (1 - v) * u
            + coarse[i + 1, j + 1] * v * u
        )
    total -= total.min()
    return total * (255 / total.max())


def rows_shifted():
    """Return two pictures whose rows move by different amounts: depth in steps, camera moved to the side."""
    wide = texture(SIZE[0], SIZE[1] + 60)
    left, right = np.empty(SIZE), np.empty(SIZE)
    for y in range(SIZE[0]):
        shift = (9, 22, 15, 30, 12, 26)[y // 40]
        left[y], right[y] = wide[y, 40 : 40 + SIZE[1]], wide[y, 40 - shift : 40 - shift + SIZE[1]]
    return [np.round(picture).astype(np.uint8) for picture in (left, right)]


LEFT, RIGHT = rows_shifted()
ROWS = np.array([[0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]) / np.sqrt(2)


def scene(count=80, noise=0.3):
    """Return matches of two cameras, and the matrix."""
    # The same in each test, in any order of the tests.
    random = np.random.default_rng(4)
    points = np.c_[random.uniform(-1, 1, (count, 2)), random.uniform(3, 6, count)]
    K = np.array([[500, 0, 320], [0, 500, 240], [0, 0, 1.0]])
    angle = 0.1
    R = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    t = np.array([0.6, 0.1, 0.2])
    x1, x2 = points @ K.T, (points @ R.T + t) @ K.T
    cross = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    inverse = np.linalg.inv(K)
    both = [x[:, :2] / x[:, 2:] + random.normal(0, noise, (count, 2)) for x in (x1, x2)]
    return *both, inverse.T @ cross @ R @ inverse, K, R, t / np.linalg.norm(t)


def program(*arguments):
    """Run the command line of the package. Return its exit status, its result if that is JSON, and its messages."""
    done = subprocess.run([sys.executable, "-m", "epiline", *map(str, arguments)], capture_output=True, text=True)
    with contextlib.suppress(ValueError):
        return done.returncode, json.loads(done.stdout), done.stderr
    return done.returncode, None, done.stderr


def handed_over(found):
    """Return the document of the session that the window would open, the paths of its pictures, and F of the same search."""
    with tempfile.TemporaryDirectory() as folder:
        with open(found._hand_over(folder), encoding="utf-8") as file:
            session = json.load(file)
        paths = [os.path.normpath(os.path.join(folder, image["path"])) for image in session["images"]]
        document = session["content"]["document"]
        if not all(map(os.path.isfile, paths)):
            return document, paths, None
        matches = document.get("given", {}).get("matches")
        if matches:
            columns = np.array(matches)
            matches = columns[:, :2], columns[:, 2:4], columns[:, 5]
        pairs = [[*pair["point1"], *pair["point2"]] for pair in document["pairs"]]
        again = epiline.estimate(*paths, pairs or None, matches=matches, seed=document["parameters"]["seed"])
        return document, paths, again.F


def save(picture, path):
    """Write a grey or a coloured picture of 8 bits. Return the path."""
    kind = b"P5" if picture.ndim == 2 else b"P6"
    with open(path, "wb") as file:
        file.write(b"%s %d %d 255\n" % (kind, picture.shape[1], picture.shape[0]) + picture.tobytes())
    return path


ROWS_OF_POINTS = RNG.uniform(20, 200, (30, 2))


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = epiline.estimate(LEFT, RIGHT)

    def test_an_estimate_has_its_matrix_and_evidence(self):
        found = self.found
        self.assertEqual(found.F.shape, (3, 3))
        distances = epiline.epipolar_distance(found.F, found.points1, found.points2)
        self.assertLess(np.median(distances), 1.0)
        self.assertGreater(len(found.points1), 50)
        self.assertEqual(found.residuals.shape, (len(found.points1),))
        y = np.abs(found.points1[:, 1] - found.points2[:, 1])
        self.assertLess(np.median(y), 0.5, "the rows moved along themselves")
        self.assertIn(found.verdict, ("reliable", "doubtful"))
        self.assertTrue(found.verdict == "reliable" or found.reasons)
        self.assertIsNone(found.inliers)
        self.assertIn(found.verdict, repr(found))

    def test_the_file_is_that_of_the_program(self):
        record = json.loads(self.found.to_json())
        self.assertEqual(record["verdict"].replace("-", " "), self.found.verdict)
        np.testing.assert_array_equal(np.array(record["fundamental"]), self.found.F)

    def test_the_same_bits_whatever_threads_and_layout(self):
        again = epiline.estimate(np.asfortranarray(LEFT), RIGHT[:, ::1], threads=1)
        np.testing.assert_array_equal(again.F, self.found.F)
        strided = np.repeat(np.repeat(LEFT, 2, axis=0), 2, axis=1)[::2, ::2]
        strided.setflags(write=False)
        np.testing.assert_array_equal(epiline.estimate(strided, RIGHT).F, self.found.F)

    def test_clicks_matches_and_progress(self):
        stages = []
        clicks = [[100, 20, 109, 20], [60, 130, 90, 130]]
        found = epiline.estimate(LEFT, RIGHT, clicks, progress=lambda stage, seconds: stages.append((stage, seconds)))
        self.assertTrue(stages and all(isinstance(name, str) and seconds >= 0 for name, seconds in stages))
        self.assertEqual(len(json.loads(found.to_json())["pairs"]), 2)
        pairs = np.hstack([self.found.points1, self.found.points2])[:40]
        matcher = {"keypoints0": pairs[None, :, :2], "keypoints1": pairs[None, :, 2:], "name": "a matcher"}
        for matches in (pairs, (pairs[:, :2], pairs[:, 2:]), (pairs[:, :2], pairs[:, 2:], np.full(40, 0.9)), matcher):
            found = epiline.estimate(LEFT, RIGHT, matches=matches)
            self.assertEqual(len(json.loads(found.to_json())["given_matches"]), 40)
        self.assertTrue(any("keypoints0" in remark for remark in found.remarks))

    def test_the_window_makes_the_same_search(self):
        pairs = np.hstack([self.found.points1, self.found.points2])[:30]
        deep = [np.uint16(200) * picture for picture in (LEFT, RIGHT)]
        floating = [picture.astype(np.float32) * 1.7 - 30 for picture in (LEFT, RIGHT)]
        weighted = pairs[:, :2], pairs[:, 2:], np.linspace(0.2, 0.9, 30)
        for images, arguments in (
            ((LEFT, RIGHT), {"pairs": [[100, 20, 109, 20], [60, 130, 90, 130]], "seed": 3}),
            (deep, {"matches": weighted}),
            (floating, {"seed": 1}),
        ):
            found = epiline.estimate(*images, **arguments)
            document, _, F = handed_over(found)
            np.testing.assert_array_equal(F, found.F)
            self.assertEqual(document.get("unclicked", False), "pairs" not in arguments)

    def test_three_rows_are_three_matches(self):
        rows = [[100, 20, 109, 20], [60, 130, 90, 130], [200, 60, 222, 60]]
        found = epiline.estimate(LEFT, RIGHT, matches=rows)
        self.assertEqual(json.loads(found.to_json())["given_matches"], rows)

    @unittest.skipUnless(hasattr(os, "fork"), "there is no fork")
    def test_a_fork_searches_with_threads_of_its_own(self):
        child = os.fork()
        if child == 0:
            os._exit(0 if (epiline.estimate(LEFT, RIGHT).F == self.found.F).all() else 1)
        for _ in range(600):
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                break
            time.sleep(0.2)
        else:
            os.kill(child, signal.SIGKILL)
            self.fail("the fork does not end")
        self.assertEqual(status, 0)

    def test_kinds_of_pixels(self):
        for convert in (
            lambda p: p.astype(np.uint16) * 200,
            lambda p: p.astype(np.float32) / 255,
            lambda p: np.stack([p] * 3, axis=2),
            lambda p: p.astype(">u2") * np.uint16(200),
        ):
            found = epiline.estimate(convert(LEFT), convert(RIGHT))
            self.assertLess(np.median(epiline.epipolar_distance(found.F, self.found.points1, self.found.points2)), 1.0)

    def test_wrong_pictures_are_named(self):
        for wrong, told in (
            (np.zeros((5, 5, 2), np.uint8), r"\(H, W, 3\)"),
            (np.zeros((50, 50), np.int32), "uint8, uint16 and float32"),
            (np.full((50, 50), np.nan, np.float32), "finite"),
            (np.zeros((0, 4), np.uint8), "no pixels|empty"),
            (3, "a path or a NumPy array, not int"),
            ("no-such-file.png", "no-such-file.png"),
            (np.full((99, 99), 7, np.uint8), "uniform"),
        ):
            with self.subTest(told), self.assertRaisesRegex(epiline.InputError, told):
                epiline.estimate(wrong, RIGHT)

    def test_wrong_arguments_are_named(self):
        for arguments, told in (
            ({"pairs": [[1, 2, 3]]}, r"\(N, 4\)"),
            ({"pairs": [[np.nan, 2, 3, 4], [9, 9, 9, 9]]}, "not a finite number"),
            ({"pairs": "here"}, "no array of numbers"),
            ({"matches": {"x": [1]}}, "no matches among the arrays x"),
            ({"matches": np.empty((0, 4))}, "there are no matches"),
            ({"preset": "fast"}, "robust"),
            ({"parameters": {"sed": 1}}, "there is no parameter sed"),
            ({"cameras": [np.eye(3)]}, "one camera for each image"),
            ({"cameras": ["left.yaml", np.eye(3)]}, "not one of each"),
            ({"cameras": [np.zeros((3, 3)), np.eye(3)]}, "camera 1 is impossible"),
            ({"cameras": [(np.eye(3), [0.1]), np.eye(3)]}, "1 distortion coefficients"),
            ({"threads": 0}, "at least 1"),
            ({"threads": 100_000}, "at most 256"),
            ({"parameters": {"seed": 3}}, "an argument of its own"),
            ({"parameters": {"patches": object()}}, "no number"),
            ({"matches": (np.ones((9, 2)), np.ones((9, 2)), [0.5])}, "1 numbers for 9 matches"),
            # Indices that cannot be read must not turn keypoints into matches.
            (
                {"matches": {"keypoints0": ROWS_OF_POINTS, "keypoints1": ROWS_OF_POINTS, "matches": [[1], [2, 3]]}},
                "matches stands beside it",
            ),
            ({"origin": "matlab"}, "colmap"),
        ):
            pairs = arguments.pop("pairs", [[100, 20, 109, 20], [60, 130, 90, 130]])
            with self.subTest(told), self.assertRaisesRegex(ValueError, told):
                epiline.estimate(LEFT, RIGHT, pairs, **arguments)

    def test_an_exception_of_the_callback_stops_the_search(self):
        def stop(stage, seconds):
            raise KeyError("stop")

        with self.assertRaises(KeyError):
            epiline.estimate(LEFT, RIGHT, progress=stop)

    def test_threads_of_python_search_at_once(self):
        results = [None] * 8

        def search(k):
            results[k] = epiline.estimate(LEFT, RIGHT, threads=1).F

        threads = [threading.Thread(target=search, args=(k,)) for k in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for F in results:
            np.testing.assert_array_equal(F, self.found.F)

    def test_ctrl_c_stops_a_search(self):
        code = (
            "import signal, numpy as np, epiline\n"
            # A shell starts processes in the background without this handler.
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "picture = np.random.default_rng(0).integers(0, 255, (1500, 2000), np.uint8)\n"
            "print('begun', flush=True)\n"
            "try:\n    epiline.estimate(picture, np.roll(picture, 7, 1))\nexcept KeyboardInterrupt:\n    print('stopped')\n"
        )
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
        self.assertEqual(process.stdout.readline(), "begun\n")
        time.sleep(0.4)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=120)[0], "stopped\n")

    def test_judgements(self):
        found = epiline.judge(LEFT, RIGHT, ROWS)
        self.assertEqual((found.finding, found.fits), ("fits", True), found.message)
        wrong = epiline.judge(LEFT, RIGHT, [[0, 0, 1], [0, 0, 0], [-1, 0, 0.0]])
        self.assertNotEqual(wrong.finding, "fits")
        rows = epiline.judge(LEFT, RIGHT, rectified=True)
        self.assertTrue(rows.fits, rows.message)
        pairs = np.hstack([self.found.points1, self.found.points2])
        by_matches = epiline.judge(LEFT, RIGHT, ROWS, matches=pairs)
        self.assertTrue(by_matches.fits and by_matches.reference_verdict is None)
        self.assertIn("lines_apart", json.loads(found.to_json()))
        for arguments, told in (
            ({}, "one geometry to judge"),
            ({"F": ROWS, "rectified": True}, "one geometry to judge"),
            ({"F": np.ones((2, 3))}, r"\(3, 3\)"),
            ({"F": np.zeros((3, 3))}, "F: "),
            ({"F": ROWS, "limit": -1.0}, "above 0"),
            ({"F": ROWS, "covariance": np.full((9, 9), np.nan)}, "finite"),
            ({"cameras": [np.eye(3, 4)] * 2}, "same centre"),
        ):
            with self.subTest(told), self.assertRaisesRegex(epiline.InputError, told):
                epiline.judge(LEFT, RIGHT, **arguments)

    def test_suggestions_and_line_similarity(self):
        found = epiline.suggest(LEFT, RIGHT, (150, 100))
        self.assertLess(np.hypot(found[0].position[0] - 165, found[0].position[1] - 100), 3, found)
        line = epiline.line_similarity(LEFT, RIGHT, (150, 100, 1, 0), (165, 100, 1, 0))
        self.assertEqual(line.disparities.shape, line.profile1.shape)
        self.assertEqual(line.warped2.shape, line.profile1.shape)
        other = epiline.line_similarity(LEFT, RIGHT, (150, 100, 1, 0), (165, 30, 1, 0))
        self.assertLess(line.cost, other.cost)
        with self.assertRaisesRegex(epiline.InputError, "2 numbers are needed"):
            epiline.suggest(LEFT, RIGHT, (1, 2, 3))
        for arguments, told in (
            (((0, 0, 0, 0), (1, 1, 1, 0)), "not zero"),
            (((0, -50, 1, 0), (1, 1, 1, 0)), "line 1 does not cross"),
        ):
            with self.assertRaisesRegex(epiline.InputError, told):
                epiline.line_similarity(LEFT, RIGHT, *arguments)

    def test_memory_does_not_grow(self):
        def resident():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        if not os.path.exists("/proc/self/statm"):
            self.skipTest("no figures of the process")
        epiline.epilines(np.zeros((10, 2)), ROWS)
        points = RNG.uniform(0, 300, (1000, 2))
        before = resident()
        for _ in range(1000):
            epiline.epilines(points, ROWS)
            with self.assertRaises(epiline.InputError):
                epiline.epilines(points[:, :1], ROWS)
        self.assertLess(resident() - before, 8_000_000)


K = np.array([[420.0, 0, 160], [0, 420, 120], [0, 0, 1]])
BENT = (K, [0.12, -0.05, 0.0, 0.0])


class Cameras(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def file(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def middlebury(self, width=320):
        rows = "; ".join(" ".join(str(number) for number in row) for row in K)
        return f"cam0=[{rows}]\ncam1=[{rows}]\ndoffs=0\nbaseline=100\nwidth={width}\nheight=240\nndisp=64\n"

    def test_a_calibration_is_that_of_the_program(self):
        path = self.file("calib.txt", self.middlebury())
        found = epiline.estimate(LEFT, RIGHT, cameras=path)
        by_numbers = epiline.estimate(LEFT, RIGHT, cameras=[K, K])
        np.testing.assert_array_equal(found.F, by_numbers.F)
        pictures = [save(picture, os.path.join(self.folder, f"{k}.pgm")) for k, picture in enumerate((LEFT, RIGHT))]
        status, record, told = program("estimate", *pictures, "--calibration", path, "--json", "-")
        self.assertEqual(status, 0, told)
        np.testing.assert_array_equal(np.array(record["fundamental"]), found.F)
        ours = json.loads(found.to_json())
        self.assertEqual(ours["calibrated"], record["calibrated"])
        self.assertEqual(ours.get("calibration_notes"), record.get("calibration_notes"))

    def test_one_file_for_each_camera(self):
        text = "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n"
        one = ", ".join(str(float(number)) for number in K.ravel())
        paths = tuple(self.file(f"{side}.yaml", text.format(one)) for side in ("left", "right"))
        found = epiline.estimate(LEFT, RIGHT, cameras=paths)
        np.testing.assert_array_equal(found.F, epiline.estimate(LEFT, RIGHT, cameras=[K, K]).F)

    def test_errors_have_the_sentence_of_the_program(self):
        pictures = [save(picture, os.path.join(self.folder, f"{k}.pgm")) for k, picture in enumerate((LEFT, RIGHT))]
        for path in (
            self.file("empty.yaml", "nothing: 1\n"),
            self.file("resized.txt", self.middlebury(width=640)),
            os.path.join(self.folder, "missing.yaml"),
        ):
            status, _, told = program("estimate", *pictures, "--calibration", path)
            self.assertEqual(status, 2, told)
            with self.assertRaises(epiline.InputError) as raised:
                epiline.estimate(LEFT, RIGHT, cameras=path)
            # The program goes on with its options.
            self.assertIn(str(raised.exception).partition(". If the image")[0], told)

    def test_rectification_by_a_calibration(self):
        rows = epiline.estimate(LEFT, RIGHT)
        pairs = np.hstack([rows.points1, rows.points2])
        path = self.file("calib.txt", self.middlebury())
        by_file, by_numbers = (
            epiline.rectify(rows.F, SIZE, SIZE, matches=pairs, cameras=cameras) for cameras in (path, [K, K])
        )
        np.testing.assert_array_equal(by_file.Q, by_numbers.Q)

    def test_a_judged_calibration_is_that_of_the_program(self):
        pictures = [save(picture, os.path.join(self.folder, f"{k}.pgm")) for k, picture in enumerate((LEFT, RIGHT))]
        path = self.file("calib.txt", self.middlebury())
        found = epiline.judge(LEFT, RIGHT, cameras=path)
        status, record, told = program("judge", *pictures, "--calibration", path, "--json", "-")
        self.assertEqual((found.fits, found.message), (status == 0, record["message"]), told)
        np.testing.assert_array_equal(found.reference, np.array(record["reference"]))
        self.assertEqual(json.loads(found.to_json()).get("pose_difference"), record.get("pose_difference"))
        self.assertIn("negate it", found.message)
        shown = epiline.estimate(LEFT, RIGHT)
        matches = np.hstack([shown.points2, shown.points1])
        exchanged = epiline.judge(RIGHT, LEFT, cameras=path, matches=matches)
        self.assertTrue(exchanged.fits, exchanged.message)
        numbers = ", ".join(str(float(number)) for number in K.ravel())
        one = self.file("one.yaml", f"%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {numbers} ]\n")
        status, _, told = program("judge", *pictures, "--calibration", one, one)
        self.assertEqual(status, 2, told)
        with self.assertRaises(epiline.InputError) as raised:
            epiline.judge(LEFT, RIGHT, cameras=(one, one))
        self.assertIn(str(raised.exception).partition(" To judge")[0], told)
        for wrong in (5, (path, np.eye(3, 4)), [np.eye(3, 4)]):
            with self.assertRaisesRegex(epiline.InputError, "two projection matrices"):
                epiline.judge(LEFT, RIGHT, cameras=wrong)

    def test_a_pose_by_a_calibration(self):
        path = self.file("calib.txt", self.middlebury())
        shown = epiline.estimate(LEFT, RIGHT)
        points = shown.points1, shown.points2
        by_file = epiline.estimate_relative_pose(*points, path, path, sizes=[SIZE, SIZE])
        by_numbers = epiline.estimate_relative_pose(*points, K, K, sizes=[SIZE, SIZE])
        np.testing.assert_array_equal(by_file.F, by_numbers.F)
        with self.assertRaisesRegex(epiline.InputError, "sizes of the images"):
            epiline.estimate_relative_pose(*points, path, path)
        with self.assertRaisesRegex(epiline.InputError, "not one of each"):
            epiline.estimate_relative_pose(*points, path, K)

    @unittest.skipUnless(hasattr(os, "fork"), "there is no fork")
    def test_a_fork_removes_the_distortion_with_threads_of_its_own(self):
        expected = epiline.estimate(LEFT, RIGHT, cameras=[BENT, BENT])
        self.assertTrue(expected.is_undistorted)
        with tempfile.TemporaryDirectory() as folder, open(expected._hand_over(folder), encoding="utf-8") as file:
            session = json.load(file)
        self.assertEqual([image["width"] for image in session["images"]], [SIZE[1]] * 2)
        self.assertEqual(len(session["content"]["cameras"]), 2)
        with concurrent.futures.ProcessPoolExecutor(1) as executor:
            row = {"image1": LEFT, "image2": RIGHT, "cameras": [BENT, BENT]}
            self.assertEqual(executor.submit(epiline.estimate_row, row).result(120)["F"], expected.F.tolist())


class Poison:
    """A value that ends the process which reads it."""

    def __reduce__(self):
        return os._exit, (3,)


class Held(concurrent.futures.Executor):
    """An executor that runs a pair only when somebody waits for it, and counts."""

    def __init__(self):
        self.futures, self.most = [], 0

    def submit(self, function, /, *arguments, **named):
        future = Waiting(function, arguments)
        self.futures.append(future)
        self.most = max(self.most, sum(not future.done() for future in self.futures))
        return future


class Waiting(concurrent.futures.Future):
    def __init__(self, function, arguments):
        super().__init__()
        self.function, self.arguments = function, arguments

    def result(self, timeout=None):
        if not self.done():
            self.set_result(self.function(*self.arguments))
        return super().result(timeout)


def rows(count):
    """Return rows that are searched quickly: from two clicks, each with another seed."""
    clicks = [[100, 20, 109, 20], [60, 130, 90, 130]]
    return [{"id": k, "image1": LEFT, "image2": RIGHT, "pairs": clicks, "seed": k} for k in range(count)]


def processes():
    return concurrent.futures.ProcessPoolExecutor(2)


class Rows(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.expected = [epiline.estimate_row(row) for row in rows(6)]

    def test_a_row_has_the_result_of_a_pair_in_plain_values(self):
        found = self.expected[2]
        pair = epiline.estimate(LEFT, RIGHT, rows(3)[2]["pairs"], seed=2)
        self.assertEqual(found["F"], pair.F.tolist())
        self.assertEqual((found["id"], found["verdict"], found["error"]), (2, pair.verdict, None))
        self.assertEqual(found["match_count"], len(pair.points1))
        self.assertEqual(set(found), set(epiline.PairResult.__annotations__))
        self.assertEqual(json.loads(json.dumps(found)), found)
        self.assertEqual(pickle.loads(pickle.dumps(found)), found)
        self.assertIsNone(found["points1"])
        kept = epiline.estimate_row({**rows(3)[2], "keep_matches": True})
        self.assertEqual(kept["points2"], pair.points2.tolist())

    def test_a_row_may_have_all_arguments(self):
        given = np.hstack([ROWS_OF_POINTS, ROWS_OF_POINTS + [12, 0]])
        row = {**rows(1)[0], "matches": given, "cameras": [K, K], "parameters": {"hypotheses": 6}, "preset": "robust"}
        found = epiline.estimate_row(row)
        named = {name: row[name] for name in ("matches", "cameras", "parameters", "preset", "seed")}
        pair = epiline.estimate(LEFT, RIGHT, row["pairs"], **named)
        self.assertEqual((found["F"], found["remarks"]), (pair.F.tolist(), pair.remarks))
        # Columns of Arrow and pandas are arrays of arrays.
        clicks = np.empty(2, object)
        clicks[:] = [np.array(click, float) for click in row["pairs"]]
        self.assertEqual(epiline.estimate_row({**rows(1)[0], "pairs": clicks, "matches": None})["F"], self.expected[0]["F"])

    def test_an_error_of_a_pair_is_a_sentence_of_its_row(self):
        uniform = np.full(SIZE, 7, np.uint8)
        for row, failure, told in (
            ({"image1": "no-such-file.png", "image2": RIGHT}, "input", "no-such-file.png"),
            ({"image1": LEFT}, "input", "the row has no image2"),
            ({"image1": LEFT, "image2": RIGHT, "pair": []}, "input", "a row has no value pair"),
            ({"image1": uniform, "image2": RIGHT}, "input", "uniform"),
            ({"image1": LEFT, "image2": RIGHT, "matches": {"x": [1]}}, "input", "no matches among the arrays x"),
            ({"image1": LEFT, "image2": RIGHT, "seed": "one"}, "input", "a value of the row has the wrong kind"),
            ([LEFT, RIGHT], "input", "a row is a dictionary"),
        ):
            with self.subTest(told):
                found = epiline.estimate_row(row)
                self.assertEqual((found["failure"], found["F"]), (failure, None), found["error"])
                self.assertIn(told, found["error"])

    def test_results_are_in_order_and_an_error_does_not_end_the_run(self):
        given = rows(6)
        given[3] = {"id": 3, "image1": "no-such-file.png", "image2": RIGHT}
        found = list(epiline.estimate_pairs(iter(given)))
        self.assertEqual([result["id"] for result in found], list(range(6)))
        self.assertEqual(found[:3] + found[4:], self.expected[:3] + self.expected[4:])
        self.assertEqual((found[3]["failure"], found[3]["image1"]), ("input", "no-such-file.png"))

    def test_few_pairs_are_in_flight_and_closing_cancels_the_rest(self):
        taken = []

        def endless():
            while True:
                taken.append(len(taken))
                yield {"id": taken[-1], "image1": LEFT}

        for stop in (lambda run: run.close(), lambda run: run.throw(KeyboardInterrupt)):
            taken.clear()
            held = Held()
            run = epiline.estimate_pairs(endless(), executor=held, in_flight=3)
            self.assertEqual(taken, [], "nothing is read before the first result is asked for")
            self.assertEqual([next(run)["id"] for _ in range(10)], list(range(10)))
            self.assertEqual(held.most, 3)
            self.assertLessEqual(len(taken), 13)
            with contextlib.suppress(KeyboardInterrupt):
                stop(run)
            self.assertTrue(all(future.cancelled() for future in held.futures[10:]))
            self.assertEqual(sum(future.cancelled() for future in held.futures), len(taken) - 10)

    def test_wrong_arguments_of_a_run_are_named(self):
        with self.assertRaisesRegex(epiline.InputError, "in_flight is at least 1"):
            epiline.estimate_pairs([], in_flight=0)
        with self.assertRaisesRegex(epiline.InputError, "executor is an executor"):
            epiline.estimate_pairs([], executor=4)

    def test_processes_give_the_results_of_threads(self):
        with processes() as executor:
            self.assertEqual(list(epiline.estimate_pairs(rows(6), executor=executor)), self.expected)

    def test_a_row_that_cannot_be_sent_is_an_error_of_its_own(self):
        given = rows(3)
        given[1]["parameters"] = {"patches": lambda: 1}
        with processes() as executor:
            found = list(epiline.estimate_pairs(given, executor=executor))
        self.assertEqual([result["failure"] for result in found], [None, "worker", None])

    @unittest.skipIf(sys.platform == "win32", "processes are ended by signals")
    def test_a_killed_process_loses_no_pair(self):
        made = []

        def made_again():
            made.append(processes())
            return made[-1]

        found = []
        for result in epiline.estimate_pairs(rows(6), executor=made_again, in_flight=4):
            found.append(result)
            if len(found) == 1:
                os.kill(next(iter(made[0]._processes)), signal.SIGKILL)
        self.assertEqual(found, self.expected)
        self.assertEqual(len(made), 2)

    def test_a_pair_that_ends_its_process_is_an_error_of_its_own(self):
        given = rows(6)
        given[2] = {"id": 2, "image1": Poison(), "image2": RIGHT}
        found = list(epiline.estimate_pairs(given, executor=processes, in_flight=4))
        self.assertEqual(found[:2] + found[3:], self.expected[:2] + self.expected[3:])
        self.assertEqual((found[2]["id"], found[2]["failure"]), (2, "lost"))
        self.assertIn("ended twice", found[2]["error"])

    def test_an_executor_that_broke_ends_the_run_after_all_complete_results(self):
        given = rows(4)
        given[2] = {"id": 2, "image1": Poison(), "image2": RIGHT}
        found = []
        with processes() as executor, self.assertRaisesRegex(concurrent.futures.BrokenExecutor, "Give a function"):
            for result in epiline.estimate_pairs(given, executor=executor, in_flight=1):
                found.append(result)
        self.assertEqual(found, self.expected[:2])


def thrown(frames=100, size=(120, 160)):
    """Return two sequences of thrown balls, and the geometry of their cameras."""
    rng = np.random.default_rng(3)
    height, width = size
    K = np.array([[150, 0, width / 2], [0, 150, height / 2], [0, 0, 1.0]])
    turn = lambda a: np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])  # noqa: E731
    # The cameras look at the middle of the scene, 5 away, from 50 degrees apart.
    cameras = []
    for angle in (0.0, 0.9):
        R = turn(angle) @ np.array([[1, 0, 0], [0, np.cos(0.1), -np.sin(0.1)], [0, np.sin(0.1), np.cos(0.1)]])
        cameras.append((R, np.array([0, 0, 5.0])))
    R, t = cameras[1][0] @ cameras[0][0].T, cameras[1][1] - cameras[1][0] @ cameras[0][0].T @ cameras[0][1]
    cross = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    F = np.linalg.inv(K).T @ cross @ R @ np.linalg.inv(K)
    time = np.arange(frames)
    y, x = np.mgrid[:height, :width]
    backgrounds = [texture(height, width, seed=k) * 0.4 + 40 for k in (1, 2)]
    both = [np.repeat(background[None], frames, axis=0) for background in backgrounds]
    for _ in range(6):
        speed, phase = rng.uniform(0.02, 0.2, (3, 2)), rng.uniform(0, 6.3, (3, 2))
        path = (np.sin(speed[:, :, None] * time + phase[:, :, None]) * [[[0.9], [0.5]]] * 0.8).sum(axis=1).T
        for (R, t), sequence in zip(cameras, both):
            seen = path @ R.T + t
            for k in range(frames):
                u, v = K[:2, :2].diagonal() * seen[k, :2] / seen[k, 2] + K[:2, 2]
                sequence[k][(x - u) ** 2 + (y - v) ** 2 < (150 * 0.18 / seen[k, 2]) ** 2] = 230
    noisy = [np.round(sequence + rng.normal(0, 1, sequence.shape)).clip(0, 255).astype(np.uint8) for sequence in both]
    scene = rng.uniform(-1.2, 1.2, (60, 3))
    places = [(scene @ R.T + t) @ K.T for R, t in cameras]
    return *noisy, F, [place[:, :2] / place[:, 2:] for place in places]


class Barcodes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.left, cls.right, cls.F, cls.points = thrown()
        cls.found = epiline.barcode(cls.left, cls.right, offset=0)

    def test_the_geometry_of_moving_objects(self):
        distances = epiline.epipolar_distance(self.found.F, *self.points)
        self.assertLess(np.median(distances), 4, self.found.summary())
        self.assertEqual(self.found.offset, 0)
        self.assertEqual(json.loads(self.found.to_json())["frame_offset"], 0)

    def test_the_result_is_that_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for name, sequence in (("left", self.left), ("right", self.right)):
                os.mkdir(os.path.join(folder, name))
                files = [os.path.join(folder, name, f"{k:04}.pgm") for k in range(len(sequence))]
                paths.append([save(frame, path) for frame, path in zip(sequence, files)])
            folders = [os.path.join(folder, name) for name in ("left", "right")]
            status, record, told = program("barcode", *folders, "--json", "-")
            self.assertEqual(status, 0, told)
            np.testing.assert_array_equal(np.array(record["fundamental"]), self.found.F)
            by_folders = epiline.barcode(*folders, offset=0, threads=1)
            np.testing.assert_array_equal(by_folders.F, self.found.F)
            self.assertEqual(handed_over(by_folders)[1], folders)
            by_files = epiline.barcode(iter(paths[0]), paths[1], offset=0)
            np.testing.assert_array_equal(by_files.F, self.found.F)

    def test_the_offset_is_found(self):
        colours = np.repeat(self.right[6:, :, :, None], 3, axis=3)
        found = epiline.barcode(self.left[: len(colours)], colours)
        self.assertEqual(found.offset, -6, found.remarks)
        self.assertLess(np.median(epiline.epipolar_distance(found.F, *self.points)), 4)
        unequal = epiline.barcode(self.left, self.right[6:], offset=-6)
        self.assertTrue(any("100 and 94 frames" in remark for remark in unequal.remarks), unequal.remarks)

    def test_clicks_take_part(self):
        pairs = np.hstack(self.points)[:2]
        found = epiline.barcode(self.left, self.right, offset=0, pairs=pairs)
        np.testing.assert_array_equal(json.loads(found.to_json())["pairs"], pairs)

    def test_wrong_sequences_are_named(self):
        still = np.repeat(self.left[:1], 20, axis=0)
        for frames, told in (
            (still, "nothing moves in frames1"),
            (self.left[:10], "frames1 has 10 frames, but at least 16"),
            ([], "frames1 has 0 frames"),
            ([*self.left[:3], np.zeros((9, 9), np.uint8)], "frame 3 of frames1 is 9×9 px"),
            ([self.left[0], 5], "frame 1 of frames1 is a path or a NumPy array, not int"),
            (self.left[0], r"\(N, H, W\)"),
            (7, "frames1 is a path, an array or a list of images, not int"),
            ("no-such-folder", "no-such-folder"),
        ):
            with self.subTest(told), self.assertRaisesRegex(epiline.InputError, told):
                epiline.barcode(frames, self.right)
        with self.assertRaisesRegex(epiline.InputError, "frames in common"):
            epiline.barcode(self.left, self.right, offset=95)
        with self.assertRaisesRegex(epiline.InputError, "the window opens sequences"):
            self.found.show()

    def test_ctrl_c_of_a_callback_stops_the_search(self):
        def stop(stage, seconds):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            epiline.barcode(self.left, self.right, progress=stop)


class Points(unittest.TestCase):
    def test_a_geometry_of_points(self):
        points1, points2, F, *_ = scene()
        points2[:20] = RNG.uniform(0, 480, (20, 2))
        found = epiline.estimate_fundamental(points1, points2, sizes=[(480, 640), (480, 640)])
        self.assertTrue(found.inliers[20:].mean() > 0.9 and found.inliers[:20].mean() < 0.3)
        self.assertEqual(found.verdict, "doubtful")
        clean = epiline.epipolar_distance(found.F, points1[20:], points2[20:])
        self.assertLess(np.median(clean), 1.0)
        self.assertEqual(found.covariance.shape, (9, 9))
        self.assertIsNone(found.E)
        self.assertIn("given_matches", found.to_json())
        with self.assertRaisesRegex(epiline.InputError, "without images"):
            found.plot()
        weighted = epiline.estimate_fundamental(points1, points2, sigma=2.0, confidences=np.full(80, 0.5))
        self.assertEqual(len(weighted.inlier_probabilities), 80)

    def test_a_pose_of_points(self):
        points1, points2, _, K, R, t = scene(noise=0.1)
        found = epiline.estimate_relative_pose(points1, points2, K, (K, None))
        angle = np.degrees(np.arccos(np.clip((np.trace(found.R.T @ R) - 1) / 2, -1, 1)))
        self.assertLess(angle, 0.5)
        self.assertLess(np.degrees(np.arccos(np.clip(found.t @ t, -1, 1))), 3)
        self.assertEqual(found.pose_covariance.shape, (6, 6))
        np.testing.assert_allclose(np.linalg.svd(found.E)[1][2], 0, atol=1e-12)

    def test_the_origin_of_colmap(self):
        points1, points2, F, *_ = scene()
        ours = epiline.estimate_fundamental(points1, points2)
        theirs = epiline.estimate_fundamental(points1 + 0.5, points2 + 0.5, origin="colmap")
        np.testing.assert_allclose(theirs.F, ours.F, rtol=1e-5, atol=1e-9)

    def test_wrong_points_are_named(self):
        points1, points2, *_ = scene()
        with self.assertRaisesRegex(epiline.InputError, "80 points in image 1 and 79"):
            epiline.estimate_fundamental(points1, points2[:-1])
        with self.assertRaisesRegex(epiline.InputError, "match 3 has a coordinate"):
            bad = points1.copy()
            bad[2, 0] = np.inf
            epiline.estimate_fundamental(bad, points2)
        with self.assertRaisesRegex(epiline.InputError, "at least 8"):
            epiline.estimate_fundamental(points1[:5], points2[:5])
        with self.assertRaisesRegex(epiline.InputError, "sigma has 3 numbers"):
            epiline.estimate_fundamental(points1, points2, sigma=[1, 2, 3])
        with self.assertRaisesRegex(epiline.InputError, "confidence above 0"):
            epiline.estimate_fundamental(points1, points2, confidences=np.zeros(80))
        with self.assertRaises(epiline.NoGeometryError):
            H = np.array([[1, 0.1, 3], [0, 1.1, 2], [1e-4, 0, 1]])
            mapped = np.c_[points1, np.ones(80)] @ H.T
            epiline.estimate_fundamental(points1, mapped[:, :2] / mapped[:, 2:])


class Geometry(unittest.TestCase):
    def test_lines_and_distances(self):
        lines = epiline.epilines([[10, 20], [30, 40]], ROWS)
        np.testing.assert_allclose(np.abs(lines), [[0, 1, 20], [0, 1, 40]])
        self.assertEqual(epiline.epilines(np.empty((0, 2)), ROWS).shape, (0, 3))
        for kind in ("symmetric", "sampson", "algebraic"):
            self.assertEqual(epiline.epipolar_distance(ROWS, [[1, 2]], [[3, 2]], kind)[0], 0)
        with self.assertRaisesRegex(epiline.InputError, "kind is"):
            epiline.epipolar_distance(ROWS, [[1, 2]], [[3, 2]], "squared")

    def test_conventions_are_told(self):
        points1, points2, F, *_ = scene(noise=0.1)
        best = epiline.check_convention(F.T, points1, points2)[0]
        self.assertTrue(best.transposed and best.fits, best)
        self.assertLess(np.median(epiline.epipolar_distance(best.F, points1, points2)), 0.5)

    def test_rectification(self):
        points1, points2, F, K, *_ = scene(noise=0.0)
        pairs = np.hstack([points1, points2])
        found = epiline.rectify(F, (480, 640), (480, 640, 3), matches=pairs)
        xs, ys = found.maps(1)
        self.assertEqual([*xs.shape], found.size)
        self.assertEqual((xs.dtype, ys.dtype), (np.float32, np.float32))
        if found.method == "planar":
            y = [(np.c_[p, np.ones(80)] @ H.T) for p, H in ((points1, found.H1), (points2, found.H2))]
            np.testing.assert_allclose(y[0][:, 1] / y[0][:, 2], y[1][:, 1] / y[1][:, 2], atol=1e-6)
        stereo = epiline.rectify(F, (480, 640), (480, 640), matches=pairs, cameras=[K, K])
        self.assertEqual(stereo.Q.shape, (4, 4))
        with self.assertRaisesRegex(epiline.InputError, "height, width"):
            epiline.rectify(F, (480, 0), (480, 640))
        for arguments, told in (({"method": "best"}, "auto, planar, polar"), ({"cameras": [K, K]}, "without matches")):
            with self.assertRaisesRegex(epiline.InputError, told):
                epiline.rectify(F, (480, 640), (480, 640), **arguments)


class Package(unittest.TestCase):
    def test_the_program_runs_from_the_package(self):
        done = subprocess.run([sys.executable, "-m", "epiline", "--version"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout.split()), (0, ["epiline", epiline.__version__]))
        done = subprocess.run([sys.executable, "-m", "epiline", "estimate", "no.png", "none.png"], capture_output=True)
        self.assertEqual(done.returncode, 2)

    def test_the_sample_is_that_of_the_program(self):
        for name in ("courtyard", "alley"):
            pair = epiline.sample(name)
            found = epiline.estimate(pair.image1, pair.image2, pair.clicks)
            status, record, told = program("estimate", "--sample", name, "--json", "-")
            self.assertEqual(status, 0, told)
            np.testing.assert_array_equal(np.array(record["fundamental"]), found.F)
            places = np.c_[RNG.uniform(-1, 1, (20, 3)), np.ones(20)]
            seen = [places @ P.T for P in (pair.P1, pair.P2)]
            seen = [points[:, :2] / points[:, 2:] for points in seen]
            np.testing.assert_allclose(epiline.epipolar_distance(pair.F, *seen, "sampson"), 0, atol=1e-6)
            for K, P in ((pair.K1, pair.P1), (pair.K2, pair.P2)):
                R = np.linalg.inv(K) @ P[:, :3]
                np.testing.assert_allclose(R @ R.T, np.eye(3) * (R @ R.T)[0, 0], atol=1e-9 * (R @ R.T)[0, 0])
        with self.assertRaisesRegex(epiline.InputError, "Choose one of courtyard, alley"):
            epiline.sample("yard")


class Drawings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = epiline.estimate(LEFT, RIGHT)

    def test_without_matplotlib_there_is_the_table_alone(self):
        with unittest.mock.patch.dict(sys.modules, {"matplotlib": None, "matplotlib.figure": None}):
            self.assertIsNone(self.found._repr_png_())
            self.assertRegex(self.found._repr_html_(), f"^<table>.*{self.found.verdict}.*</table>$")

    def test_points_have_no_picture(self):
        points1, points2, *_ = scene()
        self.assertIsNone(epiline.estimate_fundamental(points1, points2)._repr_png_())

    def test_lines_are_those_of_the_geometry(self):
        lines = self.found._lines()
        self.assertEqual([number for number, _ in lines], list(range(1, 10)))
        for _, (part1, part2) in lines:
            line = epiline.epilines(part1[:1], self.found.F)[0]
            np.testing.assert_allclose(np.array(part2) @ line[:2] + line[2], 0, atol=1e-6)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_a_drawing_leaves_no_figure_open(self):
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        picture = self.found._repr_png_()
        self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn(base64.b64encode(picture).decode(), self.found._repr_html_())
        self.assertEqual(pyplot.get_fignums(), [])
        ax = self.found.plot()
        # Matches of both images, and nine lines in each.
        self.assertEqual(len(ax.lines), 2 + 2 * 9)
        self.assertEqual([text.get_text() for text in ax.texts], [str(k) for k in range(1, 10) for _ in (1, 2)])
        pyplot.close(ax.figure)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_epipoles_inside_are_marked(self):
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        pair = epiline.sample("alley")
        found = epiline.estimate(pair.image1, pair.image2, pair.clicks)
        _, ax = pyplot.subplots()
        self.assertIs(found.plot(ax), ax)
        marked = [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "o"]
        expected = found.epipoles[:, :2] / found.epipoles[:, 2:] + [[0, 0], [pair.image1.shape[1], 0]]
        np.testing.assert_allclose(marked, expected)
        pyplot.close(ax.figure)


def load_tests(loader, tests, pattern):
    for name in ("epiline", *(f"epiline.{part}" for part in ("_geometry", "_rows", "_sample", "_search"))):
        tests.addTests(doctest.DocTestSuite(importlib.import_module(name)))
    return tests


if __name__ == "__main__":
    unittest.main()
