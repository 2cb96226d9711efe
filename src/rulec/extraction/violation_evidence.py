"""The evidence for a violation: what was measured, how long it lasts, by how much, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.extraction.recording_verdicts import rulebook_at
from rulec.extraction.traces.recorded_drive import Drive, Place
from rulec.logic.formula import Comparison, Count, atoms_of
from rulec.logic.free_names import names_in
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.told_names import names_behind, words_meant
from rulec.monitoring.verdict import Violation
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import Trace, Value


@dataclass(frozen=True, slots=True)
class ViolationEvidence:
    """What a violation rests on.

    The names that its rule reads were ``measured`` in all states, perhaps to within a tolerance,
    ``assumed`` by the user, taken ``by_default`` (presumed, or defaults were requested), or
    ``unknown`` in some state without making a difference. The violation lasts from ``from_s`` to
    ``to_s`` (s of the recording) and is decided at ``at_s``; ``margins`` say by how much, ``place``
    is where ego is then. ``whom``: participants that the rule does not name but that cause the
    value of a deciding word then, such as the vehicle that overtakes ego.
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

    @property
    def rests_on(self) -> Literal["measured", "assumed", "default"]:
        """The weakest ground of the violation."""
        if self.assumed:
            return "assumed"
        return "default" if self.by_default else "measured"


def evidence_of(
    violation: Violation,
    drive: Drive,
    rules: CompiledRulebook,
    assumed: Mapping[str, Value],
    explanation: Explanation | None = None,
) -> ViolationEvidence:
    """The evidence for a violation in a drive; ``explanation`` explains it, if already made."""
    explained = explanation or explain(
        violation, trace_for(violation, drive, rules), rules, drive.decided_by, repaired=False
    )
    read = dict.fromkeys(names_in(explained.rule.formula))
    meant = words_meant(rules.vocabulary, drive.arrays.told)
    behind = sorted(names_behind(read.keys(), rules.vocabulary, meant))
    read = dict.fromkeys([name for name in (*read, *behind) if name not in meant])
    told = [name for name in read if name in drive.kinds and name not in assumed]
    partial = {name for name in told if _is_partial(drive, name)}
    declared = rules.vocabulary.declarations
    untold = [name for name in read if name not in drive.kinds]
    source = drive.arrays.told or ()
    by_default = [name for name in untold if name in source or declared[name].presumed]
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


def explain_drive(violation: Violation, drive: Drive, rules: CompiledRulebook) -> Explanation:
    """Explain a violation in a drive, with the numbers that decided its words.

    ``rules`` may have any step that the recording's verdicts may have.
    """
    at_step = rulebook_at(rules, drive.arrays.step_s)
    return explain(violation, drive.trace, at_step, drive.decided_by)


def whom_of(explained: Explanation, drive: Drive) -> tuple[str, ...]:
    """The participants behind the values of deciding words, at the decisive state or just before.

    A duty that has ended may be violated in a state in which nobody is present any more.
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
    """The drive's trace, reduced to what the violated rule reads, of the objects that it is about.

    A drive's states have a hundred signals of dozens of objects, a rule reads five of one.
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
    meanings, meant = rules.vocabulary.meanings, words_meant(rules.vocabulary, arrays.told)
    names = {*names_behind(names, rules.vocabulary, meant)}
    among_all = any(isinstance(term, Count) for term in terms)
    among_all |= any(counts(meanings[name].formula) for name in names.intersection(meant))
    part = arrays.part(names, arrays.objects.keys() if among_all else {*violation.binding.values()})
    # To be completed as the whole trace would be
    return replace(part, ends="cut" if arrays.is_partial else arrays.ends).trace()


def _is_partial(drive: Drive, name: str) -> bool:
    """Whether a name is unknown in some state, for some object to which it applies."""
    arrays = drive.arrays
    unknown = arrays.unknown.get(name)
    if unknown is None or not unknown.any():
        return False
    if name in arrays.about and name in arrays.only:
        lengths = np.diff(arrays.starts)
        unknown = unknown & arrays.only[name].repeat(lengths)
    return bool(unknown.any())
