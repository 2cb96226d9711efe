"""The rules that can be judged from a source that lacks names or shows only a part of a drive."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.outcome_machine import OutcomeMachine, of_running_words
from rulec.logic.free_names import names_of
from rulec.monitoring.told_names import (
    names_lacking,
    untold_names,
    untold_types,
    with_untold,
)
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine, uncertain_machine
from rulec.monitoring.verdict import RuleNotJudged
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class JudgedRules:
    """The rules that can be judged, with their machines, and those that cannot.

    ``rulebook`` has these rules alone, and unknown defaults for names that the source cannot
    provide; ``presumed`` are the names that rules read and that keep their defaults where no source
    provides them.
    """

    machines: tuple[tuple[CompiledRule, UncertainMachine], ...]
    not_judged: tuple[RuleNotJudged, ...]
    rulebook: CompiledRulebook
    presumed: tuple[str, ...]

    @property
    def vocabulary(self) -> Vocabulary:
        """That of the states of such a source."""
        return self.rulebook.vocabulary


def judged_rules(
    rulebook: CompiledRulebook, told: frozenset[str] | None, *, cut: bool
) -> JudgedRules:
    """The rules for a source that provides these names, or all names if None.

    Left out are rules that no trace can be known to violate, and those whose machine would be too
    large for the step or for traces that are ``cut``. Raises RulecError R0403 if Spot, which builds
    the machines for these, is not installed. The result is cached, since it is needed for every
    trace.
    """
    known: dict[object, JudgedRules] = rulebook.prepared.setdefault(JudgedRules, {})
    if (told, cut) not in known:
        if len(known) >= _MOST_KNOWN:
            known.clear()
        known[told, cut] = _judged_rules(rulebook, told, cut=cut)
    return known[told, cut]


_MOST_KNOWN = 1 << 6
"""For how many kinds of sources the rules are kept before all are discarded."""


def _why_not_if_cut(rule: CompiledRule, rulebook: CompiledRulebook) -> str:
    """Why a rule has no machine for traces that are cut."""
    why = "of what is cut out of something longer, as recordings are, its automaton is too large"
    if not rulebook.spot:
        why += ", or only Spot can make it, which is not what compiled the rulebook"
    # Only bounds in seconds have fewer steps then.
    return why if rule.step_s is None else f"{why}; it is smaller for larger time steps"


def _judged_rules(
    rulebook: CompiledRulebook, told: frozenset[str] | None, *, cut: bool
) -> JudgedRules:
    unknown = untold_names(rulebook.vocabulary, told)
    types = untold_types(rulebook.vocabulary, told)

    def untold_by(rule: CompiledRule, machine: OutcomeMachine | None) -> RuleNotJudged | None:
        lacking = uncertain_machine(rule, machine).untold(unknown)
        lacking = names_lacking(lacking, rulebook.vocabulary, unknown)
        lacking += tuple([own.type for own in rule.variables if own.type in types])
        return RuleNotJudged(rule.name, rule.strength, lacking) if lacking else None

    # A machine for cut words is built only if some word without a past can violate the rule.
    running: dict[str, OutcomeMachine] = rulebook.prepared.setdefault(of_running_words, {})
    if cut and not running:
        running.update({rule.name: of_running_words(rule.machine) for rule in rulebook.rules})
    left_out = {
        rule.name: untold_by(rule, running[rule.name] if cut else None) for rule in rulebook.rules
    }
    prefixes: Mapping[str, OutcomeMachine | None] = {}
    if cut and rulebook.prefixes is not None:
        rules = tuple([rule for rule in rulebook.rules if left_out[rule.name] is None])
        prefixes = rulebook.prefixes(replace(rulebook, rules=rules)) if rules else {}
    machines = []
    not_judged = [
        RuleNotJudged(rule.name, rule.strength, (), rule.why) for rule in rulebook.too_large
    ]
    for rule in rulebook.rules:
        outcomes, without = prefixes.get(rule.name), left_out[rule.name]
        if cut and without is None:
            why = _why_not_if_cut(rule, rulebook)
            without = (
                RuleNotJudged(rule.name, rule.strength, (), why)
                if outcomes is None
                else untold_by(rule, outcomes)
            )
        if without is None:
            machines.append((rule, uncertain_machine(rule, outcomes)))
        else:
            not_judged.append(without)
    declarations = rulebook.vocabulary.declarations
    read = {name for rule in rulebook.rules for name in names_of(rule.formula)}
    presumed = [name for name, item in declarations.items() if item.presumed and name in read]
    vocabulary = with_untold(rulebook.vocabulary, unknown)
    judged = replace(rulebook, vocabulary=vocabulary, rules=tuple([rule for rule, _ in machines]))
    return JudgedRules(tuple(machines), tuple(not_judged), judged, tuple(presumed))
