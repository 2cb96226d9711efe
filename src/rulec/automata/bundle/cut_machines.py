"""The machines of rules for cut traces: made of two others at any step, or stored as tables.

Of the two, one judges what continues, the other the word alone. Both read, as their last read,
whether the word has begun, if the rule looks back (``prefix_machines``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.clocks.clocked_machine import TimedMachine
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, Read
from rulec.automata.outcome_machine import OutcomeMachine, of_prefixes
from rulec.automata.tables import SizeError
from rulec.logic import formula as ltl
from rulec.logic.bounds import PAST, operations_of

BEGUN = ltl.Atom("word has begun")
"""No name in a rulebook contains a space."""


def goes_on_from_before(rule: CompiledRule) -> bool:
    """Whether a rule, kept before a cut word began, may have a sequence under way there.

    Exceptions and a condition do not change that, though the whole formula may have no `then`.
    """
    formula = rule.formula if rule.parts is None else rule.parts.required
    always = ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER
    if not isinstance(formula, ltl.Unary) or formula.operator not in always or rule.variables:
        return False
    then = ltl.BinaryOperator.THEN
    return formula.bound is None and any(x.operator is then for x in operations_of(formula))


def looks_back(rule: CompiledRule) -> bool:
    """Whether a rule's machine for what continues reads whether the word has begun."""
    return any(operation.operator in PAST for operation in operations_of(rule.formula))


@dataclass(frozen=True, slots=True)
class TimedCut:
    """What the machine of a rule for cut words is made of at any step.

    ``own`` judges what continues, None if the rule's own machine does; ``alone`` judges the word
    alone, None if that is the same one.
    """

    own: TimedMachine | None
    alone: TimedMachine | None

    def at(self, rule: CompiledRule) -> OutcomeMachine:
        """The machine at the rule's step. Raises SizeError."""
        own = rule.machine if self.own is None else self.own.at(rule.step_s)
        alone = own if self.alone is None else self.alone.at(rule.step_s)
        return cut_machine(own, alone, goes_on=goes_on_from_before(rule))

    def if_small(self, rule: CompiledRule) -> OutcomeMachine | None:
        """The machine at the rule's step; None if it gets too large."""
        try:
            return self.at(rule)
        except SizeError:
            return None


def cut_machine(own: MealyMonitor, alone: MealyMonitor, *, goes_on: bool) -> OutcomeMachine:
    """The machine for cut words; ``goes_on`` if a rule that was kept may have a sequence under way.

    A run may begin in any state that earlier letters can lead to.
    """
    looks_back = own.reads[-1:] == (Read(BEGUN.name, ()),)
    half = len(own.letters) // 2 if looks_back else 0
    before, begun = (
        dict.fromkeys(
            pair
            for pair in zip(own.letters[letters], alone.letters[letters], strict=True)
            if IMPOSSIBLE not in pair
        )
        for letters in (slice(half), slice(half, None))
    )
    starts = {(0, 0): None}
    for symbols in (before, begun) if goes_on else (before,):
        for state, other in (waiting := list(starts)):
            for symbol, alone_symbol in symbols:
                pair = own.successors[state][symbol], alone.successors[other][alone_symbol]
                lost = pair[0] == own.rejecting_sink and not own.outputs[state][symbol]
                if pair not in starts and not (lost and symbols is begun):
                    starts[pair] = None
                    waiting.append(pair)
    if looks_back:
        own, alone = (
            replace(machine, reads=machine.reads[:-1], letters=machine.letters[half:])
            for machine in (own, alone)
        )
    return of_prefixes(own, alone, starts)


@dataclass(frozen=True, slots=True)
class StoredPrefixes:
    """A ``PrefixCompiler`` of stored machines, by the rule's name.

    ``timed`` says what the machines are made of at any step: where there is no entry.
    """

    entries: Mapping[str, OutcomeMachine | None]
    timed: Mapping[str, TimedCut] = field(default_factory=dict)
    _made: dict[str, OutcomeMachine | None] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __call__(self, rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
        """The machines of the rulebook's rules; None for each that would have been too large."""
        return {rule.name: self._machine(rule) for rule in rulebook.rules}

    def at_other_steps(self, rules: Iterable[CompiledRule]) -> StoredPrefixes:
        """The machines at other steps of some rules."""
        gone = {rule.name for rule in rules}
        entries = {name: entry for name, entry in self.entries.items() if name not in gone}
        return StoredPrefixes(entries, self.timed)

    def _machine(self, rule: CompiledRule) -> OutcomeMachine | None:
        timed = self.timed.get(rule.name)
        if rule.name in self.entries or timed is None:
            return self.entries.get(rule.name)
        if rule.name not in self._made:
            self._made[rule.name] = timed.if_small(rule)
        return self._made[rule.name]


def stored(
    rulebook: CompiledRulebook,
    timed: Callable[[CompiledRulebook], Mapping[str, TimedCut]] = lambda _: {},
) -> StoredPrefixes | None:
    """The machines that a file can store; None if no compiler for cut traces is available.

    Once they have been made, ``timed`` says what they are made of at any step.
    Raises RulecError R0403 if that needs Spot, and it is not installed.
    """
    if rulebook.prefixes is None or isinstance(rulebook.prefixes, StoredPrefixes):
        return rulebook.prefixes
    return StoredPrefixes(rulebook.prefixes(rulebook), timed(rulebook))
