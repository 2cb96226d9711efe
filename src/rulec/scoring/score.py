"""Scoring futures: each is extracted and judged like a recorded drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.diagnostics.fault_messages import fault_of
from rulec.extraction.drives import FEWEST_STATES
from rulec.extraction.recording_verdicts import (
    JudgedDrive,
    judged_drives,
    names_read,
)
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traces.to_trace import TraceWriter
from rulec.extraction.tracks.mirror import mirrored_participant
from rulec.garbage_collection import no_garbage_collection
from rulec.monitoring.verdict import NotJudged, RuleFor, Violation, rule_for
from rulec.recordings.recording import Participant
from rulec.scoring.candidate_score import CandidateScore, lost_candidate, without_drives
from rulec.scoring.charges import CandidateCharges, CandidateScores, forget_reasons, open_of
from rulec.scoring.rescoring import kept_since, opened_by, rescored, verdicts_of
from rulec.scoring.scores import Scores
from rulec.scoring.scoring_messages import BAD_CANDIDATES
from rulec.scoring.traffic_world import TrafficWorld


class _Past(NamedTuple):
    """What a past alone violates, and what it leaves open whatever follows."""

    violated: tuple[Violation, ...] = ()
    opened: frozenset[RuleFor] = frozenset()


_Pasts: TypeAlias = "WeakKeyDictionary[TrafficWorld, tuple[Any, _Past]]"
"""For each world the last past asked about, and what it did."""


def score(
    candidates: ArrayLike,
    world: TrafficWorld,
    rules: CompiledRulebook,
    after: ArrayLike | None = None,
) -> Scores:
    """Judge possible futures of ego, each candidate by itself, after its past.

    ``candidates`` (candidate x state x 4) has x, y (m), heading (rad) and speed (m/s), one state
    for each step of the world from the one after its present on; ``after`` (state x 4) are the
    states up to the present, and may be empty. The verdicts are those of ``verify_recording`` for
    the recording in which ego drives past and candidate. Raises RulecError R0780, and R0507 if a
    rule was compiled for another step than the world's.
    """
    paths, past = world.candidates_of(candidates), world.past_of(after)
    if len(past) + paths.shape[1] < FEWEST_STATES:
        message = "candidates: a single state without a past cannot be judged"
        way_out = "give what led up to it, such as `after=world.past`, or more states"
        raise BAD_CANDIDATES.error(None, message, help=way_out)
    # Many candidates create tens of thousands of objects, none of which is garbage
    with no_garbage_collection():
        try:
            return _scored(paths, past, world, rules)
        except Exception as problem:
            return _scored_apart(paths, past, world, rules, problem)


def _scored_apart(
    paths: NDArray[np.float64],
    past: NDArray[np.float64],
    world: TrafficWorld,
    rules: CompiledRulebook,
    problem: Exception,
) -> Scores:
    """The scores after a fault of rulec: it costs the candidates that have it by themselves."""
    candidates: list[CandidateScore] = []
    before: tuple[Violation, ...] = ()
    for number in range(len(paths)):
        try:
            alone = _scored(paths[number : number + 1], past, world, rules)
            (found,), before = alone.candidates, alone.violated_before
        except Exception as own:
            found = lost_candidate(number, paths.shape[1], own)
        candidates.append(replace(found, number=number))
    if not any(candidate.faults for candidate in candidates):
        candidates[0] = replace(candidates[0], faults=(fault_of(problem, "candidates"),))
    at_step = _at_step(rules, world.recording.step_s)
    return Scores(at_step, CandidateScores(candidates), before, paths, world.now + 1)


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
    key, before = known.get(world, (None, _Past()))
    before = before if key == about else _Past()
    is_asked = key != about and len(past) > 0
    if is_asked:
        # The past alone, first, to find what it violates whatever follows
        bodies.insert(0, world.body_at(past, steps[0]))
    at_step = _at_step(rules, world.recording.step_s)
    beside, back = world.beside_lanes(paths), world.drives_back(paths, past)
    again = partial(_by_itself, paths, past, world, rules)
    half = first + n_states // 2
    candidates: dict[int, CandidateCharges | CandidateScore] = {}
    is_awaited = is_asked
    for block in _judged(bodies, world, at_step, steps):
        # Of many candidates, most are never looked at again
        is_kept = len(block) == len(bodies)
        if is_awaited:
            before, is_awaited = _past(block.pop(0)[1]), False
        block = [(number - is_asked, own) for number, own in block]
        drives = [*map(_judged_drives, block)]
        kept = partial(
            kept_since, drives=drives, known=before.opened, rulebook=at_step, first=first
        )
        open_before = [frozenset[RuleFor]()] * len(block)
        if not before.violated:
            # The score of a candidate is made on demand.
            rules_before = {rule for rule, _ in before.opened}
            open_before = kept(open_of([own for _, own in block], rules_before))
        charges = _charges(block, first, (beside, back), open_before)
        if before.violated:
            scores = rescored(
                [candidate_charges.score() for candidate_charges in charges],
                before.violated,
                at_step,
                (first, half),
            )
            maybe = [{*map(rule_for, candidate.open)} for candidate in scores]
            scores = [x.apart(own) for x, own in zip(scores, kept(maybe), strict=True)]
            if not is_kept:
                scores = [
                    without_drives(
                        candidate, len(candidate.drives), partial(again, candidate.number)
                    )
                    for candidate in scores
                ]
            candidates.update({candidate.number: candidate for candidate in scores})
            del scores
        else:
            candidates.update({x.number: x if is_kept else x.later(again) for x in charges})
        if not is_kept:
            forget_reasons(charges)
        # Freed before the next block is made
        del block, charges, drives, kept
    # The next candidates mostly have the same past.
    known[world] = about, before
    ordered = CandidateScores([candidates[number] for number in range(len(paths))])
    return Scores(at_step, ordered, before.violated, paths, first)


def _at_step(rules: CompiledRulebook, step_s: float) -> CompiledRulebook:
    """The rulebook at a world's step. Raises R0507 if it is for another one."""
    at_step = rules.judgeable_at(step_s)
    for rule in at_step.rules:
        check_step(rule, exact_step(step_s), "the world")
    return at_step


