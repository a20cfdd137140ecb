"""Planes in depth images and point clouds, after Sun et al. 2023.

Lengths are metres, angles degrees. The sensor's frame is that of cameras: x right, y down, z forward.
The world's has z up, against gravity, and the sensor at its origin; of a cloud, its own origin.
Whatever cannot be done raises Error with one line: what was found and what was expected.
"""

from __future__ import annotations

import enum
import functools
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Error, __version__

__all__ = [
    "Error", "EventType", "Frame", "Gravity", "Map", "MapPlane", "OptionInfo", "Outline",
    "OutlinePart", "Plane", "Recording", "RecordingInfo", "Result", "Segmenter", "Trace",
    "__version__", "make_map", "options", "segment", "segment_cloud",
]


@dataclass(frozen=True, eq=False)
class Gravity:
    """Where things fall: a unit vector in the sensor's frame.

    `source`: "option", "sidecar", "imu", "picked", "estimate", "assumed", or "none": it is not known,
    and nothing is h or v. `confidence`: 0 to 1, below 1 for estimates only.
    """

    direction: NDArray[np.float64]
    source: str
    confidence: float


@dataclass(frozen=True, eq=False)
class OutlinePart:
    """Rings of (n, 2) corners on the plane, not closed by a repeated one."""

    outer: NDArray[np.float64]  # counter-clockwise from where the normal points
    holes: list[NDArray[np.float64]]  # something else was seen there, or through the plane
    unknown: list[NDArray[np.float64]]  # nothing was measured there


@dataclass(frozen=True, eq=False)
class Outline:
    """What a plane covers, as polygons on it: (x, y) stands for origin + x u + y v."""

    origin: NDArray[np.float64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]
    parts: list[OutlinePart]  # the largest first
    area_m2: float  # without holes and what is unknown

    def world(self, ring: ArrayLike) -> NDArray[np.float64]:
        """Corners (n, 2) on the plane as places (n, 3) in the world."""
        ring = np.asarray(ring, dtype=float)
        return self.origin + ring[..., :1] * self.u + ring[..., 1:] * self.v


@dataclass(frozen=True, eq=False)
class Plane:
    """In the world's frame; the normal points up (h) or to the sensor's side (v)."""

    id: int  # from 1: what Result.labels holds
    label: str  # "h": up to 45 degrees from the level, "v", or "unknown" without gravity
    normal: NDArray[np.float64]
    centroid: NDArray[np.float64]
    offset_m: float  # normal . x of its points
    tilt_deg: float  # 0 a floor, 90 a wall; nan without gravity
    points: int  # measurements on it
    voxels: int
    rms_m: float  # of its measurements' distances
    area_m2: float  # of the cells that hold points
    margin: float  # from being lost or joined with a larger neighbor; inf: not known
    undecided: bool  # the margin is below the threshold
    hull: NDArray[np.float64] = field(repr=False)  # (n, 3), convex
    outline: Outline = field(repr=False)
    height_m: float  # above the floor; nan: it is not level
    steppable: bool  # where foot_radius_m is given: whether the foot can stand here
    why_not: str  # and why not


@dataclass(frozen=True, eq=False)
class RecordingInfo:
    path: str
    format: str  # "RealSense SDK bag", "folder", ...
    device: str
    width: int  # of depth images; 0: clouds
    height: int
    K: NDArray[np.float64] | None  # (3, 3)
    depth_unit: float  # metres per count
    has_color: bool
    warnings: list[str]  # what was lost or odd


@dataclass(frozen=True, eq=False)
class OptionInfo:
    name: str
    unit: str
    meaning: str
    section: str
    paper: str  # its value in the profile "paper"
    refined: str  # and in "refined", the default


def options() -> dict[str, OptionInfo]:
    """Everything that can be set, by name: what segment() and Segmenter() take as keywords."""
    return {row[0]: OptionInfo(*row) for row in _core.Options.all()}


class EventType(enum.IntEnum):
    """What a decision was: Trace.events["type"]."""

    VISIT = 0  # a node is taken from the queue
    DECIDE = 1  # a node is settled; value: e_n where it was computed
    FOUND = 2  # a node's candidate founds a plane
    MERGE = 3  # a node's candidate joins `plane`; value: |n . dmu| [m]
    ASSIGN = 4  # a leftover point goes to `plane`; value: distance [m]
    DROP = 5  # a leftover point stays without a plane
    REFINE = 6  # the objective joined, changed or dropped `plane`


def _numbers(values: Any, what: str, expected: str) -> NDArray[np.float64]:
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "fiu":
            raise ValueError
        return array.astype(float)
    except ValueError:
        raise Error(f"{what}: it is {values!r}, expected {expected}") from None


