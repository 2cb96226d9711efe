"""Messages about what is said in the cells of recorded scenes."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

OTHER_SIDE = Code(
    "R0418",
    title="maneuvers are asked of a rulebook of the other side of the road",
    why="The maneuvers of a recorded scene are on its own road, so they are judged by rules of "
    "traffic that keeps to the side that it keeps to. Only drives that were recorded are "
    "judged as their mirror image, by `rulec verify`.",
    kind="circumstance",
)


def other_side(scene: str, recorded: str, rulebook: str, side: str) -> RulecError:
    """A scene in which no word of a rulebook would be told."""
    return OTHER_SIDE.error(
        SourceLocation(scene),
        f"traffic keeps to the {recorded} here, and in `{rulebook}` to the {side}",
        help=f"choose a rulebook of traffic that keeps to the {recorded}; `rulec verify` judges "
        "recorded drives as their mirror image",
    )
