"""messages_test.py ROOT: the site's list of messages contains those that programs print, by subject."""

import subprocess
import sys
from pathlib import Path

root = Path(sys.argv[1])
listed = subprocess.run(
    [sys.executable, root / "docs/site/messages.py", root], check=True, capture_output=True, text=True
).stdout
sections = {part.split("\n")[0]: part for part in listed.split("\n### ")[1:]}
for section, message in [
    ("Recordings and clouds", "…: the recording contains no camera intrinsics…; …"),
    ("Recordings and clouds", "cannot be decompressed into the temporary folder"),
    ("Gravity and cameras", "gravity cannot be estimated from the scene"),
    ("The library, and Python", "depth image: no pixels"),
    ("The library, and Python", "K: …; expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]"),
    ("The library, and Python", "uint16 counts or float meters of shape (height, width)"),
    ("The command line", "--also needs -o DIR, the folder to write to"),
]:
    assert message in sections[section], f"{section}: {message}"
assert listed.count("\n- ") > 500, listed.count("\n- ")
assert "{" not in listed, [line for line in listed.splitlines() if "{" in line]
