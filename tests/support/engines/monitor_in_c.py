"""Judges traces with monitors in C, which the compiler of this machine compiles."""

from __future__ import annotations

import ctypes
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.code_generation.compiled_c.c_library import CLibrary, value_given
from rulec.code_generation.monitor_layout import (
    VERDICTS,
    MonitorLayout,
    RuleLayout,
    monitor_layout,
)
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.batch.by_states import check_fitting, rulebook_for_trace
from rulec.monitoring.bindings import Binding, Cast
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.monitoring.verdict import Verdict, Violation
from rulec.trace import State, Trace
from rulec.trace.trace_model import check_trace
from rulec.vocabulary.partial_values import UNKNOWN_TYPES
from rulec.vocabulary.vocabulary_model import fitting_objects

LOST = VERDICTS.index("violated") * 5
"""The best and the worst verdict as one number, as in C: the best plus 4 times the worst."""

REJECTED = VERDICTS.index("pending")

Bytes: TypeAlias = NDArray[np.uint8]


class CEngine:
    """Judges traces in C."""

    def __init__(self, rulebook: CompiledRulebook) -> None:
        self.rulebook = rulebook
        self._libraries: dict[tuple[float, tuple[int, ...]], CLibrary] = {}

    def verify(self, trace: Trace) -> Verdict | None:
        """Judge a trace; None if C leaves it open, or has no states for a bound or an ending."""
        check_trace(trace)
        if trace.ends != "complete" or trace.told is not None:
            return None
        rulebook = rulebook_for_trace(trace, self.rulebook)
        is_partial = check_fitting(trace, rulebook)
        violations = None if is_partial else self._violations(trace, rulebook)
        return None if violations is None else Verdict(trace.id, tuple(violations))

    def _violations(self, trace: Trace, rulebook: CompiledRulebook) -> list[Violation] | None:
        """The violations of a trace; None if C does not determine them."""
        trace = with_derived_values(trace, rulebook.vocabulary)
        view = KnownLetters(trace, rulebook).view
        check_counting_axioms(rulebook, len(trace.states), view, "state {}".format, trace.place)
        cast = Cast(
            trace.objects, rulebook.vocabulary, len(trace.states), trace.present, trace.place
        )
        library = self._library(rulebook, cast)
        run = _Run(library, trace.states, cast)
        if not run.is_whole:
            return None
        violations: list[Violation] = []
        for own in library.layout.rules:
            for binding in cast.bindings(own.rule):
                word = run.verdicts(own, binding)
                if np.any((word & 3) != (word >> 2)):
                    return None
                if word[-1] & 3 >= REJECTED:
                    lost = np.flatnonzero(word == LOST)
                    step = binding.first + int(lost[0]) if lost.size else None
                    rule = own.rule
                    violations.append(Violation(rule.name, rule.strength, binding.objects, step))
        return violations

    def _library(self, rulebook: CompiledRulebook, cast: Cast) -> CLibrary:
        """The monitor with enough seats for the objects, rounded up to powers of two."""
        vocabulary = rulebook.vocabulary
        roots = [name for name, kind in vocabulary.types.items() if kind.parent is None]
        most = dict.fromkeys(roots, 1)
        for number in range(cast.n_states):
            there = Counter(
                list(vocabulary.ancestors(cast.objects[item]))[-1] for item in _items(cast, number)
            )
            most = {root: max(n, there[root]) for root, n in most.items()}
        bounds = {root: 1 << (n - 1).bit_length() for root, n in most.items()}
        steps = [rule.step_s for rule in rulebook.rules if rule.step_s is not None]
        key = float(steps[0]) if steps else 0.0, tuple(bounds.values())
        if key not in self._libraries:
            layout = monitor_layout(rulebook, bounds)
            self._libraries[key] = CLibrary(layout, optimised=False)
        return self._libraries[key]


def _items(cast: Cast, number: int) -> Iterator[str]:
    """The objects that are present in a state."""
    always = 0, cast.n_states - 1
    for item in cast.objects:
        first, last = cast.present.get(item, always)
        if first <= number <= last:
            yield item


def is_all_known(layout: MonitorLayout, state: State, objects: Mapping[str, str]) -> bool:
    """Whether a state or the defaults provide all values that the rules read."""
    vocabulary = layout.fields.vocabulary
    for item in layout.fields.read:
        if item.default is not None and type(item.default) not in UNKNOWN_TYPES:
            continue
        places: list[list[str]] = [[]]
        for kind in item.parameters:
            fitting = fitting_objects(kind, objects, vocabulary)
            places = [[*before, name] for before in places for name in fitting]
        if any(value_given(state, item, place) is None for place in places):
            return False
    return True


class _Run:
    """The verdicts of C after each state of a trace, for every rule and all seats.

    ``is_whole`` if all values are known and all steps were accepted.
    """

    def __init__(self, library: CLibrary, states: Sequence[Mapping[str, Any]], cast: Cast) -> None:
        self._ids: dict[str, int] = {}
        layout, n = library.layout, cast.n_states
        n_instances = sum(own.n_instances for own in layout.rules) or 1
        self._seats: NDArray[np.uint32] = np.zeros((n, layout.n_seats), dtype=np.uint32)
        self._verdicts: Bytes = np.zeros((n, n_instances), dtype=np.uint8)
        self._firsts: dict[str, int] = {}
        first = 0
        for own in layout.rules:
            self._firsts[own.rule.name] = first
            first += own.n_instances
        inputs = (library.input_type * n)()
        self.is_whole = True
        kept = []
        for number, state in enumerate(states):
            objects = {item: cast.objects[item] for item in _items(cast, number)}
            if not is_all_known(library.layout, state, objects):
                self.is_whole = False
                return
            kept.append(library.input_of(state, objects, self._ids))
            inputs[number] = kept[-1]
        memory = ctypes.create_string_buffer(library.call("state_size")())
        library.call("run").restype = ctypes.c_uint32
        taken = library.call("run")(
            memory,
            inputs,
            ctypes.c_uint32(n),
            self._verdicts.ctypes.data_as(ctypes.c_void_p),
            self._seats.ctypes.data_as(ctypes.c_void_p),
        )
        self.is_whole = taken == n

    def verdicts(self, own: RuleLayout, binding: Binding) -> Bytes:
        """The verdicts of a rule for some objects, while these are present."""
        number = 0
        for item, (first, end) in zip(binding.objects.values(), own.seats, strict=True):
            (seat,) = np.flatnonzero(self._seats[binding.first] == self._ids[item])
            number = number * (end - first) + int(seat) - first
        place = self._firsts[own.rule.name] + number
        return self._verdicts[binding.first : binding.last + 1, place]
