"""One shortest trace that a rule accepts, and one that it rejects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.vocabulary import Vocabulary
from rulec.witnesses.letter_witness import Witness, Witnesses


@dataclass(frozen=True, slots=True)
class ShortestTraces:
    """States of a trace that is accepted, and of one that is rejected; None if there is none.

    No shorter trace is rejected. The accepted one differs from it in one state where that is
    possible, and else shows more of the rule than a trace that never leaves the first state of its
    automaton, if any does.
    """

    accepted: tuple[Witness, ...] | None
    rejected: tuple[Witness, ...] | None


def shortest_traces(rule: CompiledRule, vocabulary: Vocabulary) -> ShortestTraces:
    """The traces, their states in the rule's variables.

    States that no world can be in, such as one with `speed < 30` and `speed > 50`, do not occur.
    """
    machine = rule.machine
    witnesses = Witnesses(rule, vocabulary)
    plainest = {
        symbol: letter
        for symbol in range(len(machine.successors[0]))
        if (letter := witnesses.plainest(symbol)) is not None
    }
    rejected = _shortest(machine, plainest, accepted=False)
    accepted = rejected and _near_miss(machine, rejected, witnesses)
    accepted = (
        accepted
        or _shortest(machine, plainest, accepted=True, moved=True)
        or _shortest(machine, plainest, accepted=True)
    )
    return ShortestTraces(_states(accepted, witnesses), _states(rejected, witnesses))


def _states(word: Sequence[int] | None, witnesses: Witnesses) -> tuple[Witness, ...] | None:
    if word is None:
        return None
    states = [witnesses.state(letter) for letter in word]
    assert all(state is not None for state in states), "only possible letters are read"
    return tuple(state for state in states if state is not None)


def _shortest(
    machine: MealyMonitor, letters: Mapping[int, int], *, accepted: bool, moved: bool = False
) -> tuple[int, ...] | None:
    """A shortest word of the letters that stand for their classes, in breadth-first order.

    It gets the verdict ``accepted``, and if need be its run has left the first state: ``moved``.
    """
    waiting: list[tuple[int, bool, tuple[int, ...]]] = [(0, False, ())]
    seen = {(0, False)}
    for state, has_moved, word in waiting:
        for symbol, letter in letters.items():
            target = machine.successors[state][symbol]
            node = (target, has_moved or target != 0)
            if machine.outputs[state][symbol] is accepted and (node[1] or not moved):
                return (*word, letter)
            if node not in seen:
                seen.add(node)
                waiting.append((*node, (*word, letter)))
    return None


def _near_miss(
    machine: MealyMonitor, rejected: Sequence[int], witnesses: Witnesses
) -> tuple[int, ...] | None:
    """The rejected word with one letter changed so that it is accepted, the last one if possible.

    It is changed as little as possible, and then so that it sees most states of the automaton.
    """
    for place in reversed(range(len(rejected))):
        found = []
        for distance, letter in witnesses.nearest(rejected[place]):
            word = (*rejected[:place], letter, *rejected[place + 1 :])
            accepted, n_states = _judge(machine, word)
            if accepted:
                found.append((distance, -n_states, letter, word))
        if found:
            return min(found)[-1]
    return None


def _judge(machine: MealyMonitor, word: Sequence[int]) -> tuple[bool, int]:
    """Is the word accepted, and how many states does it see?"""
    states, accepted = [0], False
    for letter in word:
        symbol = machine.letters[letter]
        accepted = machine.outputs[states[-1]][symbol]
        states.append(machine.successors[states[-1]][symbol])
    return accepted, len(set(states))
