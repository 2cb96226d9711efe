"""One simulated world: its files, as SUMO wrote them."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

from support.worlds.demand import Demand, routes
from support.worlds.net_state import NetState
from support.worlds.nets import make_net

_ATTRIBUTES = "id,x,y,angle,type,speed,pos,lane,edge,signals,acceleration"
_LEADER = ",leaderID,leaderSpeed,leaderGap"
FARTHEST_LEADER_M = 200


@dataclass(frozen=True, kw_only=True)
class WorldKind:
    """What a kind of world is made of, and the rulebook that its drivers are judged by."""

    name: str
    layout: str
    demand: Demand
    book: str
    lefthand: bool = False
    ends_s: int = 90
    lane_change_s: float = 3.0


@dataclass(frozen=True)
class WorldFiles:
    """The files of a world in a folder; ``lights`` are the states of all lights at each step."""

    folder: Path

    net = property(lambda self: self.folder / "world.net.xml")
    data = property(lambda self: self.folder / "world.fcd.xml")
    routes = property(lambda self: self.folder / "world.rou.xml")
    lights = property(lambda self: self.folder / "lights.xml")


def simulate(sumo, kind, seed, folder, step_s=0.1):
    """Make the files of a world. ``sumo``: the folder of SUMO's programs."""
    folder.mkdir(parents=True, exist_ok=True)
    files = WorldFiles(folder)
    make_net(sumo, kind.layout, files.net, seed, kind.lefthand)
    net = NetState(files.net)
    files.routes.write_text(routes(kind.demand, net, seed), encoding="utf-8")
    more = folder / "more.xml"
    more.write_text(_additional(net, files.lights), encoding="utf-8")
    words = [
        *("-n", files.net, "-r", files.routes, "-a", more, "--step-length", step_s),
        *("--end", kind.ends_s, "--seed", seed, "--fcd-output", files.data),
        *("--fcd-output.attributes", _ATTRIBUTES + _LEADER),
        *("--fcd-output.max-leader-distance", FARTHEST_LEADER_M, "--precision", 3),
        *("--lanechange.duration", kind.lane_change_s, "--time-to-teleport", -1),
        *("--collision.action", "none", "--no-step-log", "--no-warnings"),
        *("--intermodal-collision.action", "none", "--default.speeddev", 0),
    ]
    subprocess.run([str(sumo / "sumo"), *map(str, words)], check=True, capture_output=True)
    return files


def _additional(net, file):
    names = sorted({link.light for link in net.links.values() if link.light})
    rows = [f'<timedEvent type="SaveTLSStates" source="{name}" dest="{file}"/>' for name in names]
    return "<additional>\n" + "\n".join(rows) + "\n</additional>\n"
