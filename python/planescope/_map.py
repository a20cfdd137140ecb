"""Maps from moving cameras: of a whole recording, or of frames as they arrive."""

from __future__ import annotations

import functools
import json
import operator
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from . import _core
from ._arrays import Values, floats, numbers, same, transform, view
from ._core import Error
from ._frames import Frame, Recording
from ._planes import OutlinePart, of_json
from ._results import Result
from ._segment import Segmenter

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._arrays import Floats
    from ._options import Options


@dataclass(frozen=True, eq=False)
class MapPlane(Values):
    """A plane of the world, fused from all frames that saw it."""

    track: int
    label: str  # "h", "v" or "unknown"
    state: str  # "alive"; "gone": removed from the scene; "left": outside the window
    segment: int  # segment of the map; each has its own world
    normal: Floats
    centroid: Floats
    offset_m: float  # normal . x of its points
    sigma_offset_m: float
    sigma_tilt_deg: float
    rms_m: float
    area_m2: float
    frames_seen: int
    frames_missed: int  # visible but not found
    frames_undecided: int  # seen, but its plane was undecided
    parts: list[OutlinePart] = field(repr=False)  # rings of (n, 3) corners in the world


class Map:
    """Planes of the world, poses of the camera, and the tracks that connect the planes of frames.

    Maps are equal if their files are equal. They can be pickled.

    Attributes:
        json: map.json, byte for byte as `planescope map` writes it.
        tracks_json: tracks.json.
        poses_tum: poses.tum.
        T_world_camera: (4, 4) by frame, for the frames with a known pose.
        warnings: One line each.
        planes_png: planes/000000.png by frame: 16 bits, with the plane id per pixel that
            `track_of_plane` uses. Empty for a Mapper and for methods that do not find planes on
            pixels.

    Example:
        >>> made = ps.make_map(recording, poses=poses)
        >>> sorted(made.T_world_camera)
        [0, 1, 2]
    """

    def __init__(self, core: tuple[bytes, bytes, bytes, list[int], Any, list[str], dict[int, bytes]]):
        map_json, tracks_json, poses_tum, frames, T, warnings, planes_png = core
        self.json = map_json.decode()
        self.tracks_json = tracks_json.decode()
        self.poses_tum = poses_tum.decode()
        poses: list[Floats] = [floats(pose) for pose in view(T).tolist()]
        self.T_world_camera: dict[int, Floats] = dict(zip(frames, poses))
        self.warnings = warnings
        self.planes_png = planes_png

    @functools.cached_property
    def planes(self) -> list[MapPlane]:
        """Planes, largest first, followed by those that are gone."""
        return [
            of_json(
                MapPlane,
                plane,
                parts=[
                    OutlinePart(floats(part["outer"]), [floats(h) for h in part["holes"]], [])
                    for part in plane["outline"]
                ],
                **{f"frames_{kind}": plane["frames"][kind] for kind in ("seen", "missed", "undecided")},
            )
            for plane in json.loads(self.json)["planes"]
        ]

    @property
    def stability(self) -> dict[str, float | None]:
        """Measures of the planes' stability over time: docs/map.md."""
        return json.loads(self.json)["stability"]  # type: ignore[no-any-return]

    @functools.cached_property
    def tracks(self) -> list[dict[str, Any]]:
        """Tracks as in tracks.json: the frames in which each was seen, and reasons for gaps."""
        return json.loads(self.tracks_json)["tracks"]  # type: ignore[no-any-return]

    @functools.cached_property
    def track_of_plane(self) -> dict[int, list[int]]:
        """Tracks of each frame's planes, by plane id - 1; 0: none."""
        frames = json.loads(self.tracks_json)["frames"]
        return {frame["frame"]: frame["track_of_plane"] for frame in frames}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Map):
            return NotImplemented
        names = ("json", "tracks_json", "poses_tum", "planes_png", "warnings")
        return all(same(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        return hash(self.json)

    def __repr__(self) -> str:
        return f"<planescope.Map: {len(self.planes)} planes of {len(self.track_of_plane)} frames>"


def make_map(
    recording: Recording,
    *,
    poses: str | os.PathLike[str] | ArrayLike | Mapping[int, ArrayLike] | None = None,
    frames: Sequence[int] | None = None,
    window_m: float = 0,
    profile: str = "refined",
    threads: int = 1,
    **options: Unpack[Options],
) -> Map:
    """Track the planes of a recording and fuse them into a map.

    Args:
        recording: Depth images. With on_error="skip", damaged frames are skipped and reported in
            Map.warnings.
        poses: T_world_camera (camera axes: x right, y down, z forward): an array (n, 4, 4) with one
            pose for each frame of the map; a mapping from frames to (4, 4), like
            Map.T_world_camera; or a file (TUM, KITTI, Open3D's .log or .json). None: the
            recording's own poses or, without any, odometry.
        frames: Frame numbers, ascending. None: all.
        window_m: Edge of the map's cube around the camera; 0: unlimited.
        profile: As for Segmenter.
        threads: As for Segmenter.
        **options: As for Segmenter.

    Returns:
        The map, in a world whose z points up.

    Raises:
        Error: An argument is invalid, no frame has a pose, or a frame is damaged.

    Example:
        >>> made = ps.make_map(recording, poses=poses, window_m=6)
        >>> floors = [plane for plane in made.planes if plane.label == "h"]
    """
    if not isinstance(recording, Recording):
        raise Error(f"recording: a {type(recording).__name__}; expected a planescope.Recording")
    chosen: Sequence[int] = range(len(recording))
    if frames is not None:
        try:
            chosen = [operator.index(frame) for frame in frames]
        except TypeError:
            chosen = []
        if not chosen:
            raise Error(f"frames: {frames!r}; expected at least one whole number")
    file, by_frame = b"", {}
    if isinstance(poses, (str, os.PathLike)):
        file = os.fsencode(poses)
        if not file:
            raise Error("poses: ''; expected a file")
    elif isinstance(poses, Mapping):
        by_frame = {int(k): transform(pose, f"pose of frame {k}") for k, pose in poses.items()}
        if not by_frame:
            raise Error("poses: none; expected one for each frame")
    elif poses is not None:
        expected = f"({len(chosen)}, 4, 4), a pose for each frame"
        rows = numbers(poses, "poses", expected, (len(chosen), 4, 4))
        by_frame = {k: transform(pose, f"pose of frame {k}") for k, pose in zip(chosen, rows)}
    made = _core.make_map(
        recording._core,
        Segmenter(profile, threads=threads, **options)._core,
        file,
        numbers(window_m, "window_m", "a number"),
        [] if frames is None else list(chosen),
        by_frame,
        recording.on_error == "skip",
    )
    return Map(made)


@dataclass(frozen=True, eq=False)
class MappedFrame(Values):
    """A frame added by a Mapper."""

    result: Result
    tracks: list[int]  # by plane id - 1; 0: none
    T_world_camera: Floats  # (4, 4), aligned with the map so far
    set_aside: bool  # depth and pose do not fit the map; the map ignores the frame


class Mapper:
    """A map of frames as they arrive.

    Earlier frames help to find the planes of later ones. Threads take turns.
    """

    def __init__(
        self,
        *,
        window_m: float = 0,
        profile: str = "refined",
        threads: int = 1,
        **options: Unpack[Options],
    ) -> None:
        """Start an empty map.

        Args:
            window_m: As for make_map(). Set it for a robot that keeps moving.
            profile: As for Segmenter.
            threads: As for Segmenter.
            **options: As for Segmenter.

        Raises:
            Error: An argument is invalid.

        Example:
            >>> mapper = ps.Mapper(window_m=6)
        """
        segmenter = Segmenter(profile, threads=threads, **options)
        self._core: Any = _core.Mapper(segmenter._core, numbers(window_m, "window_m", "a number"))

    def add(self, frame: Frame, pose: ArrayLike) -> MappedFrame:
        """Find the planes of a frame and match them to the map.

        Args:
            frame: A depth image.
            pose: (4, 4), T_world_camera in a world whose z points up; camera axes: x right, y down,
                z forward.

        Returns:
            The planes and their tracks.

        Raises:
            Error: The frame is a cloud, the pose is not rigid, or the first frame clearly shows that
                z does not point up.

        Example:
            >>> added = ps.Mapper().add(recording[0], poses[0])
            >>> len(added.tracks) == len(added.result.planes)
            True
        """
        if not isinstance(frame, Frame):
            raise Error(f"frame: a {type(frame).__name__}; expected a planescope.Frame")
        core, tracks, T, set_aside = self._core.add(frame._core, transform(pose, "pose"))
        return MappedFrame(Result(core), tracks, view(T), set_aside)

    def __len__(self) -> int:
        """Number of frames so far."""
        return int(self._core.size())

    def map(self) -> Map:
        """Export the map of all frames so far, numbered in the order of add().

        Returns:
            The map.

        Raises:
            Error: There are no frames.

        Example:
            >>> mapper = ps.Mapper()
            >>> for pose in poses:
            ...     added = mapper.add(recording[0], pose)
            >>> mapper.map()
            <planescope.Map: 10 planes of 3 frames>
        """
        return Map(self._core.map())
