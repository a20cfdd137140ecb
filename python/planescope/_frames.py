"""Input: frames, and recordings as sequences of frames."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

from . import _core
from ._arrays import Values, buffer, np, numbers, view
from ._core import Error

if TYPE_CHECKING:
    import numpy
    from numpy.typing import ArrayLike, NDArray

    Depth = NDArray[numpy.uint16] | NDArray[numpy.floating[Any]] | memoryview

# Properties that are None for some frames are declared as `X | Any`, so that code for depth images, for
# example, needs no checks.
_K = "a 3x3 matrix or fx, fy, cx, cy"


@dataclass(frozen=True, eq=False)
class Gravity(Values):
    """Direction of gravity, a unit vector in the sensor's frame.

    Example:
        >>> ps.segment(depth, K, gravity=(0, 0.848, 0.53)).gravity.source
        'option'
    """

    direction: NDArray[numpy.float64]
    source: str  # option, sidecar, imu, picked, estimate, assumed; none: unknown, no plane is h or v
    confidence: float  # 0 to 1; below 1 for estimates


def intrinsics(k: Any) -> tuple[float, float, float, float]:
    """fx, fy, cx, cy of a camera matrix."""
    k = numbers(k, "K", _K, (3, 3), (4,))
    if len(k) == 4:
        return k[0], k[1], k[2], k[3]
    if k[0][1] or k[1][0] or k[2] != [0, 0, 1]:
        raise Error(f"K: {k}; expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]")
    return k[0][0], k[1][1], k[0][2], k[1][2]


def vector(gravity: Any) -> list[float] | None:
    """x, y, z of a gravity vector."""
    if gravity is None:
        return None
    if isinstance(gravity, Gravity):
        gravity = gravity.direction
    xyz: list[float] = numbers(gravity, "gravity", "x, y, z", (3,))
    return xyz


class Frame:
    """One depth image or one point cloud.

    Arrays are read-only views of the frame's memory. Frames are equal if all of their data is equal.
    They can be pickled.
    """

    def __init__(
        self,
        depth: Depth,
        K: ArrayLike,
        *,
        depth_unit: float | None = None,
        gravity: ArrayLike | Gravity | None = None,
        distortion: ArrayLike | None = None,
        distortion_model: str = "brown_conrady",
        color: NDArray[numpy.uint8] | None = None,
    ):
        """Copy a depth image.

        Args:
            depth: (height, width), uint16 counts or float meters, with any strides and byte order.
                0, and in meters also negative and nan, means not measured. Meters are stored as
                counts of 1 mm if all are whole millimeters or one is beyond 13.1 m, otherwise of
                0.2 mm. Values beyond 65.534 m are invalid.
            K: (3, 3), or fx, fy, cx, cy, in pixels.
            depth_unit: Meters per count, 0.001 by default. Not for depth in meters.
            gravity: Direction of gravity in the sensor's frame: x right, y down, z forward. None:
                estimated from the image.
            distortion: k1, k2, p1, p2, k3.
            distortion_model: "brown_conrady" (OpenCV) or "inverse_brown_conrady".
            color: uint8 RGB of shape (height, width, 3), aligned with depth.

        Raises:
            Error: An argument has the wrong shape or type, or is out of range.

        Example:
            >>> frame = ps.Frame(depth, (385, 385, 319.5, 239.5), gravity=(0, 0.848, 0.53))
            >>> frame
            <planescope.Frame 0: 640x480>
        """
        unit = None if depth_unit is None else numbers(depth_unit, "depth_unit", "a number")
        coefficients = None
        if distortion is not None:
            coefficients = numbers(distortion, "distortion", "k1, k2, p1, p2, k3", (5,))
        image = buffer(depth, "depth", "uint16 counts or float meters of shape (height, width)")
        if color is not None:
            color = buffer(color, "color", "uint8 RGB of shape (height, width, 3), aligned with depth")
        self._core: Any = _core.Frame(
            image, intrinsics(K), coefficients, distortion_model, unit, vector(gravity), color
        )
        self._shape: tuple[int, ...] | None = None

    @classmethod
    def _of(cls, core: Any, shape: tuple[int, ...] | None = None) -> Frame:
        frame = cls.__new__(cls)
        frame._core, frame._shape = core, shape
        return frame

    @classmethod
    def of_points(cls, points: ArrayLike, *, gravity: ArrayLike | Gravity | None = None) -> Frame:
        """Copy a point cloud.

        Args:
            points: (n, 3), or organized as (height, width, 3), in meters, with any number type,
                strides and byte order. (0, 0, 0) and nan mean not measured.
            gravity: Direction of gravity in the cloud's frame. None: -z.

        Returns:
            A frame whose labels have the shape of the points.

        Raises:
            Error: The points have the wrong shape or are not numbers.

        Example:
            >>> ps.Frame.of_points([[0, 0, 0.5], [1, 0, 0.5], [0, 1, 0.5]])
            <planescope.Frame 0: 3 points>
        """
        points = buffer(points, "points", "meters of shape (points, 3) or (height, width, 3)")
        core = _core.Frame.of_points(points, vector(gravity))
        shape = tuple(getattr(points, "shape", None) or memoryview(points).shape)  # type: ignore
        return cls._of(core, shape[:-1] if len(shape) == 3 else None)

    @property
    def shape(self) -> tuple[int, ...]:
        """(height, width) of an image or organized cloud, else (points,)."""
        if self._shape is not None:
            return self._shape
        depth = self._core.depth
        return (self._core.size,) if depth is None else tuple(memoryview(depth).shape)  # type: ignore

    @property
    def index(self) -> int:
        """Number in its recording, from 0."""
        return int(self._core.index)

    @property
    def name(self) -> str:
        """Name in its recording, such as the stem of a file."""
        return os.fsdecode(self._core.name)

    @property
    def timestamp_s(self) -> float:
        """Time of the sensor's clock; 0: unknown."""
        return float(self._core.timestamp_s)

    @property
    def is_cloud(self) -> bool:
        """Whether the frame is a point cloud."""
        return bool(self._core.is_cloud)

    @property
    def depth(self) -> NDArray[numpy.uint16] | Any:
        """Counts (height, width); None for a cloud."""
        return view(self._core.depth)

    @property
    def depth_unit(self) -> float:
        """Meters per count."""
        return float(self._core.depth_unit)

    @property
    def K(self) -> NDArray[numpy.float64] | Any:
        """Camera matrix (3, 3) of the depth image; None for a cloud."""
        return view(self._core.K)

    @property
    def distortion(self) -> NDArray[numpy.float64] | None:
        """k1, k2, p1, p2, k3 of the depth image; None: no distortion."""
        return view(self._core.distortion)  # type: ignore[no-any-return]

    @property
    def distortion_model(self) -> str:
        """ "brown_conrady" (OpenCV), "inverse_brown_conrady" or "none"."""
        return str(self._core.distortion_model)

    @property
    def color(self) -> NDArray[numpy.uint8] | Any:
        """RGB (height, width, 3), or None."""
        return view(self._core.color)

    @property
    def color_K(self) -> NDArray[numpy.float64] | Any:
        """Camera matrix (3, 3) of a color image that is not aligned; None: unknown."""
        return view(self._core.color_K)

    @property
    def color_is_aligned(self) -> bool:
        """Whether color is registered to depth pixel by pixel."""
        return bool(self._core.color_is_aligned)

    @property
    def T_color_depth(self) -> NDArray[numpy.float64]:
        """Transform (4, 4) from the depth camera's frame to the color camera's."""
        return view(self._core.T_color_depth)  # type: ignore[no-any-return]

    @property
    def points(self) -> NDArray[numpy.float64]:
        """Points of a cloud, in its shape and order. Empty for a depth image: see Result.points."""
        points = view(self._core.points)
        if self._shape is not None:
            shape = (*self._shape, 3)
            points = points.cast("B").cast("d", shape) if np is None else points.reshape(shape)
        return points  # type: ignore[no-any-return]

    @property
    def gravity(self) -> Gravity | None:
        """Gravity from the recording or the caller; None: to be estimated."""
        gravity = self._core.gravity
        return None if gravity is None else Gravity(view(gravity[0]), *gravity[1:])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frame):
            return NotImplemented
        return self._shape == other._shape and bool(self._core.to_bytes() == other._core.to_bytes())

    def __hash__(self) -> int:
        return hash((self.index, self.name, self.shape))

    def __reduce__(self) -> tuple[Any, ...]:
        return _frame_of_bytes, (self._core.to_bytes(), self._shape)

    def __repr__(self) -> str:
        shape = self.shape
        text = f"{shape[1]}x{shape[0]}" if len(shape) == 2 else f"{shape[0]} points"
        return f"<planescope.Frame {self.index}: {text}>"


