"""Pictures of results with matplotlib, which is imported on first use.

Example:
    >>> from planescope import plot
    >>> axes = plot.overlay(result)
    >>> axes.figure.savefig(out / "overlay.png")
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._core import Error
from ._results import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["color_of", "overlay", "scene"]

# Ten colors that most people can distinguish (Tableau).
_COLORS = ("1f77b4", "ff7f0e", "2ca02c", "d62728", "9467bd", "8c564b", "e377c2", "bcbd22", "17becf", "7f7f7f")


def color_of(id: int) -> tuple[float, float, float]:
    """Return the color of a plane.

    Args:
        id: Plane id, from 1.

    Returns:
        Red, green and blue, 0 to 1.

    Example:
        >>> plot.color_of(1)[2] > 0.7
        True
    """
    digits = _COLORS[(id - 1) % len(_COLORS)]
    red, green, blue = (int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue


def overlay(result: Result, ax: Axes | None = None, *, alpha: float = 0.5) -> Axes:
    """Draw the planes over the color image or, without one, over shaded depth.

    Args:
        result: Result of a depth image.
        ax: Axes to draw into. None: new axes.
        alpha: Opacity of the planes.

    Returns:
        The axes.

    Raises:
        Error: The result belongs to a cloud.
        ImportError: matplotlib or numpy is missing.

    Example:
        >>> axes = plot.overlay(result, alpha=0.7)
    """
    import numpy as np
    from matplotlib import pyplot

    frame = result.frame
    depth = frame.depth
    if depth is None:
        raise Error("overlay: the result belongs to a cloud; expected a depth image; use scene()")
    axes: Any = pyplot.subplots()[1] if ax is None else ax
    if frame.color is not None and frame.color_is_aligned:
        axes.imshow(frame.color)
    else:
        axes.imshow(np.where(depth == 0, np.nan, depth * frame.depth_unit), cmap="gray_r")
    labels = result.labels
    colors = np.zeros((*labels.shape, 4))
    for plane in result.planes:
        pixels = labels == plane.id
        if not pixels.any():
            continue
        colors[pixels] = (*color_of(plane.id), alpha)
        row, column = (int(np.median(place)) for place in np.nonzero(pixels))
        axes.text(column, row, str(plane.id), color="white", ha="center", va="center")
    axes.imshow(colors)
    axes.set_axis_off()
    return axes


def scene(result: Result, ax: Axes | None = None, *, points: int = 20000) -> Axes:
    """Draw the measurements in space, in the colors of their planes.

    Args:
        result: Result of a depth image or cloud.
        ax: 3D axes to draw into. None: new axes.
        points: Maximum number of points to draw.

    Returns:
        The axes.

    Raises:
        ImportError: matplotlib or numpy is missing.

    Example:
        >>> axes = plot.scene(result, points=5000)
    """
    import numpy as np
    from matplotlib import pyplot

    axes: Any = pyplot.figure().add_subplot(projection="3d") if ax is None else ax
    labels = result.labels.reshape(-1)
    xyz = result.points.reshape(-1, 3)
    measured = np.flatnonzero(np.isfinite(xyz[:, 0]))
    drawn = measured[:: max(1, -(-len(measured) // max(1, points)))]
    palette = np.array([(0.8, 0.8, 0.8), *(color_of(plane.id) for plane in result.planes)])
    axes.scatter(*xyz[drawn].T, c=palette[labels[drawn]], s=2, linewidths=0, depthshade=False)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    spans = np.ptp(xyz[drawn], axis=0) if len(drawn) else np.ones(3)
    axes.set_box_aspect(np.maximum(spans, 1e-3))
    return axes
