"""Finding planes: a Segmenter for many frames, segment() and segment_cloud() for one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _core
from ._arrays import np
from ._core import Error
from ._frames import Frame, Gravity, vector
from ._results import Result, Trace

if TYPE_CHECKING:
    import numpy
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import Unpack

    from ._frames import Depth
    from ._options import Options, OptionsWithoutGravity


@dataclass(frozen=True)
class OptionInfo:
    """An option, with its values in both profiles as text."""

    name: str
    unit: str
    meaning: str
    section: str
    paper: str
    refined: str


def options() -> dict[str, OptionInfo]:
    """List the options, which are keywords of Segmenter, segment() and segment_cloud().

    Returns:
        Options by name.

    Example:
        >>> ps.options()["max_range_m"].refined
        '1.5'
    """
    return {row[0]: OptionInfo(*row) for row in _core.Options.all()}


class Segmenter:
    """Options and a classifier, ready to segment frames.

    Threads may share a segmenter: it releases the interpreter while it works. It can be pickled.
    """

    def __init__(
        self, profile: str = "refined", *, threads: int = 1, **options: Unpack[Options]
    ) -> None:
        """Set the options.

        Args:
            profile: "refined", or "paper" for the method as published.
            threads: Number of threads per frame. Results do not depend on it.
            **options: Options by name (docs/python.md, options()).

        Raises:
            Error: An option is unknown or its value invalid.

        Example:
            >>> segmenter = ps.Segmenter(max_range_m=2.5, foot_radius_m=0.08)
            >>> planes, labels = segmenter(depth, K)
        """
        self._profile, self._threads = profile, threads
        self._options: dict[str, Any] = {**options}
        core = _core.Options(profile)
        for name, value in options.items():
            core.set(name, _text(name, value))
        try:
            if threads != int(threads) or not 1 <= threads < 2**31:
                raise ValueError
        except (TypeError, ValueError):
            raise Error(f"threads: {threads!r}; expected 1 or more") from None
        self._core: Any = _core.Segmenter(core, int(threads))

    def __call__(
        self,
        depth: Depth | Frame,
        K: ArrayLike | None = None,
        *,
        depth_unit: float | None = None,
        gravity: ArrayLike | Gravity | str | None = None,
        distortion: ArrayLike | None = None,
        distortion_model: str = "brown_conrady",
        color: NDArray[numpy.uint8] | None = None,
        profile: str | None = None,
        threads: int | None = None,
        **options: Unpack[OptionsWithoutGravity],
    ) -> Result:
        """Find the planes of a depth image or a frame.

        Args:
            depth: As for Frame, or a Frame, which has K, unit, distortion and color of its own.
            K: As for Frame.
            depth_unit: As for Frame.
            gravity: As for Frame; overrides the gravity of a Frame. Also "none" (without h and v),
                "estimate" or "auto"; "imu" for frames of recordings.
            distortion: As for Frame.
            distortion_model: As for Frame.
            color: As for Frame.
            profile: Overrides the segmenter's, for this call.
            threads: Overrides the segmenter's, for this call.
            **options: Override the segmenter's, for this call.

        Returns:
            Planes and labels.

        Raises:
            Error: An argument is invalid, or gravity can be neither found nor estimated.

        Example:
            >>> planes, labels = ps.Segmenter()(depth, K, gravity=(0, 0.848, 0.53))
        """
        over: dict[str, Any] = dict(options)
        # The option `gravity` overrides the gravity of a frame.
        is_option = isinstance(gravity, str) or isinstance(depth, Frame)
        if gravity is not None and (is_option or "gravity" in self._options):
            over["gravity"], gravity = gravity, None
        if isinstance(depth, Frame):
            if any(given is not None for given in (K, depth_unit, distortion, color)):
                raise Error(
                    "segment: a Frame has its own K, depth_unit, distortion, and color; omit them"
                )
            frame = depth
        else:
            if K is None:
                raise Error("K: missing; expected a 3x3 matrix or fx, fy, cx, cy")
            frame = Frame(
                depth,
                K,
                depth_unit=depth_unit,
                gravity=gravity,
                distortion=distortion,
                distortion_model=distortion_model,
                color=color,
            )
        return self._with(profile, threads, over).segment(frame)

    def segment(self, frame: Frame) -> Result:
        """Find the planes of a frame.

        Args:
            frame: A depth image or cloud.

        Returns:
            Planes and labels.

        Raises:
            Error: The argument is not a Frame, or its gravity can be neither found nor estimated.

        Example:
            >>> results = [segmenter.segment(frame) for frame in recording]
        """
        return Result(self._core.segment(_core_of(frame)), frame)

    def segment_cloud(
        self,
        points: ArrayLike,
        *,
        gravity: ArrayLike | Gravity | str | None = None,
        profile: str | None = None,
        threads: int | None = None,
        **options: Unpack[OptionsWithoutGravity],
    ) -> Result:
        """Find the planes of a point cloud.

        Args:
            points: As for Frame.of_points().
            gravity: In the cloud's frame, or "none". None: -z.
            profile: Overrides the segmenter's, for this call.
            threads: Overrides the segmenter's, for this call.
            **options: Override the segmenter's, for this call.

        Returns:
            Planes, and labels in the shape of the points.

        Raises:
            Error: An argument is invalid.

        Example:
            >>> planes, labels = ps.Segmenter().segment_cloud(points)
        """
        over: dict[str, Any] = dict(options)
        if gravity is not None and (isinstance(gravity, str) or "gravity" in self._options):
            over["gravity"], gravity = gravity, None
        frame = Frame.of_points(points, gravity=gravity)
        return self._with(profile, threads, over).segment(frame)

    def trace(self, frame: Frame) -> Trace:
        """Find the planes of a frame and keep every decision.

        Args:
            frame: A depth image or cloud.

        Returns:
            The decisions and the result.

        Raises:
            Error: As for segment(), or the option `method` is not "ours".

        Example:
            >>> len(ps.Segmenter().trace(recording[0])) > 1000
            True
        """
        return Trace(self._core.trace(_core_of(frame)), frame)

    def _with(
        self, profile: str | None, threads: int | None, options: dict[str, Any]
    ) -> Segmenter:
        """Return the segmenter with some settings replaced."""
        if profile is None and threads is None and not options:
            return self
        return _segmenter_of(
            self._profile if profile is None else profile,
            self._threads if threads is None else threads,
            {**self._options, **options},
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return _segmenter_of, (self._profile, self._threads, self._options)

    def __repr__(self) -> str:
        others = "".join(f", {name}={value!r}" for name, value in self._options.items())
        return f"planescope.Segmenter({self._profile!r}, threads={self._threads}{others})"


def _segmenter_of(profile: str, threads: int, options: Any) -> Segmenter:
    return Segmenter(profile, threads=threads, **options)


def _core_of(frame: Any) -> Any:
    if not isinstance(frame, Frame):
        raise Error(f"frame: a {type(frame).__name__}; expected a planescope.Frame")
    return frame._core


def _text(name: str, value: Any) -> str:
    """Format an option's value for the registry."""
    if isinstance(value, bool) or (np is not None and isinstance(value, np.bool_)):
        return "on" if value else "off"
    if name == "gravity" and not isinstance(value, str):
        return ",".join(repr(part) for part in vector(value) or [])
    return str(value)


