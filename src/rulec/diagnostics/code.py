"""Diagnostic codes: kinds of mistakes, each with its explanation and examples."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias, TypedDict

from rulec.diagnostics.diagnostic import (
    Diagnostic,
    Fix,
    Label,
    RulecError,
    Severity,
    SourceLocation,
    Span,
)
from rulec.diagnostics.ways_out import Help, offers_of
from rulec.resources import install_command
from rulec.value_display import short_repr

if TYPE_CHECKING:
    from typing_extensions import Unpack

ExampleKind: TypeAlias = Literal[
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
"""Kinds of examples, by how they are run.

``rules``: a rulebook or a vocabulary to check. ``compiled``: a rulebook to compile. ``analyzed``: a
rulebook to analyze. ``examples``: a rulebook whose examples are run. ``maneuvers``: a rulebook by
which the maneuvers of scenario s1 are judged. ``trace``: a line to judge by ``esterle2019``.
``scenario``: a file to build the graph of. ``command``: lines for a POSIX shell in an empty folder.
``python``: a program. ``circumstance``: no input causes it, so there is no example.
"""


class Details(TypedDict, total=False):
    """What a diagnostic may contain besides its message, place and help."""

    expected: str
    labels: tuple[Label, ...]
    notes: tuple[str, ...]
    severity: Severity
    fix: Fix | None


_MARKED = re.compile("⟪(.*?)\\|(.*?)⟫", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Code:
    """A kind of mistake, with its explanation for ``rulec explain``.

    ``title``: one line. ``why``: its meaning and what to do, in a paragraph. ``bad``: a small
    example that causes this code and no other. ``good``: the same example, corrected; instead,
    places that differ may be given as ``⟪bad|good⟫`` in ``bad``. The hundreds digit of ``code`` is
    the stage: 1 syntax, 2 names, 3 types and meaning, 4 compiling, 5 traces, 6 scenarios and
    graphs, 7 files, 8 analysis.
    """

    __repr__ = short_repr

    code: str
    title: str
    why: str
    bad: str = ""
    good: str = ""
    kind: ExampleKind = "rules"

    def __post_init__(self) -> None:
        if "⟪" in self.bad:
            bad, good = (_MARKED.sub(rf"\{side}", self.bad) for side in (1, 2))
            object.__setattr__(self, "bad", bad)
            object.__setattr__(self, "good", good)

    def at(
        self,
        place: SourceLocation | Span | None,
        message: str,
        *,
        help: Help = "",
        **details: Unpack[Details],
    ) -> Diagnostic:
        """Make a diagnostic of this code, with a place if known."""
        where = place.place if isinstance(place, Span) else place
        offers = offers_of(help, where)
        return Diagnostic(self.code, message, where, help=str(help), offers=offers, **details)

    def error(
        self,
        place: SourceLocation | Span | None,
        message: str,
        *,
        help: Help = "",
        **details: Unpack[Details],
    ) -> RulecError:
        """Make an exception with one diagnostic of this code."""
        return RulecError(self.at(place, message, help=help, **details))


def missing_package(
    code: Code,
    task: str,
    package: str,
    extra: str,
    place: SourceLocation | None = None,
    *,
    otherwise: str = "",
) -> RulecError:
    """Say that a ``task`` needs a package, which extra installs it, and the alternative."""
    return code.error(
        place,
        f"{task} takes the package `{package}`, which is not installed",
        help=f"`{install_command(extra)}`" + (f", or {otherwise}" if otherwise else ""),
    )
