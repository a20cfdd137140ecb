# The documentation's site, by Sphinx: scripts/site.
import re
from pathlib import Path

here = Path(__file__).parent

project = "planescope"
author = "The planescope authors"
copyright = f"2026 {author}"
release = re.search(r"project\(planescope VERSION ([0-9.]+)", (here / "CMakeLists.txt").read_text())[1]

extensions = ["myst_parser"]
root_doc = "index"
source_suffix = {".md": "markdown"}
# Headings have the anchors that they have where the files themselves are read.
myst_heading_anchors = 4
myst_enable_extensions = ["deflist", "html_image"]
suppress_warnings = ["myst.header"]  # pages that go on where an included part of another begins

html_theme = "furo"
html_title = f"planescope {release}"
html_favicon = html_logo = "planescope.svg"
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
html_static_path = ["static"]
html_css_files = ["site.css"]
html_theme_options = {"sidebar_hide_name": False}
html_permalinks = True
# Made by scripts/reference.
html_extra_path = ["extra"]
