"""python_reference.py FILE: what a Python module offers, as Markdown: signatures, fields and their comments."""

import ast
import sys
from pathlib import Path

text = Path(sys.argv[1]).read_text()
lines = text.splitlines()
module = ast.parse(text)


def code(body):
    return "```python\n" + "\n".join(body) + "\n```\n"


def doc_of(node):
    return (ast.get_docstring(node) or "") + "\n"


def signature(node):
    """The lines of a function up to its body."""
    return [line[node.col_offset :] for line in lines[node.lineno - 1 : node.body[0].lineno - 1]]


print("\n## Reference\n")
for node in module.body:
    if not isinstance(node, (ast.ClassDef, ast.FunctionDef)) or node.name.startswith("_"):
        continue
    print(f"### {node.name}\n\n{doc_of(node)}")
    if isinstance(node, ast.FunctionDef):
        print(code(signature(node)))
        continue
    fields = [part for part in node.body if isinstance(part, (ast.AnnAssign, ast.Assign))]
    if fields:
        print(code(line.strip() for line in lines[fields[0].lineno - 1 : fields[-1].end_lineno]))
    for part in node.body:
        decorators = [ast.unparse(d) for d in getattr(part, "decorator_list", [])]
        if not isinstance(part, ast.FunctionDef) or "overload" in decorators:
            continue
        if part.name.startswith("_") and (part.name != "__init__" or not ast.get_docstring(part)):
            continue
        if any("property" in d for d in decorators):
            kind = f": {ast.unparse(part.returns)}" if part.returns else ""
            print(f"`{part.name}{kind}`\n: {' '.join(doc_of(part).split()) or 'as its name says'}\n")
        else:
            print(code(signature(part)) + "\n" + doc_of(part))
