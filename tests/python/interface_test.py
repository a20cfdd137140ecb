"""Interface of the Python package: errors, a process without numpy, metadata, docstrings, stub."""

import ast
import doctest
import importlib.metadata
import itertools
import json
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np
from package_test import SAMPLE, K, step_image

import planescope as ps
from planescope import _core, plot


class BadInput(unittest.TestCase):
    def expect(self, message, call):
        with self.assertRaises(ps.Error) as caught:
            call()
        self.assertEqual(str(caught.exception), message)
        self.assertIsInstance(caught.exception, ValueError)

    def test_is_named_in_one_line(self):
        depth = step_image()
        expected = "expected uint16 counts or float meters of shape (height, width)"
        for wrong, found in (
            (depth.astype(int), "int64 of shape (240, 424)"),
            (depth[0], "uint16 of shape (424,)"),
            (depth.astype(np.float16), "format e of shape (240, 424)"),
            (depth > 0, "format ? of shape (240, 424)"),
            (b"depth", "uint8 of shape (5,)"),
            ("depth", "format w of shape ()"),
            (None, "format O of shape ()"),
            ([[1, 2], [3]], "a list"),
        ):
            with self.assertRaises(ps.Error) as caught:
                ps.segment(wrong, K)
            self.assertTrue(str(caught.exception).startswith("depth: "), caught.exception)
            if not isinstance(wrong, (str, type(None))):
                self.assertEqual(str(caught.exception), f"depth: {found}; {expected}")
        for interface in (
            {},
            5,
            {"typestr": "<", "shape": (2, 2), "data": b"12345678"},
            {"typestr": "<u2", "shape": (20, 20), "data": b"12345678"},
            {"typestr": "<u2", "shape": (2, 2), "strides": (1000, 2), "data": b"12345678"},
            {"typestr": "<u2", "shape": (2, 2), "strides": (-4, 2), "data": b"12345678"},
            {"typestr": "<u2", "shape": (-2, 2), "data": b"12345678"},
            {"typestr": "<u2", "shape": (2, 2), "strides": (2,), "data": b"12345678"},
        ):
            with self.assertRaisesRegex(ps.Error, "^depth: a .*; expected"):
                ps.Frame(types.SimpleNamespace(__array_interface__=interface), K)
        with self.assertRaisesRegex(ps.Error, "^depth: a ndarray; expected an array of numbers"):
            ps.Frame(np.zeros((2, 2), "M8[s]"), K)
        self.expect(
            "depth image: every pixel is beyond 65.5 m; expected depth in meters",
            lambda: ps.segment(100.0 * np.maximum(depth, 1000), K),
        )
        self.expect(
            "depth_unit: depth is in meters; expected no unit",
            lambda: ps.segment(depth / 1000, K, depth_unit=0.001),
        )
        self.expect(
            "K: 'sample'; expected a 3x3 matrix or fx, fy, cx, cy", lambda: ps.segment(depth, "sample")
        )
        self.expect(
            "depth image: focal length 1, 1 px for 424x240 pixels, a field of view of more than 160 degrees; "
            "expected fx, fy, cx, and cy in pixels",
            lambda: ps.segment(depth, np.eye(3)),
        )
        self.expect("threads: 0; expected 1 or more", lambda: ps.Segmenter(threads=0))
        self.expect(
            "at: (480, 0); expected a pixel or point in shape (240, 424)",
            lambda: ps.Segmenter().trace(ps.Frame(depth, K, gravity=(0, 1, 0))).plane_of(0, (480, 0)),
        )
        self.expect("K: missing; expected a 3x3 matrix or fx, fy, cx, cy", lambda: ps.segment(depth))
        self.expect(
            "K: shape (2, 2); expected a 3x3 matrix or fx, fy, cx, cy",
            lambda: ps.segment(depth, K[:2, :2]),
        )
        self.expect(
            "K: [[300.0, 0.0, 0.0], [0.0, 300.0, 0.0], [211.5, 119.5, 1.0]]; "
            "expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]",
            lambda: ps.segment(depth, K.T),
        )
        self.expect("frame: a ndarray; expected a planescope.Frame", lambda: ps.Segmenter().segment(depth))
        self.expect(
            "segment: a Frame has its own K, depth_unit, distortion, and color; omit them",
            lambda: ps.segment(ps.Frame(depth, K), depth_unit=0.5),
        )
        self.expect("gravity: shape (2,); expected x, y, z", lambda: ps.segment(depth, K, gravity=(0, 1)))
        self.expect(
            "color: float64 of shape (240, 424, 3); expected uint8 RGB of shape (height, width, 3), aligned with depth",
            lambda: ps.segment(depth, K, color=np.zeros((240, 424, 3))),
        )
        self.expect(
            "points: float64 of shape (4, 4); expected meters of shape (points, 3) or (height, width, 3)",
            lambda: ps.segment_cloud(np.eye(4)),
        )
        self.expect(
            "points: int64 of shape (0,); expected meters of shape (points, 3) or (height, width, 3)",
            lambda: ps.segment_cloud(np.zeros(0, int)),
        )
        self.expect("point cloud: no points", lambda: ps.segment_cloud(np.zeros((0, 3))))
        self.expect("/nowhere: no such file or folder", lambda: ps.Recording("/nowhere"))
        recording = ps.Recording(SAMPLE)
        self.assertEqual(recording[np.int64(-1)].index, len(recording) - 1)
        with self.assertRaisesRegex(TypeError, "frame 1.0: expected a whole number or a slice"):
            recording[1.0]
        with self.assertRaisesRegex(ps.Error, "theta_n_out"):
            ps.segment(depth, K, theta_n_ou=3)

