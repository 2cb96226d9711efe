"""What became of a recorded scene: what is left out, continued, and derived."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rulec.planning import Maneuvers
from rulec.report.findings.source_excerpt import visible
from rulec.scenario import Account


def as_data(found: Maneuvers, account: Account) -> dict[str, Any]:
    """For JSON: the lanelet, counts of obstacles, derived signals with their reasons."""
    supplied = found.paths.states[0][0]
    return {
        "reference": account.reference,
        "obstacles": account.recorded,
        "left_out": account.left_out,
        "recorded_until_s": account.until_s,
        "remarks": list(account.remarks),
        "derived": {
            name: {"value": supplied[name], "because": why}
            for name, why in account.derived.items()
            if name in supplied
        },
    }


def lines(found: Maneuvers, account: Account) -> Iterator[str]:
    """The same as text."""
    kept = account.recorded - account.left_out
    out = f", {account.left_out} left out: not on this road" if account.left_out else ""
    yield f"obstacles   {kept} on the road of lanelet {account.reference}{out}"
    end = float(len(found.graph.layers) * found.graph.step)
    if end > account.until_s:
        yield (
            f"recorded    until {max(account.until_s, 0):g} s; who is there then is taken to go on "
            "at its last speed"
        )
    for name, item in as_data(found, account)["derived"].items():
        value = str(item["value"]).lower() if isinstance(item["value"], bool) else item["value"]
        yield visible(f"derived     {name} = {value}: {item['because']}")
    for remark in account.remarks:
        yield visible(f"note        {remark}")
