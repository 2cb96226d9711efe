"""Diagnostic codes: kinds of mistakes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

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


class Details(TypedDict, total=False):
    """What a diagnostic may contain besides its message, place and help."""

    expected: str
    labels: tuple[Label, ...]
    notes: tuple[str, ...]
    severity: Severity
    fix: Fix | None


@dataclass(frozen=True, slots=True)
class Code:
    """A kind of mistake, which the page on codes explains (``report/findings/code_registry``).

    The hundreds digit of ``code`` is the stage: 1 syntax, 2 names, 3 types and meaning,
    4 compiling, 5 traces, 6 scenarios and graphs, 7 files, 8 analysis.
    """

    __repr__ = short_repr

    code: str

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
