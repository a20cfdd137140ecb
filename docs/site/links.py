"""links.py SITE: every link and picture of a site's pages leads to a file, and a place in it, that is there."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

site = Path(sys.argv[1]).resolve()


class Page(HTMLParser):
    def __init__(self, file):
        super().__init__()
        self.links, self.places = [], set()
        self.feed(file.read_text(errors="replace"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if value and name in ("href", "src"):
                self.links.append(value)
            elif value and name in ("id", "name"):
                self.places.add(value)


pages = {file: Page(file) for file in site.rglob("*.html")}
bad = []
for file, page in pages.items():
    for link in page.links:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc or link.startswith(("javascript:", "data:")):
            continue
        target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
        if target.is_dir():
            target /= "index.html"
        if not target.is_file():
            bad.append(f"{file.relative_to(site)}: {link}: there is no such file")
        elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places | {"top", ""}:
            # Doxygen's own pages make some of their places when they are opened.
            if "reference" not in target.parts:
                bad.append(f"{file.relative_to(site)}: {link}: there is no such place")
for line in bad:
    print(line, file=sys.stderr)
print(f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links", file=sys.stderr)
sys.exit(bool(bad))
