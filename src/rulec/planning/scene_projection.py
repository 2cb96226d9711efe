"""What a recorded scene supplies, as far as a rulebook has words for it.

Nobody has written a recording for one rulebook: its types are the most specific that the vocabulary
knows, and signals that it does not know, or means otherwise, are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from rulec.planning.partition_choice import SUPPLIED
from rulec.trace import State, TraceGraph, Value
from rulec.trace.vocabulary_projection import could_mean, known_types
from rulec.vocabulary import Declaration, Vocabulary

if TYPE_CHECKING:
    from rulec.scenario import Obstacle

_Said = Value | Mapping[str, Value]

RECORDED_UNIT = "km/h"
"""The unit of the quantities that recorded scenes supply."""


def fitted(
    vocabulary: Vocabulary, traces: TraceGraph, obstacles: Mapping[str, Obstacle]
) -> TraceGraph:
    """Traces of a recorded scene with what the vocabulary knows of it.

    ``obstacles`` are the objects of the traces.
    """
    objects = known_types(
        {name: (one.type, *one.broader) for name, one in obstacles.items()}, vocabulary
    )
    fit = _Fit(vocabulary, objects)
    return replace(
        traces,
        objects=objects,
        present={name: there for name, there in traces.present.items() if name in objects},
        states=tuple(tuple(map(fit.state, layer)) for layer in traces.states),
    )


class _Fit:
    """What a vocabulary knows of states. What states say alike is looked at once, and stays one."""

    def __init__(self, vocabulary: Vocabulary, objects: Mapping[str, str]) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._about: dict[str | None, frozenset[str]] = {}
        self._known: dict[tuple[str, int], tuple[_Said, _Said | None]] = {}

    def state(self, state: State) -> State:
        """A state, with what the vocabulary knows of it."""
        kept: dict[str, _Said] = {}
        for name, value in state.items():
            key = (name, id(value))
            if key not in self._known:
                # Beside its value, so that no other value is given its number
                self._known[key] = (value, self._fitted(name, value))
            fitting = self._known[key][1]
            if fitting is not None:
                kept[name] = fitting
        return kept

    def _fitted(self, name: str, value: _Said) -> _Said | None:
        """What the vocabulary knows of what is said of a name; None if nothing."""
        declaration = self._vocabulary.declarations.get(name)
        if name not in SUPPLIED and not _fits(value, declaration):
            return None
        if not isinstance(value, Mapping):
            return value
        known = self._of(
            declaration.parameters[0] if declaration and declaration.parameters else None
        )
        if known.issuperset(value):
            return value
        return {one: inner for one, inner in value.items() if one in known}

    def _of(self, kind: str | None) -> frozenset[str]:
        if kind not in self._about:
            self._about[kind] = frozenset(
                item
                for item, own in self._objects.items()
                if kind is None or self._vocabulary.is_subtype(own, kind)
            )
        return self._about[kind]


def _fits(value: Value | Mapping[str, Value], declaration: Declaration | None) -> bool:
    """Could this be what the vocabulary means by the name?"""
    if declaration is None or isinstance(value, Mapping) != bool(declaration.parameters):
        return False
    values = value.values() if isinstance(value, Mapping) else (value,)
    return could_mean(values, declaration, RECORDED_UNIT)
