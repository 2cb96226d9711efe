"""Machines of rules for words of which neither the past nor the rest has been seen.

A recording begins and stops because the recorder did. What an operator of the past looks for before
the first letter is unknown: it may have been anything. So a rule with such operators is compiled as
``not begun weak until (begun and formula)``, where ``begun`` is true from the first letter on; a
run may start in whatever state the letters before it lead to. A sequence may be under way, too: a
rule of what ego alone always or never does has been kept until then, and goes on. Those about
others begin where these are there: in some past that there might be, ego passed them on a crossing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.compiler import answers_to, job_of
from rulec.automata.compiler_jobs import MOST_LETTERS, Done, Failed, Job
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, Read
from rulec.automata.outcome_machine import OutcomeMachine, of_prefixes
from rulec.automata.worker import compiler_choice
from rulec.logic import formula as ltl
from rulec.logic.bounds import PAST, operations_of
from rulec.logic.semantics import Semantics

_BEGUN = ltl.Atom("word has begun")
"""No name of a rulebook has a space in it."""

_KNOWN: dict[tuple[object, ...], OutcomeMachine | None] = {}
_MOST_KNOWN = 1 << 10


def prefix_machines(rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
    """The machine of each rule for prefixes, by the rule's name; None where it gets too large.

    They are compiled on first use. Raises RulecError R0403 if Spot is asked for and not installed.
    """
    keys = {rule.name: _key(rule, rulebook) for rule in rulebook.rules}
    missing = [rule for rule in rulebook.rules if keys[rule.name] not in _KNOWN]
    if missing and len(_KNOWN) + len(missing) > _MOST_KNOWN:
        _KNOWN.clear()
        missing = list(rulebook.rules)
    jobs = [job for rule in missing for job in _jobs(rule, rulebook)]
    answers = iter(_answers(jobs, is_spots=bool(rulebook.spot)))
    for rule in missing:
        own = _table(next(answers)) if _looks_back(rule) else rule.machine
        finite = own if rulebook.semantics == "finite" else _table(next(answers))
        machine = None
        if own is not None and finite is not None:
            machine = _machine(own, finite, goes_on=_goes_on(rule.formula, rule.variables))
        _KNOWN[keys[rule.name]] = machine
    return {name: _KNOWN[key] for name, key in keys.items()}


def _answers(jobs: Sequence[Job], *, is_spots: bool) -> list[Done | Failed | None]:
    """The machines, by decision diagrams where nobody asks for another compiler.

    Spot takes twice as long for words that end, and of some rules ten times; the tables are the
    same. What diagrams have no way for is Spot's, if that has made the rulebook.
    """
    if not jobs:
        return []
    if compiler_choice.choice():
        return answers_to(jobs)[0]
    answers, _ = answers_to(jobs, choice=compiler_choice.DIAGRAMS)
    left = [job for job, answer in zip(jobs, answers, strict=True) if not isinstance(answer, Done)]
    if not left or not is_spots:
        return answers
    others = iter(answers_to(left)[0])
    return [answer if isinstance(answer, Done) else next(others) for answer in answers]


def _key(rule: CompiledRule, rulebook: CompiledRulebook) -> tuple[object, ...]:
    axioms = tuple([(axiom.variables, axiom.formula) for axiom in rulebook.axioms])
    return rule.formula, rule.machine.reads, rule.step_s, rule.variables, rulebook.semantics, axioms


def _goes_on(formula: ltl.Formula, variables: Sequence[object]) -> bool:
    """Whether a rule was kept before a word that is cut, a sequence perhaps under way."""
    always = ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER
    if not isinstance(formula, ltl.Unary) or formula.operator not in always or variables:
        return False
    then = ltl.BinaryOperator.THEN
    return formula.bound is None and any(x.operator is then for x in operations_of(formula))


def _looks_back(rule: CompiledRule) -> bool:
    return any(operation.operator in PAST for operation in operations_of(rule.formula))


def _jobs(rule: CompiledRule, rulebook: CompiledRulebook) -> Iterator[Job]:
    """What continuations decide, and what the word alone does.

    The first is the rule's own machine if it does not look back; both are one if words end.
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
        # The signal that the word has begun comes on top of what a rule may read.
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
