"""options_test.py FILE [--write]: FILE, planescope/_options.py, has the options of the registry, as types."""

import sys
from pathlib import Path

from planescope import _core

HEAD = '''"""Options as a typed dictionary: written by tests/python/options_test.py from the registry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._frames import Gravity


class Options(TypedDict, total=False):
    """Keywords of Segmenter, segment(), segment_cloud(), make_map() and Mapper.

    Example:
        >>> options: ps.Options = {"max_range_m": 2.5, "foot_radius_m": 0.08}
        >>> planes, labels = ps.segment(depth, K, **options)
    """

'''


def type_of(name, unit, default):
    if name == "gravity":
        return "ArrayLike | Gravity | str"
    if unit == "on/off":
        return "bool"
    if "/" in unit:
        choices = unit.split("/")
        # A file is any text.
        return "str" if "FILE" in choices else "Literal[" + ", ".join(f'"{c}"' for c in choices) + "]"
    # Whole numbers are counts.
    return "int" if unit in ("points", "levels", "tries") or name == "ransac_seed" else "float"


def text():
    lines = [HEAD.rstrip("\n"), ""]
    for name, unit, meaning, section, paper, refined in _core.Options.all():
        if name == "profile":  # an argument of its own
            continue
        shown = f" [{unit}]" if "/" not in unit and unit not in ("", "1") else ""
        sentence = meaning[0].upper() + meaning[1:] if not meaning.startswith("e_n") else meaning
        lines += [f"    # {sentence}{shown}", f"    {name}: {type_of(name, unit, refined)}"]
    return "\n".join(lines) + "\n"


file = Path(sys.argv[1])
if sys.argv[2:] == ["--write"]:
    file.write_text(text())
elif file.read_text() != text():
    sys.exit(f"{file}: differs from the option registry; run {sys.argv[0]} {file} --write")
