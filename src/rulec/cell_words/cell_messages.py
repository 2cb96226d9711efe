"""Messages about the words in the cells of recorded scenes."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

OTHER_SIDE = Code(
    "R0418",
    title="maneuvers are judged by a rulebook for the other side of the road",
    why="If a recording's traffic keeps to the other side of the road than the rulebook's, its "
    "mirror image is judged. The mirror image is made from the recording, so it would lack later "
    "changes to the scene, except those of its step and horizon.",
    kind="circumstance",
)


def other_side(scene: str, recorded: str, rulebook: str, side: str) -> RulecError:
    """The error for a rulebook for the other side of the road: it would have no known word."""
    return OTHER_SIDE.error(
        SourceLocation(scene),
        f"traffic keeps to the {recorded} here, and in `{rulebook}` to the {side}",
        help=f"choose a rulebook for traffic that keeps to the {recorded}; `rulec verify` judges "
        "recorded drives as their mirror image",
    )
