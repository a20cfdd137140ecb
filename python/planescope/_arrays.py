"""Arrays in and out, with or without numpy: numpy arrays where it is installed, else memoryviews."""

from __future__ import annotations

import array as _array
import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._core import Error

np: Any
try:
    import numpy as np
except ImportError:
    np = None

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    Floats = NDArray[numpy.float64]
    Ints = NDArray[numpy.int32]


def view(core: Any) -> Any:
    """A _core.Array, without copying it; anything else as it is."""
    if not hasattr(core, "__class__") or core.__class__.__name__ != "Array":
        return core
    return memoryview(core) if np is None else np.asarray(core)


def floats(values: Any) -> Any:
    """Nested lists of numbers as an array of doubles."""
    if np is not None:
        return np.array(values, dtype=np.float64)
    return _doubles(values)


def _doubles(values: Any) -> memoryview:
    shape, flat = _shape_of(values), _flat(values)
    bytes_view = memoryview(_array.array("d", flat)).cast("B")
    return bytes_view.cast("d", shape) if flat else bytes_view


def buffer(values: Any, what: str, expected: str) -> Any:
    """An object whose memory _core can read: any array, or nested lists of numbers."""
    try:
        memoryview(values)
        return values
    except (TypeError, ValueError, BufferError):
        if hasattr(values, "__array_interface__"):
            return values
    try:
        return _doubles(values) if np is None else np.asarray(values)
    except (TypeError, ValueError):
        raise Error(f"{what}: it is a {type(values).__name__}, expected {expected}") from None


def numbers(values: Any, what: str, expected: str, *shapes: tuple[int, ...]) -> Any:
    """Numbers as a float, or as nested lists of floats of one of these shapes."""
    if not shapes:
        shapes = ((),)
    shown = repr(values)
    try:
        if np is not None and not isinstance(values, (list, tuple, int, float)):
            values = np.asarray(values)
        if hasattr(values, "tolist"):
            values = values.tolist()
        shape = _shape_of(values)
        numbers = _flat(values)
        if any(isinstance(number, bool) for number in numbers):
            raise ValueError
        numbers = [float(number) for number in numbers]
    except (TypeError, ValueError, NotImplementedError):
        raise Error(f"{what}: it is {shown}, expected {expected}") from None
    if shape not in shapes:
        raise Error(f"{what}: it has shape {shape}, expected {expected}")
    return _nested(numbers, shape)


def transform(values: Any, what: str) -> list[float]:
    """A 4x4 matrix, row by row."""
    rows = numbers(values, what, "a 4x4 matrix", (4, 4))
    return [value for row in rows for value in row]


def _is_list(values: Any) -> bool:
    return isinstance(values, Sequence) and not isinstance(values, (str, bytes))


def _shape_of(values: Any) -> tuple[int, ...]:
    if not _is_list(values):
        return ()
    shapes = {_shape_of(value) for value in values}
    if len(shapes) > 1:
        raise ValueError("rows of different lengths")
    return (len(values), *(shapes.pop() if shapes else ()))


def _flat(values: Any) -> list[Any]:
    if not _is_list(values):
        if isinstance(values, (str, bytes)) or not hasattr(values, "__float__"):
            raise ValueError("no number")
        return [values]
    return [number for value in values for number in _flat(value)]


def _nested(numbers: list[float], shape: tuple[int, ...]) -> Any:
    if not shape:
        return numbers[0]
    step = len(numbers) // shape[0] if shape[0] else 0
    return [_nested(numbers[i * step : (i + 1) * step], shape[1:]) for i in range(shape[0])]


def same(a: Any, b: Any) -> bool:
    """Equal, arrays to the bit; nan equals nan."""
    if isinstance(a, float) and isinstance(b, float):
        return a == b or (math.isnan(a) and math.isnan(b))
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if hasattr(a, "tobytes") and hasattr(b, "tobytes"):
        return bool(a.shape == b.shape and a.itemsize == b.itemsize and a.tobytes() == b.tobytes())
    return type(a) is type(b) and bool(a == b)


class Values:
    """Equality of frozen dataclasses that have arrays among their fields."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(same(a, b) for a, b in zip(self._values(), other._values()))

    def __hash__(self) -> int:
        plain = (value for value in self._values() if isinstance(value, (int, str)))
        return hash((type(self).__name__, *plain))

    def _values(self) -> list[Any]:
        return [getattr(self, field.name) for field in dataclasses.fields(self)]  # type: ignore