def _frame_of_bytes(data: bytes, shape: tuple[int, ...] | None) -> Frame:
    return Frame._of(_core.Frame.of_bytes(data), shape)


@dataclass(frozen=True, eq=False)
class RecordingInfo(Values):
    """Properties of a recording.

    Example:
        >>> recording.info.format
        'folder of images'
    """

    path: str
    format: str  # "RealSense SDK bag", "folder of images", ...
    device: str
    width: int  # of depth images; 0: clouds
    height: int
    K: NDArray[numpy.float64] | Any  # (3, 3); None for clouds and unknown cameras
    depth_unit: float  # meters per count
    has_color: bool
    warnings: list[str]  # one line each
    damaged: dict[int, str]  # frames found damaged on opening, and why; reading one raises Error


class Recording(Sequence):  # type: ignore[type-arg]
    """A recording of any format that planescope reads, as a sequence of frames.

    The files are never written to. Threads may share a recording.

    Attributes:
        on_error: "raise", or "skip" to leave out damaged frames in loops, slices and make_map().
        skipped: Damaged frames that loops and slices left out so far, and why.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        K: ArrayLike | None = None,
        depth_unit: float | None = None,
        color: bool = True,
        on_error: str = "raise",
    ):
        """Open a recording.

        Args:
            path: RealSense or ROS bag (1 and 2), folder of images, Viewer .raw, or cloud.
            K: Overrides the camera matrix in the files.
            depth_unit: Overrides the meters per count in the files.
            color: False reads only depth, which is faster.
            on_error: "raise" an Error at a damaged frame, or "skip" it in loops, slices and
                make_map(). The others keep their numbers, Frame.index.

        Raises:
            Error: The recording is missing, in an unknown format, or all of its frames are damaged.

        Example:
            >>> recording = ps.Recording("assets/sample")
            >>> len(recording), recording[-1].index
            (3, 2)
        """
        self._core: Any = _core.Recording(
            os.fsencode(path),
            None if K is None else intrinsics(K),
            None if depth_unit is None else numbers(depth_unit, "depth_unit", "a number"),
            bool(color),
        )
        if on_error not in ("raise", "skip"):
            raise Error(f"on_error: {on_error!r}; expected 'raise' or 'skip'")
        self.on_error = on_error
        self.skipped: dict[int, str] = {}

    @property
    def info(self) -> RecordingInfo:
        """Properties of the recording."""
        info: dict[str, Any] = self._core.info()
        info["path"] = os.fsdecode(info["path"])
        info["K"] = view(info["K"])
        info["damaged"] = {i: os.fsdecode(why) for i, why in info["damaged"].items()}
        return RecordingInfo(**info)

    def __len__(self) -> int:
        return int(self._core.size())

    @overload
    def __getitem__(self, i: int) -> Frame: ...

    @overload
    def __getitem__(self, i: slice) -> list[Frame]: ...

    def __getitem__(self, i: int | slice) -> Frame | list[Frame]:
        if isinstance(i, slice):
            return list(self._frames(range(*i.indices(len(self)))))
        try:
            k = operator.index(i)
        except TypeError:
            raise TypeError(f"frame {i!r}: expected a whole number or a slice") from None
        k = k + len(self) if k < 0 else k
        if not 0 <= k < len(self):
            raise IndexError(f"frame {i} is out of range; the recording has {len(self)} frames")
        return Frame._of(self._core.frame(k))

    def __iter__(self) -> Iterator[Frame]:
        return self._frames(range(len(self)))

    def _frames(self, numbers: range) -> Iterator[Frame]:
        for i in numbers:
            try:
                frame = self[i]
            except Error as error:
                if self.on_error == "raise":
                    raise
                self.skipped[i] = str(error)
            else:
                yield frame

    def __repr__(self) -> str:
        info = self.info
        return f"<planescope.Recording {info.path}: {info.format}, {len(self)} frames>"