def _by_itself(
    paths: NDArray[np.float64],
    past: NDArray[np.float64],
    world: TrafficWorld,
    rules: CompiledRulebook,
    number: int,
) -> CandidateScore:
    """The score of one candidate, computed alone and with its drives."""
    (found,) = _scored(paths[number : number + 1], past, world, rules).candidates
    return found


def _past(drives: Sequence[JudgedDrive | NoDrive]) -> _Past:
    made = [drive.with_verdict() for drive in drives if isinstance(drive, JudgedDrive)]
    violated = [violation for _, verdict in verdicts_of(made) for violation in verdict.violations]
    return _Past(tuple(violated), opened_by(made))


def _judged(
    bodies: Sequence[Participant],
    world: TrafficWorld,
    rules: CompiledRulebook,
    steps: tuple[int, int],
) -> Iterator[list[tuple[int, list[JudgedDrive | NoDrive]]]]:
    """The judged drives of some bodies at a time, with the body's index."""
    drives, mirrored = world.drives(rules.traffic, *steps)
    if mirrored:
        bodies = [mirrored_participant(body) for body in bodies]
    wanted = world.wanted
    names = names_read(rules)
    writer = TraceWriter(rules.vocabulary, names, wanted.assumed, wanted.defaults)
    for block in drives.in_blocks(bodies, writer):
        judged = judged_drives([drive for _, own in block for drive in own], rules)
        yield [(number, [next(judged) for _ in own]) for number, own in block]
        del block, judged


def _judged_drives(candidate: tuple[int, Sequence[JudgedDrive | NoDrive]]) -> list[Drive]:
    own = [drive for drive in candidate[1] if isinstance(drive, JudgedDrive)]
    return [drive.drive for drive in own if not isinstance(drive.judged, NotJudged)]


def _charges(
    block: Sequence[tuple[int, Sequence[JudgedDrive | NoDrive]]],
    first: int,
    off_lanes: tuple[NDArray[np.bool_], NDArray[np.bool_]],
    open_before: Sequence[frozenset[RuleFor]],
) -> list[CandidateCharges]:
    """Candidates with everything that their drives violate; ``first`` is their first step.

    ``off_lanes`` are masks of all states beside all lanes, and of those driven backwards;
    ``open_before`` is what is open and not charged to each.
    """
    members = np.array([number for number, _ in block], dtype=np.intp)
    beside, back = (flags[members] for flags in off_lanes)
    on_road, begins = np.zeros(beside.shape, dtype=bool), []
    for row, (_, drives) in zip(on_road, block, strict=True):
        begins.append(
            [x.drive.first_step - first if isinstance(x, JudgedDrive) else 0 for x in drives]
        )
        for drive, start in zip(drives, begins[-1], strict=True):
            if isinstance(drive, JudgedDrive) and not isinstance(drive.judged, NotJudged):
                row[max(start, 0) : max(start + drive.drive.arrays.n_states, 0)] = True
    off_road = beside | ~on_road
    leave, go_back, are_judged = (
        np.logical_or.reduce(flags, axis=1).tolist() for flags in (off_road, back, on_road)
    )
    counts = (off_road | back).sum(axis=1).tolist()
    return [
        CandidateCharges(
            number,
            drives,
            begins[row],
            off_road=counts[row],
            is_judged=are_judged[row],
            why=_why(drives, leaves=leave[row], goes_back=go_back[row]),
            open_before=open_before[row],
        )
        for row, (number, drives) in enumerate(block)
    ]


def _why(drives: Sequence[JudgedDrive | NoDrive], *, leaves: bool, goes_back: bool) -> str:
    """The reason why states of a candidate are not judged, or off the road."""
    reasons = [drive.why for drive in drives if isinstance(drive, NoDrive)]
    judged = [drive.judged for drive in drives if isinstance(drive, JudgedDrive)]
    reasons += [str(drive.error) for drive in judged if isinstance(drive, NotJudged)]
    if leaves and not reasons:
        reasons = ["it leaves the lanes that lead its way"]
    if goes_back:
        reasons.append("it drives backwards, faster than at walking pace")
    return "; ".join(reasons)
