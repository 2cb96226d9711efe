"""Machines for words that are cut, from one compiler within one time."""

from dataclasses import replace

import pytest

from rulec.automata import prefix_machines
from rulec.automata.compiler_jobs import Done, Failed
from rulec.automata.decision_diagrams import diagram_compiler
from rulec.automata.step_compilation import StepCompiler
from rulec.automata.worker import compiler_choice
from rulec.resource_limits import BudgetSpentError
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from support.asked_compilers import machine_by
from support.builders.rulebooks import compile_here
from support.remembered_machines import ASKED


def compiled(spot):
    text = (
        "rulebook book\nuse road\n"
        "hard rule first { require always (speed > 9 km/h implies once built_up) }\n"
        "hard rule second { require eventually speed > 30 km/h }\n"
    )
    return replace(compile_here(parse_rulebook(text)), spot=spot)


def test_one_compiler_is_asked_once_for_all_rules(monkeypatch):
    asked = []

    def answers_to(jobs, *, time):
        asked.append([job.name for job in jobs])
        return [machine_by(job, diagram_compiler.COMPILER) for job in jobs], ""

    monkeypatch.setattr(prefix_machines, "_KNOWN", {})
    monkeypatch.setattr(prefix_machines, "answers_to", answers_to)
    machines = prefix_machines.prefix_machines(compiled("2.13"))
    assert asked == [["first", "first", "second"]]
    assert list(machines) == ["first", "second"]
    # Before a speed of 30 is seen all is open, whatever was before.
    assert [len(machine.starts) for machine in machines.values()] == [2, 1]
    assert prefix_machines.prefix_machines(compiled("2.13")) == machines
    assert len(asked) == 1


def test_time_that_is_spent_is_an_error_and_no_rule_is_too_large(monkeypatch):
    monkeypatch.setattr(prefix_machines, "_KNOWN", {})
    monkeypatch.setattr(
        prefix_machines, "answers_to", lambda jobs, **_: ([Failed("time")] * len(jobs), "")
    )
    with pytest.raises(BudgetSpentError, match="R0718"):
        prefix_machines.prefix_machines(compiled("2.13"))


USUAL = ("at", "de", "un-r157")
"""Without `--long`: a book of many rules, and what the others are made of."""


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in USUAL else pytest.mark.long)
        for name in available_rulebooks(())
    ],
)
def test_cut_words_of_what_ships_need_no_spot(name):
    book = StepCompiler(load_rulebook(name)).at_own_steps()
    jobs = [job for rule in book.rules for job in prefix_machines._jobs(rule, book)]
    answers, _ = ASKED(jobs, choice=compiler_choice.DIAGRAMS)
    found = zip(jobs, answers, strict=True)
    assert [job.name for job, answer in found if not isinstance(answer, Done)] == []


@pytest.mark.long
@pytest.mark.spot
@pytest.mark.parametrize("name", available_rulebooks(()))
def test_spots_tables_of_cut_words_are_the_same(name):
    book = StepCompiler(load_rulebook(name)).at_own_steps()
    jobs = [job for rule in book.rules for job in prefix_machines._jobs(rule, book)]
    own, _ = ASKED(jobs, choice=compiler_choice.DIAGRAMS)
    others, _ = ASKED(jobs, choice=compiler_choice.SPOT)
    # Of one Italian rule Spot's takes longer than a compiler may.
    both = [pair for pair in zip(own, others, strict=True) if isinstance(pair[1], Done)]
    assert len(both) >= len(jobs) - 1
    assert all(one.machine == other.machine for one, other in both)
