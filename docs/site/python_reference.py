"""python_reference.py PACKAGE EXAMPLES: everything public of the Python package, and its examples, as Markdown."""

import ast
import re
import sys
from pathlib import Path

package, examples = Path(sys.argv[1]), Path(sys.argv[2])


def code(body, language="python"):
    return f"```{language}\n" + "\n".join(body) + "\n```\n"


def markdown(text):
    """A docstring: its sections as lists, its example as code."""
    out, section = [], None
    for line in text.splitlines():
        if re.fullmatch(r"(Args|Returns|Raises|Example|Attributes):", line):
            section = line[:-1]
            while not out[-1]:
                out.pop()
            out += ["", f"{'Arguments' if section == 'Args' else section}:", ""]
            out += ["```python"] if section == "Example" else []
        elif section == "Example":
            out.append(line[4:])
        elif section and not line:
            continue
        elif section and (item := re.match(r" {4}(?! )(\*{0,2}\w+): (.*)", line)):
            out.append(f"- `{item[1]}`: {item[2]}")
        elif section:
            is_first = not out[-1]
            out.append(f"- {line.strip()}" if is_first else f"  {line.strip()}")
        else:
            out.append(line)
    while section == "Example" and not out[-1]:
        out.pop()
    return "\n".join(out) + ("\n```\n" if section == "Example" else "\n")


def doc_of(node):
    return markdown(ast.get_docstring(node) or "")


class Module:
    def __init__(self, file):
        text = file.read_text()
        self.lines, self.body = text.splitlines(), ast.parse(text).body

    def signature(self, node):
        """The lines of a function up to its body."""
        return [line[node.col_offset :] for line in self.lines[node.lineno - 1 : node.body[0].lineno - 1]]

    def show(self, node, name):
        print(f"### {name}\n\n{doc_of(node)}")
        if isinstance(node, ast.FunctionDef):
            print(code(self.signature(node)))
            return
        fields = [part for part in node.body if isinstance(part, (ast.AnnAssign, ast.Assign))]
        if fields:
            first = fields[0].lineno - 1
            first -= self.lines[first - 1].strip().startswith("#")
            print(code(line.strip() for line in self.lines[first : fields[-1].end_lineno]))
        for part in node.body:
            decorators = [ast.unparse(d) for d in getattr(part, "decorator_list", [])]
            if not isinstance(part, ast.FunctionDef) or "overload" in decorators:
                continue
            if part.name.startswith("_") and (part.name not in ("__init__", "__call__") or not ast.get_docstring(part)):
                continue
            if any("property" in d for d in decorators):
                print(f"`{part.name}: {ast.unparse(part.returns)}`\n: {' '.join(ast.get_docstring(part).split())}\n")
            else:
                print(code(self.signature(part)) + "\n" + doc_of(part))


front = ast.parse((package / "__init__.py").read_text()).body
public = next(node.value for node in front if isinstance(node, ast.Assign))
names = set(ast.literal_eval(public))
print("\n## Reference\n")
for imported in front:
    if isinstance(imported, ast.ImportFrom) and imported.module != "_core":
        module = Module(package / f"{imported.module}.py")
        for node in module.body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name in names:
                module.show(node, node.name)
plot = Module(package / "plot.py")
for node in plot.body:
    if isinstance(node, ast.FunctionDef):
        plot.show(node, f"plot.{node.name}")
print("\n## Source of the examples\n")
for file in sorted(examples.glob("*.py")):
    print(f"### {file.name}\n\n{code(file.read_text().splitlines())}")
