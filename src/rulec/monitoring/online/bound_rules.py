"""The rules, bound to the objects that are there at one time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeAlias

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation
from rulec.monitoring.axioms import check_counting_axioms
from rulec.monitoring.letter_reader import LetterReader
from rulec.monitoring.online.encoded_values import Told
from rulec.monitoring.online.four_valued import Edge
from rulec.monitoring.online.group_letters import GroupLetters
from rulec.monitoring.online.rule_group import Node, Ready, RuleGroup, RuleGroups
from rulec.monitoring.online.state_shape import Items, StateShape
from rulec.monitoring.online.transition_cache import TransitionCache
from rulec.monitoring.state_validation import check_state
from rulec.trace import State
from rulec.vocabulary.object_choices import choices

Letters: TypeAlias = list[int]
"""For each binding of each team, one after the other, the letter that it reads."""


MOST_OUTLINES = 64
"""So many outlines of states are remembered before they are forgotten again."""


Known: TypeAlias = tuple[StateShape, tuple[Told, ...]]
"""The outline of a state, and what is told of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Crowd:
    """A rule with every binding of its variables to objects that are there.

    ``bindings`` are those objects, in the order of the variables. They stand at ``place`` among all
    bindings of all teams; there the rule is the one with this ``number`` in its ``team``.
    """

    ready: Ready
    bindings: tuple[Items, ...]
    team: RuleGroup
    place: slice
    number: int

    def edges(self, nodes: Sequence[Node]) -> list[Edge]:
        """Where the rule's machine stands for each binding."""
        return [node.edges[self.number] for node in nodes[self.place]]


class BoundRules:
    """Rules, and the objects that are there, of types that the vocabulary knows."""

    def __init__(
        self, rulebook: CompiledRulebook, teams: RuleGroups, objects: Mapping[str, str]
    ) -> None:
        self.objects = dict(objects)
        self.teams = teams
        self.memory = TransitionCache()
        self._rulebook = rulebook
        self._counting = any(counts(fact.formula) for fact in rulebook.axioms)
        self._readings: dict[tuple[str, ...], GroupLetters | None] = {}
        self._bound: list[tuple[RuleGroup, tuple[Items, ...]]] = []
        crowds: dict[str, Crowd] = {}
        end = 0
        for team in teams.teams:
            bindings = tuple(choices(team.types, self.objects, rulebook.vocabulary))
            begin, end = end, end + len(bindings)
            for number, ready in enumerate(team.rules):
                place = slice(begin, end)
                crowds[ready.rule.name] = Crowd(ready, bindings, team, place, number)
            if bindings:
                self._bound.append((team, bindings))
        self.crowds = tuple([crowds[ready.rule.name] for ready in teams.rules])
        self.hard = tuple([rule.name for rule in rulebook.rules if rule.strength == "hard"])

    def read(
        self, state: State, number: int, place: SourceLocation | None
    ) -> tuple[Letters, Known | None]:
        """What the teams read of a state, and by what it is known, if that can be said.

        Raises:
            RulecError: R0502 to R0505 or R0508, naming the state by its ``number``.
        """
        known = None
        try:
            reading = self._reading_of(tuple(state))
            if reading is not None:
                told = reading.outline.told(state)
                known = reading.outline, told
                if not self._counting:
                    return reading.letters(state, told), known
        except (LookupError, TypeError):
            pass
        return self._careful_letters(state, number, place), known

    def _reading_of(self, names: tuple[str, ...]) -> GroupLetters | None:
        """What reads states that give values to these names; None if they need a closer look."""
        try:
            return self._readings[names]
        except KeyError:
            pass
        if len(self._readings) >= MOST_OUTLINES:
            self._readings.clear()
        about = (self.objects, self._rulebook.vocabulary, self.teams.floors)
        self._readings[names] = None
        with suppress(LookupError, TypeError):
            self._readings[names] = GroupLetters(StateShape(names, *about), self._bound, *about)
        return self._readings[names]

    def _careful_letters(self, state: State, number: int, place: SourceLocation | None) -> Letters:
        """Their letters, the way ``verify`` goes, which knows every case and every complaint."""
        where = f"state {number}"
        check_state(state, self.objects, self._rulebook.vocabulary, where, place)
        columns = LetterReader(
            (state,),
            self._rulebook.vocabulary,
            lambda _: where,
            place,
            self.objects,
            axioms=self._rulebook.axioms,
        )
        check_counting_axioms(self._rulebook, 1, columns.moment, lambda _: where, place)
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
