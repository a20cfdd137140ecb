"""Output: planes and labels of a frame, and the decisions that led to them."""

from __future__ import annotations

import enum
import functools
import json
import operator
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

from ._arrays import np, same, view
from ._core import Error
from ._frames import Frame, Gravity
from ._planes import Flight, Kerb, Plane, Ramp, flight_of, of_json, plane_of

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    # For type checkers a result is a pair, so that `planes, labels = result` has types.
    _Pair = tuple[list[Plane], NDArray[numpy.int32]]
else:
    _Pair = Sequence

_FORMATS = ("geojson", "obj", "ply", "planar-terrain", "csv", "svg")


class Result(_Pair):
    """Planes of one frame. Unpacks as `planes, labels`.

    Planes and their outlines are computed on first use. Results are equal if their frames, planes
    and labels are equal. They can be pickled, including everything that their methods return.

    Example:
        >>> result = ps.segment(depth, K)
        >>> planes, labels = result
        >>> len(planes), labels.shape
        (10, (480, 640))
    """

    def __init__(self, core: Any, frame: Frame | None = None, parts: dict[str, Any] | None = None):
        self._core = core  # None: unpickled; everything is in `parts`
        self._frame = Frame._of(core.frame) if frame is None else frame
        self._parts = {} if parts is None else parts

    def _part(self, name: str) -> Any:
        if name not in self._parts:
            self._parts[name] = _PARTS[name](self)
        return self._parts[name]

    def __iter__(self) -> Iterator[Any]:
        return iter((self.planes, self.labels))

    def __len__(self) -> int:
        return 2

    def __getitem__(self, i: Any) -> Any:
        return (self.planes, self.labels)[i]

    @property
    def frame(self) -> Frame:
        """The frame that was segmented."""
        return self._frame

    @property
    def planes(self) -> list[Plane]:
        """Planes by id - 1."""
        return self._part("planes")  # type: ignore[no-any-return]

    @property
    def labels(self) -> NDArray[numpy.int32]:
        """Plane id of each pixel or point, in the frame's shape; 0: none."""
        return self._part("labels")  # type: ignore[no-any-return]

    @property
    def inclination(self) -> NDArray[numpy.uint8]:
        """Label of each pixel or point by the classifier: 0 none, 1 h, 2 v."""
        return self._part("inclination")  # type: ignore[no-any-return]

    @property
    def points(self) -> NDArray[numpy.float64]:
        """Position of each pixel or point in the world, (height, width, 3) or (n, 3); nan: none."""
        if self._core is None:
            return self._parts["points"]  # type: ignore[no-any-return]
        return view(self._core.points(list(self._frame.shape)))  # type: ignore[no-any-return]

    @property
    def gravity(self) -> Gravity:
        """Gravity used to find the planes."""
        return self._part("gravity")  # type: ignore[no-any-return]

    @property
    def T_world_sensor(self) -> NDArray[numpy.float64]:
        """Transform (4, 4) from the sensor's frame to the world, whose z points up."""
        return self._part("T_world_sensor")  # type: ignore[no-any-return]

    @property
    def flights(self) -> list[Flight]:
        """Flights of stairs."""
        return self._part("flights")  # type: ignore[no-any-return]

    @property
    def kerbs(self) -> list[Kerb]:
        """Single steps between large levels."""
        return self._part("kerbs")  # type: ignore[no-any-return]

    @property
    def ramps(self) -> list[Ramp]:
        """Slopes between levels."""
        return self._part("ramps")  # type: ignore[no-any-return]

    @property
    def floor(self) -> int | None:
        """Id of the floor, the origin of heights; None: no level plane is large enough."""
        return self._part("floor")  # type: ignore[no-any-return]

    @property
    def counts(self) -> dict[str, int]:
        """Number of points by outcome."""
        return dict(self._part("counts"))

    @property
    def timings(self) -> dict[str, float]:
        """Milliseconds by stage."""
        return dict(self._part("timings"))

    def mesh(self, id: int) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32]]:
        """Triangulate the outline of a plane.

        Args:
            id: Plane id.

        Returns:
            Vertices (n, 3) in the world, and triangles (m, 3) as indices of vertices.

        Raises:
            Error: There is no such plane.

        Example:
            >>> vertices, triangles = result.mesh(1)
            >>> triangles.shape[1]
            3
        """
        if self._core is not None:
            vertices, triangles = self._core.mesh(operator.index(id))
            return view(vertices), view(triangles)
        meshes: list[Any] = self._parts["meshes"]
        if not 1 <= id <= len(meshes):
            raise Error(f"plane {id} is out of range; expected 1 to {len(meshes)}")
        return meshes[id - 1]  # type: ignore[no-any-return]

    def json(self) -> str:
        """Export planes.json, byte for byte as `planescope segment` writes it.

        Returns:
            JSON (docs/formats.md).

        Example:
            >>> json.loads(result.json())["schema"]
            'planescope.planes/4'
        """
        return self._part("json")  # type: ignore[no-any-return]

    def text(self, format: str) -> str:
        """Export the planes in another format.

        Args:
            format: "geojson", "obj", "ply", "planar-terrain", "csv" or "svg".

        Returns:
            Contents of the file that `planescope segment --also FORMAT` writes.

        Raises:
            Error: The format is unknown.

        Example:
            >>> result.text("csv").splitlines()[0][:9]
            'id,label,'
        """
        if self._core is not None:
            return str(self._core.text(format))
        texts: dict[str, str] = self._parts["texts"]
        if format not in texts:
            raise Error(f"unknown format '{format}'; expected one of {', '.join(texts)}")
        return texts[format]

    def table(self) -> str:
        """Format the planes as a plain text table.

        Returns:
            A header and one line for each plane.

        Example:
            >>> print(result.table().splitlines()[0])
            id  label    tilt_deg  area_m2  height_m  rms_mm    pixels  margin
        """
        def number(value: float, width: int, digits: int) -> str:
            return f"{value:{width}.{digits}f}" if value == value else "-".rjust(width)

        unit = "points" if self._frame.is_cloud else "pixels"
        lines = [f"id  label    tilt_deg  area_m2  height_m  rms_mm  {unit:>8}  margin"]
        for plane in self.planes:
            lines.append(
                f"{plane.id:2}  {plane.label:7}{number(plane.tilt_deg, 10, 1)}"
                f"{plane.area_m2:9.2f}{number(plane.height_m, 10, 2)}{1000 * plane.rms_m:8.1f}"
                f"{plane.points:10}{plane.margin:8.1f}" + ("  undecided" if plane.undecided else "")
            )
        return "\n".join(lines) + "\n"

    def to_open3d(self) -> list[Any]:
        """Convert the planes to Open3D.

        Returns:
            One open3d.geometry.PointCloud per plane, by id - 1: its measurements in the world with
            the plane's normal, in the plane's color of planescope.plot.

        Raises:
            ImportError: Open3D or numpy is missing.

        Example:
            >>> clouds = result.to_open3d()  # doctest: +SKIP
        """
        import open3d

        from . import plot

        points, labels = self.points, self.labels
        clouds = []
        for plane in self.planes:
            xyz = points[labels == plane.id]
            cloud = open3d.geometry.PointCloud()
            cloud.points = open3d.utility.Vector3dVector(xyz)
            cloud.normals = open3d.utility.Vector3dVector(np.tile(plane.normal, (len(xyz), 1)))
            cloud.paint_uniform_color(plot.color_of(plane.id))
            clouds.append(cloud)
        return clouds

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Result):
            return NotImplemented
        return (
            self.frame == other.frame
            and self.json() == other.json()
            and same(self.labels, other.labels)
        )

    def __hash__(self) -> int:
        return hash((self.frame, self.json()))

    def __reduce__(self) -> tuple[Any, ...]:
        parts = {name: self._part(name) for name in _PARTS}
        parts["points"] = self.points
        parts["meshes"] = [self.mesh(plane.id) for plane in self.planes]
        parts["texts"] = {format: self.text(format) for format in _FORMATS}
        return Result, (None, self._frame, parts)

    def __repr__(self) -> str:
        return f"<planescope.Result: {len(self.planes)} planes>"


