"""The rules that can be judged from a source that lacks names or shows only a part of a drive."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, replace
from itertools import chain

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import Read
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
    """The rules with their machines, and those that no trace can be known to violate.

    Of these, the ``lacking`` ones have a machine: a trace keeps them whatever the names are that
    they lack, or they are not judged.
    ``rulebook`` has the other rules that have a machine, and unknown defaults for names that the
    source cannot provide; ``presumed`` are the names that rules read and that keep their defaults
    where no source provides them.
    """

    machines: tuple[tuple[CompiledRule, UncertainMachine], ...]
    unknowable: tuple[RuleNotJudged, ...]
    lacking: frozenset[str]
    rulebook: CompiledRulebook
    presumed: tuple[str, ...]

    def unanswered(self, doubtful: Set[str]) -> tuple[tuple[RuleNotJudged, ...], tuple[str, ...]]:
        """The rules that are not judged in a trace, and the lacking ones that it keeps regardless.

        Some lacking ones are ``doubtful`` in it: kept or not, as what is not told may be.
        """
        kept = self.lacking - doubtful
        return (
            tuple([x for x in self.unknowable if x.rule not in kept]),
            tuple([x.rule for x in self.unknowable if x.rule in kept]),
        )

    @property
    def vocabulary(self) -> Vocabulary:
        """That of the states of such a source."""
        return self.rulebook.vocabulary


def judged_rules(
    rulebook: CompiledRulebook, told: frozenset[str] | None, *, cut: bool
) -> JudgedRules:
    """The rules for a source that provides these names, or all names if None.

    Without a machine are rules that would look kept because of a value or a type that the source
    never tells, and those whose machine would be too large for the step or for traces that are
    ``cut``. Raises RulecError R0403 if Spot, which builds the machines for these, is not installed.
    The result is cached, since it is needed for every trace.
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
    values = unknown - rulebook.vocabulary.declarations.keys()
    # Before a machine for cut words is built, one without a past says whether it can be of use.
    running: dict[str, OutcomeMachine] = rulebook.prepared.setdefault(of_running_words, {})
    if cut and not running:
        running.update({rule.name: of_running_words(rule.machine) for rule in rulebook.rules})

    def lack(rule: CompiledRule, outcomes: OutcomeMachine | None) -> tuple[str, ...]:
        machine = uncertain_machine(rule, (outcomes or running[rule.name]) if cut else None)
        names = names_lacking(machine.untold(unknown), rulebook.vocabulary, unknown)
        return *names, *[own.type for own in rule.variables if own.type in types]

    def may_look_kept(rule: CompiledRule) -> bool:
        """Whether a state or an object that seems known may be one that the source never tells."""
        read = [read.values for read in rule.machine.reads if isinstance(read, Read)]
        hidden = types.union(values)
        return not hidden.isdisjoint([*chain(*read), *[own.type for own in rule.variables]])

    useless = {x.name for x in rulebook.rules if may_look_kept(x) and lack(x, None)}
    prefixes: Mapping[str, OutcomeMachine | None] = {}
    if cut and rulebook.prefixes is not None:
        rules = tuple([rule for rule in rulebook.rules if rule.name not in useless])
        prefixes = rulebook.prefixes(replace(rulebook, rules=rules)) if rules else {}
    machines = []
    unknowable = [
        RuleNotJudged(rule.name, rule.strength, (), rule.why) for rule in rulebook.too_large
    ]
    lacking = set()
    for rule in rulebook.rules:
        outcomes = prefixes.get(rule.name)
        untold = lack(rule, outcomes)
        if (cut and outcomes is None) or (untold and may_look_kept(rule)):
            why = "" if untold else _why_not_if_cut(rule, rulebook)
            unknowable.append(RuleNotJudged(rule.name, rule.strength, untold, why))
            continue
        machines.append((rule, uncertain_machine(rule, outcomes)))
        if untold:
            unknowable.append(RuleNotJudged(rule.name, rule.strength, untold))
            lacking.add(rule.name)
    declarations = rulebook.vocabulary.declarations
    read = {name for rule in rulebook.rules for name in names_of(rule.formula)}
    presumed = [name for name, item in declarations.items() if item.presumed and name in read]
    vocabulary = with_untold(rulebook.vocabulary, unknown)
    judged = tuple([rule for rule, _ in machines if rule.name not in lacking])
    return JudgedRules(
        tuple(machines),
        tuple(unknowable),
        frozenset(lacking),
        replace(rulebook, vocabulary=vocabulary, rules=judged),
        tuple(presumed),
    )
