"""tour_test.py DOCUMENT...: runs the examples in documents as readers would type them, and compares the output.

Lines that begin with >>> are one Python session. Lines that begin with $ in a block of ```console are one shell
session in an empty folder, with `planescope` in the path; > continues a command. In the expected output, ... matches
any text. A failing command must be followed by `echo $?`. Other blocks are not run.
"""

import doctest
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
NO_RENDERER = 3  # the exit code of planescope without OpenGL


def run_python(document):
    """(examples, failures)"""
    test = doctest.DocTestParser().get_doctest(
        # The end of a block is not output.
        document.read_text().replace("\n```", "\n\n"), {}, document.name, str(document), 0
    )
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    runner.run(test)
    result = runner.summarize()
    return result.attempted, result.failed


def shell_examples(text):
    """Commands of a document: (line, command, expected output)."""
    examples = []
    for block in re.finditer(r"^```console\n(.*?)^```$", text, re.M | re.S):
        line = text.count("\n", 0, block.start()) + 2
        for at, row in enumerate(block[1].splitlines(), line):
            if row.startswith("$ "):
                examples.append([at, row[2:], ""])
            elif row.startswith("> ") and not examples[-1][2]:
                examples[-1][1] += "\n" + row[2:]
            else:
                examples[-1][2] += row + "\n"
    return examples


def run_shell(document):
    """(examples, failures)"""
    examples = shell_examples(document.read_text())
    with tempfile.TemporaryDirectory() as folder:
        here, work = Path(folder), Path(folder, "work")
        (here / "bin").mkdir()
        work.mkdir()
        (here / "bin/planescope").symlink_to(os.environ["PLANESCOPE_PROGRAM"])
        script = ""
        for i, (_, command, _) in enumerate(examples):
            script += f"{{ {command}\n}} >{here}/{i}.out 2>&1; s=$?; echo $s >{here}/{i}.code; (exit $s)\n"
        environment = os.environ | {"PATH": f"{here}/bin:{os.environ['PATH']}", "HOME": folder}
        subprocess.run(["bash", "-c", script], cwd=work, env=environment, stdin=subprocess.DEVNULL, check=False)
        failures = 0
        for i, (line, command, expected) in enumerate(examples):
            printed = (here / f"{i}.out").read_text()
            code = int((here / f"{i}.code").read_text())
            if code == NO_RENDERER:
                print(f"{document.name}:{line}: skipped, no renderer: {command}")
                continue
            shown = i + 1 < len(examples) and examples[i + 1][1] == "echo $?"
            if doctest.OutputChecker().check_output(expected, printed, FLAGS) and (code == 0 or shown):
                continue
            failures += 1
            print(f"{document.name}:{line}: {command}\nexpected:\n{expected}printed (exit code {code}):\n{printed}")
    return len(examples), failures


failed = 0
for document in map(Path, sys.argv[1:]):
    document = document.resolve()
    python, shell = run_python(document), run_shell(document)
    failed += python[1] + shell[1]
    if python[0] + shell[0] < 8:
        sys.exit(f"{document.name}: only {python[0] + shell[0]} examples were found")
sys.exit(failed > 0)
