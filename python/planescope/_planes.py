"""Planes with their surface, certainty, and outline; stairs, kerbs, and ramps made of planes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ._arrays import Values, floats, np, numbers, view

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._arrays import Floats


@dataclass(frozen=True, eq=False)
class OutlinePart(Values):
    """Rings of corners, (n, 2) on a plane or (n, 3) in the world. The first is not repeated."""

    outer: Floats  # counterclockwise, seen against the normal
    holes: list[Floats]  # another surface was measured there, or through the plane
    unknown: list[Floats]  # nothing was measured there


@dataclass(frozen=True, eq=False)
class Outline(Values):
    """Region that a plane covers, as polygons on it: (x, y) is origin + x u + y v."""

    origin: Floats
    u: Floats
    v: Floats
    parts: list[OutlinePart]  # largest first
    area_m2: float  # without holes and unknown areas

    def world(self, ring: ArrayLike) -> Floats:
        """Convert corners on the plane to the world.

        Args:
            ring: (n, 2).

        Returns:
            (n, 3).

        Raises:
            Error: The corners have the wrong shape.

        Example:
            >>> outline = planes[0].outline
            >>> outline.world(outline.parts[0].outer).shape[1]
            3
        """
        if np is not None:
            corners: Any = np.asarray(ring, dtype=float)
            if corners.ndim == 2 and corners.shape[1] == 2:
                placed: Floats = self.origin + corners[:, :1] * self.u + corners[:, 1:] * self.v
                return placed
        corners = numbers(ring, "ring", "corners of shape (n, 2)", (len(ring), 2))  # type: ignore
        axes: Any = list(zip(self.origin, self.u, self.v))
        world: Floats = floats([[o + x * u + y * v for o, u, v in axes] for x, y in corners])
        return world


@dataclass(frozen=True, eq=False)
class Surface(Values):
    """Slope and roughness of a plane's surface (docs/footholds.md)."""

    slope_deg: float | None  # None: gravity is unknown
    rough_rms_m: float  # RMS height about the plane
    rough_step_m: float  # largest step between neighbors
    support: float  # share of the outline that was measured
    best_place: Floats  # center of the largest circle within the outline, world
    clearance_m: float  # radius of that circle


@dataclass(frozen=True, eq=False)
class Certainty(Values):
    """Uncertainty of a plane's fit (docs/footholds.md)."""

    sigma_m: float  # of the voxels' distances from the plane
    eigenvalues_m2: Floats  # of their scatter, ascending
    axes: Floats  # (2, 3): unit vectors in the plane, longest extent first
    tilt_sigma_deg: Floats  # of the normal toward each axis
    offset_sigma_m: float  # along the normal at the centroid
    covariance: Floats  # (3, 3): tilt toward each axis [rad], offset [m]


@dataclass(frozen=True, eq=False)
class Foothold(Values):
    """Area for the center of a foot. Requires the option `foot_radius_m`."""

    steppable: bool
    why_not: str  # empty if steppable
    area_m2: float  # size of the area
    area: list[OutlinePart]  # rings (n, 3) in the world
    pieces: list[Floats]  # the area as convex polygons (n, 3)


@dataclass(frozen=True, eq=False)
class Plane(Values):
    """A plane in the world frame. Its normal points up (h) or toward the sensor (v).

    Example:
        >>> floor = planes[0]
        >>> floor.label, round(floor.tilt_deg, 1), floor.surface.support > 0.9
        ('h', 0.7, True)
    """

    id: int  # from 1; value in Result.labels
    label: str  # "h": within 45 degrees of level; "v"; "unknown" without gravity
    normal: Floats
    centroid: Floats
    offset_m: float  # normal . x of its points
    tilt_deg: float  # 0: floor, 90: wall; nan without gravity
    points: int  # measurements on it
    voxels: int
    rms_m: float  # RMS distance of its measurements
    area_m2: float  # of the cells that contain points
    margin: float  # how far it is from being lost or joined with a larger neighbor; inf: unknown
    undecided: bool  # the margin is below the threshold
    hull: Floats = field(repr=False)  # (n, 3), convex
    outline: Outline = field(repr=False)
    height_m: float  # above the floor; nan if not level
    steppable: bool  # whether a foot can stand here; requires the option foot_radius_m
    why_not: str  # empty if steppable
    surface: Surface = field(repr=False)
    certainty: Certainty = field(repr=False)
    foothold: Foothold | None = field(repr=False)  # None without foot_radius_m


@dataclass(frozen=True, eq=False)
class Step(Values):
    """One step of a flight. Planes are ids."""

    tread: list[int]  # behind the nosing, largest first; empty: not visible, or a minor plane
    riser: int | None
    rise_m: float
    going_m: float | None  # from the nosing below; None for the first
    nosing: Floats  # (2, 3): right and left end, looking uphill


@dataclass(frozen=True, eq=False)
class Flight(Values):
    """A flight of stairs (docs/stairs.md)."""

    direction: str | None  # "up" or "down" from the sensor; None for clouds
    rise_m: float  # mean
    going_m: float | None  # mean
    width_m: float  # visible part
    uphill: Floats  # unit, level
    landing: bool  # the last tread is a landing
    foot: list[int]  # planes before the first riser
    steps: list[Step]  # lowest first


@dataclass(frozen=True, eq=False)
class Kerb(Values):
    """A single step between two large levels."""

    rise_m: float
    width_m: float
    uphill: Floats
    lower: list[int]
    upper: list[int]
    riser: int | None
    nosing: Floats


@dataclass(frozen=True, eq=False)
class Ramp(Values):
    """A slope between two levels, one of which may be invisible."""

    plane: int
    slope_deg: float
    rise_m: float
    run_m: float
    width_m: float  # visible part
    uphill: Floats
    lower: list[int]
    upper: list[int]


def of_json(kind: type, values: dict[str, Any], **others: Any) -> Any:
    """Make a dataclass from its JSON object. Fields of type Floats become arrays; other keys are ignored."""
    made = dict(others)
    for name, declared in kind.__annotations__.items():
        if name not in made:
            value = values[name]
            made[name] = floats(value) if declared == "Floats" else value
    return kind(**made)


def _foothold(values: dict[str, Any] | None) -> Foothold | None:
    if values is None:
        return None
    area = [
        OutlinePart(floats(part["outer"]), [floats(hole) for hole in part["holes"]], [])
        for part in values["area"]
    ]
    pieces = [floats(piece) for piece in values["pieces"]]
    made: Foothold = of_json(
        Foothold, values, area=area, pieces=pieces, why_not=values["why_not"] or ""
    )
    return made


def plane_of(core: dict[str, Any], facts: dict[str, Any]) -> Plane:
    """Make a plane from _core's fields and from its object in planes.json."""
    core = {name: view(value) for name, value in core.items()}
    outline = {name: view(value) for name, value in core.pop("outline").items()}
    parts = [
        OutlinePart(
            view(part["outer"]),
            [view(ring) for ring in part["holes"]],
            [view(ring) for ring in part["unknown"]],
        )
        for part in outline.pop("parts")
    ]
    return Plane(
        outline=Outline(parts=parts, **outline),
        surface=of_json(Surface, facts["surface"]),
        certainty=of_json(Certainty, facts["certainty"]),
        foothold=_foothold(facts.get("foot")),
        **core,
    )


def flight_of(values: dict[str, Any]) -> Flight:
    """Make a flight from its object in planes.json."""
    steps = [of_json(Step, step) for step in values["steps"]]
    made: Flight = of_json(Flight, values, steps=steps)
    return made
