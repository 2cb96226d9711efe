"""Messages about pictures."""

from __future__ import annotations

from rulec.diagnostics.code import Code

PNG_UNAVAILABLE = Code(
    "R0707",
    title="a picture cannot be written as PNG or PDF",
    why="PNG and PDF need the package `matplotlib`, which is installed on request: "
    "`.venv/bin/python -m pip install -e '.[pictures]'` in the checkout. A picture with very many "
    "layers may also be too long for them. SVG and HTML have neither restriction.",
    bad="rulec draw scene s1 --step 0.01 -o s1.png",
    good="rulec draw scene s1 --step 0.01 -o s1.html",
    kind="command",
)
