"""What the past has violated: whether a candidate ends it, and does nothing of the kind again.

What goes on is violated again as soon as it can be, each time one begins to look: then the first
half of a candidate is left to end it. What is violated later than that is violated anew.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from rulec.automata.bundle.compiled_rulebook import (
    CompiledRule,
    CompiledRulebook,
    PrefixCompiler,
)
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.extraction.recording_verdicts import (
    DriveVerdict,
    SomeRules,
    some_rules,
)
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.monitoring.batch.verify_arrays import answer_to, judge_contained
from rulec.monitoring.verdict import (
    NotJudged,
    OpenVerdict,
    RuleFor,
    Verdict,
    Violation,
    agreed_by_type,
    rule_for,
)
from rulec.scoring.candidate_score import CandidateScore
from rulec.scoring.charges import at
from rulec.trace.trace_arrays import TraceArrays, stretches_of


def verdicts_of(
    drives: Sequence[DriveVerdict | NoDrive],
) -> Iterator[tuple[Drive, Verdict]]:
    """The drives that have been judged, with their verdicts."""
    for drive in drives:
        if isinstance(drive, DriveVerdict) and isinstance(drive.answer, Verdict):
            yield drive.drive, drive.answer


def rescored(
    scores: list[CandidateScore],
    before: Sequence[Violation],
    rulebook: CompiledRulebook,
    steps: tuple[int, int],
) -> list[CandidateScore]:
    """The scores, with rules that the past violated judged anew by the future alone.

    ``steps`` are the candidates' first step, and the one from which they are judged so: the first
    half of their time is left for ending a violation that goes on, and for nothing else.
    """
    known = {rule_for(violation) for violation in before}
    if not known:
        return scores
    found = _anew(scores, known, rulebook, steps)
    n_others = max(
        (len(drive.otherwise) for x in scores for drive, _ in verdicts_of(x.drives)), default=0
    )
    for number in range(n_others):
        others, types = zip(*[_with_types(own, number) for own in scores], strict=True)
        anew = _anew(others, known, rulebook, steps)
        found = [
            _agreed_by_type(own, other, kinds, known) if kinds else own
            for own, other, kinds in zip(found, anew, types, strict=True)
        ]
    return found


def opened_by(drives: Sequence[DriveVerdict | NoDrive]) -> frozenset[RuleFor]:
    """What the drives of a past alone leave open."""
    return frozenset(
        rule_for(result) for _, verdict in verdicts_of(drives) for result in verdict.open
    )


def kept_since(
    doubtful: Sequence[Set[RuleFor]],
    drives: Sequence[Sequence[Drive]],
    known: Set[RuleFor],
    rulebook: CompiledRulebook,
    first: int,
) -> list[frozenset[RuleFor]]:
    """What candidates' own states, from step ``first`` on, keep of what they leave open.

    ``doubtful`` is what each candidate leaves open; asked of it is what the past alone leaves open,
    which is ``known``. Its drives are judged after any past that is not lost yet, with each type
    that participants may have.
    """
    if not known:
        return [frozenset() for _ in doubtful]
    some = _after_any_past(frozenset(rule for rule, _ in known), rulebook)
    kept = [set(about & known) for about in doubtful]
    futures = [
        _Future(number, drive.first_step, trace)
        for number, own_drives in enumerate(drives)
        if kept[number]
        for drive in own_drives
        if drive.first_step + drive.arrays.n_states > first
        for trace in (drive.arrays, *drive.otherwise)
    ]
    for future, answer in zip(futures, _since([first] * len(futures), futures, some), strict=True):
        own = kept[future.number]
        if isinstance(answer, Verdict):
            untold = {result.rule for result in answer.not_judged}
            own -= {about for about in own if about[0] in untold or not _keeps(answer, {about})}
        else:
            own.clear()
    return [frozenset(own) for own in kept]


def _after_any_past(names: frozenset[str], rulebook: CompiledRulebook) -> SomeRules:
    """Some rules for traces that begin after any states that have not lost the rule for good.

    Duties of those states may be left, too, which ``since`` takes to be none.
    """
    known: dict[frozenset[str], SomeRules] = rulebook.prepared.setdefault(_after_any_past, {})
    if names not in known:
        known.clear()  # mostly the same ones are open in each past
        some = some_rules(names, rulebook)
        prefixes = some.rulebook.prefixes
        if prefixes is not None:
            begun = replace(some.rulebook, prefixes=partial(_begun_anywhere, prefixes))
            some = SomeRules(begun, some.names)
        known[names] = some
    return known[names]


def _begun_anywhere(
    prefixes: PrefixCompiler, rulebook: CompiledRulebook
) -> dict[str, OutcomeMachine | None]:
    def begun(machine: OutcomeMachine) -> OutcomeMachine:
        left = frozenset(range(len(machine.successors))) - machine.lost
        return replace(machine, starts=left or machine.starts)

    machines = prefixes(rulebook).items()
    return {name: None if machine is None else begun(machine) for name, machine in machines}


def _with_types(score: CandidateScore, number: int) -> tuple[CandidateScore, list[str]]:
    """The score with the drives there would be by the types of that number, and these types."""
    drives: list[DriveVerdict | NoDrive] = []
    types: set[str] = set()
    for drive in score.drives:
        if isinstance(drive, DriveVerdict) and len(drive.drive.otherwise) > number:
            own, other = drive.drive.arrays, drive.drive.otherwise[number]
            types |= {kind for _, kind in other.objects.items() - own.objects.items()}
            drive = replace(drive, drive=replace(drive.drive, arrays=other))
        drives.append(drive)
    return replace(score, drives=drives), sorted(types)


def _agreed_by_type(
    score: CandidateScore, other: CandidateScore, types: Sequence[str], known: Collection[RuleFor]
) -> CandidateScore:
    """What both scores say of what the past violated; where they differ it depends on the types."""
    one, two = (
        Verdict(
            "",
            tuple([x for x in found.violations if rule_for(x) in known]),
            tuple([x for x in found.open if rule_for(x) in known]),
        )
        for found in (score, other)
    )
    agreed = agreed_by_type(one, [(types, two)])
    return replace(
        score,
        violations=(*[x for x in score.violations if rule_for(x) not in known], *agreed.violations),
        open=(*[x for x in score.open if rule_for(x) not in known], *agreed.open),
        late=max(score.late, other.late),
    )


def _anew(
    scores: Sequence[CandidateScore],
    known: Collection[RuleFor],
    rulebook: CompiledRulebook,
    steps: tuple[int, int],
) -> list[CandidateScore]:
    """The scores, with the ``known`` rules judged anew."""
    first, begin = steps
    some = some_rules(frozenset(rule for rule, _ in known), rulebook)
    futures = [
        _Future(number, drive.first_step, drive.arrays)
        for number, found in enumerate(scores)
        for drive, _ in verdicts_of(found.drives)
        if drive.first_step + drive.arrays.n_states > begin
    ]
    answers = _since([begin] * len(futures), futures, some)
    late = _mended_after(futures, known, some, steps)
    new, ended = _violated_again(futures, known, some, steps)
    reopened = _open_again(futures, ended, some, begin)
    violations: dict[int, list[Violation]] = {}
    judged_from: dict[int, dict[RuleFor, int]] = {}
    doubtful: dict[int, list[OpenVerdict]] = {}
    for place, (future, again, answer) in enumerate(zip(futures, new, answers, strict=True)):
        number, own = future.number, dict(again)
        if isinstance(answer, Verdict):
            begins, asked = max(begin, future.first_step) - first, known - again.keys()
            own |= {rule_for(x): (begins, x) for x in answer.violations if rule_for(x) in asked}
            sooner = {about: x for about, x in reopened[place].items() if about not in own}
            asked -= sooner.keys()
            doubtful.setdefault(number, []).extend(x for x in answer.open if rule_for(x) in asked)
            doubtful[number].extend(sooner.values())
        violations.setdefault(number, []).extend(at(x, begins) for begins, x in own.values())
        judged_from.setdefault(number, {}).update({x: begins for x, (begins, _) in own.items()})
    return [
        replace(
            found,
            violations=(
                *(violation for violation in found.violations if rule_for(violation) not in known),
                *violations.get(number, ()),
            ),
            open=(
                *(verdict for verdict in found.open if rule_for(verdict) not in known),
                *doubtful.get(number, ()),
            ),
            late=late.get(number, 0),
            judged_from=judged_from.get(number, {}),
        )
        for number, found in enumerate(scores)
    ]


class _Future(NamedTuple):
    """A candidate's drive and the step in which it begins; ``number`` is the candidate's."""

    number: int
    first_step: int
    trace: TraceArrays


def _since(
    steps: Sequence[int], futures: Sequence[_Future], some: SomeRules, most: int | None = None
) -> list[Verdict | NotJudged]:
    """The answers to the drives, each from a step on, as if nothing before were known.

    With ``most`` nothing is known after so many states, either.
    """
    stretches = [
        range(own.trace.n_states)[max(step - own.first_step, 0) :][:most]
        for step, own in zip(steps, futures, strict=True)
    ]
    traces = stretches_of([own.trace for own in futures], stretches, some.names)
    judged = judge_contained(traces, some.rulebook)
    return [answer_to(own, trace) for own, trace in zip(judged, traces, strict=True)]


_Asked = Mapping[tuple[int, RuleFor], int]
"""By future and rule, the step from which on it is asked."""


def _answers(
    futures: Sequence[_Future], asked: _Asked, some: SomeRules, most: int | None = None
) -> Iterator[tuple[tuple[int, RuleFor], Verdict | NotJudged]]:
    """The answer to each question; ``most`` as in ``_since``."""
    jobs = sorted({(n, step) for (n, _), step in asked.items()})
    answers = _since([step for _, step in jobs], [futures[n] for n, _ in jobs], some, most)
    answered = dict(zip(jobs, answers, strict=True))
    for key, step in asked.items():
        yield key, answered[key[0], step]


def _about(
    answer: Verdict | NotJudged, about: RuleFor
) -> tuple[Violation | None, OpenVerdict | None]:
    """What an answer says of a rule and objects: a violation, or that it is open."""
    if not isinstance(answer, Verdict):
        return None, None
    violation = next((x for x in answer.violations if rule_for(x) == about), None)
    return violation, next((x for x in answer.open if rule_for(x) == about), None)


def _mended_after(
    futures: Sequence[_Future],
    known: Collection[RuleFor],
    some: SomeRules,
    steps: tuple[int, int],
) -> dict[int, int]:
    """For each candidate the number of states until what the past violated is kept for good.

    Found by bisection, since what is kept from some state on is kept from any later one on.
    """
    first, begin = steps
    low, high = np.zeros(len(futures), dtype=int), np.full(len(futures), begin - first)
    while (low < high).any():
        middle = (low + high) // 2
        answers = _since((first + middle).tolist(), futures, some)
        is_kept = np.array([_keeps(answer, known) for answer in answers])
        low, high = np.where(is_kept, low, middle + 1), np.where(is_kept, middle, high)
        low = np.minimum(low, high)
    late: dict[int, int] = {}
    for future, states in zip(futures, low.tolist(), strict=True):
        late[future.number] = max(states, late.get(future.number, 0))
    return late


def _keeps(answer: Verdict | NotJudged, known: Collection[RuleFor]) -> bool:
    if not isinstance(answer, Verdict):
        return True
    is_open = any(rule_for(open_verdict) in known for open_verdict in answer.open)
    return not is_open and not any(rule_for(violation) in known for violation in answer.violations)


def _violated_again(
    futures: Sequence[_Future],
    known: Collection[RuleFor],
    some: SomeRules,
    steps: tuple[int, int],
) -> tuple[list[dict[RuleFor, tuple[int, Violation]]], list[dict[RuleFor, int]]]:
    """For each future what it violates after the past's violation has ended, and when it has.

    With each violation comes the state of the candidate from which it is judged, and from which its
    steps count. The second list has, of what is not violated surely again, the step from which it
    is asked last. As long as the past's goes on, a rule that is asked from some state on is
    violated after as many states as it takes at least, and so it is if it is asked from the next
    one on.
    """
    first, begin = steps
    soonest = {rule.name: _least_states(rule) for rule in some.rulebook.rules}
    found: list[dict[RuleFor, tuple[int, Violation]]] = [{} for _ in futures]
    ended: list[dict[RuleFor, int]] = [{} for _ in futures]
    asked = {(n, about): first for n in range(len(futures)) for about in known}
    while asked:
        goes_on = {}
        for (n, about), answer in _answers(futures, asked, some):
            step, (one, _) = asked[n, about], _about(answer, about)
            if one is None or one.step is None:
                ended[n][about] = step
                continue
            begins = max(step, futures[n].first_step)
            if one.step >= soonest[about[0]]:
                found[n][about] = begins - first, one
            elif begins + one.step + 1 < begin:
                goes_on[n, about] = begins + one.step + 1
        asked = goes_on
    return found, ended


def _open_again(
    futures: Sequence[_Future],
    ended: Sequence[Mapping[RuleFor, int]],
    some: SomeRules,
    begin: int,
) -> list[dict[RuleFor, OpenVerdict]]:
    """For each future what is open after the past's violation has surely ended, before ``begin``.

    ``ended`` has the steps from which nothing is surely violated. What is open from there on may be
    the rest of the past's violation, until a state that by itself surely keeps the rule.
    """
    found: list[dict[RuleFor, OpenVerdict]] = [{} for _ in futures]
    asked = {(n, about): step for n, own in enumerate(ended) for about, step in own.items()}
    answers = _answers(futures, asked, some)
    waiting = {key: asked[key] for key, answer in answers if _about(answer, key[1])[1]}
    surely = {}
    while waiting := {key: step for key, step in waiting.items() if step < begin}:
        for key, answer in list(_answers(futures, waiting, some, most=1)):
            if _keeps(answer, {key[1]}):
                surely[key] = waiting.pop(key)
            else:
                waiting[key] += 1
    for (n, about), answer in _answers(futures, surely, some):
        _, verdict = _about(answer, about)
        if verdict is not None:
            found[n][about] = verdict
    return found


def _least_states(rule: CompiledRule) -> int:
    """How many states it takes at least to violate a rule."""
    machine = rule.machine
    reached, states = {0}, 0
    here = reached
    while here and machine.rejecting_sink not in here:
        here = {after for state in here for after in machine.successors[state]} - reached
        reached |= here
        states += 1
    return states
