"""The message that a package is not there which is installed on request."""

from __future__ import annotations

from rulec.diagnostics.code import Code
from rulec.diagnostics.diagnostic import RulecError
from rulec.diagnostics.source_text import SourceLocation
from rulec.version import install_command


def missing_package(
    code: Code,
    task: str,
    package: str,
    extra: str,
    place: SourceLocation | None = None,
    *,
    otherwise: str = "",
) -> RulecError:
    """Say that a ``task`` takes a package, which of rulec's extras has it, and what else to do."""
    return code.error(
        place,
        f"{task} takes the package `{package}`, which is not installed",
        help=f"`{install_command(extra)}`" + (f", or {otherwise}" if otherwise else ""),
    )