def _planes(result: Result) -> list[Plane]:
    facts = result._part("facts")["planes"]
    return [plane_of(core, fact) for core, fact in zip(result._core.planes(), facts)]


def _gravity(result: Result) -> Gravity:
    direction, source, confidence = result._core.gravity
    return Gravity(view(direction), source, confidence)


# Parts of a result, each computed from _core once.
_PARTS: dict[str, Any] = {
    "json": lambda result: result._core.json(),
    "facts": lambda result: json.loads(result.json()),
    "planes": _planes,
    "labels": lambda result: view(result._core.labels(list(result._frame.shape))),
    "inclination": lambda result: view(result._core.inclination(list(result._frame.shape))),
    "gravity": _gravity,
    "T_world_sensor": lambda result: view(result._core.T_world_sensor),
    "flights": lambda result: [flight_of(one) for one in result._part("facts")["flights"]],
    "kerbs": lambda result: [of_json(Kerb, one) for one in result._part("facts")["kerbs"]],
    "ramps": lambda result: [of_json(Ramp, one) for one in result._part("facts")["ramps"]],
    "floor": lambda result: result._part("facts")["floor"],
    "counts": lambda result: result._core.counts(),
    "timings": lambda result: result._core.timings(),
}


class EventType(enum.IntEnum):
    """Type of a decision, Trace.events["type"]."""

    VISIT = 0  # a node is taken from the queue
    DECIDE = 1  # a node is settled; value: e_n if it was computed
    FOUND = 2  # a node's candidate founds a plane
    MERGE = 3  # a node's candidate joins `plane`; value: |n . dmu| [m]
    ASSIGN = 4  # a leftover point is assigned to `plane`; value: distance [m]
    DROP = 5  # a leftover point remains unassigned
    REFINE = 6  # the objective joined, changed or dropped `plane`


