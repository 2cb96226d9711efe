"""Messages of the language server."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code, missing_package

LANGUAGE_SERVER_UNAVAILABLE = Code("R0760")


def no_pygls() -> RulecError:
    return missing_package(LANGUAGE_SERVER_UNAVAILABLE, "the language server", "pygls", "lsp")
