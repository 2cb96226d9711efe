"""A compiled rulebook's verdict on a trace."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.compiled import CompiledRulebook
from rulec.automata.machine import Machine
from rulec.diagnostics import RulecError
from rulec.runtime.binding import bindings
from rulec.runtime.checking import check_objects, check_state
from rulec.runtime.letters import Columns
from rulec.runtime.verdict import NotJudged, Verdict, Violation
from rulec.trace import Trace
from rulec.trace.check import check_trace


def verify(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """Judge a trace by every rule, for every binding of its variables.

    Raises:
        RulecError: R0501 to R0506 if it is no trace or does not fit the rulebook's vocabulary, with
            the trace's own place.
    """
    check_trace(trace)
    check_objects(trace.objects, rulebook.vocabulary, trace.place)
    for number, state in enumerate(trace.states):
        check_state(state, trace.objects, rulebook.vocabulary, f"state {number}", trace.place)
    columns = Columns(trace.states, rulebook.vocabulary, "state {}".format, trace.place)
    violations = []
    for rule in rulebook.rules:
        # Objects that did the same are judged once.
        verdicts: dict[tuple[int, ...], tuple[bool, int | None]] = {}
        for binding in bindings(
            rule, rulebook.vocabulary, trace.objects, trace.present, len(trace.states)
        ):
            word = columns.word(rule, binding.objects, binding.first, binding.last)
            if word not in verdicts:
                verdicts[word] = run(rule.machine, word)
            accepted, step = verdicts[word]
            if not accepted:
                step = None if step is None else binding.first + step
                violations.append(Violation(rule.name, rule.strength, binding.objects, step))
    return Verdict(trace.id, tuple(violations))


def judge(item: Trace | RulecError, rulebook: CompiledRulebook) -> Verdict | NotJudged:
    """As ``verify``, for one of many: what cannot be judged is an answer too.

    ``item`` may be, in place of a trace, the error that kept it from being read.
    """
    if isinstance(item, RulecError):
        return NotJudged(None, item)
    try:
        return verify(item, rulebook)
    except RulecError as error:
        return NotJudged(item.id, error)


def run(machine: Machine, word: Sequence[int]) -> tuple[bool, int | None]:
    """Run a machine over a non-empty word of letter classes.

    Returns:
        Whether it accepts, and the index of the letter that led into the dead state, if any. A
        machine that starts out dead is lost with the first letter.
    """
    following, dead = machine.following, machine.dead
    state = before = 0
    for index, symbol in enumerate(word):
        before, state = state, following[state][symbol]
        if state == dead:
            return False, index
    return machine.accepting[before][word[-1]], None
