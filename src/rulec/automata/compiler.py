"""A rulebook into a compiled rulebook, with Spot kept in a process of its own.

A formula's automaton can be doubly exponential in it. Spot then uses up memory or ends its process;
so it runs beside this one, with bounds on processor time and memory.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.automata.letters import reads_of
from rulec.automata.spot_worker import Done, Failed, Job, Ready
from rulec.diagnostics import Diagnostic, RulecError
from rulec.diagnostics.diagnostic import at
from rulec.rulebook.model import Rule, Rulebook
from rulec.version import __version__

CPU_LIMIT_S = 5

# It finds what this process finds, and nothing in the working directory.
_WORKER = """
import sys
sys.path[:] = sys.argv[1:]
from rulec.automata.spot_worker import main
main()
"""


def compile_rulebook(rulebook: Rulebook, *, cpu_limit_s: int = CPU_LIMIT_S) -> CompiledRulebook:
    """Compile every rule.

    Args:
        rulebook: the rulebook, as meant.
        cpu_limit_s: processor time that a rule's automaton may take, in whole seconds.

    Returns:
        The compiled rulebook, rules in the same order.

    Raises:
        RulecError: R0401 for each rule whose automaton is too large, R0402 for each whose
            automaton failed its check, R0403 if Spot is not installed.
    """
    compiled: list[CompiledRule] = []
    problems: list[Diagnostic] = []
    waiting = list(rulebook.rules)
    spot = ""
    while waiting or not spot:
        # A worker lives until it is done or a rule has killed it; the next one takes the rest.
        with _worker() as (process, spot):
            while waiting:
                rule = waiting.pop(0)
                answer = _ask(process, _job(rulebook, rule, cpu_limit_s))
                if isinstance(answer, Done):
                    compiled.append(_compiled(rule, answer))
                else:
                    problems.append(_problem(rule, answer, cpu_limit_s))
                if answer is None:
                    break
    if problems:
        raise RulecError(problems)
    return CompiledRulebook(
        rulebook.name,
        rulebook.vocabulary,
        tuple(compiled),
        rulebook.title,
        rulebook.law,
        rulebook.as_of,
        rulebook.sources,
        rulec=__version__,
        spot=spot,
    )


@contextmanager
def _worker() -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    process = subprocess.Popen(
        [sys.executable, "-I", "-c", _WORKER, *filter(None, sys.path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        # What a dying C++ library has to say is said better by the diagnostic.
        stderr=subprocess.DEVNULL,
        # In a group of its own Ctrl-C does not reach it; it is ended below.
        start_new_session=True,
    )
    try:
        assert process.stdout is not None
        try:
            ready: Ready = pickle.load(process.stdout)
        except EOFError:
            ready = Ready(None, f"its process ended with status {process.wait()}")
        if ready.spot is None:
            raise RulecError(_no_spot(ready.problem))
        yield process, ready.spot
    finally:
        process.kill()
        process.communicate()


def _ask(process: subprocess.Popen[bytes], job: Job) -> Done | Failed | None:
    """The worker's answer; None if the job was the end of it."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        pickle.dump(job, process.stdin)
        process.stdin.flush()
        answer: Done | Failed = pickle.load(process.stdout)
    except (EOFError, BrokenPipeError, pickle.UnpicklingError):
        return None
    return answer


def _job(rulebook: Rulebook, rule: Rule, cpu_limit_s: int) -> Job:
    cite = f", {rule.cite}" if rule.cite else ""
    remarks = (
        f"{rule.strength} rule {rule.name} of {rulebook.name}{cite}",
        f"compiled by rulec {__version__}",
    )
    reads = reads_of(rule.formula, rulebook.vocabulary)
    return Job(rule.name, rule.formula, reads, remarks, cpu_limit_s)


def _compiled(rule: Rule, done: Done) -> CompiledRule:
    return CompiledRule(
        rule.name,
        rule.strength,
        rule.variables,
        rule.cite,
        rule.says,
        rule.formula,
        done.machine,
        done.hoa,
    )


def _problem(rule: Rule, failed: Failed | None, cpu_limit_s: int) -> Diagnostic:
    place = at(rule.span)
    if failed is not None and failed.why == "bug":
        raise RuntimeError(f"while compiling rule {rule.name}:\n{failed.traceback}")
    if failed is not None and failed.why == "check":
        return Diagnostic(
            "R0402",
            f"the automaton of rule `{rule.name}` is not equivalent to its formula",
            place,
            help="this is a bug in Spot or rulec, not in the rulebook: please report the rule",
        )
    why = (
        "it reads too many signals and enumerations at once"
        if failed is not None and failed.why == "letters"
        else f"it takes more than {cpu_limit_s} s or 2 GiB to build"
    )
    return Diagnostic(
        "R0401",
        f"the automaton of rule `{rule.name}` would be too large: {why}",
        place,
        help="say each of its demands in a rule of its own: rules joined by `and` multiply, "
        "rules beside each other do not",
    )


def _no_spot(problem: str) -> Diagnostic:
    return Diagnostic(
        "R0403",
        f"Spot, which turns rules into automata, cannot be loaded: {problem}",
        help="`pip install spottl` on Linux x86-64 with glibc 2.34 or later, "
        "`conda install -c conda-forge spot` elsewhere; a compiled rulebook runs without Spot",
    )
