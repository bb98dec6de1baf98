"""Tests of the package. They need NumPy alone, and the pictures that the program draws."""

import doctest
import json
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

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
    points = np.c_[RNG.uniform(-1, 1, (count, 2)), RNG.uniform(3, 6, count)]
    K = np.array([[500, 0, 320], [0, 500, 240], [0, 0, 1.0]])
    angle = 0.1
    R = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    t = np.array([0.6, 0.1, 0.2])
    x1, x2 = points @ K.T, (points @ R.T + t) @ K.T
    cross = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    inverse = np.linalg.inv(K)
    both = [x[:, :2] / x[:, 2:] + RNG.normal(0, noise, (count, 2)) for x in (x1, x2)]
    return *both, inverse.T @ cross @ R @ inverse, K, R, t / np.linalg.norm(t)


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
        self.assertIn("<table>", found._repr_html_())

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
            "import sys, threading, _thread, numpy as np, epiline\n"
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
        points1, points2, _, K, R, t = scene()
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

    def test_a_plot_where_matplotlib_is(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("matplotlib is not installed")
        matplotlib.use("Agg")
        ax = epiline.estimate(LEFT, RIGHT).plot()
        self.assertGreater(len(ax.lines), 2)


def load_tests(loader, tests, pattern):
    tests.addTests(doctest.DocTestSuite(epiline))
    return tests


if __name__ == "__main__":
    unittest.main()
