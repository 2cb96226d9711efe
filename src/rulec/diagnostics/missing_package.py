"""The message that an optional package is not installed."""

from __future__ import annotations

from rulec.diagnostics.code import Code
from rulec.diagnostics.diagnostic import RulecError
from rulec.diagnostics.source_text import SourceLocation
from rulec.resources import install_command


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
