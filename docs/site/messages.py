"""messages.py ROOT: print every message in the sources as Markdown, by topic.

Messages are the arguments of the calls in CALLS, and other texts that match WRONG. String literals are joined, and
values that are filled in at run time become an ellipsis.
"""

import re
import sys
from pathlib import Path

# Calls with a message for the user.
CALLS = re.compile(r"\b(?:Error|DrawingFailed|FrameRefused|fail|fail_kind|notice|warn|warnings\.(?:push|emplace)_back)\(")

# Texts that become part of a message elsewhere.
WRONG = re.compile(
    r"\b(?:expected|cannot|could not|is not|are not|is no|there is no|missing|lacks?|too (?:large|small|long|many|few)|unknown|damaged"
    r"|out of range|rejected)\b"
)
LITERALS = re.compile(r'(?:"(?:\\.|[^"\\])*"\s*)+')

# By the folder of the source, the longest first.
SECTIONS = [
    ("core/io", "Recordings and clouds"),
    ("core/labels", "Labels"),
    ("core/world", "Tracks and maps"),
    ("app/commands/labels", "Labels"),
    ("app/commands/train", "Training and tuning"),
    ("app/commands/tun", "Training and tuning"),
    ("core/lab", "Synthetic sets, training, tuning and experiments"),
    ("core/planes/cloud", "Gravity and cameras"),
    ("core/planes/classify", "Classifiers and their weights"),
    ("core/planes", "Options and methods"),
    ("core/report", "Reports, baselines and rules"),
    ("app/commands/report", "Reports, baselines and rules"),
    ("core/debug", "The window: filters, sessions, scripts"),
    ("app/desktop", "The window: filters, sessions, scripts"),
    ("render", "Pictures and OpenGL"),
    ("library", "The library, and Python"),
    ("python", "The library, and Python"),
    ("core/model", "Files and folders"),
    ("app/lab", "planescope-lab"),
    ("app", "The command line"),
]


def without_comments(text):
    """The same length, so that places stay; string literals are kept, but raw ones, which are pages and tables."""
    text = re.sub(r'R"\((.*?)\)"', lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S)
    pattern = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\''
    keep = lambda m: m[0] if m[0][0] in "\"'" else re.sub(r"[^\n]", " ", m[0])
    return re.sub(pattern, keep, text, flags=re.S)


def arguments(text, start):
    """From after a parenthesis to the one that closes it."""
    depth, i = 1, start
    while i < len(text) and depth:
        if text[i] == '"':
            i = re.compile(r'"(?:\\.|[^"\\])*"').match(text, i).end()
            continue
        if text[i] == "'":
            i = re.compile(r"'(?:\\.|[^'\\])*'").match(text, i).end()
            continue
        depth += text[i] in "([{"
        depth -= text[i] in ")]}"
        i += 1
    return text[start : i - 1]


def message(source):
    """The literals of a call's arguments as one text."""
    pieces, last = [], 0
    for literal in re.finditer(r'"((?:\\.|[^"\\])*)"', source):
        between = source[last : literal.start()].strip()
        # Literals in a row are one; whatever else stands between fills something in.
        if pieces and between:
            pieces.append("…")
        elif not pieces and between and not re.fullmatch(r"(?:fmt::format\(|std::string\(|\{|\()*", between):
            pieces.append("…")
        pieces.append(bytes(literal[1], "utf-8").decode("unicode_escape").encode("latin-1", "replace").decode("utf-8", "replace"))
        last = literal.end()
    if re.search(r"\+\s*[a-z_]", source[last:]):
        pieces.append("…")
    text = re.sub(r"\{[^{}]*\}", "…", "".join(pieces).replace("{{", "").replace("}}", ""))
    text = re.sub(r"%[-+.0-9]*(?:z|l)*[a-zA-Z]", "…", text).replace("%%", "%")
    return re.sub(r"\s+", " ", re.sub(r"…(?:\s*…)+", "…", text)).strip()


def messages(root):
    found = {title: set() for _, title in SECTIONS}
    for folder in ("core", "app", "render", "library", "python"):
        for file in sorted((root / folder).rglob("*.[chi]*")):
            if file.suffix not in (".cpp", ".hpp", ".inl"):
                continue
            name = str(file.relative_to(root))
            title = next(title for start, title in SECTIONS if name.startswith(start))
            text = without_comments(file.read_text())
            taken = []
            for call in CALLS.finditer(text):
                source = arguments(text, call.end())
                taken.append((call.end(), call.end() + len(source)))
                told = message(source)
                if len(re.findall(r"[a-z]{2,}", told)) >= 2:
                    found[title].add(told)
            for literals in LITERALS.finditer(text):
                if any(start <= literals.start() < end for start, end in taken):
                    continue
                told = message(literals[0])
                one_line = 3 <= len(told.split()) <= 35 and not re.search(r"[<>]\s*|::", told)
                if one_line and WRONG.search(told) and not name.startswith(("core/lab", "app/lab")):
                    found[title].add(told)
    for file in sorted((root / "python").rglob("*.py")):
        for call in re.finditer(r"raise Error\(\s*f?\"(.*?)\"\s*\)", file.read_text(), re.S):
            found["The library, and Python"].add(re.sub(r"\{[^{}]*\}", "…", call[1]))
    return found


def main():
    found = messages(Path(sys.argv[1]))
    count = sum(map(len, found.values()))
    print("## All messages\n")
    print(
        f"{count} messages from the sources. An ellipsis (…) stands for a file, a number, a name or another message."
        " Messages about unknown commands and options are omitted. Press `Ctrl+F` to search.\n"
    )
    for title, told in found.items():
        if not told:
            continue
        print(f"### {title}\n")
        for text in sorted(told, key=lambda text: text.lstrip("…: \"'").lower()):
            # A code span of a text that may have backticks.
            print(f"- ``` {text} ```" if "`" in text else f"- `{text}`")
        print()


main()
