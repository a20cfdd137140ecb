"""Conversion of arrays: to and from numpy arrays if numpy is installed, memoryviews otherwise."""

from __future__ import annotations

import array as _array
import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._core import Array, Error

np: Any
try:
    import numpy as np
except ImportError:
    np = None

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    Floats = NDArray[numpy.float64]


def view(core: Any) -> Any:
    """View a _core.Array without copying it; return anything else unchanged."""
    if not isinstance(core, Array):
        return core
    return memoryview(core) if np is None else np.asarray(core)  # type: ignore[arg-type]


def floats(values: Any) -> Any:
    """Convert nested lists of numbers to an array of doubles."""
    if np is not None:
        return np.array(values, dtype=np.float64)
    return _doubles(values)


def _doubles(values: Any) -> memoryview:
    nested = _plain(values)
    shape, flat = _shape_of(nested), _flat(nested)
    bytes_view = memoryview(_array.array("d", flat)).cast("B")
    return bytes_view.cast("d", shape) if flat else bytes_view


def buffer(values: Any, what: str, expected: str) -> Any:
    """Convert an array or nested lists of numbers to an object whose memory _core can read."""
    try:
        memoryview(values)
        return values
    except (TypeError, ValueError, BufferError):
        if hasattr(values, "__array_interface__"):
            return values
    try:
        return _doubles(values) if np is None else np.asarray(values)
    except (TypeError, ValueError):
        raise Error(f"{what}: a {type(values).__name__}; expected {expected}") from None


def numbers(values: Any, what: str, expected: str, *shapes: tuple[int, ...]) -> Any:
    """Convert to a float or to nested lists of floats; raise Error unless it has one of the shapes."""
    try:
        if np is None:
            nested = _plain(values)
            shape = _shape_of(nested)
        else:
            array = np.asarray(values)
            if array.dtype.kind not in "fiu":
                raise ValueError
            shape, nested = array.shape, array.astype(float).tolist()
    except (TypeError, ValueError):
        shown = " ".join(repr(values).split())
        shown = shown if len(shown) <= 80 else shown[:80] + "..."
        raise Error(f"{what}: {shown}; expected {expected}") from None
    if shape not in (shapes or ((),)):
        raise Error(f"{what}: shape {shape}; expected {expected}")
    return nested


def transform(values: Any, what: str) -> list[float]:
    """Convert a 4x4 matrix to a list, row by row."""
    rows = numbers(values, what, "a 4x4 matrix", (4, 4))
    return [value for row in rows for value in row]


def _plain(values: Any) -> Any:
    """Convert numbers to a float or to nested lists of floats."""
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, Sequence) and not isinstance(values, (str, bytes)):
        return [_plain(value) for value in values]
    if isinstance(values, (str, bytes, bool)):
        raise ValueError("not a number")
    return float(values)


def _shape_of(nested: Any) -> tuple[int, ...]:
    if not isinstance(nested, list):
        return ()
    shapes = {_shape_of(value) for value in nested}
    if len(shapes) > 1:
        raise ValueError("rows of different lengths")
    return (len(nested), *(shapes.pop() if shapes else ()))


def _flat(nested: Any) -> list[float]:
    if not isinstance(nested, list):
        return [nested]
    return [number for value in nested for number in _flat(value)]


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal. Arrays are compared bit by bit; nan equals nan."""
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
    """Base of frozen dataclasses with array fields: equality and hash."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(same(a, b) for a, b in zip(_values(self), _values(other)))

    def __hash__(self) -> int:
        plain = (value for value in _values(self) if isinstance(value, (int, str)))
        return hash((type(self).__name__, *plain))


def _values(of: Any) -> list[Any]:
    return [getattr(of, field.name) for field in dataclasses.fields(of)]