def _number(value: Any, what: str) -> float:
    number = _numbers(value, what, "a number")
    if number.shape != ():
        raise Error(f"{what}: it has shape {number.shape}, expected a number")
    return float(number)


def _intrinsics(k: ArrayLike) -> tuple[float, float, float, float]:
    k = _numbers(k, "K", "a 3x3 matrix or fx, fy, cx, cy")
    if k.shape == (4,):
        return float(k[0]), float(k[1]), float(k[2]), float(k[3])
    if k.shape != (3, 3):
        raise Error(f"K: it has shape {k.shape}, expected a 3x3 matrix or fx, fy, cx, cy")
    if k[0, 1] or k[1, 0] or k[2, 0] or k[2, 1] or k[2, 2] != 1:
        raise Error(f"K: it is {k.tolist()}, expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]")
    return float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2])


def _vector(gravity: ArrayLike | Gravity | None) -> list[float] | None:
    if gravity is None:
        return None
    if isinstance(gravity, Gravity):
        gravity = gravity.direction
    gravity = _numbers(gravity, "gravity", "x, y, z")
    if gravity.shape != (3,):
        raise Error(f"gravity: it has shape {gravity.shape}, expected x, y, z")
    return [float(part) for part in gravity]


def _frame_core(frame: Any) -> Any:
    if not isinstance(frame, Frame):
        raise Error(f"frame: it is a {type(frame).__name__}, expected a planescope.Frame")
    return frame._core


class Frame:
    """One depth image, or one cloud. Arrays are views of the frame's own memory."""

    def __init__(
        self,
        depth: NDArray[np.uint16],
        K: ArrayLike,
        *,
        depth_unit: float = 0.001,
        gravity: ArrayLike | Gravity | None = None,
        distortion: ArrayLike | None = None,
        distortion_model: str = "brown_conrady",
        color: NDArray[np.uint8] | None = None,
    ):
        """`depth`: counts (height, width), 0 not measured. `K`: (3, 3) or (fx, fy, cx, cy).

        `distortion`: k1, k2, p1, p2, k3, of the model "brown_conrady", which is OpenCV's, or
        "inverse_brown_conrady". `color`: RGB on the pixels of depth.
        `gravity`: where things fall, in the sensor's frame; None: it is estimated.
        """
        coefficients = None
        if distortion is not None:
            coefficients = _numbers(distortion, "distortion", "k1, k2, p1, p2, k3")
            if coefficients.shape != (5,):
                raise Error(f"distortion: it has shape {coefficients.shape}, expected k1, k2, p1, p2, k3")
        self._core = _core.Frame(
            np.asarray(depth), _intrinsics(K), coefficients, distortion_model,
            _number(depth_unit, "depth_unit"), _vector(gravity), color,
        )

    @classmethod
    def _of(cls, core: Any) -> Frame:
        frame = cls.__new__(cls)
        frame._core = core
        return frame

    @classmethod
    def of_points(cls, points: ArrayLike, *, gravity: ArrayLike | Gravity | None = None) -> Frame:
        """A cloud of (n, 3) points; (0, 0, 0) and nan are no measurement.

        `gravity`: in the cloud's frame; None: -z.
        """
        return cls._of(_core.Frame.of_points(np.asarray(points), _vector(gravity)))

    @property
    def index(self) -> int:
        return self._core.index

    @property
    def name(self) -> str:
        return os.fsdecode(self._core.name)

    @property
    def timestamp_s(self) -> float:
        return self._core.timestamp_s

    @property
    def is_cloud(self) -> bool:
        return self._core.is_cloud

    @property
    def depth(self) -> NDArray[np.uint16] | None:
        """Counts (height, width); None of a cloud."""
        return self._core.depth

    @property
    def depth_unit(self) -> float:
        """Metres per count."""
        return self._core.depth_unit

    @property
    def K(self) -> NDArray[np.float64] | None:
        """(3, 3) of the depth image; None of a cloud."""
        return self._core.K

    @property
    def distortion(self) -> NDArray[np.float64] | None:
        """k1, k2, p1, p2, k3 of the depth image's lens, None: it has none."""
        return self._core.distortion

    @property
    def distortion_model(self) -> str:
        """"brown_conrady", as OpenCV has it, "inverse_brown_conrady", or "none"."""
        return self._core.distortion_model

    @property
    def color(self) -> NDArray[np.uint8] | None:
        """RGB (height, width, 3), where there is one."""
        return self._core.color

    @property
    def color_K(self) -> NDArray[np.float64] | None:
        """(3, 3) of a colour image that is not aligned; None: not known."""
        return self._core.color_K

    @property
    def color_is_aligned(self) -> bool:
        """Whether colour is registered to depth pixel by pixel."""
        return self._core.color_is_aligned

    @property
    def T_color_depth(self) -> NDArray[np.float64]:
        """(4, 4), takes places in the depth camera's frame to the colour camera's."""
        return self._core.T_color_depth

    @property
    def points(self) -> NDArray[np.float64]:
        """(n, 3) of a cloud, in its order; of a depth image none: Result.points has them."""
        return self._core.points

    @property
    def gravity(self) -> Gravity | None:
        """As the recording tells."""
        gravity = self._core.gravity
        return None if gravity is None else Gravity(*gravity)

    def __repr__(self) -> str:
        depth = self.depth
        shape = f"{self._core.size} points" if depth is None else "{1}x{0}".format(*depth.shape)
        return f"<planescope.Frame {self.index}: {shape}>"


