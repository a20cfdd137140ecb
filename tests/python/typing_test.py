"""typing_test.py DOCUMENT EXAMPLES: mypy accepts the package, the examples, and a document's lines after >>>."""

import doctest
import importlib.metadata
import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

if not importlib.util.find_spec("mypy"):
    print("mypy is not installed")
    sys.exit(77)
document, examples = Path(sys.argv[1]), Path(sys.argv[2])
package = importlib.util.find_spec("planescope").submodule_search_locations[0]
code = "".join(example.source for example in doctest.DocTestParser().get_examples(document.read_text().replace("\n```", "\n\n")))
version = tuple(map(int, importlib.metadata.version("mypy").split(".")[:2]))
# Incorrect uses, each with mypy's message.
wrong = {
    "ps.segment(np.zeros((2, 2), np.int64), K)": "incompatible type",
    "ps.segment(depth, K, theta_n_ou=3)": 'Unexpected keyword argument "theta_n_ou"',
    'ps.segment(depth, K, mse_normalization="mode")': "incompatible type",
    "planes.append(labels)": "incompatible type",
    "planes[0].surface.slope": "has no attribute",
}


def mypy(*files):
    # Only documents assign names twice.
    flags = ["--strict", "--ignore-missing-imports", "--allow-redefinition", "--no-warn-unused-ignores"]
    if version < (1, 7):
        flags.append("--enable-incomplete-feature=Unpack")
    with tempfile.TemporaryDirectory() as cache:
        ran = subprocess.run(
            [sys.executable, "-m", "mypy", *flags, "--cache-dir", cache, *map(str, files)],
            capture_output=True, text=True, env={"MYPYPATH": str(Path(package).parent), "PATH": "/usr/bin:/bin"},
        )  # fmt: skip
    return ran.returncode, ran.stdout + ran.stderr


with tempfile.TemporaryDirectory() as folder:
    typed, misused = Path(folder) / "tour.py", Path(folder) / "misused.py"
    typed.write_text(code)
    status, said = mypy(package, typed, *sorted(examples.glob("*.py")))
    assert status == 0, said
    head = "import numpy as np\nimport planescope as ps\nrecording = ps.Recording('.')\ndepth, K = recording[0].depth, recording[0].K\n"
    head += "planes, labels = ps.segment(depth, K)\n"
    misused.write_text(head + "\n".join(wrong) + "\n")
    status, said = mypy(misused)
    for message in wrong.values():
        assert message in said, f"expected {message!r}: {said}"
    assert said.count("error:") == len(wrong), said
