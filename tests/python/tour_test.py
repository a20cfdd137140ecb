"""tour_test.py DOCUMENT: runs every line of a document that begins with >>>, in order, as one session."""

import doctest
import sys
from pathlib import Path

document = Path(sys.argv[1]).resolve()
test = doctest.DocTestParser().get_doctest(
    # The end of a block is no output.
    document.read_text().replace("\n```", "\n\n"), {}, document.name, str(document), 0
)
runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
runner.run(test)
result = runner.summarize()
if result.attempted < 20:
    sys.exit(f"{document.name}: only {result.attempted} examples were found")
sys.exit(result.failed > 0)