class Recording(Sequence):
    """RealSense and ROS bags (1 and 2), folders of PNGs, clouds: a sequence of frames."""

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        K: ArrayLike | None = None,
        depth_unit: float | None = None,
        color: bool = True,
    ):
        """`K` and `depth_unit` win over what the files say; `color=False` reads depth alone."""
        self._core = _core.Recording(
            os.fsencode(path),
            None if K is None else _intrinsics(K),
            None if depth_unit is None else _number(depth_unit, "depth_unit"),
            bool(color),
        )

    @property
    def info(self) -> RecordingInfo:
        info: dict[str, Any] = self._core.info()
        info["path"] = os.fsdecode(info["path"])
        return RecordingInfo(**info)

    def __len__(self) -> int:
        return self._core.size()

    @overload
    def __getitem__(self, i: int) -> Frame: ...

    @overload
    def __getitem__(self, i: slice) -> list[Frame]: ...

    def __getitem__(self, i):
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(len(self)))]
        k = i + len(self) if i < 0 else i
        if not 0 <= k < len(self):
            raise IndexError(f"frame {i} of a recording of {len(self)}")
        return Frame._of(self._core.frame(k))

    def __iter__(self) -> Iterator[Frame]:
        for i in range(len(self)):
            yield self[i]

    def __repr__(self) -> str:
        info = self.info
        return f"<planescope.Recording {info.path}: {info.format}, {len(self)} frames>"