class WithoutNumpy(unittest.TestCase):
    def test_memoryviews_come_in_and_go_out(self):
        # The same image with numpy, and in a process in which importing numpy fails.
        expected = ps.segment(step_image(), K, gravity=(0, 1, 0))
        script = """
import sys
sys.modules["numpy"] = None
try:
    import numpy
except ImportError:
    pass
else:
    raise SystemExit("numpy was imported")
import planescope as ps
data = memoryview(sys.stdin.buffer.read())
result = ps.segment(data.cast("H", (240, 424)), (300, 300, 211.5, 119.5), gravity=(0, 1, 0), foot_radius_m=0.05)
planes, labels = result
assert isinstance(labels, memoryview) and labels.readonly and labels.shape == (240, 424), labels
floor = planes[labels[239, 200] - 1]
assert abs(floor.normal[2] - 1) < 0.01 and floor.normal.format == "d"
corners = floor.outline.world(floor.outline.parts[0].outer)
assert abs(sum(corners[0, k] * floor.normal[k] for k in range(3)) - floor.offset_m) < 1e-6
assert result.points.shape == (240, 424, 3) and result.mesh(1)[1].shape[1] == 3
assert floor == result.planes[floor.id - 1] and floor.foothold.steppable
K = ps.Frame(data.cast("H", (240, 424)), [[300, 0, 211.5], [0, 300, 119.5], [0, 0, 1]]).K
assert K.tolist()[0] == [300, 0, 211.5]
meters = memoryview(__import__("array").array("f", [v / 1000 for v in data.cast("H")])).cast("B").cast("f", (240, 424))
assert ps.segment(meters, K, gravity=(0, 1, 0), foot_radius_m=0.05) == result
x = [[i / 50, j / 50, 0.5] for i in range(50) for j in range(50)]
assert len(ps.segment_cloud(x).planes) == 1
trace = ps.Segmenter().trace(result.frame)
assert len(trace.events) == len(trace) and trace.plane_of(len(trace)).shape == (240, 424)
assert sys.modules["numpy"] is None
sys.stdout.write(ps.segment(result.frame).json())
"""
        ran = subprocess.run([sys.executable, "-c", script], input=step_image().tobytes(), capture_output=True)
        self.assertEqual(ran.stderr.decode(), "")
        self.assertEqual(ran.stdout.decode(), expected.json())

    def test_no_source_includes_the_api_of_numpy(self):
        for source in Path("python").glob("*.?pp"):
            self.assertNotRegex(source.read_text(), r"pybind11/(numpy|eigen)\.h|numpy/")


class Package(unittest.TestCase):
    def test_has_its_version_as_metadata(self):
        self.assertEqual(importlib.metadata.version("planescope"), ps.__version__)

    def test_documents_everything_public(self):
        def check(name, thing, is_call):
            text = thing.__doc__ or ""
            self.assertTrue(text, f"{name} has no docstring")
            if not is_call:
                return
            self.assertIn("Example:", text, name)
            code = thing.__init__.__code__ if isinstance(thing, type) else thing.__code__
            arguments = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
            for argument in arguments:
                if argument not in ("self", "cls"):
                    self.assertIn(f" {argument}:", text, f"{name}: {argument}")

        names = [(ps, name) for name in ps.__all__ if name not in ("Error", "__version__")]
        for module, name in names + [(plot, name) for name in plot.__all__]:
            thing = getattr(module, name)
            check(name, thing, not isinstance(thing, type))
            for member, value in vars(thing).items() if isinstance(thing, type) else ():
                value = getattr(value, "__func__", value)
                public = not member.startswith("_") or member in ("__init__", "__call__")
                is_own = hasattr(value, "__code__") and value.__module__.startswith("planescope")
                if public and is_own and not (member == "__init__" and value.__doc__ is None):
                    check(f"{name}.{member}", value, True)
                elif public and isinstance(value, property):
                    self.assertTrue(value.__doc__, f"{name}.{member}")

    def test_runs_the_examples_of_its_docstrings(self):
        recording = ps.Recording(SAMPLE)
        result = ps.segment(recording[0])
        x, y = np.meshgrid(np.arange(0, 1, 0.01), np.arange(0, 1, 0.01))
        points = np.stack([x, y, np.where(x < 0.5, 0.0, 0.15)], axis=-1)
        with tempfile.TemporaryDirectory() as folder:
            names = {
                "np": np, "ps": ps, "json": json, "plot": plot, "recording": recording, "result": result,
                "planes": result.planes, "depth": recording[0].depth, "K": recording[0].K, "points": points,
                "segmenter": ps.Segmenter(), "trace": ps.Segmenter(max_range_m=1.5).trace(recording[0]),
                "poses": [result.T_world_sensor] * 3, "out": Path(folder),
            }  # fmt: skip
            finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
            modules = [sys.modules[name] for name in sorted(sys.modules) if name.startswith("planescope")]
            for test in itertools.chain(*(finder.find(module, globs=names) for module in modules)):
                runner.run(test)
        self.assertEqual(runner.failures, 0)
        self.assertGreater(runner.tries, 50)

    def test_has_a_stub_with_the_names_of_the_module(self):
        stub = ast.parse(Path(_core.__file__).with_name("_core.pyi").read_text())

        def names_of(body):
            declared = {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
            return declared | {node.target.id for node in body if isinstance(node, ast.AnnAssign)}

        for node in stub.body:
            if isinstance(node, ast.ClassDef) and node.name != "Error":
                members = {name for name in vars(getattr(_core, node.name)) if not name.startswith("_")}
                self.assertEqual(names_of(node.body) - {"__init__"}, members, node.name)
        public = {name for name in vars(_core) if not name.startswith("_")} | {"__version__"}
        self.assertEqual(names_of(stub.body), public)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