class Trace:
    """Every decision of a segmentation: step k is the state after k events.

    Example:
        >>> trace = ps.Segmenter().trace(recording[0])
        >>> trace.describe(1)[:6]
        'node 0'
    """

    def __init__(self, core: Any, frame: Frame):
        self._core, self._frame = core, frame

    def __len__(self) -> int:
        """Number of steps."""
        return int(self._core.steps())

    @property
    def events(self) -> NDArray[numpy.void]:
        """Records with the fields type (EventType), case (1 to 4), stage (index into stages), label
        (1 h, 2 v), node (index into nodes), plane and other (in order of founding), point (voxel),
        value. -1: not applicable."""
        return view(self._core.events)  # type: ignore[no-any-return]

    @property
    def nodes(self) -> NDArray[numpy.void]:
        """Records, root first, with the fields parent, depth, case, voxels, voxels_h, corners (8, 3),
        and queued, visited and decided: the steps at which this happened; 2147483647: never."""
        return view(self._core.nodes)  # type: ignore[no-any-return]

    @property
    def stages(self) -> list[str]:
        """Names of stages: "criteria", "merge", "assign", and "join" to "list" for the objective."""
        return self._core.stages()  # type: ignore[no-any-return]

    def describe(self, step: int) -> str:
        """Describe the event that led to a step.

        Args:
            step: 1 to len(trace).

        Returns:
            One line.

        Raises:
            Error: There is no such step.

        Example:
            >>> trace.describe(602)
            'node 279 (800 points) creates P49'
        """
        return str(self._core.describe(operator.index(step)))

    @overload
    def plane_of(self, step: int) -> NDArray[numpy.int32]: ...

    @overload
    def plane_of(self, step: int, at: int | tuple[int, int]) -> int: ...

    def plane_of(self, step: int, at: Any = None) -> Any:
        """Return the planes of pixels or points at a step, numbered in order of founding.

        Args:
            step: 0 to len(trace).
            at: (row, column), or the index of a point. None: all pixels or points.

        Returns:
            An int or, without `at`, an array in the frame's shape; -1: none.

        Raises:
            Error: There is no such step, pixel or point.

        Example:
            >>> trace.plane_of(len(trace), (400, 320)) >= 0
            True
        """
        shape, step = self._frame.shape, operator.index(step)
        if at is None:
            return view(self._core.plane_of(step, list(shape)))
        place = (at,) if not isinstance(at, (tuple, list)) else tuple(at)
        try:
            if len(place) != len(shape):
                raise ValueError
            index = 0
            for k, size in zip(place, shape):
                if k != int(k) or not 0 <= k < size:
                    raise ValueError
                index = index * size + int(k)
        except (TypeError, ValueError):
            raise Error(f"at: {at!r}; expected a pixel or point in shape {shape}") from None
        return self._core.plane_at(step, index)

    def id_of(self, plane: int) -> int:
        """Find the final id of a plane.

        Args:
            plane: Number in order of founding.

        Returns:
            Id in Result.planes; 0: not in the result.

        Raises:
            Error: There is no such plane.

        Example:
            >>> trace.id_of(trace.plane_of(len(trace), (400, 320)))
            1
        """
        return int(self._core.id_of(operator.index(plane)))

    @functools.cached_property
    def result(self) -> Result:
        """The final planes."""
        return Result(self._core.result(), self._frame)
