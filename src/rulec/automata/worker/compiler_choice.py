"""The choice between the two compilers: Spot if installed, else decision diagrams.

It is an environment variable, so that child processes compile alike.
"""

from __future__ import annotations

import os

from rulec.diagnostics import did_you_mean
from rulec.diagnostics.code import Code

NO_COMPILER = Code("R0416")

VARIABLE = "RULEC_COMPILER"
SPOT, DIAGRAMS = "spot", "diagrams"


def choice() -> str:
    """The requested compiler; empty for the default. Raises RulecError R0416."""
    name = os.environ.get(VARIABLE, "")
    if name not in ("", SPOT, DIAGRAMS):
        raise NO_COMPILER.error(
            None,
            f"{VARIABLE} is `{name}`, and there is no such compiler",
            help=did_you_mean(name, [SPOT, DIAGRAMS])
            or f"use `{SPOT}` or `{DIAGRAMS}`; if it is unset, Spot is used where it is installed",
        )
    return name
