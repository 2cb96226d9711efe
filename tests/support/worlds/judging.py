"""Worlds simulated, judged and scored; the same on recordings that are disturbed."""

from concurrent.futures import ProcessPoolExecutor

from support.worlds.disturbances import at_frames, mirrored, thinned, with_noise
from support.worlds.raw_labels import DRIVERS, LABELLED, labels
from support.worlds.raw_recordings import RawRecording
from support.worlds.scoring import Score, answers, scores, true_facts
from support.worlds.simulate import simulate
from support.worlds.stored import SMALL, StoredWorld
from support.worlds.world_kinds import KINDS
from support.worlds.world_state import WorldState

USUAL = "thinned"
DISTURBANCES = {
    USUAL: thinned,
    "rounded": lambda files, folder: with_noise(files, folder, rounded_m=0.1),
    "noise": lambda files, folder: with_noise(files, folder, noise_m=0.3),
    "mirrored": mirrored,
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
    return scores(facts, found, kind.book, f"{name} {seed}")


def judged_all(sumo, kinds, seeds, folder, disturbance=None):
    """Kind -> rule -> its score in all worlds of the kind."""
    jobs = [(name, seed) for name in kinds for seed in seeds]
    total = {}
    with ProcessPoolExecutor(2) as pool:
        waiting = [
            pool.submit(judged, sumo, name, seed, folder / f"{name}_{seed}", disturbance)
            for name, seed in jobs
        ]
        for (name, _), result in zip(jobs, waiting, strict=True):
            by_rule = total.setdefault(name, {})
            for rule, score in result.result().items():
                by_rule.setdefault(rule, Score()).add(score)
    return total


def judged_recordings(files):
    """File -> rule -> the score of `de` by labels from raw places, of the rules that have some."""
    total = {}
    for file in files:
        recording = RawRecording(file)
        if not recording.tracks:
            continue
        facts = list(labels(recording))
        try:
            found = answers(file, "de")
        except RuntimeError as error:
            total[file.stem] = {"refused": Score(missed=[str(error).splitlines()[0]])}
            continue
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
