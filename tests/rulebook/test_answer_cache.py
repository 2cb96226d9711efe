"""Answers that are kept while their sources are as they were."""

from pathlib import Path

import pytest

from rulec.analysis.diff import comparison_matrix
from rulec.analysis.lint import rulebook_findings
from rulec.cli.main import main

BOOK = "rulebook {}\nuse words\nhard rule r {{ require always {} }}\n"


@pytest.fixture
def asked(tmp_path, monkeypatch, capsys):
    """What the command says of two rulebooks, and how often it was computed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    Path("a.rules").write_text(BOOK.format("a", "(p or not p)"))
    Path("b.rules").write_text(BOOK.format("b", "p"))
    Path("words.rules").write_text("vocabulary words { signal p }\n")
    computed = []
    for module, name in (
        (rulebook_findings, "rulebook_findings"),
        (comparison_matrix, "growing_matrices"),
    ):
        own = getattr(module, name)
        monkeypatch.setattr(
            module, name, lambda *given, own=own, **more: computed.append(1) or own(*given, **more)
        )

    def ask(*arguments):
        status = main(list(arguments))
        captured = capsys.readouterr()
        return (status, captured.out, captured.err), len(computed)

    return ask


QUESTIONS = [["analyze", "./a.rules"], ["diff", "--all", "./a.rules", "./b.rules"]]


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda words: words[0])
def test_the_same_is_answered_once(question, asked):
    first, computed = asked(*question)
    assert computed == 1
    assert first[1]
    assert asked(*question) == (first, 1)
    assert asked(*question, "--no-cache") == (first, 2)
    # Another form is the same answer to an analysis, and another text of a comparison.
    assert asked(*question, "--json")[1] == (2 if question[0] == "analyze" else 3)


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda words: words[0])
@pytest.mark.parametrize(
    "change",
    [
        lambda: Path("a.rules").write_text(BOOK.format("a", "p")),
        lambda: Path("words.rules").write_text("vocabulary words { signal p, q }\n"),
        lambda: Path("other.rules").write_text("vocabulary other { signal p }\n"),
        lambda: next(Path("cache").glob("*.answer")).write_text("[]"),
    ],
    ids=["source", "vocabulary", "one more", "odd"],
)
def test_a_change_is_answered_anew(question, change, asked):
    asked(*question)
    change()
    assert asked(*question)[1] == 2
