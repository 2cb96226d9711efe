"""A rulebook's own examples, judged by its machines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.diagnostics import Diagnostic, RulecError
from rulec.diagnostics.diagnostic import at
from rulec.rulebook.model import Example, Rule, Rulebook
from rulec.runtime.letters import Columns
from rulec.runtime.verify import run
from rulec.trace import Trace


def example_trace(rule: Rule, example: Example) -> Trace:
    """The example as a trace whose objects are the rule's variables."""
    states = []
    for mentioned in example.states:
        state: dict[str, Any] = {}
        for (name, variables), value in mentioned.items():
            *outer, last = (name, *variables)
            inside = state
            for key in outer:
                inside = inside.setdefault(key, {})
            inside[last] = value
        states.append(state)
    objects = {variable.name: variable.type for variable in rule.variables}
    return Trace(example.label or rule.name, 1.0, objects, tuple(states))


def failing_examples(rulebook: Rulebook, compiled: CompiledRulebook) -> Iterator[Diagnostic]:
    """A diagnostic (R0406) for every example that comes out otherwise than it says."""
    for rule, machine in zip(rulebook.rules, compiled.rules, strict=True):
        for number, example in enumerate(rule.examples, 1):
            trace = example_trace(rule, example)
            try:
                accepted = _accepts(machine, compiled, trace)
            except RulecError as error:
                yield from error.diagnostics
                continue
            if accepted != example.accepts:
                yield _surprise(rule, example, number)


def _accepts(rule: CompiledRule, rulebook: CompiledRulebook, trace: Trace) -> bool:
    """The rule's verdict for the binding that gives every variable its own name."""
    own = {variable.name: variable.name for variable in rule.variables}
    columns = Columns(trace.states, rulebook.vocabulary, "state {}".format)
    return run(rule.machine, columns.word(rule, own, 0, len(trace.states) - 1))[0]


def _surprise(rule: Rule, example: Example, number: int) -> Diagnostic:
    name = f"`{example.label}`" if example.label else f"number {number}"
    claim, truth = ("accept", "rejects") if example.accepts else ("reject", "accepts")
    return Diagnostic(
        "R0406",
        f"example {name} of rule `{rule.name}` says `{claim}`, but the rule {truth} it",
        at(example.span),
        help="either the formula or the example does not say what is meant",
        severity="warning",
    )