class Result:
    """The planes of one frame. Unpacks as `planes, labels`."""

    def __init__(self, core: Any):
        self._core = core

    def __iter__(self) -> Iterator[Any]:
        return iter((self.planes, self.labels))

    @property
    def frame(self) -> Frame:
        return Frame._of(self._core.frame)

    @functools.cached_property
    def planes(self) -> list[Plane]:
        """By id - 1. Outlines and heights are found when planes are first asked for."""
        planes = []
        for values in self._core.planes():
            outline = values.pop("outline")
            parts = [OutlinePart(**part) for part in outline.pop("parts")]
            planes.append(Plane(outline=Outline(parts=parts, **outline), **values))
        return planes

    @property
    def labels(self) -> NDArray[np.int32]:
        """Plane id of each pixel (height, width), or of each point of a cloud; 0 of none."""
        return self._core.labels

    @property
    def inclination(self) -> NDArray[np.uint8]:
        """What the classifier said of each: 0 nothing, 1 h, 2 v."""
        return self._core.inclination

    @property
    def points(self) -> NDArray[np.float64]:
        """Where each is in the world: (height, width, 3) or (n, 3); nan: not measured."""
        return self._core.points

    @property
    def gravity(self) -> Gravity:
        return Gravity(*self._core.gravity)

    @property
    def T_world_sensor(self) -> NDArray[np.float64]:
        """(4, 4)"""
        return self._core.T_world_sensor

    @property
    def counts(self) -> dict[str, int]:
        """Points by what became of them."""
        return self._core.counts()

    @property
    def timings(self) -> dict[str, float]:
        """Milliseconds by stage."""
        return self._core.timings()

    def mesh(self, id: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """What a plane covers, as vertices (n, 3) and triangles (m, 3)."""
        return self._core.mesh(id)

    def json(self) -> str:
        """planes.json, as `planescope segment` writes it: stairs, kerbs and ramps as well."""
        return self._core.json()

    def text(self, format: str) -> str:
        """The planes as "geojson", "obj", "ply", "planar-terrain", "csv" or "svg"."""
        return self._core.text(format)

    def __repr__(self) -> str:
        return f"<planescope.Result: {len(self.planes)} planes>"


class Trace:
    """How the planes of a frame came about: step k is the state after k events."""

    def __init__(self, core: Any):
        self._core = core

    def __len__(self) -> int:
        """Steps."""
        return self._core.steps()

    @property
    def events(self) -> NDArray[np.void]:
        """Records: type (EventType), case (1 to 4), stage (index into stages), label (1 h, 2 v),
        node (index into nodes), plane and other (in order of founding), point (voxel), value.
        -1: does not apply."""
        return self._core.events

    @property
    def nodes(self) -> NDArray[np.void]:
        """Records, the root first: parent, depth, case, voxels, voxels_h, corners (8 x 3), and the
        steps at which it was queued, visited, decided; 2147483647: never."""
        return self._core.nodes

    @property
    def stages(self) -> list[str]:
        """"criteria", "merge" or "assign"; "join" to "list" by the objective."""
        return self._core.stages()

    def describe(self, step: int) -> str:
        """What the event that led to this step did; 1 <= step <= len(trace)."""
        return self._core.describe(step)

    @overload
    def plane_of(self, step: int) -> NDArray[np.int32]: ...

    @overload
    def plane_of(self, step: int, at: int | tuple[int, int]) -> int: ...

    def plane_of(self, step, at=None):
        """At a step, the plane of each pixel or point in order of founding; -1 of none.

        `at`: of one alone, (row, column) or the number of a point.
        """
        shape = self.result.labels.shape
        if at is None:
            return self._core.plane_of(step).reshape(shape)
        try:
            i = int(np.ravel_multi_index(np.atleast_1d(at).tolist(), shape))
        except (TypeError, ValueError):
            raise Error(f"at: it is {at!r}, expected a place in {shape}") from None
        return self._core.plane_at(step, i)

    def id_of(self, plane: int) -> int:
        """The id at the end of a plane in order of founding; 0: it did not last."""
        return self._core.id_of(plane)

    @functools.cached_property
    def result(self) -> Result:
        return Result(self._core.result())


class Segmenter:
    """Options and the classifier that they name, ready for frames. Threads may share one."""

    def __init__(self, profile: str = "refined", *, threads: int = 1, **options: Any):
        """`options`: by the names that options() lists. Results do not depend on `threads`."""
        core = _core.Options(profile)
        for name, value in options.items():
            if isinstance(value, (bool, np.bool_)):
                value = "on" if value else "off"
            elif name == "gravity" and not isinstance(value, str):
                value = ",".join(repr(part) for part in _vector(value) or [])
            core.set(name, str(value))
        if not isinstance(threads, (int, np.integer)) or not 1 <= threads < 2**31:
            raise Error(f"threads: {threads!r}, expected 1 or more")
        self._core = _core.Segmenter(core, threads)

    def segment(self, frame: Frame) -> Result:
        return Result(self._core.segment(_frame_core(frame)))

    def trace(self, frame: Frame) -> Trace:
        """The same with every decision kept."""
        return Trace(self._core.trace(_frame_core(frame)))


def segment(
    depth: NDArray[np.uint16] | Frame,
    K: ArrayLike | None = None,
    *,
    depth_unit: float | None = None,
    gravity: ArrayLike | Gravity | str | None = None,
    distortion: ArrayLike | None = None,
    distortion_model: str = "brown_conrady",
    color: NDArray[np.uint8] | None = None,
    profile: str = "refined",
    threads: int = 1,
    **options: Any,
) -> Result:
    """planes, labels = segment(depth, K): of one depth image, or of a Frame.

    Arguments as those of Frame and Segmenter; `gravity` goes before what a Frame knows, and may be the
    option's "none" or "estimate" as well. For many frames make one Segmenter.
    """
    if gravity is not None and (isinstance(gravity, str) or isinstance(depth, Frame)):
        options["gravity"], gravity = gravity, None
    if not isinstance(depth, Frame):
        if K is None:
            raise Error("K: it is not given, expected a 3x3 matrix or fx, fy, cx, cy")
        depth = Frame(
            depth, K, depth_unit=0.001 if depth_unit is None else depth_unit, gravity=gravity,
            distortion=distortion, distortion_model=distortion_model, color=color,
        )
    elif K is not None or depth_unit is not None or distortion is not None or color is not None:
        raise Error("segment: a Frame has its own K, depth_unit, distortion and color")
    return Segmenter(profile, threads=threads, **options).segment(depth)


def segment_cloud(
    points: ArrayLike,
    *,
    gravity: ArrayLike | Gravity | str | None = None,
    profile: str = "refined",
    threads: int = 1,
    **options: Any,
) -> Result:
    """planes, labels = segment_cloud(points): of (n, 3) points; `gravity` None: -z."""
    if isinstance(gravity, str):
        options["gravity"], gravity = gravity, None
    frame = Frame.of_points(points, gravity=gravity)
    return Segmenter(profile, threads=threads, **options).segment(frame)


@dataclass(frozen=True, eq=False)
class MapPlane:
    """A plane of the world, as all frames that saw it tell it."""

    track: int
    label: str  # "h", "v" or "unknown"
    state: str  # "alive", "gone": it was taken away, or "left": beyond the window
    segment: int  # of the map: each has a world of its own
    normal: NDArray[np.float64]
    centroid: NDArray[np.float64]
    offset_m: float  # normal . x of its points
    sigma_offset_m: float
    sigma_tilt_deg: float
    rms_m: float
    area_m2: float
    frames_seen: int
    frames_missed: int  # in sight, and not found
    frames_undecided: int  # of those seen, frames in which its plane was undecided
    parts: list[OutlinePart] = field(repr=False)  # rings of (n, 3) corners in the world


class Map:
    """Planes of the world, where the camera was, and which plane of which frame is which."""

    def __init__(
        self,
        core: tuple[
            bytes, bytes, bytes, list[int], NDArray[np.float64], list[str], dict[int, bytes]
        ],
    ):
        map_json, tracks_json, poses_tum, frames, T, told, planes_png = core
        self.json = map_json.decode()  # what `planescope map` writes as map.json,
        self.tracks_json = tracks_json.decode()  # tracks.json
        self.poses_tum = poses_tum.decode()  # and poses.tum, byte by byte
        self.T_world_camera = dict(zip(frames, T))  # (4, 4), of each frame whose pose is known
        self.told = told  # what was odd, one line each
        # By frame, planes/000000.png: 16 bit, per pixel the id of the plane in `track_of_plane`.
        # Empty for methods that do not find planes on pixels.
        self.planes_png = planes_png

    @functools.cached_property
    def planes(self) -> list[MapPlane]:
        """The largest first; those that are gone after the others."""
        return [
            MapPlane(
                parts=[
                    OutlinePart(np.array(part["outer"]), [np.array(h) for h in part["holes"]], [])
                    for part in plane["outline"]
                ],
                frames_seen=plane["frames"]["seen"],
                frames_missed=plane["frames"]["missed"],
                frames_undecided=plane["frames"]["undecided"],
                normal=np.array(plane["normal"]),
                centroid=np.array(plane["centroid"]),
                **{
                    name: plane[name]
                    for name in (
                        "track", "label", "state", "segment", "offset_m", "sigma_offset_m",
                        "sigma_tilt_deg", "rms_m", "area_m2",
                    )
                },
            )
            for plane in json.loads(self.json)["planes"]
        ]

    @property
    def stability(self) -> dict[str, float | None]:
        return json.loads(self.json)["stability"]

    @functools.cached_property
    def tracks(self) -> list[dict[str, Any]]:
        """Of each track, where it was seen, and why it was not where it was not: as tracks.json."""
        return json.loads(self.tracks_json)["tracks"]

    @functools.cached_property
    def track_of_plane(self) -> dict[int, list[int]]:
        """By frame, the tracks of its planes, by id - 1; 0: none."""
        frames = json.loads(self.tracks_json)["frames"]
        return {frame["frame"]: frame["track_of_plane"] for frame in frames}

    def __repr__(self) -> str:
        return f"<planescope.Map: {len(self.planes)} planes of {len(self.track_of_plane)} frames>"


def make_map(
    recording: Recording,
    *,
    poses: str | os.PathLike[str] | None = None,
    frames: Sequence[int] | None = None,
    window_m: float = 0,
    profile: str = "refined",
    threads: int = 1,
    **options: Any,
) -> Map:
    """Follows the planes of a recording's frames, and makes one map of them.

    `poses`: a file (TUM, KITTI, Open3D's .log or .json); else they are the recording's, else they
    are found from its images. `window_m`: the edge of the cube about the camera that the map is held
    in; 0: no limit. The rest as for Segmenter.
    """
    if not isinstance(recording, Recording):
        raise Error(f"recording: {type(recording).__name__}, expected a planescope.Recording")
    if frames is not None and (len(frames) == 0 or any(frame != int(frame) for frame in frames)):
        raise Error(f"frames: {frames!r}, expected whole numbers, at least one")
    if poses is not None and not os.fspath(poses):
        raise Error("poses: '', expected a file")
    return Map(
        _core.make_map(
            recording._core,
            Segmenter(profile, threads=threads, **options)._core,
            b"" if poses is None else os.fsencode(poses),
            _number(window_m, "window_m"),
            [] if frames is None else [int(frame) for frame in frames],
        )
    )
