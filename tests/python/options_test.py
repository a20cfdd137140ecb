"""options_test.py FILE [--write]: FILE (planescope/_options.py) declares the types of all registered options.

--write generates it.
"""

import importlib.util
import sys
from pathlib import Path

# Import _core without the package, which needs FILE.
sys.path += importlib.util.find_spec("planescope").submodule_search_locations
import _core  # noqa: E402

HEAD = '''"""Options as a typed dictionary, generated from the registry by tests/python/options_test.py."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._frames import Gravity


class OptionsWithoutGravity(TypedDict, total=False):
    """Options of segment() and segment_cloud(), which have a separate argument `gravity`.

    Example:
        >>> options: ps.OptionsWithoutGravity = {"max_range_m": 2.5, "foot_radius_m": 0.08}
        >>> planes, labels = ps.segment(depth, K, **options)
    """

'''

TAIL = '''

class Options(OptionsWithoutGravity, total=False):
    """Keywords of Segmenter, make_map() and Mapper.

    Example:
        >>> options: ps.Options = {"gravity": "imu", "theta_n_in": 10}
        >>> segmenter = ps.Segmenter(**options)
    """

'''


def type_of(name, unit, default):
    if name == "gravity":
        return "ArrayLike | Gravity | str"
    if unit == "on/off":
        return "bool"
    if "/" in unit:
        choices = unit.split("/")
        # A file can be any text.
        return "str" if "FILE" in choices else "Literal[" + ", ".join(f'"{c}"' for c in choices) + "]"
    # Counts are whole numbers.
    return "int" if unit in ("points", "levels", "tries") or name == "ransac_seed" else "float"


def text():
    rows, tail = [], ""
    for name, unit, meaning, _section, _paper, refined in _core.Options.all():
        shown = f" [{unit}]" if "/" not in unit and unit not in ("", "1") else ""
        sentence = meaning if meaning.startswith("e_n") else meaning[0].upper() + meaning[1:]
        row = f"    # {sentence}{shown}\n    {name}: {type_of(name, unit, refined)}\n"
        if name == "gravity":
            tail = TAIL + row
        elif name != "profile":  # a separate argument
            rows.append(row)
    return HEAD + "".join(rows) + tail


file = Path(sys.argv[1])
if sys.argv[2:] == ["--write"]:
    file.write_text(text())
elif file.read_text() != text():
    sys.exit(f"{file}: differs from the option registry; run {sys.argv[0]} {file} --write")
