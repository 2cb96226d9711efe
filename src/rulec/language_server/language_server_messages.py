"""Messages of the language server."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code, missing_package

LANGUAGE_SERVER_UNAVAILABLE = Code(
    "R0760",
    title="the language server needs a package that is not installed",
    why="The language server needs the package `pygls`, which is installed on request: "
    "`.venv/bin/python -m pip install -e '.[lsp]'` in the checkout.",
    kind="circumstance",
)


def no_pygls() -> RulecError:
    return missing_package(LANGUAGE_SERVER_UNAVAILABLE, "the language server", "pygls", "lsp")
