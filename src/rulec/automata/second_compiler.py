"""Rules that are compiled a second time: for certificates, and for automata as texts.

Certificates name the rules that Spot and rulec's own compiler compile to the same table.

Both compilers make the minimal machine with the same numbering of states and letter classes, so
the tables must be equal number for number.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rulec.automata import compiler
from rulec.automata.bundle.cut_machines import StoredPrefixes
from rulec.automata.compiler_jobs import Done, Failed
from rulec.automata.worker.compiler_choice import DIAGRAMS
from rulec.automata.worker.compiler_messages import COMPILERS_DISAGREE, no_machine, no_time
from rulec.diagnostics import RulecError
from rulec.validation.file_proof import table_digest

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.automata.mealy_monitor import MealyMonitor


def certified(rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook with certificates for the rules that rulec's own compiler gives the same table.

    Rules that it cannot compile get none, nor does a rulebook that Spot did not compile. A rulebook
    read from a file keeps its certificates. Raises RulecError R0417 if the tables differ.
    """
    if not rulebook.spot:
        return rulebook
    if rulebook.prefixes is None or isinstance(rulebook.prefixes, StoredPrefixes):
        return rulebook
    return _with_certificates(rulebook)


def _with_certificates(rulebook: CompiledRulebook) -> CompiledRulebook:
    jobs = [compiler.job_of(rule, rulebook) for rule in rulebook.rules]
    answers, _ = compiler.answers_to(jobs, choice=DIAGRAMS)
    pairs = list(zip(rulebook.rules, answers, strict=True))
    different = [
        rule.name
        for rule, answer in pairs
        if answer == Failed("check")
        or (isinstance(answer, Done) and answer.machine != rule.machine)
    ]
    if different:
        raise RulecError(
            [
                COMPILERS_DISAGREE.at(
                    rulebook.place_of(name),
                    f"Spot and rulec's own compiler make different tables for rule `{name}`",
                    help="this is a bug in one of them, not in the rulebook: please report it",
                )
                for name in different
            ]
        )
    rules = [
        replace(rule, certificate=_digest(rule.machine) if isinstance(answer, Done) else "")
        for rule, answer in pairs
    ]
    return replace(rulebook, rules=tuple(rules))


def _digest(machine: MealyMonitor) -> str:
    return table_digest(machine.letters, machine.successors, machine.outputs)


def with_automata(rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook with the automaton of every rule as text.

    Each is translated anew, as a whole: the table had a way of its own, with the past in registers.
    Raises RulecError R0402 where both differ, else as ``build_all``.
    """
    lacking = [rule for rule in rulebook.rules if not rule.hoa]
    if not lacking:
        return rulebook
    jobs = [
        replace(
            compiler.job_of(x, rulebook), remarks=compiler.remarks_on(x, rulebook.name, x.step_s)
        )
        for x in lacking
    ]
    texts, problems = {}, []
    for rule, answer in zip(lacking, compiler.answers_to(jobs)[0], strict=True):
        place = rulebook.place_of(rule.name)
        if answer == Failed("time"):
            raise no_time(rule.name, place, rule.step_s)
        if not isinstance(answer, Done):
            problems.append(no_machine(rule, place, answer, rule.step_s))
        elif answer.machine != rule.machine:
            problems.append(no_machine(rule, place, Failed("check")))
        else:
            texts[rule.name] = answer.hoa
    if problems:
        raise RulecError(problems)
    rules = [replace(rule, hoa=texts.get(rule.name, rule.hoa)) for rule in rulebook.rules]
    return replace(rulebook, rules=tuple(rules))


def with_clocked_automata(rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook with automata for any step, as texts, of its rules with bounds in seconds.

    Rules that no clocks tell keep the text that they have. Raises RulecError R0403.
    """
    timed = [rule for rule in rulebook.rules if rule.step_s is not None]
    jobs = [
        replace(
            compiler.job_of(rule, rulebook), remarks=compiler.remarks_on(rule, rulebook.name, None)
        )
        for rule in timed
    ]
    names = [rule.name for rule in timed]
    texts = dict(zip(names, compiler.clocked_texts(jobs), strict=True))
    rules = [replace(rule, hoa=texts.get(rule.name) or rule.hoa) for rule in rulebook.rules]
    return replace(rulebook, rules=tuple(rules))
