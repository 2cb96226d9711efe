"""Messages about near and far where the side of traffic is not known."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import in_header, offering
from rulec.syntax import tree

UNKNOWN_SIDE = Code("R0211")


def no_traffic(use: tree.AtomUse, name: str) -> Diagnostic:
    """The mistake of ``near_side_of`` without a declared side of traffic."""
    return UNKNOWN_SIDE.at(
        use.name.span,
        f"`{name}` depends on the side on which traffic drives, and the rulebook does not say it",
        expected="left or right?",
        help=offering(
            "write `traffic right` or `traffic left` in the rulebook's header",
            *(in_header(f"traffic {side}", use.span.source.name) for side in ("right", "left")),
        ),
    )


def no_sides(use: tree.AtomUse, name: str, side: str) -> Diagnostic:
    """``near_side_of`` with a vocabulary that has no sides."""
    return UNKNOWN_SIDE.at(
        use.name.span,
        f"`{name}` means `{side}` here, which the vocabulary does not have",
        expected="expected a signal or a value",
        help="`use` a vocabulary that has `left_of` and `right_of`, such as `road`",
    )
