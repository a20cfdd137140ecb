"""The Python package as users call it."""

import json
import os
import pickle
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import planescope as ps

sys.path.insert(0, "python/examples")
import live_loop  # noqa: E402

SAMPLE = "assets/sample"


def step_image():
    """A level camera 30 cm above a floor; a step of 15 cm, 1 m ahead."""
    down = np.repeat((np.arange(240)[:, None] - 119.5) / 300, 424, axis=1)
    with np.errstate(divide="ignore"):
        z = np.where(down > 0.3, 0.3 / down, np.where(down > 0.15, 1.0, 0.15 / down))
    return np.where(down > 0.05, np.rint(z * 1000), 0).astype(np.uint16)


K = np.array([[300, 0, 211.5], [0, 300, 119.5], [0, 0, 1]])


class Interface:
    """An array of a library without numpy: only __array_interface__."""

    def __init__(self, array, as_bytes=False):
        self.kept = array
        self.__array_interface__ = dict(array.__array_interface__)
        if as_bytes:
            self.__array_interface__["data"] = array.tobytes()


@unittest.skipUnless("PLANESCOPE_PROGRAM" in os.environ, "PLANESCOPE_PROGRAM is not set")
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
        self.assertEqual(pickle.loads(pickle.dumps(again)), again)

    def test_take_poses_as_arrays(self):
        recording = ps.Recording(self.walk)
        made = ps.make_map(recording, frames=range(12))
        poses = np.stack([made.T_world_camera[frame] for frame in range(12)])
        of_array = ps.make_map(recording, poses=poses, frames=range(12))
        self.assertEqual(sorted(of_array.T_world_camera), list(range(12)))
        self.assertGreater(len(of_array.planes), 3)
        self.assertEqual(of_array, ps.make_map(recording, poses=made.T_world_camera, frames=range(12)))
        for wrong, why in (
            (poses[:3], re.escape("poses: shape (3, 4, 4); expected (12, 4, 4)")),
            (2 * poses, "pose of frame 0: not a rigid transform"),
            ({50: poses[0]}, "frame 50 is out of range; the recording has 40"),
            ({}, "poses: none"),
        ):
            with self.assertRaisesRegex(ps.Error, why):
                ps.make_map(recording, poses=wrong, frames=range(12))

    def test_grow_frame_by_frame(self):
        mapper, again = ps.Mapper(), ps.Mapper(threads=2)
        with self.assertRaisesRegex(ps.Error, "no frames"):
            mapper.map()
        for depth, pose in live_loop.camera(8):
            added = mapper.add(ps.Frame(depth, live_loop.K), pose)
            again.add(ps.Frame(depth, live_loop.K), pose)
            self.assertFalse(added.set_aside)
            self.assertEqual(len(added.tracks), len(added.result.planes))
            np.testing.assert_allclose(added.T_world_camera, pose, atol=0.01)
        grown = mapper.map()
        self.assertEqual(len(mapper), 8)
        self.assertEqual(grown.track_of_plane[7], added.tracks)
        self.assertEqual(pickle.loads(pickle.dumps(added)), added)
        # A floor, a step of 15 cm, and its riser at x = 1 m.
        levels = sorted(plane.offset_m for plane in grown.planes if plane.label == "h")
        np.testing.assert_allclose(levels, [0, 0.15], atol=0.005)
        (riser,) = (plane for plane in grown.planes if plane.label == "v")
        np.testing.assert_allclose(riser.normal, [-1, 0, 0], atol=0.05)
        self.assertAlmostEqual(riser.centroid[0], 1, places=2)
        self.assertEqual(again.map(), grown)

    def test_need_a_world_whose_z_points_up(self):
        frame = ps.Recording(self.walk)[0]
        for pose, why in (
            (np.eye(4), "expected a world frame with z up"),
            (np.diag([2, 2, 2, 1]), "pose of frame 0: not a rigid transform"),
            (np.eye(3), re.escape("pose: shape (3, 3); expected a 4x4 matrix")),
        ):
            with self.assertRaisesRegex(ps.Error, why):
                ps.Mapper().add(frame, pose)
        with self.assertRaisesRegex(ps.Error, "point cloud"):
            ps.Mapper().add(ps.Frame.of_points(np.ones((9, 3))), np.eye(4))

    def test_refuse_invalid_input(self):
        for wrong, why in (
            (dict(frames=[3, 1]), "are not in ascending order"),
            (dict(frames=[40]), "the recording has 40 frames"),
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

    def test_depth_in_any_layout_and_byte_order(self):
        depth = step_image()
        expected = ps.Frame(depth, K)
        for array in (
            depth.astype(">u2"),
            np.asfortranarray(depth),
            depth[::-1, ::-1].copy()[::-1, ::-1],
            np.pad(depth, 3)[3:-3, 3:-3],
            np.repeat(depth, 2, axis=1)[:, ::2],
            memoryview(depth),
            Interface(depth),
            Interface(depth.astype(">u2"), as_bytes=True),
            Interface(depth[:, ::-1].copy()[:, ::-1]),
        ):
            self.assertEqual(ps.Frame(array, K), expected)

    def test_depth_in_meters(self):
        depth = step_image()
        expected = ps.segment(depth, K, gravity=(0, 1, 0))
        meters = depth / 1000
        meters[0, :3] = np.nan, -1, np.inf  # not measured
        for array in (meters, meters.astype(">f4"), meters.astype("f4")[:, ::-1].copy()[:, ::-1]):
            result = ps.segment(array, K, gravity=(0, 1, 0))
            self.assertEqual(result, expected)  # multiples of 1 mm give the same image, bit by bit
        random = np.random.default_rng(1).uniform(0.3, 6.5, depth.shape).astype("f4")
        frame = ps.Frame(random, K)
        self.assertEqual(frame.depth_unit, 0.0002)
        np.testing.assert_allclose(frame.depth * frame.depth_unit, random, atol=1.001e-4)
        random[0, 0] = 1000  # an outlier does not affect other pixels
        frame = ps.Frame(random, K)
        self.assertEqual(frame.depth[0, 0], 65535)
        np.testing.assert_allclose((frame.depth * frame.depth_unit)[1:], random[1:], atol=1.001e-4)

    def test_a_segmenter_called_like_the_function(self):
        depth = step_image()
        segmenter = ps.Segmenter(max_range_m=2)
        self.assertEqual(segmenter(depth, K, gravity=(0, 1, 0)), ps.segment(depth, K, gravity=(0, 1, 0), max_range_m=2))
        frame = ps.Frame(depth, K, gravity=(0, 1, 0))
        self.assertEqual(segmenter(frame, gravity="none").planes[0].label, "unknown")
        self.assertEqual(segmenter(frame, profile="paper"), ps.segment(frame, profile="paper", max_range_m=2))
        self.assertEqual(segmenter(frame, max_range_m=1.2), ps.segment(frame, max_range_m=1.2))
        # Arguments of a call override the options.
        fixed = ps.Segmenter(gravity="none")
        self.assertEqual(fixed(depth, K, gravity=(0, 1, 0)).gravity.source, "option")
        self.assertEqual(fixed(depth, K).gravity.source, "none")
        self.assertEqual(pickle.loads(pickle.dumps(segmenter))(frame), segmenter(frame))

    def test_an_organized_cloud(self):
        points = ps.segment(step_image(), K, gravity=(0, 1, 0)).points
        flat = ps.segment_cloud(points.reshape(-1, 3))
        for organized in (points, np.moveaxis(np.moveaxis(points, 2, 0).copy(), 0, 2), points.astype(">f8")):
            result = ps.Segmenter().segment_cloud(organized)
            self.assertEqual(result.labels.shape, (240, 424))
            self.assertEqual(result.points.shape, (240, 424, 3))
            self.assertEqual(result.frame.points.shape, (240, 424, 3))
            np.testing.assert_array_equal(result.labels.ravel(), flat.labels)
            self.assertEqual(result.json(), flat.json())
        trace = ps.Segmenter("paper").trace(result.frame)
        self.assertEqual(trace.plane_of(len(trace)).shape, (240, 424))

    def test_a_cloud_of_any_kind_of_numbers(self):
        x, y = np.meshgrid(np.arange(100) / 100, np.arange(100) / 100)
        points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.5)], axis=1)
        for kind in (np.float64, np.float32, ">f4"):
            planes, labels = ps.segment_cloud(points.astype(kind))
            self.assertEqual(len(planes), 1)
            self.assertTrue((labels == 1).all())
        lying = ps.segment_cloud(points[:, [2, 0, 1]], gravity=(1, 0, 0))
        self.assertAlmostEqual(lying.planes[0].tilt_deg, 0, places=3)
        self.assertEqual(ps.segment_cloud(points, gravity="none").planes[0].label, "unknown")
        self.assertEqual(ps.segment_cloud(points.tolist()), ps.segment_cloud(points))

    @unittest.skipUnless("PLANESCOPE_PROGRAM" in os.environ, "PLANESCOPE_PROGRAM is not set")
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

    def test_a_given_gravity_overrides_the_frames(self):
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
        # Each access returns the same memory.
        self.assertTrue(np.shares_memory(self.result.labels, self.result.labels))

    def test_compare_and_pickle(self):
        again = self.segmenter.segment(self.frame)
        self.assertEqual(again, self.result)
        self.assertEqual(hash(again), hash(self.result))
        self.assertEqual(again.planes, self.result.planes)
        self.assertNotEqual(self.result, ps.segment(self.frame, max_range_m=1.2))
        self.assertNotEqual(self.result.planes[0], self.result.planes[1])
        self.assertNotEqual(self.frame, ps.Recording(SAMPLE)[1])
        for thing in (self.frame, self.result.planes, self.result, self.result.gravity):
            self.assertEqual(pickle.loads(pickle.dumps(thing)), thing)
        cloud = ps.segment_cloud(self.result.points[::4, ::4])
        for result in (self.result, cloud):
            back = pickle.loads(pickle.dumps(result))
            self.assertEqual(ps.segment(back.frame), ps.segment(result.frame))
            np.testing.assert_array_equal(back.points, result.points)
            np.testing.assert_array_equal(back.mesh(1)[1], result.mesh(1)[1])
            for name in ("flights", "kerbs", "ramps", "floor", "counts", "timings", "gravity"):
                self.assertEqual(getattr(back, name), getattr(result, name), name)
            for format in ("geojson", "obj", "ply", "planar-terrain", "csv", "svg"):
                self.assertEqual(back.text(format), result.text(format))
            for call in (lambda r: r.mesh(99), lambda r: r.text("pdf")):
                messages = []
                for r in (result, back):
                    with self.assertRaises(ps.Error) as caught:
                        call(r)
                    messages.append(str(caught.exception))
                self.assertEqual(*messages)
        with self.assertRaisesRegex(ps.Error, "damaged bytes"):
            ps._frames._frame_of_bytes(self.frame._core.to_bytes()[:-1], None)

    def test_have_the_facts_of_planes_json(self):
        footed = ps.segment(self.frame, foot_radius_m=0.08)
        told = json.loads(footed.json())
        for plane, facts in zip(footed.planes, told["planes"]):
            self.assertEqual(plane.surface.slope_deg, facts["surface"]["slope_deg"])
            np.testing.assert_array_equal(plane.certainty.covariance, facts["certainty"]["covariance"])
            self.assertEqual(plane.foothold.steppable, plane.steppable)
            self.assertEqual(plane.foothold.why_not, plane.why_not)
            self.assertEqual(len(plane.foothold.pieces), len(facts["foot"]["pieces"]))
        self.assertIsNone(self.result.planes[0].foothold)
        (flight,) = footed.flights
        self.assertEqual(len(flight.steps), 4)
        self.assertAlmostEqual(flight.rise_m, 0.15, places=2)
        self.assertEqual(flight.steps[1].riser, told["flights"][0]["steps"][1]["riser"])
        self.assertEqual(flight.steps[0].nosing.shape, (2, 3))
        with self.assertRaises(AttributeError):
            flight.rise_m = 1
        lines = footed.table().splitlines()
        self.assertEqual(len(lines), 1 + len(footed.planes))
        self.assertEqual(lines[1].split()[:3], ["1", "h", "0.7"])

    def test_are_drawn(self):
        from matplotlib import pyplot

        from planescope import plot

        cloud = ps.segment_cloud(self.result.points[::8, ::8])
        gray = ps.segment(step_image(), K, gravity=(0, 1, 0))
        for axes in (plot.overlay(self.result, alpha=1), plot.overlay(gray, alpha=1), plot.scene(cloud)):
            axes.figure.canvas.draw()
            pixels = np.asarray(axes.figure.canvas.buffer_rgba())[..., :3]
            of_floor = np.abs(pixels - 255 * np.array(plot.color_of(1))).max(axis=2) < 3
            self.assertGreater(of_floor.sum(), 100)
        with self.assertRaisesRegex(ps.Error, "expected a depth image"):
            plot.overlay(cloud)
        pyplot.close("all")

    def test_convert_to_open3d(self):
        try:
            import open3d  # noqa: F401
        except ImportError:
            self.skipTest("python3-open3d is not installed")
        clouds = self.result.to_open3d()
        self.assertEqual([len(cloud.points) for cloud in clouds], [plane.points for plane in self.result.planes])
        np.testing.assert_allclose(np.asarray(clouds[0].normals)[0], self.result.planes[0].normal)

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

    def test_release_the_interpreter_meanwhile(self):
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
        # If the lock were held, at most one tick would fit between two calls.
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

    def test_with_a_damaged_frame_raise_or_skip(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "recording"
            shutil.copytree(SAMPLE, path)
            (path / "depth" / "000001.png").write_bytes(b"cut")
            recording = ps.Recording(path)
            self.assertEqual(list(recording.info.damaged), [1])
            for read in (lambda: list(recording), lambda: recording[1], lambda: recording[:],
                         lambda: ps.make_map(recording)):
                with self.assertRaisesRegex(ps.Error, "000001.png: "):
                    read()
            careful = ps.Recording(path, on_error="skip")
            self.assertEqual([frame.index for frame in careful], [0, 2])
            self.assertEqual([frame.index for frame in careful[1:]], [2])
            self.assertEqual(careful.skipped, careful.info.damaged)
            self.assertIn("000001.png: ", "".join(ps.make_map(careful).warnings))
            with self.assertRaisesRegex(ps.Error, "on_error: 'ignore'; expected 'raise' or 'skip'"):
                ps.Recording(path, on_error="ignore")

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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
