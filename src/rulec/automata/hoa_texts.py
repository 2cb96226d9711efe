"""The automata of rules in the HOA format, which only files contain."""

from __future__ import annotations

from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.bundle.stored_steps import StoredSteps, for_steps
from rulec.automata.compiler import answers_to, job_of, remarks_on
from rulec.automata.compiler_jobs import Done, Failed
from rulec.automata.compiler_messages import no_machine, no_time
from rulec.diagnostics import RulecError


def with_automata(rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook, or its books for several steps, with the automaton of every rule as text.

    Each is translated anew, as a whole: the table had a way of its own, with the past in registers.
    Raises RulecError R0402 where both differ, else as ``build_all``.
    """
    if isinstance(rulebook.recompile, StoredSteps):
        steps, books = rulebook.recompile.steps, rulebook.recompile.books
        return for_steps([with_automata(book) for book in books], steps)
    lacking = [rule for rule in rulebook.rules if not rule.hoa]
    if not lacking:
        return rulebook
    jobs = [
        replace(job_of(rule, rulebook), remarks=remarks_on(rule, rulebook.name, rule.step_s))
        for rule in lacking
    ]
    texts, problems = {}, []
    for rule, answer in zip(lacking, answers_to(jobs)[0], strict=True):
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
