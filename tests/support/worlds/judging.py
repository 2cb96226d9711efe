"""Worlds simulated, judged and scored; the same on recordings that are disturbed."""

import json
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from support.worlds.disturbances import at_frames, mirrored, thinned, with_noise
from support.worlds.raw_labels import DRIVERS, LABELLED, labels
from support.worlds.raw_recordings import RawRecording
from support.worlds.scoring import Score, answers, scores, true_facts
from support.worlds.simulate import simulate
from support.worlds.stored import SMALL, StoredWorld
from support.worlds.world_kinds import KINDS
from support.worlds.world_state import WorldState

USUAL = "thinned"
_SAME_MOMENT_S = 1e-6
"""Numbers of times are rounded differently: 898 tenths of a second are a hair more than 89.8 s."""

DISTURBANCES = {
    USUAL: thinned,
    "rounded": lambda files, folder: with_noise(files, folder, rounded_m=0.1),
    "noise": lambda files, folder: with_noise(files, folder, noise_m=0.3),
    "mirrored": lambda files, folder: thinned(mirrored(files, folder / "whole"), folder),
    "24": lambda files, folder: at_frames(files, folder, 24),
    "29.97": lambda files, folder: at_frames(files, folder, 29.97),
    "30": lambda files, folder: at_frames(files, folder, 30),
}
"""What may be done to a recording before it is judged; the truth stays what it was."""


def judged(sumo, name, seed, folder, disturbance=None):
    """Rule -> its score in one world of a kind."""
    kind = KINDS[name]
    files = simulate(sumo, kind, seed, folder)
    facts = true_facts(WorldState(files, 0.1, kind.book))
    seen = DISTURBANCES[disturbance or USUAL]
    files = seen(files, folder / (disturbance or USUAL))
    found = answers(files.data, kind.book, files.net)
    ends_s = last_moment_s(files.data)
    return scores(
        [fact for fact in facts if fact.begin <= ends_s + _SAME_MOMENT_S],
        found,
        kind.book,
        f"{name} {seed}",
    )


def last_moment_s(data):
    """When a recording ends (s): what comes later in its world, nobody can find in it."""
    last = 0.0
    for _, one in ElementTree.iterparse(data):
        if one.tag == "timestep":
            last = float(one.get("time"))
        one.clear()
    return last


@dataclass(frozen=True, kw_only=True)
class Run:
    """How worlds are judged: so many at a time, seen in one of ``DISTURBANCES``.

    ``keep`` is a folder for their files, ``results`` one for the scores of each: a world that has
    some there is not judged again.
    """

    sumo: Path
    disturbance: str | None = None
    processes: int = 2
    keep: Path | None = None
    results: Path | None = None


def judged_all(run, worlds):
    """Kind -> rule -> its score in all ``worlds``, which are kinds and seeds, in this order."""
    total = {}
    with ProcessPoolExecutor(run.processes) as pool:
        for (name, _), scored in zip(worlds, pool.map(partial(_once, run), worlds), strict=True):
            by_rule = total.setdefault(name, {})
            for rule, score in scored.items():
                by_rule.setdefault(rule, Score()).add(score)
    return total


def _once(run, world):
    name, seed = world
    stored = run.results and run.results / f"{name}_{seed}.json"
    if stored and stored.exists():
        by_rule = json.loads(stored.read_text(encoding="utf-8"))
        return {rule: Score(**score) for rule, score in by_rule.items()}
    with TemporaryDirectory() as temporary:
        folder = (run.keep or Path(temporary)) / f"{name}_{seed}"
        scored = judged(run.sumo, name, seed, folder, run.disturbance)
    if stored:
        text = json.dumps({rule: asdict(score) for rule, score in scored.items()}, indent=1)
        run.results.mkdir(parents=True, exist_ok=True)
        stored.write_text(text + "\n", encoding="utf-8")
    return scored


def judged_recordings(files):
    """File -> rule -> the score of `de` by labels from raw places, of the rules that have some."""
    total = {}
    for file in files:
        recording = RawRecording(file)
        if not recording.tracks:
            continue
        facts = list(labels(recording))
        found = answers(file, "de")
        labelled = {key for key, track in recording.tracks.items() if track.type in DRIVERS}
        found = {key: answer for key, answer in found.items() if key in labelled}
        by_rule = scores(facts, found, "de", file.stem)
        total[file.stem] = {rule: by_rule[rule] for rule in LABELLED}
    return total


def judged_stored():
    """Stored world -> rule -> its score."""
    total = {}
    for name in SMALL:
        world = StoredWorld(name)
        found = answers(world.data, world.book, world.net)
        total[name] = scores(world.facts(), found, world.book, name)
    return total
