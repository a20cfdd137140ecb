"""Find planes in depth images and point clouds (Sun et al. 2023).

Lengths are in meters, angles in degrees. The sensor's frame is that of cameras: x right, y down, z
forward. In the world, z points up and the sensor is at the origin (of a cloud: the cloud's origin).

Array arguments can be any object with the buffer protocol or `__array_interface__`. Results are numpy
arrays if numpy is installed, and memoryviews otherwise. Invalid input raises Error, a ValueError, with
a message of one line.

Example:
    >>> planes, labels = ps.segment(depth, K)
"""

from ._core import Error, __version__
from ._frames import Frame, Gravity, Recording, RecordingInfo
from ._map import Map, MappedFrame, MapPlane, Mapper, make_map
from ._options import Options, OptionsWithoutGravity
from ._planes import (
    Certainty,
    Flight,
    Foothold,
    Kerb,
    Outline,
    OutlinePart,
    Plane,
    Ramp,
    Step,
    Surface,
)
from ._results import EventType, Result, Trace
from ._segment import OptionInfo, Segmenter, options, segment, segment_cloud

__all__ = [
    "Certainty",
    "Error",
    "EventType",
    "Flight",
    "Foothold",
    "Frame",
    "Gravity",
    "Kerb",
    "Map",
    "MapPlane",
    "MappedFrame",
    "Mapper",
    "OptionInfo",
    "Options",
    "OptionsWithoutGravity",
    "Outline",
    "OutlinePart",
    "Plane",
    "Ramp",
    "Recording",
    "RecordingInfo",
    "Result",
    "Segmenter",
    "Step",
    "Surface",
    "Trace",
    "__version__",
    "make_map",
    "options",
    "segment",
    "segment_cloud",
]
