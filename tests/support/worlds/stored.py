"""Small worlds that are stored with the tests: net, recording, and what is true of them."""

import gzip
import json
import xml.etree.ElementTree as ElementTree
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from support.worlds.facts import Fact
from support.worlds.scoring import true_facts
from support.worlds.simulate import simulate
from support.worlds.world_kinds import KINDS
from support.worlds.world_state import WorldState

FOLDER = Path(__file__).resolve().parents[2] / "worlds" / "stored"
_EVERY = 2
"""One state in so many is stored; the truth is that of all."""

_LEFT_OUT = ("pos", "acceleration", "accelerationLat", "leaderID", "leaderSpeed", "leaderGap")

SMALL = {
    "grid": (7, 12, 25),
    "spider_left": (3, 12, 25),
    "priority": (4, 16, 20),
    "stop_signs_left": (1, 12, 20),
    "all_way_stop": (4, 12, 20),
    "right_before_left": (1, 14, 20),
    "roundabout": (2, 16, 20),
    "zebra": (2, 12, 25),
    "motorway": (6, 14, 20),
}
"""Kind -> its seed, how many vehicles depart, and in how many seconds."""

_AFTER_S = 25


@dataclass(frozen=True)
class StoredWorld:
    """One of the stored worlds, by its kind's name; stored with the tests, or in a folder."""

    name: str
    folder: Path = FOLDER

    net = property(lambda self: self.folder / f"{self.name}.net.xml")
    data = property(lambda self: self.folder / f"{self.name}.fcd.xml.gz")
    truth = property(lambda self: self.folder / f"{self.name}.truth.json")

    @property
    def book(self):
        return KINDS[self.name].book

    def facts(self):
        stored = json.loads(self.truth.read_text(encoding="utf-8"))
        return [Fact(**fact) for fact in stored["facts"]]

    def store(self, sumo, work):
        """Simulate it anew in a folder for work, and write its files."""
        kind, (seed, vehicles, over_s) = KINDS[self.name], SMALL[self.name]
        walkers = min(kind.demand.walkers, vehicles)
        demand = replace(kind.demand, vehicles=vehicles, over_s=over_s, walkers=walkers)
        small = replace(kind, demand=demand, ends_s=over_s + _AFTER_S)
        files = simulate(sumo, small, seed, work)
        facts = true_facts(WorldState(files, 0.1, kind.book))
        self.folder.mkdir(parents=True, exist_ok=True)
        self.net.write_bytes(files.net.read_bytes())
        packed = gzip.compress(_shorter(files.data).encode(), 9, mtime=0)
        self.data.write_bytes(packed)
        rows = ",\n  ".join(json.dumps(asdict(fact)) for fact in facts)
        head = json.dumps({"kind": self.name, "seed": seed})[:-1]
        self.truth.write_text(f'{head}, "facts": [\n  {rows}\n]}}\n', encoding="utf-8")


def _shorter(file):
    """The recording with every second state, and without what only the truth needs."""
    tree = ElementTree.parse(file)
    root = tree.getroot()
    for number, moment in enumerate(list(root)):
        if number % _EVERY:
            root.remove(moment)
            continue
        moment.tail = moment.text = "\n"
        for one in moment:
            one.tail = "\n"
            for name in _LEFT_OUT:
                one.attrib.pop(name, None)
            for name in ("x", "y", "angle", "speed"):
                one.set(name, f"{float(one.get(name)):.2f}")
    return ElementTree.tostring(root, encoding="unicode")
