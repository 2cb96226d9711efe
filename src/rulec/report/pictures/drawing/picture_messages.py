"""Messages about pictures."""

from __future__ import annotations

from rulec.diagnostics.code import Code

PNG_UNAVAILABLE = Code(
    "R0707",
    title="a picture cannot be written as PNG or PDF",
    why="It takes the package `matplotlib`, which is installed on request: "
    "`.venv/bin/python -m pip install -e '.[pictures]'` in the checkout. And a picture with very "
    "many layers is longer than these can sensibly be. SVG and HTML have neither limit.",
    bad="rulec draw scene s1 --step 0.01 -o s1.png",
    good="rulec draw scene s1 --step 0.01 -o s1.html",
    kind="command",
)
