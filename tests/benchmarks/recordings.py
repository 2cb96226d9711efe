"""How long CommonRoad's files take to read, beside the format's own library.

All of CommonRoad's recordings, if RULEC_RECORDINGS names the folder that they are in.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from figure import Result
from peer import named, peers
from program import run
from timing import in_turns, processor_time

import rulec

LEAST_RATIO = 3
LIBRARY = "commonroad-io"


def measure(rounds: int) -> Iterator[Result]:
    """Files as they are, to the objects that each has of them."""
    folder = os.environ.get("RULEC_RECORDINGS")
    if not folder:
        return
    files = [str(file) for file in sorted(Path(folder).glob("*.xml"))]
    ours = f"rulec, {len(files)} files"

    def read() -> None:
        for file in files:
            rulec.read_recording(file)

    with peers(files, {LIBRARY: "commonroad_reading"}) as (there, notes):
        tasks = {ours: processor_time(read, 1e6)}
        tasks |= {name: peer.timed(1e6) for name, peer in there.items()}
        taken = in_turns(tasks, min(rounds, 3))
        figures = [taken[ours].figure(ours, "ms")]
        if there:
            library = named(LIBRARY)
            figures = [
                taken[ours].against(taken[library], library, ours, "ms", None, LEAST_RATIO),
                taken[library].figure(library, "ms"),
            ]
    yield Result(
        "Reading CommonRoad's scenarios",
        f"the {len(files)} recordings in XML, each from its file to lanelets, signs, lights, and "
        "everybody's states",
        figures,
        notes,
    )


if __name__ == "__main__":
    run(measure, rounds=3)
