"""Certificates of two compilers: in the compiled file, checked without either."""

import json
from dataclasses import replace

import pytest

import rulec
from rulec.automata import compiler
from rulec.automata.bundle.bundle_file import read_compiled, to_json
from rulec.automata.worker.compiler_choice import DIAGRAMS
from rulec.diagnostics import RulecError
from support.builders.compiled_files import sealed

pytestmark = pytest.mark.spot

SOURCE = """\
rulebook soon
signal p, q
hard rule soon { require always (p implies eventually[<= 1 s] q) }
hard rule apart { require always not (p and q) }
hard rule beyond { require always (p implies once always q) }
"""


@pytest.fixture(scope="module")
def soon(tmp_path_factory):
    path = tmp_path_factory.mktemp("rules") / "soon.rules"
    path.write_text(SOURCE)
    return path


def written(soon, folder, step_s, **more):
    """The file of rules that have been compiled, and its path."""
    paths = rulec.write_compiled(rulec.compile_rulebook(soon, step_s=step_s), folder, **more)
    return json.loads(paths[-1].read_text()), paths[-1]


def agreed(path):
    assert not any(proof.because for proof in rulec.verify_compiled(path))
    return [proof.rule for proof in rulec.verify_compiled(path) if proof.agreed]


def test_rules_that_both_compile_have_a_certificate(soon, tmp_path):
    """What is beyond the second compiler has none, and is proved all the same."""
    _, path = written(soon, tmp_path, 0.5)
    assert sorted(agreed(path)) == ["apart", "soon"]


def test_none_is_written_where_none_is_asked_for(soon, tmp_path):
    book, path = written(soon, tmp_path, 0.5, certificate=False)
    assert not any("certificate" in rule for rule in book["rules"])
    assert agreed(path) == []


def test_a_certificate_is_kept_when_a_file_is_written_again(soon, tmp_path):
    _, path = written(soon, tmp_path, 0.5)
    assert to_json(read_compiled(path)) == path.read_text()


def test_a_certificate_of_another_table_is_found(soon, tmp_path):
    """Two rules that change places of their certificates."""
    book, path = written(soon, tmp_path, 0.5)
    first, second = book["rules"][:2]
    first["certificate"], second["certificate"] = second["certificate"], first["certificate"]
    path.write_bytes(sealed(book))
    found = [proof.because for proof in rulec.verify_compiled(path)]
    assert found == ["its certificate belongs to another table"] * 2 + [""]


def test_two_compilers_that_disagree_write_nothing(soon, tmp_path, monkeypatch):
    """As if the second one took `soon` for `apart`."""
    compiled = rulec.compile_rulebook(soon, step_s=0.5)
    ask = compiler.answers_to

    def mistaken(jobs, *, choice=None, **more):
        if choice != DIAGRAMS:  # the texts, which Spot translates
            return ask(jobs, choice=choice, **more)
        return ask([jobs[1], *[replace(job, name="x") for job in jobs[1:]]], choice=choice)

    monkeypatch.setattr(compiler, "answers_to", mistaken)
    with pytest.raises(RulecError) as refused:
        rulec.write_compiled(compiled, tmp_path)
    (problem,) = refused.value.diagnostics
    assert problem.code == "R0417"
    assert "`soon`" in problem.message
    assert list(tmp_path.iterdir()) == []
