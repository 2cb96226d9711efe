"""Machines of rules for words whose past and continuation are unobserved.

A recording begins and stops because the recorder did. What past operators look for before the
first letter is unknown. So a rule with past operators is compiled as
``not begun weak until (begun and formula)``, where ``begun`` is true from the first letter on; a
run may start in any state that earlier letters can lead to. A sequence may be under way, too: a
rule on what ego alone always or never does has been kept so far and continues. Rules about other
objects begin when these appear: otherwise, in some possible past, ego passed them on a crossing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.bundle.cut_machines import (
    BEGUN,
    TimedCut,
    cut_machine,
    goes_on_from_before,
    looks_back,
)
from rulec.automata.compiler import answers_to, job_of
from rulec.automata.compiler_jobs import MOST_LETTERS, Done, Failed, Job
from rulec.automata.mealy_monitor import MealyMonitor, Read
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.automata.tables import SizeError
from rulec.automata.worker.compiler_messages import no_time
from rulec.logic import formula as ltl
from rulec.logic.semantics import Semantics
from rulec.resource_limits import CompilerTime

_KNOWN: dict[tuple[object, ...], OutcomeMachine | None] = {}
_TIMED: dict[tuple[object, ...], TimedCut] = {}
_MOST_KNOWN = 1 << 10


def prefix_machines(
    rulebook: CompiledRulebook, time: CompilerTime | None = None
) -> Mapping[str, OutcomeMachine | None]:
    """The machine of each rule for prefixes, by the rule's name; None if it gets too large.

    They are compiled on first use, if possible for all steps. Raises RulecError R0403 if Spot is
    requested but not installed, BudgetSpentError (R0718) if no ``time`` is left.
    """
    keys = {rule.name: (_key(rule, rulebook), rule.step_s) for rule in rulebook.rules}
    fresh = {key for key in keys.values() if key not in _KNOWN}
    if fresh and len(_KNOWN) + len(fresh) > _MOST_KNOWN:
        _KNOWN.clear()
        _TIMED.clear()
    missing = []
    for rule in rulebook.rules:
        key = keys[rule.name]
        timed = _TIMED.get(key[0])
        if key not in _KNOWN and timed is not None:
            # If it is too large, a compiler may know a smaller way.
            with suppress(SizeError):
                _KNOWN[key] = timed.at(rule)
        missing += [] if key in _KNOWN else [rule]
    jobs = [job for rule in missing for job in _jobs(rule, rulebook)]
    answers = iter(answers_to(jobs, time=time)[0] if jobs else ())
    for rule in missing:
        mine = [next(answers) for _ in _jobs(rule, rulebook)]
        if Failed("time") in mine:
            raise no_time(rule.name, rulebook.place_of(rule.name), rule.step_s)
        key = keys[rule.name]
        _KNOWN[key] = _machine(rule, mine, rulebook.semantics)
        timed = _timed(rule, mine, rulebook.semantics)
        if timed is not None:
            _TIMED[key[0]] = timed
    return {name: _KNOWN[key] for name, key in keys.items()}


def timed_cuts(rulebook: CompiledRulebook) -> Mapping[str, TimedCut]:
    """What the machines that this process has made are made of at any step, by the rule's name."""
    known = {rule.name: _TIMED.get(_key(rule, rulebook)) for rule in rulebook.rules}
    return {name: timed for name, timed in known.items() if timed is not None}


def _machine(
    rule: CompiledRule, answers: Sequence[Done | Failed | None], semantics: Semantics
) -> OutcomeMachine | None:
    tables = [_table(answer) for answer in answers]
    own = tables[0] if looks_back(rule) else rule.machine
    alone = own if semantics == "finite" else tables[-1]
    if own is None or alone is None:
        return None
    return cut_machine(own, alone, goes_on=goes_on_from_before(rule))


def _timed(
    rule: CompiledRule, answers: Sequence[Done | Failed | None], semantics: Semantics
) -> TimedCut | None:
    tables = [answer.timed if isinstance(answer, Done) else None for answer in answers]
    if None in tables:
        return None
    own = tables[0] if looks_back(rule) else None
    return TimedCut(own, None if semantics == "finite" else tables[-1])


def _key(rule: CompiledRule, rulebook: CompiledRulebook) -> tuple[object, ...]:
    axioms = tuple([(axiom.variables, axiom.formula) for axiom in rulebook.axioms])
    formula = rule.formula, goes_on_from_before(rule)
    return formula, rule.machine.reads, rule.variables, rulebook.semantics, axioms


def _jobs(rule: CompiledRule, rulebook: CompiledRulebook) -> Iterator[Job]:
    """The jobs for the rule's machine on continuations and its machine on the word alone.

    The first is omitted if the rule does not look back (its own machine serves); the second, if
    the rulebook has finite semantics, since both would be the same.
    """
    job = job_of(rule, rulebook)
    wanted: list[Semantics] = [] if rulebook.semantics == "finite" else ["finite"]
    if looks_back(rule):
        wanted.insert(0, rulebook.semantics)
        before = ltl.Unary(ltl.UnaryOperator.NOT, BEGUN)
        begun = ltl.Binary(ltl.BinaryOperator.AND, BEGUN, job.formula)
        formula = ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, before, begun)
        job = replace(job, formula=formula, reads=(*job.reads, Read(BEGUN.name, ())))
    for semantics in wanted:
        # The signal that the word has begun is added to what a rule may read.
        yield replace(job, semantics=semantics, most_letters=2 * MOST_LETTERS)


def _table(answer: Done | Failed | None) -> MealyMonitor | None:
    return answer.machine if isinstance(answer, Done) else None
