"""A compiled rulebook's verdict on a trace."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.automata.machine import Machine
from rulec.diagnostics import RulecError
from rulec.runtime.binding import Binding, bindings
from rulec.runtime.reading import check_objects, check_state, letter
from rulec.runtime.verdict import NotJudged, Verdict, Violation
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary


def verify(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """Judge a trace by every rule, for every binding of its variables.

    Raises:
        RulecError: R0502 to R0505 if the trace does not fit the rulebook's vocabulary, with the
            trace's own place.
    """
    vocabulary = rulebook.vocabulary
    check_objects(trace.objects, vocabulary, trace.place)
    for number, state in enumerate(trace.states):
        check_state(state, trace.objects, vocabulary, f"state {number}", trace.place)
    violations = []
    for rule in rulebook.rules:
        for binding in bindings(rule, vocabulary, trace.objects, trace.present, len(trace.states)):
            letters = _letters(rule, binding, trace, vocabulary)
            accepted, step = run(rule.machine, letters)
            if not accepted:
                step = None if step is None else binding.first + step
                violations.append(Violation(rule.name, rule.strength, binding.objects, step))
    return Verdict(trace.id, tuple(violations))


def verify_all(
    traces: Iterable[Trace | RulecError], rulebook: CompiledRulebook
) -> Iterator[Verdict | NotJudged]:
    """Judge traces one by one; one that cannot be judged does not stop the others.

    ``traces`` may hold, in place of a trace, the error that kept it from being read.
    """
    for trace in traces:
        if isinstance(trace, RulecError):
            yield NotJudged(None, trace)
            continue
        try:
            verdict = verify(trace, rulebook)
        except RulecError as error:
            yield NotJudged(trace.id, error)
        else:
            yield verdict


def run(machine: Machine, letters: Sequence[int]) -> tuple[bool, int | None]:
    """Run a machine over a non-empty word of letter classes.

    Returns:
        Whether it accepts, and the index of the letter that led into the dead state, if any. A
        machine that starts out dead is lost with the first letter.
    """
    following, dead = machine.following, machine.dead
    state = before = 0
    for index, symbol in enumerate(letters):
        before, state = state, following[state][symbol]
        if state == dead:
            return False, index
    return machine.accepting[before][letters[-1]], None


def _letters(
    rule: CompiledRule, binding: Binding, trace: Trace, vocabulary: Vocabulary
) -> list[int]:
    stretch = range(binding.first, binding.last + 1)
    return [
        letter(
            rule.machine,
            binding.objects,
            trace.states[number],
            vocabulary,
            f"state {number}",
            rule.name,
            trace.place,
        )
        for number in stretch
    ]
