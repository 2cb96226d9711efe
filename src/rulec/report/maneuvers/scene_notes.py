"""Notes on a recorded scene: left out, continued and derived data."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rulec.planning import Maneuvers
from rulec.report.text.terminal_text import visible
from rulec.scenario import Account


def derived_signals(maneuvers: Maneuvers, account: Account) -> dict[str, tuple[Any, str]]:
    """Signals supplied by the recording, each with value and reason."""
    supplied = maneuvers.paths.states[0][0]
    return {
        name: (supplied[name], because)
        for name, because in account.derived.items()
        if name in supplied
    }


def lines(maneuvers: Maneuvers, account: Account) -> Iterator[str]:
    """Notes on a recorded scene, as lines of text."""
    kept = account.recorded - account.left_out
    out = f", {account.left_out} left out: not on this road" if account.left_out else ""
    yield f"obstacles   {kept} on the road of lanelet {account.reference}{out}"
    end = float(len(maneuvers.graph.layers) * maneuvers.graph.step)
    if end > account.until_s:
        yield (
            f"recorded    until {max(account.until_s, 0):g} s; who is there then is taken to go on "
            "at its last speed"
        )
    for name, (value, because) in derived_signals(maneuvers, account).items():
        shown = str(value).lower() if isinstance(value, bool) else value
        yield visible(f"derived     {name} = {shown}: {because}")
    for remark in account.remarks:
        yield visible(f"note        {remark}")