def segment(
    depth: Depth | Frame,
    K: ArrayLike | None = None,
    *,
    depth_unit: float | None = None,
    gravity: ArrayLike | Gravity | str | None = None,
    distortion: ArrayLike | None = None,
    distortion_model: str = "brown_conrady",
    color: NDArray[numpy.uint8] | None = None,
    profile: str = "refined",
    threads: int = 1,
    **options: Unpack[OptionsWithoutGravity],
) -> Result:
    """Find the planes of one depth image or frame. Use a Segmenter for many.

    Args:
        depth: As for Frame, or a Frame, which has K, unit, distortion and color of its own.
        K: As for Frame.
        depth_unit: As for Frame.
        gravity: As for Frame; overrides the gravity of a Frame. Also "none" (without h and v),
            "estimate" or "auto"; "imu" for frames of recordings.
        distortion: As for Frame.
        distortion_model: As for Frame.
        color: As for Frame.
        profile: As for Segmenter.
        threads: As for Segmenter.
        **options: As for Segmenter.

    Returns:
        Planes and labels.

    Raises:
        Error: An argument is invalid, or gravity can be neither found nor estimated.

    Example:
        >>> planes, labels = ps.segment(depth, K, gravity=(0, 0.848, 0.53))
        >>> planes[0].label
        'h'
    """
    return Segmenter(profile, threads=threads, **options)(
        depth,
        K,
        depth_unit=depth_unit,
        gravity=gravity,
        distortion=distortion,
        distortion_model=distortion_model,
        color=color,
    )


def segment_cloud(
    points: ArrayLike,
    *,
    gravity: ArrayLike | Gravity | str | None = None,
    profile: str = "refined",
    threads: int = 1,
    **options: Unpack[OptionsWithoutGravity],
) -> Result:
    """Find the planes of one point cloud.

    Args:
        points: As for Frame.of_points().
        gravity: In the cloud's frame, or "none". None: -z.
        profile: As for Segmenter.
        threads: As for Segmenter.
        **options: As for Segmenter.

    Returns:
        Planes, and labels in the shape of the points.

    Raises:
        Error: An argument is invalid.

    Example:
        >>> planes, labels = ps.segment_cloud(points)
        >>> len(planes)
        2
    """
    return Segmenter(profile, threads=threads, **options).segment_cloud(points, gravity=gravity)
