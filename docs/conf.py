"""How `sphinx-build -b html docs docs/_build` makes the site of the documentation."""

import sys
from pathlib import Path

from sphinx.application import Sphinx

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "extensions"), str(HERE.parent / "src")]
sys.path.append(str(HERE.parent / "tests" / "benchmarks"))

from rulec.report.text.pygments_lexer import RulecLexer  # noqa: E402
from rulec.version import __version__  # noqa: E402

project = "rulec"
author = "The rulec authors"
project_copyright = author
release = version = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "built_parts",
]
exclude_patterns = ["_build", "samples"]
html_theme = "furo"
html_title = f"rulec {release}"
html_copy_source = False
html_domain_indices = False

# The pages are read on GitHub as well: headings get the anchors that they have there.
myst_heading_anchors = 4

# Docstrings and help put code into single backticks.
default_role = "code"
smartquotes = False

# A reference that leads nowhere is a mistake. Of the types in signatures, most have no page here.
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"


def setup(app: Sphinx) -> None:
    """Colour rulebooks also where rulec is not installed, but only on the path."""
    app.add_lexer("rulec", RulecLexer)
