"""What takes long is answered once, and anew as soon as anything has changed that it comes from."""

import os
from datetime import date

import pytest

from rulec import Session
from rulec.analysis.diff import comparison_matrix
from rulec.analysis.lineage import book_lineage
from rulec.cache import kept_bytes
from rulec.cache.cache_folder import cache_folder
from rulec.cli.commands.reading import explain, show
from rulec.cli.main import main
from rulec.rulebook.batch import answer_cache
from support.builders.rulebook_projects import project_in

WORDS = "vocabulary words {\n  signal p, q \n}\n"
BASE = "rulebook base\nuse words\nparam most: time = 1 s\n"
BOOK = """\
rulebook {}
extends base
hard rule r {{
    require always (p implies eventually[<= most] {})
    accept {{ p and not q; not p and q }}
}}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    books = {"book": BOOK.format("book", "q"), "other": BOOK.format("other", "not p")}
    return project_in(tmp_path, monkeypatch, words=WORDS, base=BASE, **books)


@pytest.fixture
def answered(monkeypatch):
    """How often a question has been answered anew."""
    times = []

    def counting(original):
        def answer(*arguments, **more):
            times.append(1)
            return original(*arguments, **more)

        return answer

    monkeypatch.setattr(Session, "analyze", counting(Session.analyze))
    monkeypatch.setattr(show, "_shown", counting(show._shown))
    monkeypatch.setattr(explain, "_explained", counting(explain._explained))
    monkeypatch.setattr(book_lineage, "read_with_lineage", counting(book_lineage.read_with_lineage))
    matrices = comparison_matrix.growing_matrices
    monkeypatch.setattr(comparison_matrix, "growing_matrices", counting(matrices))
    return times


QUESTIONS = {
    "analyze": ["analyze", "./book.rules"],
    "show": ["show", "./book.rules", "r"],
    "tree": ["show", "--tree", "./book.rules"],
    "diff": ["diff", "--all", "./book.rules", "./other.rules"],
}


@pytest.fixture(params=QUESTIONS)
def ask(request, folder, capsys):
    """Ask a question; what is said."""

    def said(*options):
        status = main([*QUESTIONS[request.param], *options])
        assert status in (0, 1)
        return status, capsys.readouterr().out

    return said


def edited(name, old, new):
    """Change a file of the project."""

    def change(folder, _):
        path = folder / f"{name}.rules"
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))

    return change


def nearer_words(folder, _):
    (folder / "vocabulary").mkdir()
    (folder / "vocabulary" / "words.rules").write_text(WORDS)


class Tomorrow(date):
    @classmethod
    def today(cls):
        return cls(2030, 1, 1)


CHANGES = {
    "the book": edited("book", "always", "never"),
    "a comment": edited("book", "rulebook book", "# c\nrulebook book"),
    "its parent": edited("base", "1 s", "2 s"),
    "the vocabulary": edited("words", "p, q", "p, q, other"),
    "a file in the vocabulary's place": nearer_words,
    "rulec": lambda _, patch: patch.setattr(kept_bytes, "program_digest", lambda: "0"),
    "the day": lambda _, patch: patch.setattr(answer_cache, "date", Tomorrow),
    "the compiler": lambda _, patch: patch.setenv("RULEC_COMPILER", "diagrams"),
    "a limit": lambda _, patch: patch.setenv("RULEC_LIMITS", "search=9000000"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_every_change_counts(folder, answered, ask, monkeypatch, change):
    first = ask()
    assert ask() == first
    assert len(answered) == 1
    CHANGES[change](folder, monkeypatch)
    again = ask()
    assert ask() == again
    assert len(answered) == 2


@pytest.mark.parametrize("change", ["the book", "the vocabulary", "rulec"])
def test_a_word_is_explained_once(folder, answered, monkeypatch, capsys, change):
    def said(word="p"):
        assert main(["explain", word]) == 0
        return capsys.readouterr().out

    first = said()
    assert said() == first != said("q")
    assert len(answered) == 2
    CHANGES[change](folder, monkeypatch)
    again = said()
    assert said() == again
    assert len(answered) == 3
    (folder / "more.rules").write_text("rulebook more\nuse words\nhard rule new { require p }\n")
    assert "more" in said()
    assert len(answered) == 4


def test_another_question_is_answered_anew(answered, ask):
    ask()
    ask("--at", "2020-01-01")
    assert len(answered) == 2


@pytest.mark.parametrize("verb", ["analyze", "diff"])
def test_an_answer_is_made_anew_without_the_cache(folder, answered, verb):
    for options in ([], ["--no-cache"]):
        assert main([*QUESTIONS[verb], *options]) in (0, 1)
    assert len(answered) == 2


@pytest.mark.parametrize("options", [("--step", "0.5"), ("--rule", "r*"), ("--json",)])
def test_another_overview_is_made_anew(folder, answered, capsys, options):
    for _ in range(2):
        assert main(QUESTIONS["diff"]) == 1
        assert main([*QUESTIONS["diff"], *options]) == 1
    assert len(answered) == 2


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(path.read_bytes()[:-4]),
        lambda path: path.write_bytes(path.read_bytes()[:-1] + bytes([path.read_bytes()[-1] ^ 1])),
        lambda path: path.chmod(0o602),
        lambda path: path.parent.chmod(0o770),
    ],
)
def test_a_damaged_answer_or_one_that_others_can_write_is_not_taken(answered, ask, damage):
    first = ask()
    (path,) = cache_folder().glob("*.answer")
    damage(path)
    assert ask() == first
    assert len(answered) == 2


def test_the_answer_of_somebody_else_is_not_taken(answered, ask, monkeypatch):
    first = ask()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert ask() == first
    assert len(answered) == 2
