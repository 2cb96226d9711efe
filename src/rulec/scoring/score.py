"""Scores of futures: each is extracted and judged as a drive that was recorded."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import (
    DriveVerdict,
    agreed_answers,
    names_read,
    rounded_rulebooks,
    verified,
)
from rulec.extraction.to_trace import Drive, TraceWriter
from rulec.extraction.tracks.mirror import mirrored_participant
from rulec.files import no_garbage_collection
from rulec.monitoring.verdict import NotJudged, OpenVerdict, Verdict, Violation
from rulec.recordings.recording import Participant
from rulec.scoring.scored_again import without_drives
from rulec.scoring.scores import CandidateScore, Scores
from rulec.scoring.traffic_world import TrafficWorld

_Key = tuple[str, tuple[str, ...]]
"""A rule, and the objects of its variables."""

_Pasts: TypeAlias = "WeakKeyDictionary[TrafficWorld, tuple[Any, tuple[Violation, ...]]]"
"""By worlds the last past that was asked about, and what it violates by itself."""


def score(
    candidates: ArrayLike,
    world: TrafficWorld,
    rules: CompiledRulebook,
    after: ArrayLike | None = None,
) -> Scores:
    """Judge what one might do next, each candidate by itself, after what was before.

    ``candidates`` (candidate x state x 4) has x, y (m), heading (rad) and speed (m/s), a state for
    each step of the world from the one after its present on; ``after`` (state x 4) leads up to it,
    and may have no states. Each is what ``verify_recording`` says of the recording in which ego
    drives so, past and candidate together. Raises RulecError R0780.
    """
    paths, past = world.candidates_of(candidates), world.past_of(after)
    # Many candidates have some ten thousand parts, none of which is garbage
    with no_garbage_collection():
        return _scored(paths, past, world, rules)


def _scored(
    paths: NDArray[np.float64],
    past: NDArray[np.float64],
    world: TrafficWorld,
    rules: CompiledRulebook,
) -> Scores:
    bodies = world.bodies_along(paths, past)
    first, n_states = world.now + 1, paths.shape[1]
    steps = first - len(past), first + n_states - 1
    about = past.tobytes(), steps
    known: _Pasts = rules.prepared.setdefault(score, WeakKeyDictionary())
    key, before = known.get(world, (None, ()))
    before = before if key == about else ()
    is_asked = key != about and len(past) > 0
    if is_asked:
        # Alone, and before all others, to see what it has violated whatever comes
        bodies.insert(0, world.body_at(past, steps[0]))
    roundings = rounded_rulebooks(rules, world.recording.step_s)
    beside, back = world.beside_lanes(paths), world.drives_back(paths, past)
    scores: dict[int, CandidateScore] = {}
    for block in _judged(bodies, world, roundings, steps):
        is_every = len(block) == len(bodies)
        if is_asked and not scores:
            ((_, alone), *block) = block
            before = tuple([one for _, verdict in _verdicts(alone) for one in verdict.violations])
        charged = [
            _charged(at, own, first, beside[at], back[at])
            for at, own in ((number - is_asked, own) for number, own in block)
        ]
        half = first + n_states // 2
        for found in _anew(charged, before, roundings, (first, half)):
            again = partial(_by_itself, paths[found.number], past, world, rules)
            # What is among many is mostly looked at no more
            scores[found.number] = found if is_every else without_drives(found, again)
        # Before the next ones are made
        del block, charged, found
    # The next candidates are mostly asked about after the same past.
    known[world] = about, before
    ordered = tuple([scores[number] for number in range(len(paths))])
    return Scores(roundings[0], ordered, before, paths, first)


def _by_itself(
    path: NDArray[np.float64],
    past: NDArray[np.float64],
    world: TrafficWorld,
    rules: CompiledRulebook,
) -> CandidateScore:
    """What one candidate comes to, with its drives."""
    (found,) = _scored(path[None], past, world, rules).candidates
    return found


def _judged(
    bodies: Sequence[Participant],
    world: TrafficWorld,
    roundings: Sequence[CompiledRulebook],
    steps: tuple[int, int],
) -> Iterator[list[tuple[int, tuple[DriveVerdict | NoDrive, ...]]]]:
    """The verdicts on the drives of some bodies at a time, by number, of which 0 is the first."""
    rules = roundings[0]
    drives, mirrored = world.drives(rules.traffic, *steps)
    if mirrored:
        bodies = [mirrored_participant(body) for body in bodies]
    wanted = world.wanted
    names = names_read(rules)
    writer = TraceWriter(rules.vocabulary, names, wanted.assumed, wanted.defaults)
    for block in drives.in_blocks(bodies, writer):
        answers = _verified([own for _, own in block], roundings)
        numbers = [number for number, _ in block]
        del block
        yield list(zip(numbers, answers, strict=True))
        del answers


def _verified(
    drives: Sequence[tuple[Drive | NoDrive, ...]], roundings: Sequence[CompiledRulebook]
) -> Iterator[tuple[DriveVerdict | NoDrive, ...]]:
    answers = verified([drive for own in drives for drive in own], roundings)
    for own in drives:
        yield tuple([next(answers) for _ in own])


def _verdicts(
    drives: Sequence[DriveVerdict | NoDrive],
) -> Iterator[tuple[Drive, Verdict]]:
    for one in drives:
        if isinstance(one, DriveVerdict) and isinstance(one.answer, Verdict):
            yield one.drive, one.answer


def _charged(
    number: int,
    drives: tuple[DriveVerdict | NoDrive, ...],
    first: int,
    beside: NDArray[np.bool_],
    back: NDArray[np.bool_],
) -> CandidateScore:
    """A candidate from a step on, charged with all that is violated.

    ``beside`` flags its states that are beside all lanes, ``back`` those in which it drives back.
    """
    violations: list[Violation] = []
    doubtful: list[OpenVerdict] = []
    not_judged = {}
    on_road = np.zeros(len(beside), dtype=bool)
    for drive, verdict in _verdicts(drives):
        begins = drive.first_step - first
        on_road[max(begins, 0) : max(begins + drive.arrays.n_states, 0)] = True
        violations += [_at(violation, begins) for violation in verdict.violations]
        doubtful += verdict.open
        not_judged.update({one.rule: one for one in verdict.not_judged})
    reasons = [one.why for one in drives if isinstance(one, NoDrive)]
    reasons += [
        str(one.answer.error)
        for one in drives
        if isinstance(one, DriveVerdict) and isinstance(one.answer, NotJudged)
    ]
    off_road = beside | ~on_road
    if off_road.any() and not reasons:
        reasons = ["it leaves the lanes that lead its way"]
    if back.any():
        reasons.append("it drives backwards, faster than at walking pace")
    return CandidateScore(
        number,
        violations=tuple(violations),
        open=tuple(doubtful),
        not_judged=tuple(not_judged.values()),
        off_road=int((off_road | back).sum()),
        why="; ".join(reasons),
        drives=drives,
    )


def _at(violation: Violation, begins: int) -> Violation:
    step = violation.step
    return replace(violation, step=step + begins) if begins and step is not None else violation


def _anew(
    scores: list[CandidateScore],
    before: Sequence[Violation],
    roundings: Sequence[CompiledRulebook],
    steps: tuple[int, int],
) -> list[CandidateScore]:
    """The scores with what was violated before judged by what comes alone.

    ``steps`` are the candidates' first one, and the one from which on they are judged so: half of
    their time is left to mend what goes on.
    """
    first, begin = steps
    known = {_key(violation) for violation in before}
    if not known:
        return scores
    futures = [
        (number, max(begin - drive.first_step, 0), drive)
        for number, found in enumerate(scores)
        for drive, _ in _verdicts(found.drives)
        if drive.first_step + drive.arrays.n_states > begin
    ]
    answers = agreed_answers([drive.arrays.since(at) for _, at, drive in futures], roundings)
    late = _mended_after([(number, drive) for number, _, drive in futures], known, roundings, steps)
    violations: dict[int, list[Violation]] = {}
    doubtful: dict[int, list[OpenVerdict]] = {}
    for (number, at, drive), answer in zip(futures, answers, strict=True):
        if isinstance(answer, Verdict):
            begins = drive.first_step + at - first
            own = [_at(one, begins) for one in answer.violations if _key(one) in known]
            violations.setdefault(number, []).extend(own)
            doubtful.setdefault(number, []).extend(x for x in answer.open if _key(x) in known)
    return [
        replace(
            found,
            violations=(
                *(one for one in found.violations if _key(one) not in known),
                *violations.get(number, ()),
            ),
            open=(
                *(one for one in found.open if _key(one) not in known),
                *doubtful.get(number, ()),
            ),
            late=late.get(number, 0),
        )
        for number, found in enumerate(scores)
    ]


def _mended_after(
    drives: Sequence[tuple[int, Drive]],
    known: Collection[_Key],
    roundings: Sequence[CompiledRulebook],
    steps: tuple[int, int],
) -> dict[int, int]:
    """How many states of candidates, by number, pass before what was violated is kept for good.

    What is kept from some state on is kept from any later one on, so half of them are asked about
    at a time.
    """
    first, begin = steps
    low, high = np.zeros(len(drives), dtype=int), np.full(len(drives), begin - first)
    while (low < high).any():
        middle = (low + high) // 2
        futures = [
            drive.arrays.since(max(first + after - drive.first_step, 0))
            for after, (_, drive) in zip(middle.tolist(), drives, strict=True)
        ]
        is_kept = np.array([_keeps(one, known) for one in agreed_answers(futures, roundings)])
        low, high = np.where(is_kept, low, middle + 1), np.where(is_kept, middle, high)
        low = np.minimum(low, high)
    late: dict[int, int] = {}
    for (number, _), states in zip(drives, low.tolist(), strict=True):
        late[number] = max(states, late.get(number, 0))
    return late


def _keeps(answer: Verdict | NotJudged, known: Collection[_Key]) -> bool:
    if not isinstance(answer, Verdict):
        return True
    is_open = any(_key(one) in known for one in answer.open)
    return not is_open and not any(_key(one) in known for one in answer.violations)


def _key(found: Violation | OpenVerdict) -> _Key:
    return found.rule, tuple(found.binding.values())
