"""The explanation of a code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "rules",
    "compiled",
    "analyzed",
    "examples",
    "maneuvers",
    "trace",
    "scenario",
    "command",
    "python",
    "circumstance",
]
"""What an example is, and so how it is run.

``rules``: a rulebook or a vocabulary, to check. ``compiled``: a rulebook, to compile.
``analyzed``: a rulebook, to analyze. ``examples``: a rulebook, to run the examples of.
``maneuvers``: a rulebook, to judge the maneuvers of scenario s1 by. ``trace``: a line, to judge by
``esterle2019``. ``scenario``: a file, to build the graph of. ``command``: lines for a POSIX shell
in an empty folder. ``python``: a program. ``circumstance``: no input makes it; there is no example.
"""


@dataclass(frozen=True, slots=True)
class Explanation:
    """What a code is about.

    ``title``: in one line. ``why``: what it means and what to do, in a paragraph. ``bad``: a small
    example that gets this code and no other. ``good``: the same, mended.
    """

    title: str
    why: str
    bad: str
    good: str
    kind: Kind = "rules"
