"""Rules for a source that cannot tell all names, or has not seen what was before."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.monitoring.uncertainty.possible_letters import untold_names, with_untold
from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine


def judged_rules(
    rulebook: CompiledRulebook, told: frozenset[str] | None, *, cut: bool
) -> tuple[CompiledRulebook, Mapping[str, OutcomeMachine] | None]:
    """The rules that can be judged, whose untold names are unknown, and machines for a cut past.

    Left out are rules that no state can be known to violate, and, of a cut past, those whose
    machine would be too large.
    """
    untold = untold_names(rulebook.vocabulary, told)
    machines: Mapping[str, OutcomeMachine | None] | None = None
    if cut:
        machines = {} if rulebook.prefixes is None else rulebook.prefixes(rulebook)
    rules, cut_machines = [], {}
    for rule in rulebook.rules:
        machine = None if machines is None else machines.get(rule.name)
        if machines is not None and machine is None:
            continue
        if uncertain_machine(rule, machine).untold(untold):
            continue
        rules.append(rule)
        if machine is not None:
            cut_machines[rule.name] = machine
    vocabulary = with_untold(rulebook.vocabulary, untold)
    judged = replace(rulebook, vocabulary=vocabulary, rules=tuple(rules))
    return judged, cut_machines if cut else None
