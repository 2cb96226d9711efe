"""Machines of rules for words whose past and continuation are unobserved.

A recording begins and stops because the recorder did. What past operators look for before the
first letter is unknown. So a rule with past operators is compiled as
``not begun weak until (begun and formula)``, where ``begun`` is true from the first letter on; a
run may start in any state that earlier letters can lead to. A sequence may be under way, too: a
rule on what ego alone always or never does has been kept so far and continues. Rules about other
objects begin when these appear: otherwise, in some possible past, ego passed them on a crossing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.compiler import CompilerTime, answers_to, job_of
from rulec.automata.compiler_jobs import MOST_LETTERS, Done, Failed, Job
from rulec.automata.compiler_messages import no_time
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, Read
from rulec.automata.outcome_machine import OutcomeMachine, of_prefixes
from rulec.logic import formula as ltl
from rulec.logic.bounds import PAST, operations_of
from rulec.logic.semantics import Semantics

_BEGUN = ltl.Atom("word has begun")
"""No name in a rulebook contains a space."""

_KNOWN: dict[tuple[object, ...], OutcomeMachine | None] = {}
_MOST_KNOWN = 1 << 10


def prefix_machines(
    rulebook: CompiledRulebook, time: CompilerTime | None = None
) -> Mapping[str, OutcomeMachine | None]:
    """The machine of each rule for prefixes, by the rule's name; None if it gets too large.

    They are compiled on first use. Raises RulecError R0403 if Spot is requested but not installed,
    BudgetSpentError (R0718) if no ``time`` is left.
    """
    keys = {rule.name: _key(rule, rulebook) for rule in rulebook.rules}
    missing = [rule for rule in rulebook.rules if keys[rule.name] not in _KNOWN]
    if missing and len(_KNOWN) + len(missing) > _MOST_KNOWN:
        _KNOWN.clear()
        missing = list(rulebook.rules)
    jobs = [job for rule in missing for job in _jobs(rule, rulebook)]
    answers = iter(answers_to(jobs, time=time)[0] if jobs else ())
    for rule in missing:
        mine = [next(answers) for _ in _jobs(rule, rulebook)]
        if Failed("time") in mine:
            raise no_time(rule.name, rulebook.place_of(rule.name), rule.step_s)
        tables = [_table(answer) for answer in mine]
        own = tables[0] if _looks_back(rule) else rule.machine
        finite = own if rulebook.semantics == "finite" else tables[-1]
        machine = None
        if own is not None and finite is not None:
            machine = _machine(own, finite, goes_on=_goes_on(rule))
        _KNOWN[keys[rule.name]] = machine
    return {name: _KNOWN[key] for name, key in keys.items()}


def _key(rule: CompiledRule, rulebook: CompiledRulebook) -> tuple[object, ...]:
    axioms = tuple([(axiom.variables, axiom.formula) for axiom in rulebook.axioms])
    formula = rule.formula, _goes_on(rule)
    return formula, rule.machine.reads, rule.step_s, rule.variables, rulebook.semantics, axioms


def _goes_on(rule: CompiledRule) -> bool:
    """Whether a rule, kept before a cut word began, may have a sequence under way there.

    Exceptions and a condition do not change that, though the whole formula may have no `then`.
    """
    formula = rule.formula if rule.parts is None else rule.parts.required
    always = ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER
    if not isinstance(formula, ltl.Unary) or formula.operator not in always or rule.variables:
        return False
    then = ltl.BinaryOperator.THEN
    return formula.bound is None and any(x.operator is then for x in operations_of(formula))


def _looks_back(rule: CompiledRule) -> bool:
    return any(operation.operator in PAST for operation in operations_of(rule.formula))


def _jobs(rule: CompiledRule, rulebook: CompiledRulebook) -> Iterator[Job]:
    """The jobs for the rule's machine on continuations and its machine on the word alone.

    The first is omitted if the rule does not look back (its own machine serves); the second, if
    the rulebook has finite semantics, since both would be the same.
    """
    job = job_of(rule, rulebook)
    wanted: list[Semantics] = [] if rulebook.semantics == "finite" else ["finite"]
    if _looks_back(rule):
        wanted.insert(0, rulebook.semantics)
        before = ltl.Unary(ltl.UnaryOperator.NOT, _BEGUN)
        begun = ltl.Binary(ltl.BinaryOperator.AND, _BEGUN, job.formula)
        formula = ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, before, begun)
        job = replace(job, formula=formula, reads=(*job.reads, Read(_BEGUN.name, ())))
    for semantics in wanted:
        # The signal that the word has begun is added to what a rule may read.
        yield replace(job, semantics=semantics, most_letters=2 * MOST_LETTERS)


def _table(answer: Done | Failed | None) -> MealyMonitor | None:
    return answer.machine if isinstance(answer, Done) else None


def _machine(own: MealyMonitor, finite: MealyMonitor, *, goes_on: bool) -> OutcomeMachine:
    looks_back = own.reads[-1:] == (Read(_BEGUN.name, ()),)
    half = len(own.letters) // 2 if looks_back else 0
    before, begun = (
        dict.fromkeys(
            pair
            for pair in zip(own.letters[letters], finite.letters[letters], strict=True)
            if IMPOSSIBLE not in pair
        )
        for letters in (slice(half), slice(half, None))
    )
    starts = {(0, 0): None}
    for symbols in (before, begun) if goes_on else (before,):
        for state, other in (waiting := list(starts)):
            for symbol, finite_symbol in symbols:
                pair = own.successors[state][symbol], finite.successors[other][finite_symbol]
                lost = pair[0] == own.rejecting_sink and not own.outputs[state][symbol]
                if pair not in starts and not (lost and symbols is begun):
                    starts[pair] = None
                    waiting.append(pair)
    if looks_back:
        own, finite = (
            replace(machine, reads=machine.reads[:-1], letters=machine.letters[half:])
            for machine in (own, finite)
        )
    return of_prefixes(own, finite, starts)
