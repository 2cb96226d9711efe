"""Compiles a rulebook to monitors, with Spot or with decision diagrams, in another process.

A formula's automaton can be doubly exponential in it. Spot then uses up memory or ends its process;
so it runs in a separate process, with limits on memory, and on the processor time of all rules.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import KW_ONLY, dataclass
from fractions import Fraction
from typing import TypeAlias

from rulec.automata.alphabet import propositions_of, reads_of
from rulec.automata.axiom_groups import axiom_groups
from rulec.automata.bundle.compiled_rulebook import (
    CompiledAxiom,
    CompiledRule,
    CompiledRulebook,
    GivenRulebook,
    alike,
)
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.worker import compiler_choice
from rulec.automata.worker.clocked_jobs import Answer, machines, texts_with_clocks
from rulec.automata.worker.compiler_messages import no_machine, no_spot, no_time, not_confined
from rulec.automata.worker.machine_cache import MachineCache
from rulec.automata.worker.worker_answers import HAS_PROCESSES, WorkerGreeting, answered_here
from rulec.cache.keeping import is_keeping
from rulec.diagnostics import Diagnostic, RulecError
from rulec.diagnostics.diagnostic import at
from rulec.logic.bounds import fitting_step, has_seconds, in_steps
from rulec.logic.formula import Formula
from rulec.logic.printing import time_in_words
from rulec.resource_limits import CompilerTime
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook, parts_of
from rulec.rulebook.rules.axiom_instances import axiom_instances
from rulec.rulebook.rules.exemptions import rule_trigger
from rulec.rulebook.rules.implied_signals import with_implied
from rulec.version import __version__

# The worker finds the modules that this process finds, and nothing in the working directory.
_REQUIRE_CONFINED = "RULEC_REQUIRE_CONFINED"
_WORKER = """
import sys
choice, *sys.path[:] = sys.argv[1:]
from rulec.automata.worker.confinement import confine
confined = confine()  # before NumPy has threads
from rulec.automata.worker.compiler_worker import main
main(confined, choice)
"""


@dataclass(frozen=True, slots=True)
class RuleFormula:
    """A formula with bounds in steps of ``step_s`` s (None if any step fits)."""

    rule: Rule
    formula: Formula
    step_s: Fraction | None

    @property
    def key(self) -> tuple[str, Formula]:
        """What decides the rule's machine in its rulebook."""
        return self.rule.name, self.formula


@dataclass(frozen=True, slots=True)
class RulebookFormulas:
    """The formulas of a rulebook's rules for one step.

    ``step_s`` is None if each rule has the step of its own examples.
    """

    rules: tuple[RuleFormula, ...]
    step_s: Fraction | None = None


def lower(rulebook: Rulebook, step_s: Fraction | None = None) -> RulebookFormulas:
    """Translate every rule's bounds in seconds into steps.

    ``step_s`` is the number of seconds between two states of the traces to be judged; None for the
    step of each rule's own examples, and for a rule without examples, for one of which all its
    bounds are multiples.
    """
    formulas: list[RuleFormula] = []
    for rule in rulebook.rules:
        step: Fraction | None = rule.step_s if step_s is None else step_s
        if not has_seconds(rule.formula):
            step = None  # any fits
        if step is not None and step_s is None and not rule.examples:
            step = fitting_step(rule.formula, step)
        formula = rule.formula if step is None else in_steps(rule.formula, step)
        formulas.append(RuleFormula(rule, formula, step))
    return RulebookFormulas(tuple(formulas), step_s)


def compile_rulebook(rulebook: Rulebook, *, step_s: Fraction | None = None) -> CompiledRulebook:
    """Compile every rule for one step: ``lower``, then ``build_all``."""
    return build_all(rulebook, lower(rulebook, step_s), with_texts=True)


