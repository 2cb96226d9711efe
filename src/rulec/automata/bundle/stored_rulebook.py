"""Serialisation of cached compiled rulebooks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.bundle.cut_machines import StoredPrefixes, TimedCut
from rulec.automata.clocks.clocked_machine import ClockedMachine, ClockLetters, TimedMachine
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read, Threshold
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.cache.stored_objects import ObjectCodec, ObjectKind, kind_of_fields, kinds_of_fields
from rulec.diagnostics import Diagnostic
from rulec.logic import formula as ltl
from rulec.rulebook.reading.reading_cache import READING_KINDS, Basis
from rulec.rulebook.reading.rulebook_cache import RULE_KINDS


@dataclass(frozen=True, slots=True)
class Compilation:
    """The content of a file: what it was made from, the warnings, and the rulebook."""

    basis: Basis
    warnings: tuple[Diagnostic, ...] = ()
    rulebook: CompiledRulebook | None = None


def _rulebook(*parts: Any) -> CompiledRulebook:
    """A rulebook from its stored parts, with the machines for cut traces as the last one."""
    return replace(CompiledRulebook(*parts[:-1]), prefixes=parts[-1])


_RULEBOOK = kind_of_fields(CompiledRulebook, ["origin", "recompile", "too_large"])
_MACHINES = Read, Threshold, NumberRead, MealyMonitor, ClockLetters, ClockedMachine
MACHINE_KINDS = {**RULE_KINDS, **kinds_of_fields(_MACHINES)}
COMPILATIONS = ObjectCodec(
    {
        **READING_KINDS,
        **MACHINE_KINDS,
        ltl.Bound: kind_of_fields(ltl.Bound, ["span"]),
        CompiledRulebook: ObjectKind(_RULEBOOK.parts, _rulebook),
        **kinds_of_fields(
            (
                *(CompiledRule, CompiledAxiom, TimedMachine),
                *(OutcomeMachine, TimedCut, StoredPrefixes, Compilation),
            )
        ),
    }
)
