"""The rules, bound to the objects that are there at one time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.automata.facts import counts
from rulec.automata.machine import IMPOSSIBLE
from rulec.diagnostics import Place
from rulec.runtime.checking import check_state
from rulec.runtime.facts import check_counting_facts
from rulec.runtime.letters import Columns
from rulec.runtime.online.columns import Items, OneStateColumns
from rulec.runtime.online.gate import Gate
from rulec.runtime.online.prefix import Links, linked
from rulec.runtime.online.weighing import Weighing, weighings
from rulec.runtime.online.words import Reading, reading
from rulec.trace import State
from rulec.vocabulary.choices import choices

Letters: TypeAlias = list[int]
"""For each binding of each rule, one after the other, the class of the letter that it reads."""


@dataclass(frozen=True, slots=True, eq=False)
class Ready:
    """A rule made ready for any objects."""

    rule: CompiledRule
    links: Links
    weighings: tuple[Weighing, ...]

    def bound(self, items: Items) -> dict[str, str]:
        """Objects by the names of the variables that they stand for."""
        return dict(zip([one.name for one in self.rule.variables], items, strict=True))


def made_ready(rulebook: CompiledRulebook) -> tuple[Ready, ...]:
    """The rules of a rulebook."""
    return tuple(
        Ready(rule, linked(rule.machine), tuple(weighings(rule.machine, rulebook.vocabulary)))
        for rule in rulebook.rules
    )


@dataclass(frozen=True, slots=True, eq=False)
class Crowd:
    """A rule with every binding of its variables to objects that are there.

    ``bindings`` are those objects, in the order of the variables; ``place`` is where the first of
    them stands among all bindings of the scene.
    """

    ready: Ready
    bindings: tuple[Items, ...]
    place: slice


class Scene:
    """Rules, and the objects that are there, of types that the vocabulary knows."""

    def __init__(
        self, rulebook: CompiledRulebook, rules: Sequence[Ready], objects: Mapping[str, str]
    ) -> None:
        self.objects = dict(objects)
        self._rulebook = rulebook
        self._gate = Gate(rulebook.vocabulary, self.objects)
        self._careful = any(counts(fact.formula) for fact in rulebook.facts)
        self._columns = OneStateColumns(rulebook.vocabulary, self.objects)
        self._readings: list[Reading] = []
        crowds, end = [], 0
        for ready in rules:
            types = [variable.type for variable in ready.rule.variables]
            bindings = tuple(choices(types, self.objects, rulebook.vocabulary))
            begin, end = end, end + len(bindings)
            crowds.append(Crowd(ready, bindings, slice(begin, end)))
            if bindings:
                self._readings.append(reading(ready.rule, ready.weighings, bindings, self._columns))
        self.crowds = tuple(crowds)

    def letters(self, state: State, number: int, place: Place | None) -> Letters:
        """What the crowds read of a state.

        Raises:
            RulecError: R0502 to R0505 or R0508, naming the state by its ``number``.
        """
        if self._gate.passes(state) and not self._careful:
            found: Letters = []
            try:
                values, columns = self._columns.fetched(state)
                for read in self._readings:
                    found += read(values, columns)
            except (LookupError, TypeError):
                found = [IMPOSSIBLE]
            if IMPOSSIBLE not in found:
                return found
        return self._careful_letters(state, number, place)

    def _careful_letters(self, state: State, number: int, place: Place | None) -> Letters:
        """As ``letters``, the way ``verify`` goes, which knows every case and every complaint."""
        where = f"state {number}"
        check_state(state, self.objects, self._rulebook.vocabulary, where, place)
        columns = Columns(
            (state,),
            self._rulebook.vocabulary,
            lambda _: where,
            place,
            self.objects,
            facts=self._rulebook.facts,
        )
        check_counting_facts(self._rulebook, 1, columns.moment, lambda _: where, place)
        return [
            columns.word(crowd.ready.rule, crowd.ready.bound(items), 0, 0)[0]
            for crowd in self.crowds
            for items in crowd.bindings
        ]
