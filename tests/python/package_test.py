"""The Python package, as its users call it."""

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import planescope as ps

SAMPLE = "assets/sample"


def step_image():
    """A level camera 30 cm above a floor, with a step of 15 cm 1 m ahead."""
    down = np.repeat((np.arange(240)[:, None] - 119.5) / 300, 424, axis=1)
    with np.errstate(divide="ignore"):
        z = np.where(down > 0.3, 0.3 / down, np.where(down > 0.15, 1.0, 0.15 / down))
    return np.where(down > 0.05, np.rint(z * 1000), 0).astype(np.uint16)


K = np.array([[300, 0, 211.5], [0, 300, 119.5], [0, 0, 1]])


@unittest.skipUnless("PLANESCOPE_PROGRAM" in os.environ, "there is no program")
class Maps(unittest.TestCase):
    """A walk of 40 small frames."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        walk = Path(cls.folder.name) / "walk"
        program = os.environ["PLANESCOPE_PROGRAM"]
        subprocess.run(
            [program, "synth", "sequence", "-o", str(walk), "--frames", "40", "--size", "160x120"],
            check=True, capture_output=True,
        )
        cls.walk = walk

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_are_those_of_the_program(self):
        out = Path(self.folder.name) / "map"
        subprocess.run(
            [os.environ["PLANESCOPE_PROGRAM"], "map", str(self.walk), "-o", str(out)],
            check=True, capture_output=True,
        )
        made = ps.make_map(ps.Recording(self.walk), threads=2)
        self.assertEqual(made.json, (out / "map.json").read_text())
        self.assertEqual(made.tracks_json, (out / "tracks.json").read_text())
        self.assertEqual(made.poses_tum, (out / "poses.tum").read_text())
        floor = made.planes[0]
        self.assertEqual(floor.label, "h")
        np.testing.assert_allclose(floor.normal, [0, 0, 1], atol=0.02)
        self.assertEqual(floor.parts[0].outer.shape[1], 3)
        self.assertEqual(sorted(made.T_world_camera), list(range(40)))
        self.assertTrue(any(floor.track in tracks for tracks in made.track_of_plane.values()))
        stored = {int(file.stem): file.read_bytes() for file in (out / "planes").iterdir()}
        self.assertEqual(made.planes_png, stored)
        again = ps.make_map(ps.Recording(self.walk), poses=out / "poses.tum", frames=[1, 3])
        self.assertEqual(sorted(again.track_of_plane), [1, 3])

    def test_what_cannot_be_mapped_is_told(self):
        for wrong, why in (
            (dict(frames=[3, 1]), "do not ascend"),
            (dict(frames=[40]), "it has 40 of them"),
            (dict(poses=self.walk / "none.tum"), "none.tum"),
            (dict(window_m=-1), "window_m"),
            (dict(frames=[]), "at least one"),
            (dict(poses=""), "expected a file"),
        ):
            with self.assertRaisesRegex(ps.Error, why):
                ps.make_map(ps.Recording(self.walk), **wrong)
        with self.assertRaisesRegex(ps.Error, "expected a planescope.Recording"):
            ps.make_map("walk")


class Segments(unittest.TestCase):
    def test_a_depth_image(self):
        planes, labels = ps.segment(step_image(), K, depth_unit=0.001, gravity=(0, 1, 0))
        self.assertEqual(labels.shape, (240, 424))
        self.assertEqual(labels.dtype, np.int32)
        self.assertEqual(sorted(plane.label for plane in planes), ["h", "h", "v"])
        heights = sorted(plane.height_m for plane in planes if plane.label == "h")
        np.testing.assert_allclose(heights, [0, 0.15], atol=0.002)
        floor = planes[labels[239, 200] - 1]
        self.assertEqual(floor.id, labels[239, 200])
        np.testing.assert_allclose(floor.normal, [0, 0, 1], atol=0.01)

    def test_a_part_of_an_image_without_copying_it_first(self):
        depth = step_image()
        part_K = K - [[0, 0, 212], [0, 0, 100], [0, 0, 0]]
        result = ps.segment(depth[100:, 212:], part_K, gravity=(0, 1, 0))
        np.testing.assert_array_equal(result.frame.depth, depth[100:, 212:])
        every_second = ps.segment(depth[:, ::-1], K, gravity=(0, 1, 0))  # pixels that run backwards
        np.testing.assert_array_equal(every_second.frame.depth, depth[:, ::-1])
        self.assertEqual(len(every_second.planes), 3)

    def test_a_cloud_of_any_kind_of_numbers(self):
        x, y = np.meshgrid(np.arange(100) / 100, np.arange(100) / 100)
        points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.5)], axis=1)
        for kind in (np.float64, np.float32):
            planes, labels = ps.segment_cloud(points.astype(kind))
            self.assertEqual(len(planes), 1)
            self.assertTrue((labels == 1).all())
        lying = ps.segment_cloud(points[:, [2, 0, 1]], gravity=(1, 0, 0))
        self.assertAlmostEqual(lying.planes[0].tilt_deg, 0, places=3)
        self.assertEqual(ps.segment_cloud(points, gravity="none").planes[0].label, "unknown")

    @unittest.skipUnless("PLANESCOPE_PROGRAM" in os.environ, "there is no program")
    def test_as_the_program_does(self):
        frame = ps.Recording(SAMPLE)[1]
        with tempfile.TemporaryDirectory() as folder:
            for profile in ("refined", "paper"):
                out = Path(folder) / profile
                subprocess.run(
                    [os.environ["PLANESCOPE_PROGRAM"], "segment", SAMPLE, "--frames", "1", "--profile",
                     profile, "--also", "geojson", "-o", out],
                    check=True, capture_output=True,
                )
                result = ps.segment(frame, profile=profile)
                written = out / "frames" / "000001"
                self.assertEqual(result.json(), (written / "planes.json").read_text())
                self.assertEqual(result.text("geojson"), (written / "planes.geojson").read_text())
                import matplotlib.image

                png = matplotlib.image.imread(written / "planes.png")
                np.testing.assert_array_equal(np.rint(png * 65535).astype(int), result.labels)

    def test_the_same_for_any_number_of_threads(self):
        frame = ps.Recording(SAMPLE)[0]
        self.assertEqual(ps.segment(frame).json(), ps.segment(frame, threads=3).json())


    def test_a_lens_with_distortion(self):
        coefficients = (0.05, -0.1, 0.001, 0.002, 0.03)
        frame = ps.Frame(step_image(), K, gravity=(0, 1, 0), distortion=coefficients)
        np.testing.assert_allclose(frame.distortion, coefficients)
        again = ps.Frame(
            frame.depth, frame.K, gravity=(0, 1, 0), distortion=frame.distortion, distortion_model=frame.distortion_model
        )
        self.assertEqual(ps.segment(again).json(), ps.segment(frame).json())
        self.assertNotEqual(ps.segment(frame).json(), ps.segment(ps.Frame(step_image(), K, gravity=(0, 1, 0))).json())
        self.assertIsNone(ps.Recording(SAMPLE)[0].distortion)

    def test_gravity_that_is_given_goes_before_what_a_frame_knows(self):
        frame = ps.Frame(step_image(), K, gravity=(1, 0, 0))
        np.testing.assert_allclose(ps.segment(frame, gravity=(0, 1, 0)).gravity.direction, (0, 1, 0))


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.frame = ps.Recording(SAMPLE)[0]
        cls.segmenter = ps.Segmenter()
        cls.result = cls.segmenter.segment(cls.frame)

    def test_agree_with_each_other(self):
        told = json.loads(self.result.json())["planes"]
        self.assertEqual(len(told), len(self.result.planes))
        points = self.result.points
        self.assertEqual(points.shape, (480, 640, 3))
        for plane, also in zip(self.result.planes, told):
            self.assertEqual(plane.id, also["id"])
            mine = points[self.result.labels == plane.id]
            self.assertEqual(len(mine), plane.points)
            np.testing.assert_allclose(
                np.sqrt(np.mean((mine @ plane.normal - plane.offset_m) ** 2)), plane.rms_m, rtol=1e-3
            )
            outer = plane.outline.world(plane.outline.parts[0].outer)
            np.testing.assert_allclose(outer @ plane.normal, plane.offset_m, atol=1e-6)
            vertices, triangles = self.result.mesh(plane.id)
            a, b, c = (vertices[triangles[:, k]] for k in range(3))
            area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
            self.assertAlmostEqual(area, plane.outline.area_m2, places=4)

    def test_are_views_that_outlive_what_they_view(self):
        labels = ps.segment(step_image(), K, gravity=(0, 1, 0)).labels
        depth = ps.Recording(SAMPLE)[0].depth
        events = ps.Segmenter().trace(self.frame).events
        self.assertFalse(labels.flags.writeable or depth.flags.writeable or events.flags.writeable)
        self.assertFalse(labels.flags.owndata or depth.flags.owndata or events.flags.owndata)
        self.assertEqual(labels.max(), 3)
        self.assertEqual(depth.sum(), self.frame.depth.sum())
        self.assertEqual(events["type"][0], ps.EventType.VISIT)
        # The same memory each time.
        self.assertTrue(np.shares_memory(self.result.labels, self.result.labels))

    def test_come_about_step_by_step(self):
        trace = self.segmenter.trace(self.frame)
        self.assertEqual(trace.result.json(), self.result.json())
        events = trace.events
        self.assertEqual(len(events), len(trace))
        decided = events[events["type"] == ps.EventType.DECIDE]
        nodes = trace.nodes
        np.testing.assert_array_equal(nodes["case"][decided["node"]], decided["case"])
        self.assertEqual(trace.stages[:3], ["criteria", "merge", "assign"])
        self.assertIn("join", trace.stages)
        self.assertTrue((trace.plane_of(0) == -1).all())
        self.assertEqual(trace.plane_of(len(trace)).shape, (480, 640))
        founded = np.count_nonzero(events["type"] == ps.EventType.FOUND)
        ids = {trace.id_of(plane) for plane in range(founded)} - {0}
        self.assertEqual(ids, {plane.id for plane in self.result.planes})
        self.assertIn("node 0", trace.describe(1))

    def test_leave_other_threads_running_meanwhile(self):
        # Two segmentations hold the interpreter's lock for none of their time but little.
        ticks, stop = [], threading.Event()

        def tick():
            while not stop.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.001)

        beside = threading.Thread(target=tick)
        beside.start()
        try:
            begin = time.perf_counter()
            for _ in range(5):
                self.segmenter.segment(self.frame)
            end = time.perf_counter()
        finally:
            stop.set()
            beside.join()
        during = sum(begin < t < end for t in ticks)
        # With the lock held it would be one at most between any two calls.
        self.assertGreater(during, 10)


class Recordings(unittest.TestCase):
    def test_are_sequences_of_frames(self):
        recording = ps.Recording(SAMPLE)
        self.assertEqual(len(recording), 3)
        self.assertEqual([frame.index for frame in recording], [0, 1, 2])
        self.assertEqual([frame.index for frame in recording[1:]], [1, 2])
        self.assertEqual(recording[-1].index, 2)
        with self.assertRaises(IndexError):
            recording[3]
        frame = recording[0]
        self.assertEqual(frame.depth.shape, (480, 640))
        self.assertEqual(frame.color.shape, (480, 640, 3))
        np.testing.assert_array_equal(frame.K, recording.info.K)
        self.assertIsNone(ps.Recording(Path(SAMPLE), color=False)[0].color)
        self.assertEqual(ps.Recording(SAMPLE, K=(400, 401, 320, 240))[0].K[1, 1], 401)

    def test_of_ros_and_of_clouds(self):
        real = os.environ.get("PLANESCOPE_DATA")
        if not real:
            self.skipTest("PLANESCOPE_DATA is not set")
        cloud = ps.Recording(Path(real) / "plane_seg_clouds" / "terrain_med.pcd")[0]
        self.assertTrue(cloud.is_cloud)
        self.assertIsNone(cloud.depth)
        self.assertEqual(cloud.points.shape[1], 3)
        files = sorted((Path(real) / "realsense_sdk_db3").rglob("*.db3"))
        frames = [ps.Recording(file)[0] for file in files]
        self.assertTrue(frames)
        for frame in frames:
            np.testing.assert_array_equal(frame.depth, frames[0].depth)


class BadInput(unittest.TestCase):
    def expect(self, message, call):
        with self.assertRaises(ps.Error) as caught:
            call()
        self.assertEqual(str(caught.exception), message)
        self.assertIsInstance(caught.exception, ValueError)

    def test_is_named_in_one_line(self):
        depth = step_image()
        self.expect(
            "depth: it is float64 of shape (240, 424), expected uint16 counts of shape (height, width)",
            lambda: ps.segment(depth / 1000, K),
        )
        self.expect(
            "depth: it is uint16 of shape (424,), expected uint16 counts of shape (height, width)",
            lambda: ps.segment(depth[0], K),
        )
        self.expect("K: it is not given, expected a 3x3 matrix or fx, fy, cx, cy", lambda: ps.segment(depth))
        self.expect(
            "K: it has shape (2, 2), expected a 3x3 matrix or fx, fy, cx, cy",
            lambda: ps.segment(depth, K[:2, :2]),
        )
        self.expect(
            "K: it is [[300.0, 0.0, 0.0], [0.0, 300.0, 0.0], [211.5, 119.5, 1.0]], "
            "expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]",
            lambda: ps.segment(depth, K.T),
        )
        self.expect("frame: it is a ndarray, expected a planescope.Frame", lambda: ps.Segmenter().segment(depth))
        self.expect(
            "segment: a Frame has its own K, depth_unit, distortion and color",
            lambda: ps.segment(ps.Frame(depth, K), depth_unit=0.5),
        )
        self.expect("gravity: it has shape (2,), expected x, y, z", lambda: ps.segment(depth, K, gravity=(0, 1)))
        self.expect(
            "color: it is float64 of shape (240, 424, 3), expected uint8 RGB on the pixels of depth",
            lambda: ps.segment(depth, K, color=np.zeros((240, 424, 3))),
        )
        self.expect(
            "points: they are float64 of shape (4, 4), expected metres of shape (points, 3)",
            lambda: ps.segment_cloud(np.eye(4)),
        )
        self.expect("point cloud: it has no points", lambda: ps.segment_cloud(np.zeros((0, 3))))
        self.expect("/nowhere: no such file or folder", lambda: ps.Recording("/nowhere"))
        with self.assertRaisesRegex(ps.Error, "theta_n_out"):
            ps.segment(depth, K, theta_n_ou=3)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
