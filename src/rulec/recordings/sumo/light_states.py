"""SUMO's traffic lights in files beside the data: recorded states, and additional programmes.

Recorded states are SUMO's output ``SaveTLSStates``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.safe_xml import root_of, scan
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.encodings.xml_tree import scan_trees
from rulec.recordings.sumo.fcd import demand_beside, named_beside
from rulec.recordings.sumo.fcd_content import FcdHead
from rulec.recordings.sumo.net import SignalProgramme, read_programme

STATES = XmlFormat(
    "SUMO's states of traffic lights",
    "SUMO writes them for a `timedEvent` of the type `SaveTLSStates`",
    root="tlsStates",
)
_ADDITIONAL = XmlFormat("an additional file of SUMO", "SUMO takes it with -a", root="additional")
_A_DAY_S = 86_400.0


def light_states_beside(path: Path, head: FcdHead) -> tuple[Path, ...]:
    """The files of recorded states: those named in additional files, or the only ``*.tls.xml``."""
    names: list[str] = []

    def begin(element: Tree) -> None:
        if element.name == "timedEvent" and element.get("type") == "SaveTLSStates":
            names.append(element.get("dest"))

    for file in demand_beside(path, head):
        if root_of(file, _ADDITIONAL) == "additional":
            scan(file, _ADDITIONAL, begin)
    paths = {there for name in names if (there := named_beside(path, name)) is not None}
    if paths:
        return tuple(sorted(paths))
    only = [*path.parent.glob("*.tls.xml"), *path.parent.glob("*.tls.xml.gz")]
    return tuple(only) if len(only) == 1 else ()


def programmes_beside(path: Path, head: FcdHead) -> Mapping[str, SignalProgramme | None] | None:
    """Light -> the programme that an additional file gives it; None if such a file is missing.

    SUMO loads these files after the net, and runs the programme loaded last. The programme of a
    light is unknown (None) if a file switches between several.
    """
    replaced: dict[str, SignalProgramme | None] = {}
    for name in head.additional:
        file = named_beside(path, name)
        if file is None:
            return None
        replaced.update(_replaced_by(file))
    return replaced


def _replaced_by(file: Path) -> Mapping[str, SignalProgramme | None]:
    replaced: dict[str, SignalProgramme | None] = {}
    switched: dict[str, None] = {}

    def add(tree: Tree) -> None:
        if tree.name == "tlLogic":
            replaced[tree.filled("id")] = read_programme(tree)
        elif tree.name == "wautJunction":
            switched[tree.get("junctionID")] = None

    form = replace(_ADDITIONAL, root=root_of(file, _ADDITIONAL))
    scan_trees(file, form, lambda _: None, add)
    return {**replaced, **switched}


def read_light_states(path: Path) -> Mapping[str, SignalProgramme]:
    """Light -> its recorded states, as a programme that runs once.

    The first state holds from time 0, the last one for a day: SUMO writes this output and the data
    for the same time. Raises RulecError R0610 for another kind of file, R0701 if it cannot be read.
    """
    changes: dict[str, list[tuple[float, str]]] = {}

    def begin(element: Tree) -> None:
        if element.name == "tlsState":
            time, state = element.number("time"), element.filled("state")
            known = changes.setdefault(element.filled("id"), [])
            if known and time < known[-1][0]:
                raise element.wrong("its times are not in ascending order")
            if not known or known[-1][1] != state:
                known.append((time, state))

    scan(path, STATES, begin)
    return {name: SignalProgramme(0.0, _phases(known)) for name, known in changes.items()}


def _phases(changes: list[tuple[float, str]]) -> tuple[tuple[float, str], ...]:
    starts = [0.0, *(time for time, _ in changes[1:])]
    ends = [*starts[1:], starts[-1] + _A_DAY_S]
    return tuple((ends[k] - starts[k], state) for k, (_, state) in enumerate(changes))
