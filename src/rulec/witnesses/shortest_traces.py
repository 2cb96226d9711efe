"""Shortest words on which monitors give verdicts, and shortest traces of one rule.

The product of several monitors is searched breadth first, and only built as far as needed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.vocabulary import Vocabulary
from rulec.witnesses.joint_alphabet import JointLetter
from rulec.witnesses.letter_functions import Digits
from rulec.witnesses.letter_witness import LetterWitnesses, WitnessTrace
from rulec.witnesses.undecided import UndecidedError

MOST_STATES = 50_000
MOST_STEPS = 3_000_000
"""The most states and transitions of a product that a search examines."""

ProductState = tuple[int, ...]


def shortest_word(
    monitors: Sequence[MealyMonitor],
    verdicts: Sequence[bool],
    letters: Sequence[JointLetter],
    can_be_read: Callable[[JointLetter], bool] = lambda _: True,
) -> tuple[JointLetter, ...] | None:
    """Find a shortest non-empty word with these verdicts, or None.

    Among several, the first in the order of ``letters`` that can be read is returned;
    ``can_be_read`` is only called where it matters. A single monitor is searched completely; raises
    UndecidedError if a product is too large for that.
    """
    start: ProductState = (0,) * len(monitors)
    words: dict[ProductState, tuple[JointLetter, ...]] = {start: ()}
    waiting = [start]
    hopeless = [
        monitor.rejecting_sink if verdict else monitor.accepting_sink
        for monitor, verdict in zip(monitors, verdicts, strict=True)
    ]
    steps = 0
    for state in waiting:
        pairs = list(zip(monitors, state, strict=True))
        outputs = [monitor.outputs[own] for monitor, own in pairs]
        successors = [monitor.successors[own] for monitor, own in pairs]
        for letter in letters:
            if all(
                row[own] is verdict
                for row, own, verdict in zip(outputs, letter, verdicts, strict=True)
            ) and can_be_read(letter):
                return (*words[state], letter)
            target = tuple([row[own] for row, own in zip(successors, letter, strict=True)])
            if target in words or any(
                own == sink for own, sink in zip(target, hopeless, strict=True)
            ):
                continue
            if not can_be_read(letter):
                continue
            words[target] = (*words[state], letter)
            waiting.append(target)
        steps += len(letters)
        if len(monitors) > 1 and (len(waiting) > MOST_STATES or steps > MOST_STEPS):
            raise UndecidedError("their automata together are too large")
    return None


@dataclass(frozen=True, slots=True)
class ShortestTraces:
    """An accepted trace and a shortest rejected trace of a rule, each or None.

    The accepted trace differs from the rejected one in one state if possible; otherwise it shows
    more of the rule than a trace that never leaves the first state of its automaton, if possible.
    What cannot change is the same in all states.
    """

    accepted: WitnessTrace | None
    rejected: WitnessTrace | None


def shortest_traces(rule: CompiledRule, vocabulary: Vocabulary) -> ShortestTraces:
    """Find the traces, with states in terms of the rule's variables.

    Impossible states, such as one with `speed < 30` and `speed > 50`, do not occur.
    """
    monitor = rule.machine
    witnesses = LetterWitnesses(rule, vocabulary)
    rejected = _shortest(monitor, witnesses, accepted=False)
    accepted = (
        (rejected and _near_miss(monitor, rejected, witnesses))
        or _shortest(_after_first_state(monitor), witnesses, accepted=True)
        or _shortest(monitor, witnesses, accepted=True)
    )
    return ShortestTraces(
        witnesses.trace(accepted) if accepted else None,
        witnesses.trace(rejected) if rejected else None,
    )


def _shortest(
    monitor: MealyMonitor, witnesses: LetterWitnesses, *, accepted: bool
) -> list[int] | None:
    """A shortest word of letters with the same constants, with most defaults of these.

    Mostly the plainest letters have the same constants; only if not, each value is searched.
    """
    plainest = _shortest_with(None, monitor, witnesses, accepted=accepted)
    if plainest is None or len(set(map(witnesses.constants, plainest))) == 1:
        return plainest
    words = [
        _shortest_with(constants, monitor, witnesses, accepted=accepted)
        for constants in witnesses.all_constants()
    ]
    return min((word for word in words if word is not None), key=len, default=None)


def _shortest_with(
    constants: Digits | None, monitor: MealyMonitor, witnesses: LetterWitnesses, *, accepted: bool
) -> list[int] | None:
    plainest: dict[JointLetter, int] = {
        (letter_class,): letter
        for letter_class in range(len(monitor.successors[0]))
        if (letter := witnesses.plainest(letter_class, constants)) is not None
    }
    word = shortest_word([monitor], [accepted], list(plainest))
    return None if word is None else [plainest[symbol] for symbol in word]


def _after_first_state(monitor: MealyMonitor) -> MealyMonitor:
    """A monitor that accepts only words whose runs leave the first state.

    State ``n + 1`` is state ``n`` of a run that has left; state 0 is the first one before that.
    """
    moved = [tuple([target + 1 for target in row]) for row in monitor.successors]
    first = tuple([target + 1 if target else 0 for target in monitor.successors[0]])
    outputs = zip(monitor.outputs[0], first, strict=True)
    return replace(
        monitor,
        successors=(first, *moved),
        outputs=(
            tuple([accepted and target > 0 for accepted, target in outputs]),
            *monitor.outputs,
        ),
        rejecting_sink=None,
        accepting_sink=None,
    )


def _near_miss(
    monitor: MealyMonitor, rejected: Sequence[int], witnesses: LetterWitnesses
) -> list[int] | None:
    """An accepted word that differs from the rejected one in one letter.

    The change is as late and as small as possible, and then so that the run visits most states of
    the monitor.
    """
    for place in reversed(range(len(rejected))):
        candidates = []
        # In a word of one letter even a constant may differ; in a longer word it may not.
        constants = witnesses.constants(rejected[place]) if len(rejected) > 1 else None
        for distance, letter in witnesses.nearest(rejected[place], constants):
            word = [*rejected[:place], letter, *rejected[place + 1 :]]
            accepted, n_states = _run(monitor, word)
            if accepted:
                candidates.append((distance, -n_states, letter, word))
        if candidates:
            return min(candidates)[-1]
    return None


def _run(monitor: MealyMonitor, word: Sequence[int]) -> tuple[bool, int]:
    states, accepted = [0], False
    for letter in word:
        letter_class = monitor.letters[letter]
        accepted = monitor.outputs[states[-1]][letter_class]
        states.append(monitor.successors[states[-1]][letter_class])
    return accepted, len(set(states))
