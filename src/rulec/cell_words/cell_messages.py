"""Messages about recorded scenes that rules are asked of."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

CHANGED_SCENE = Code("R0418")


def changed_scene(file: str, recorded: str, rulebook: str, side: str) -> RulecError:
    """A changed scene, recorded on one side, for a rulebook of the other one."""
    return CHANGED_SCENE.error(
        SourceLocation(file),
        f"traffic keeps to the {recorded} here, and in `{rulebook}` to the {side}, and the scene "
        "was changed after it was read from its recording: it cannot be mirrored",
        help=f"change the recording instead, or use a rulebook of traffic that keeps to the "
        f"{recorded}",
    )
