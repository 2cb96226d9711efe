"""Many inputs with mistakes for one format: what failed, the longest time, the memory taken."""

from __future__ import annotations

import signal
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from resource import RUSAGE_SELF, getrusage

import numpy as np

from rulec.diagnostics import RulecError
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Lanelet
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from support.mutations.sample import Sample

REFUSALS = {"R0610", "R0612", "R0614", "R0615", "R0701"}
LONGEST_S = 30.0
"""Processor time after which an input counts as one that hangs: files here have few kilobytes."""

_MOST_SHOWN = 20


@dataclass
class Trial:
    """What came of the inputs of a format; failures by seed, shortened."""

    name: str
    inputs: int = 0
    refused: int = 0
    failures: dict[int, str] = field(default_factory=dict)
    longest_s: float = 0.0
    longest_seed: int = 0
    grown_mb: float = 0.0


def read_as_recording(folder: Path, sample: Sample, form: str) -> None:
    """Read all recordings of a file, and look at what they are."""
    roads = folder / sample.roads if sample.roads else None
    for recording in read_recordings(RecordingSource(folder / sample.entry, roads, form)):
        assert recording.step_s > 0
        _assert_sound(recording.lanelets)


def read_as_map(folder: Path, sample: Sample, _: str) -> None:
    """Read a map, and look at its lanelets."""
    lanelets = read_map(folder / sample.entry, 0.1).lanelets
    assert lanelets
    _assert_sound(lanelets)


def _assert_sound(lanelets: dict[str, Lanelet]) -> None:
    for lanelet in lanelets.values():
        for line in (lanelet.left, lanelet.right, lanelet.centre):
            assert len(line) >= 2
            assert np.isfinite(line).all()


def assert_refused_well(error: RulecError, folder: Path) -> None:
    """A refusal is in one line, of a known kind, and names a file that was given."""
    assert error.diagnostics
    for found in error.diagnostics:
        assert found.code in REFUSALS, found.code
        assert found.place.file.startswith(str(folder)), found.place.file
        assert "\n" not in found.message
        assert len(found.message) < 400


def tried(
    name: str,
    samples: Sequence[Sample],
    read: Callable[[Path, Sample, str], None],
    folder: Path,
    seeds: range,
) -> Trial:
    """What comes of an input for each seed, in a folder that is empty at the beginning."""
    trial = Trial(name)
    files = [sample.packed() for sample in samples]
    whole = [{key: one.whole() for key, one in of.items()} for of in files]
    folders = [folder / str(number) for number in range(len(samples))]
    for number, of in enumerate(whole):
        for key, content in of.items():
            file = folders[number] / key
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        read(folders[number], samples[number], name)  # without mistakes
    before = _peak_mb()
    for seed in seeds:
        pick = Random(seed)
        number = pick.randrange(len(samples))
        key = pick.choice(sorted(files[number]))
        file = folders[number] / key
        file.write_bytes(files[number][key].broken(pick))
        _try_one(trial, seed, folders[number], lambda n=number: read(folders[n], samples[n], name))
        file.write_bytes(whole[number][key])
    trial.grown_mb = _peak_mb() - before
    return trial


def _try_one(trial: Trial, seed: int, folder: Path, read: Callable[[], None]) -> None:
    trial.inputs += 1
    started = time.process_time()
    try:
        # A warning, too, would be on somebody's screen
        with _not_for_ever(), warnings.catch_warnings():
            warnings.simplefilter("error")
            read()
    except RulecError as error:
        trial.refused += 1
        try:
            assert_refused_well(error, folder)
        except AssertionError:
            trial.failures[seed] = f"{error}\n{traceback.format_exc(limit=-1)}"
    except Exception:
        trial.failures[seed] = traceback.format_exc(limit=-3)
    taken = time.process_time() - started
    if taken > trial.longest_s:
        trial.longest_s, trial.longest_seed = taken, seed


@contextmanager
def _not_for_ever() -> Iterator[None]:
    """Raise an error in what takes much too long."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {LONGEST_S:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LONGEST_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _peak_mb() -> float:
    return getrusage(RUSAGE_SELF).ru_maxrss / 1024


def summary(trial: Trial) -> str:
    """A line, and the first of the failures."""
    line = (
        f"{trial.name:22} {trial.inputs:7,} inputs {trial.refused:7,} refused "
        f"{len(trial.failures):5,} failed  longest {trial.longest_s:6.3f} s "
        f"(seed {trial.longest_seed})  memory +{trial.grown_mb:.0f} MB"
    )
    shown = list(trial.failures.items())[:_MOST_SHOWN]
    return "\n".join([line, *(f"seed {seed}: {why}" for seed, why in shown)])
