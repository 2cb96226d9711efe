"""The evidence for a violation: what was measured, how long it lasts, by how much, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.extraction.to_trace import Drive, Place
from rulec.logic.formula import Comparison, Count, atoms_of
from rulec.logic.free_names import names_in
from rulec.monitoring.explain.explained_arrays import explain_arrays
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.verdict import Violation
from rulec.trace import Trace, Value


@dataclass(frozen=True, slots=True)
class ViolationEvidence:
    """What a violation rests on.

    The names that its rule reads were ``measured`` in all states, be it to a tolerance, ``assumed``
    by the user, presumed (or taken by default, if that was asked for), or ``unknown`` in some state
    without making a difference. It lasts from ``from_s`` to ``to_s`` (s of the recording), and is
    decided ``at_s``; ``margins`` say by how much, ``place`` where ego is then. ``whom`` are those
    because of whom a word that decides is then as it is, such as who overtakes ego, where the rule
    itself names nobody.
    """

    measured: tuple[str, ...]
    assumed: tuple[str, ...]
    by_default: tuple[str, ...]
    unknown: tuple[str, ...]
    from_s: float
    to_s: float
    at_s: float
    margins: tuple[Margin, ...]
    place: Place | None
    whom: tuple[str, ...] = ()


def evidence_of(
    violation: Violation,
    drive: Drive,
    rules: CompiledRulebook,
    assumed: Mapping[str, Value],
    explanation: Explanation | None = None,
) -> ViolationEvidence:
    """The evidence for a violation by a drive; ``explanation`` is its own, if there is one."""
    explained = (
        explanation
        or explain_arrays(violation, drive.arrays, rules, drive.decided_by)
        or explain(
            violation, trace_for(violation, drive, rules), rules, drive.decided_by, repaired=False
        )
    )
    read = dict.fromkeys(names_in(explained.rule.formula))
    told = [name for name in read if name in drive.kinds and name not in assumed]
    partial = {name for name in told if _is_partial(drive, name)}
    declared = rules.vocabulary.declarations
    untold = [name for name in read if name not in drive.kinds]
    by_default = [name for name in untold if drive.arrays.told is None or declared[name].presumed]
    first, last = explained.lasts
    unknown = [name for name in untold if name not in by_default]
    return ViolationEvidence(
        measured=tuple([name for name in told if name not in partial]),
        assumed=tuple([name for name in read if name in assumed]),
        by_default=tuple(by_default),
        unknown=tuple([name for name in read if name in partial or name in unknown]),
        from_s=drive.time_s(first),
        to_s=drive.time_s(last),
        at_s=drive.time_s(explained.decisive),
        margins=tuple(explained.margins()),
        place=drive.places[explained.decisive] if drive.places else None,
        whom=whom_of(explained, drive),
    )


def whom_of(explained: Explanation, drive: Drive) -> tuple[str, ...]:
    """Those because of whom words that decide are as they are, when it is decided or just before.

    A duty that has come to its end may be lost in a state in which nobody is there any more.
    """
    decide = [fact.text for fact in explained.facts if fact.decides and fact.text in drive.whom]
    first, _ = explained.lasts
    for state in range(explained.decisive, first - 1, -1):
        found = [one for name in decide for one in drive.whom[name][state]]
        if found:
            named = explained.violation.binding.values()
            return tuple([name for name in dict.fromkeys(found) if name not in named])
    return ()


def trace_for(violation: Violation, drive: Drive, rules: CompiledRulebook) -> Trace:
    """The drive's trace with what the violated rule reads, of the objects that it is about.

    A drive's states say a hundred things of dozens, a rule reads five of one.
    """
    arrays = drive.arrays
    rule = next(rule for rule in rules.rules if rule.name == violation.rule)
    terms = [
        term
        for read in rule.machine.reads
        if isinstance(read, NumberRead)
        for _, term in read.terms
    ]
    comparisons = [atom for atom in atoms_of(rule.formula) if isinstance(atom, Comparison)]
    terms += [term for comparison in comparisons for _, term in comparison.terms]
    names = {name for read in (rule.formula, *terms) for name in names_in(read)}
    names |= {read.name for read in rule.machine.reads if isinstance(read, Read)}
    counts = any(isinstance(term, Count) for term in terms)
    part = arrays.part(names, arrays.objects.keys() if counts else {*violation.binding.values()})
    # To be completed as the whole trace would be
    return replace(part, ends="cut" if arrays.is_partial else arrays.ends).trace()


def _is_partial(drive: Drive, name: str) -> bool:
    """Whether a name is unknown in some state, of somebody of whom it is said."""
    arrays = drive.arrays
    unknown = arrays.unknown.get(name)
    if unknown is None or not unknown.any():
        return False
    if name in arrays.about and name in arrays.only:
        lengths = np.diff(arrays.starts)
        unknown = unknown & arrays.only[name].repeat(lengths)
    return bool(unknown.any())
