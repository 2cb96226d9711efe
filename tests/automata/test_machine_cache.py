"""Machines are recalled by the whole of what a compiler was asked, and by nothing less."""

from contextlib import contextmanager
from dataclasses import fields, replace
from fractions import Fraction
from functools import cache
from importlib.machinery import ModuleSpec

import pytest

from rulec.automata import compiler
from rulec.automata.compiler_jobs import Failed, Job
from rulec.automata.decision_diagrams import diagram_compiler
from rulec.automata.worker import compiler_choice, machine_cache
from rulec.automata.worker.job_answers import answer_to
from rulec.cache import kept_bytes
from rulec.cache.cache_folder import cache_folder
from rulec.cache.keeping import keeping
from rulec.resource_limits import CompilerTime
from rulec.rulebook.loader import parse_rulebook
from support.asked_compilers import machine_by
from support.remembered_machines import ASKED

BOOK = """\
rulebook book
use road
hard rule first (v: vehicle) { require always (oncoming(v) implies next speed < 9 km/h) }
hard rule second { require never (speed > 30 km/h and built_up) }
"""


def jobs_of(text):
    book = parse_rulebook(text)
    return [compiler._job(book, one, with_texts=True) for one in compiler.lower(book).rules]


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """The jobs that a worker was given, which answers without Spot; with a cache of their own."""
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    given = []

    @contextmanager
    def worker(*_, **__):
        yield None, "2.13"

    def answer(_, job, __):
        given.append(job)
        return answer_to(job, diagram_compiler.COMPILER), 0.0

    monkeypatch.setattr(compiler, "_worker", worker)
    monkeypatch.setattr(compiler, "_ask", answer)
    monkeypatch.setattr(compiler, "_end", lambda _: None)
    with keeping():
        yield given


def test_what_is_recalled_is_what_was_answered(asked):
    jobs = jobs_of(BOOK)
    first = ASKED(jobs)
    assert asked == jobs
    assert (
        ASKED(jobs_of(BOOK))
        == first
        == ([machine_by(j, diagram_compiler.COMPILER) for j in jobs], "2.13")
    )
    assert asked == jobs


def test_only_the_rule_that_was_changed_is_compiled(asked):
    ASKED(jobs_of(BOOK))
    asked.clear()
    jobs = jobs_of(BOOK.replace("30 km/h", "50 km/h"))
    answers, _ = ASKED(jobs)
    assert [job.name for job in asked] == ["second"]
    assert answers == [machine_by(job, diagram_compiler.COMPILER) for job in jobs]


@cache
def job():
    return jobs_of(BOOK)[0]


def changed(name):
    """The job with another value of one of its fields."""
    value = {
        "name": "other",
        "formula": jobs_of(BOOK.replace("next speed", "speed"))[0].formula,
        "reads": job().reads[::-1],
        "remarks": ("by another rulec",),
        "semantics": "finite",
        "groups": job().groups[1:],
        "most_letters": 1 << 17,
        "clocks": (),
        "named": job().propositions,
        "step_s": Fraction(2),
    }[name]
    assert value != getattr(job(), name)
    return replace(job(), **{name: value})


@pytest.mark.parametrize("name", [one.name for one in fields(Job)])
def test_another_job_is_asked_anew(asked, name):
    questions = compiler._Asked(None, more_will_come=False, time=CompilerTime())
    questions.answers([job()])
    questions.answers([changed(name)])
    assert len(asked) == 2


def test_another_compiler_is_asked_anew(asked, monkeypatch):
    ASKED([job()])
    ASKED([job()], choice=compiler_choice.DIAGRAMS)
    assert len(asked) == 2
    monkeypatch.setenv(compiler_choice.VARIABLE, compiler_choice.DIAGRAMS)
    ASKED([job()])
    assert len(asked) == 2
    monkeypatch.delenv(compiler_choice.VARIABLE)
    monkeypatch.setattr(machine_cache, "find_spec", lambda _: None)
    ASKED([job()])
    monkeypatch.setattr(machine_cache, "find_spec", lambda name: ModuleSpec(name, None, origin="a"))
    ASKED([job()])
    assert len(asked) == 4


def test_another_rulec_asks_anew(asked, monkeypatch):
    ASKED([job()])
    monkeypatch.setattr(kept_bytes, "program_digest", lambda: "0.0")
    ASKED([job()])
    assert len(asked) == 2


@pytest.mark.parametrize("why", ["memory", "time", "bug", "check", "facts"])
def test_what_another_machine_might_answer_otherwise_is_not_kept(asked, monkeypatch, why):
    """And what says more than its reason."""
    monkeypatch.setattr(compiler, "_ask", lambda _, one, __: (asked.append(one) or Failed(why), 0))
    assert ASKED([job()]) == ASKED([job()]) == ([Failed(why)], "2.13")
    assert len(asked) == 2
    monkeypatch.setattr(compiler, "_ask", lambda _, one, __: (asked.append(one), 0))
    assert ASKED([job(), job()]) == ([None, None], "2.13")
    assert len(asked) == 4
    assert not cache_folder().exists()


@pytest.mark.parametrize("why", ["letters", "size", "sets", "reach"])
def test_a_refusal_that_the_job_decides_is_kept(asked, monkeypatch, why):
    monkeypatch.setattr(compiler, "_ask", lambda _, one, __: (asked.append(one) or Failed(why), 0))
    assert ASKED([job()]) == ASKED([job()]) == ([Failed(why)], "2.13")
    assert len(asked) == 1


@pytest.mark.parametrize("data", [b"", b"{}", b"\xff", bytes(50)])
def test_what_is_damaged_is_compiled_anew(asked, data, monkeypatch):
    first = ASKED([job()])
    # As it was written, and yet no machine: what keeps files has its tests with the trees.
    monkeypatch.setattr(kept_bytes.KeptBytes, "recall", lambda *_: data)
    assert ASKED([job()]) == first
    assert len(asked) == 2


def test_who_imports_rulec_keeps_nothing(asked):
    with keeping(on=False):
        ASKED([job()])
        ASKED([job()])
    assert len(asked) == 2
    assert not cache_folder().exists()