def build_all(
    rulebook: Rulebook,
    formulas: RulebookFormulas,
    *,
    with_texts: bool = False,
    more_will_come: bool = False,
    time: CompilerTime | None = None,
) -> CompiledRulebook:
    """Build the automaton of every formula, in the order of the rules; ``with_texts`` in HOA, too.

    With ``more_will_come`` the worker stays alive for the next call, since starting one takes
    0.25 s.
    Raises RulecError R0401 for each rule whose automaton is too large, R0402 for each whose
    automaton failed its check, R0403 for each that needs Spot if Spot is missing, R0409 for axioms
    that contradict each other; BudgetSpentError (R0718) alone if no ``time`` is left.
    """
    compiled: list[CompiledRule] = []
    problems: list[Diagnostic] = []
    jobs = [_job(rulebook, rule, with_texts=with_texts) for rule in formulas.rules]
    answers, spot = answers_to(jobs, more_will_come=more_will_come, time=time)
    for lowered, answer in zip(formulas.rules, answers, strict=True):
        if isinstance(answer, Done):
            compiled.append(_compiled(lowered.rule, lowered.step_s, answer))
        elif answer == Failed("time"):
            raise no_time(lowered.rule.name, at(lowered.rule.span), lowered.step_s)
        else:
            place = at(lowered.rule.span)
            problems.append(no_machine(lowered.rule, place, answer, lowered.step_s))
    if problems:
        # Every rule reports contradictory facts; each report is kept once.
        raise RulecError(dict.fromkeys(problems))
    return CompiledRulebook(
        **alike(Rulebook, rulebook),
        vocabulary=with_implied(rulebook.vocabulary, [axiom.formula for axiom in rulebook.axioms]),
        rules=tuple(compiled),
        sources=rulebook.sources,
        rulec=__version__,
        spot=spot,
        axioms=tuple(
            CompiledAxiom(axiom.variables, axiom.formula, at(axiom.span))
            for axiom in rulebook.axioms
        ),
        priorities=rulebook.priorities,
        origin=GivenRulebook(rulebook),
    )


def job_of(rule: CompiledRule, rulebook: CompiledRulebook) -> Job:
    """The job that a compiled rule came from, without remarks."""
    facts = [Axiom(axiom.variables, axiom.formula) for axiom in rulebook.axioms]
    instances = axiom_instances(rule.variables, facts, rulebook.vocabulary)
    return Job(
        rule.name,
        rule.formula,
        rule.machine.reads,
        remarks=(),
        semantics=rulebook.semantics,
        groups=axiom_groups(propositions_of(rule.formula), instances, rulebook.vocabulary),
        step_s=rule.step_s,
    )


def answers_to(
    jobs: Sequence[Job],
    *,
    more_will_come: bool = False,
    choice: str | None = None,
    time: CompilerTime | None = None,
) -> tuple[list[Done | Failed | None], str]:
    """The worker's answers, None for a job that killed it; and Spot's version, empty without Spot.

    The time that they take is added to ``time``; once that is over, no more jobs are sent.

    ``choice`` is the compiler, None for the one that the environment chooses. Raises RulecError
    R0403 if Spot is requested but not installed.
    """
    asked = _Asked(choice, more_will_come=more_will_come, time=time or CompilerTime())
    return machines(jobs, asked.answers), asked.spot or ""


def clocked_texts(jobs: Sequence[Job]) -> list[str]:
    """The automata of jobs with clocks, as ``texts_with_clocks``. Raises RulecError R0403."""
    return texts_with_clocks(jobs, _Asked(None, more_will_come=False, time=CompilerTime()).answers)


@dataclass(slots=True)
class _Asked:
    """Questions to a compiler; ``spot`` is Spot's version once it is known."""

    choice: str | None
    _: KW_ONLY
    more_will_come: bool
    time: CompilerTime
    spot: str | None = None

    def answers(self, jobs: Sequence[Job]) -> list[Answer]:
        """The answers to jobs, from the cache or from a worker."""
        if not HAS_PROCESSES:
            return [*answered_here(jobs)]
        choice = compiler_choice.choice() if self.choice is None else self.choice
        # A command ends soon, and may first need another rulebook, or machines for cut words.
        more_will_come = self.more_will_come or is_keeping()
        cache = MachineCache(choice)
        known, spot = cache.recalled(jobs)
        self.spot = spot if self.spot is None else self.spot
        missing = [job for job, answer in zip(jobs, known, strict=True) if answer is None]
        answers: list[Answer] = []
        while len(answers) < len(missing) or self.spot is None:
            # A worker lives until it is done or a job kills it; a new one takes the remaining jobs.
            with _worker(choice, more_will_come=more_will_come) as (process, self.spot):
                for job in missing[len(answers) :]:
                    if self.time.left_s <= 0:
                        answers.append(Failed("time"))
                        continue
                    answer, seconds = _ask(process, job, self.time.left_s)
                    answers.append(answer)
                    self.time.taken_s += seconds
                    if answer in (None, Failed("time")):
                        _end(process)
                        break
        cache.keep(missing, answers, self.spot)
        new = iter(answers)
        return [next(new) if answer is None else answer for answer in known]


