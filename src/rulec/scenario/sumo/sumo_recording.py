"""SUMO's floating-car data and their companion files as one recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy import int64

from rulec.diagnostics import SourceLocation
from rulec.scenario.recorded.recording import Lanelet, Participant, Recording
from rulec.scenario.scenario_messages import OTHER_NET
from rulec.scenario.sumo.fcd import (
    FCD,
    MICROSECONDS,
    FloatingCarData,
    demand_beside,
    net_beside,
    read_fcd,
)
from rulec.scenario.sumo.fcd_participants import fcd_participants, time_step
from rulec.scenario.sumo.lanelets import net_lanelets
from rulec.scenario.sumo.net import SumoNet, read_net
from rulec.scenario.sumo.vehicle_types import VehicleType, read_vehicle_types, vehicle_type
from rulec.scenario.xml_element import short

NEAR_M = 1000.0
"""Nobody in the data is farther from the net than this."""

_NAMED = 5


def read_sumo(path: Path, net_path: Path | None = None) -> Recording:
    """Read floating-car data on the roads of a net: the one given, or the one beside them.

    Raises RulecError R0610 for a file that cannot be read as what it should be, R0614 if there is
    no net, R0615 for another road's net, R0701 if a file cannot be opened.
    """
    data = read_fcd(path)
    if data.head.geographic:
        why = "its places are geographic, degrees of longitude and latitude"
        raise FCD.refused(path, why, help_text="have SUMO write them without --fcd-output.geo")
    if not data.tracks:
        raise FCD.refused(path, "nobody is in it")
    net_path = net_beside(path, data.head) if net_path is None else net_path
    net = read_net(net_path)
    _check_places(path, data, net_path, net)
    step_s = time_step(path, data.moments)
    types = read_vehicle_types(demand_beside(path, data.head))
    unknown: set[str] = set()
    participants = tuple(_participants(data, types, step_s, unknown))
    lanelets = net_lanelets(net, step_s)
    _check_near(path, participants, lanelets.values())
    return Recording(
        name=path.name.split(".")[0] or path.name,
        step_s=step_s,
        lanelets=lanelets,
        participants=participants,
        problems=(),
        form="SUMO data",
        side=net.side,
        remarks=tuple(_remarks(unknown, net)),
    )


def _participants(
    data: FloatingCarData, types: dict[str, VehicleType], step_s: float, unknown: set[str]
) -> Iterator[Participant]:
    step = round(step_s * MICROSECONDS)
    steps = np.array(data.moments, dtype=int64) // step
    for key, track in data.tracks.items():
        kind, known = vehicle_type(track.type, track.element, types)
        if not known:
            unknown.add(f"`{short(track.type)}` ({kind.kind}, {kind.length:g} m)")
        yield from fcd_participants(key, track, kind, steps, step_s)


def _remarks(unknown: Iterable[str], net: SumoNet) -> Iterator[str]:
    guessed = sorted(unknown)
    if guessed:
        yield f"types that no file describes are taken to be as usual: {_some(guessed)}"
    lights = [f"`{short(name)}`" for name in net.unknown_lights()]
    if lights:
        yield f"the programmes of these traffic lights are not known: {_some(lights)}"


def _some(names: list[str]) -> str:
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED] + ([f"{more} more"] if more > 0 else []))


def _check_places(path: Path, data: FloatingCarData, net_path: Path, net: SumoNet) -> None:
    for name, (kind, line) in data.on.items():
        if name not in (net.lanes if kind == "lane" else net.edges):
            raise OTHER_NET.error(
                SourceLocation(str(path), line),
                f"somebody is on {kind} `{short(name)}`, which the net {net_path.name} has not",
                help="name with --net the net that the data were made with",
            )


def _check_near(
    path: Path, participants: Iterable[Participant], lanelets: Iterable[Lanelet]
) -> None:
    roads = np.concatenate([lanelet.centre for lanelet in lanelets])
    low, high = roads.min(axis=0) - NEAR_M, roads.max(axis=0) + NEAR_M
    for participant in participants:
        state = participant.states[next(iter(participant.states))]
        place = np.array([state.x, state.y])
        if (place < low).any() or (place > high).any():
            raise OTHER_NET.error(
                SourceLocation(str(path)),
                f"`{short(participant.id)}` is at x = {state.x:g}, y = {state.y:g}, far from all "
                "roads of the net",
                help="have SUMO write places in the net's own metres, without "
                "--fcd-output.geo and --fcd-output.utm",
            )
