"""Link anchors of headings in Markdown, as most viewers make them."""

from __future__ import annotations

import re
from collections.abc import Sequence


def anchors(headings: Sequence[str]) -> list[str]:
    """A distinct anchor for each plain-text heading, in the page's order."""
    taken: set[str] = set()
    names = []
    for heading in headings:
        plain = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        name, number = plain, 0
        while name in taken:
            number += 1
            name = f"{plain}-{number}"
        taken.add(name)
        names.append(name)
    return names