_Started: TypeAlias = "tuple[subprocess.Popen[bytes], str]"
_waiting: dict[tuple[object, ...], _Started] = {}
"""Idle workers, kept for more jobs: by the process that started them and how; one for each."""


@contextmanager
def _worker(choice: str, *, more_will_come: bool = False) -> Iterator[_Started]:
    key = os.getpid(), _WORKER, os.environ.get(_REQUIRE_CONFINED), choice, *sys.path
    process, spot = _waiting.pop(key) if key in _waiting else _started(choice)
    if process.poll() is not None:  # it ended while idle
        _end(process)
        process, spot = _started(choice)
    is_fit = False
    try:
        yield process, spot
        is_fit = more_will_come and process.poll() is None and key not in _waiting
    finally:
        if is_fit:
            _waiting[key] = process, spot
        else:
            _end(process)


@atexit.register
def _end_waiting() -> None:
    for key in [key for key in _waiting if key[0] == os.getpid()]:
        _end(_waiting.pop(key)[0])


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.communicate()


def _started(choice: str) -> _Started:
    process = subprocess.Popen(
        [sys.executable, "-I", "-c", _WORKER, choice, *filter(None, sys.path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        # The diagnostic explains the failure better than the output of a dying C++ library.
        stderr=subprocess.DEVNULL,
        # In its own process group Ctrl-C does not reach it; it is ended below.
        start_new_session=True,
    )
    try:
        assert process.stdout is not None
        try:
            ready: WorkerGreeting = pickle.load(process.stdout)
        except EOFError:
            ready = WorkerGreeting(None, f"its process ended with status {process.wait()}")
        if ready.spot is None:
            raise RulecError(no_spot(ready.problem))
        if ready.confined and not all(ready.confined) and os.environ.get(_REQUIRE_CONFINED):
            raise RulecError(not_confined(ready.confined))
    except BaseException:
        _end(process)
        raise
    return process, ready.spot


def _ask(process: subprocess.Popen[bytes], job: Job, most_s: float) -> tuple[Answer, float]:
    """The worker's answer, None if the job killed it, and the time that it took (s).

    It is stopped after ``most_s`` seconds of processor time.
    """
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        pickle.dump((job, most_s), process.stdin)
        process.stdin.flush()
        answer: tuple[Answer, float] = pickle.load(process.stdout)
    except (EOFError, BrokenPipeError, pickle.UnpicklingError):
        before_s = _children_s()
        is_late = process.wait() == -signal.SIGXCPU
        return Failed("time") if is_late else None, _children_s() - before_s
    return answer


def _children_s() -> float:
    """The processor time (s) of all processes that this one started and that have ended."""
    used = os.times()
    return used.children_user + used.children_system


def remarks_on(
    rule: Rule | CompiledRule, rulebook: str, step_s: Fraction | None
) -> tuple[str, ...]:
    """The comments in the text of a rule's automaton."""
    cite = f", {rule.cite}" if rule.cite else ""
    step = [] if step_s is None else [f"one letter is {time_in_words(step_s, 's')}"]
    of = f"{rule.strength} rule {rule.name} of {rulebook}{cite}"
    return of, f"compiled by rulec {__version__}", *step


def _job(rulebook: Rulebook, lowered: RuleFormula, *, with_texts: bool = False) -> Job:
    rule, formula = lowered.rule, lowered.rule.formula
    vocabulary = rulebook.vocabulary
    instances = axiom_instances(rule.variables, rulebook.axioms, vocabulary)
    return Job(
        name=rule.name,
        formula=formula,
        reads=reads_of(formula, vocabulary),
        remarks=remarks_on(rule, rulebook.name, lowered.step_s) if with_texts else (),
        semantics=rulebook.semantics,
        groups=axiom_groups(propositions_of(formula), instances, vocabulary),
        step_s=lowered.step_s,
    )


def _compiled(rule: Rule, step: Fraction | None, done: Done) -> CompiledRule:
    return CompiledRule(
        **alike(Rule, rule),
        variables=rule.variables,
        formula=rule.formula,
        machine=done.machine,
        hoa=done.hoa,
        step_s=step,
        timed=done.timed,
        weight=rule.weight,
        trigger=rule_trigger(rule),
        parts=parts_of(rule),
    )
