"""The rules, bound to the objects that are there at one time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from rulec.automata.compiled import CompiledRulebook
from rulec.automata.facts import counts
from rulec.diagnostics import Place
from rulec.runtime.checking import check_state
from rulec.runtime.facts import check_counting_facts
from rulec.runtime.letters import Columns
from rulec.runtime.online.columns import Items, OneStateColumns
from rulec.runtime.online.gate import Gate
from rulec.runtime.online.memory import Memory
from rulec.runtime.online.prefix import Edge
from rulec.runtime.online.reading import Reading, World
from rulec.runtime.online.team import Node, Ready, Team, Teams
from rulec.trace import State
from rulec.vocabulary.choices import choices

Letters: TypeAlias = list[int]
"""For each binding of each team, one after the other, the letter that it reads."""


@dataclass(frozen=True, slots=True, eq=False)
class Crowd:
    """A rule with every binding of its variables to objects that are there.

    ``bindings`` are those objects, in the order of the variables. They stand at ``place`` among all
    bindings of all teams; there the rule is the one with this ``number`` in its ``team``.
    """

    ready: Ready
    bindings: tuple[Items, ...]
    team: Team
    place: slice
    number: int

    def edges(self, nodes: Sequence[Node]) -> list[Edge]:
        """Where the rule's machine stands for each binding."""
        return [node.edges[self.number] for node in nodes[self.place]]


class Scene:
    """Rules, and the objects that are there, of types that the vocabulary knows."""

    def __init__(
        self, rulebook: CompiledRulebook, teams: Teams, objects: Mapping[str, str]
    ) -> None:
        self.objects = dict(objects)
        self.teams = teams
        self.memory = Memory(rulebook.vocabulary, teams.floors)
        self._rulebook = rulebook
        self._gate = Gate(rulebook.vocabulary, self.objects)
        self._careful = any(counts(fact.formula) for fact in rulebook.facts)
        self._columns = OneStateColumns(rulebook.vocabulary, self.objects)
        self._readings: list[tuple[int, Reading]] = []
        self._world = World(teams.teams)
        crowds: dict[str, Crowd] = {}
        end = 0
        for index, team in enumerate(teams.teams):
            bindings = tuple(choices(team.types, self.objects, rulebook.vocabulary))
            begin, end = end, end + len(bindings)
            for number, ready in enumerate(team.rules):
                place = slice(begin, end)
                crowds[ready.rule.name] = Crowd(ready, bindings, team, place, number)
            if bindings:
                self._readings.append((index, Reading(team, bindings, self._columns)))
        self.crowds = tuple([crowds[ready.rule.name] for ready in teams.rules])
        declarations = rulebook.vocabulary.declarations
        self._asked: list[tuple[str, Any]] = [
            (name, declarations[name].default) for name in self._world.names
        ]

    def letters(self, state: State, number: int, place: Place | None) -> Letters:
        """What the teams read of a state.

        Raises:
            RulecError: R0502 to R0505 or R0508, naming the state by its ``number``.
        """
        if self._gate.passes(state) and not self._careful:
            found: Letters = []
            get: Callable[[str, Any], Any] = state.get
            try:
                world = self._world.letters([get(name, default) for name, default in self._asked])
                columns = self._columns.fetched(state)
                for index, reading in self._readings:
                    found += reading.letters(world[index], columns)
            except (LookupError, TypeError):
                pass
            else:
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
        classes = {
            crowd.ready.rule.name: [
                columns.word(crowd.ready.rule, crowd.ready.bound(items), 0, 0)[0]
                for items in crowd.bindings
            ]
            for crowd in self.crowds
        }
        found = []
        for team in self.teams.teams:
            words = [classes[ready.rule.name] for ready in team.rules]
            found += [team.letter(letter) for letter in zip(*words, strict=True)]
        return found
