"""Folders, patterns and what a project excludes, in the verbs that take sources; ``--watch``."""

from pathlib import Path

import pytest

from rulec.cli import watching
from rulec.cli.main import main
from rulec.rulebook.batch import batch_format

BOOK = (
    "rulebook {}\nuse words\nhard rule r {{ require always p accept {{ p }} reject {{ not p }} }}\n"
)
WORDS = "vocabulary words { signal p }\n"


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Two rulebooks, one of them in ``old``, and their vocabulary."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / ".cache"))
    for path, text in {
        "laws/one.rules": BOOK.format("one"),
        "laws/old/two.rules": BOOK.format("two"),
        "laws/words.rules": WORDS,
        "laws/old/words.rules": WORDS,
    }.items():
        Path(path).parent.mkdir(exist_ok=True, parents=True)
        Path(path).write_text(text)
    return tmp_path


def run(capsys, *arguments):
    status = main(list(arguments))
    return status, *capsys.readouterr()


@pytest.mark.parametrize(
    "references",
    [["laws"], [], ["laws/**/*.rules"], ["laws/one.rules", "laws/old"], ["laws", "laws/one.rules"]],
)
def test_a_folder_stands_for_its_rulebooks(references, project, capsys):
    status, out, err = run(capsys, "test", *references)
    assert (status, err) == (0, "")
    assert out.splitlines()[-1] == "4 examples: 4 passed, 0 failed"
    assert {line.split()[1] for line in out.splitlines()[:-1]} == {"one", "two"}


@pytest.mark.parametrize("verb", ["audit", "analyze", "tree"])
def test_other_verbs_take_folders_too(verb, project, capsys):
    both = run(capsys, verb, "laws/one.rules", "laws/old/two.rules", "--json")
    folder = run(capsys, verb, "laws", "--json")
    assert sorted(folder[1]) == sorted(both[1])  # in the folder's order
    assert (folder[0], folder[2]) == (both[0], both[2])


def test_every_two_of_a_folder_are_compared(project, capsys):
    assert run(capsys, "diff", "--all", "laws")[0] == 0


def test_what_is_excluded_is_left_alone_in_folders_and_taken_by_name(project, capsys, monkeypatch):
    Path("rulec.toml").write_text('exclude = ["old/", "*.draft.rules"]\n')
    Path("laws/new.draft.rules").write_text("rulebook")
    left = "left alone: 2 excluded (laws/old, laws/new.draft.rules)\n"
    assert run(capsys, "check", "laws") == (0, "2 files checked, nothing found\n", left)
    assert run(capsys, "fmt", "--check", "laws")[2].endswith(left)
    assert run(capsys, "test", "laws")[1].splitlines()[-1] == "2 examples: 2 passed, 0 failed"
    assert run(capsys, "test", "laws/old/two.rules")[1].count("pass  two") == 2
    # Its patterns are relative to the file of settings, wherever one is.
    monkeypatch.chdir("laws/old")
    left = "left alone: 2 excluded (../old, ../new.draft.rules)\n"
    assert run(capsys, "check", "..") == (0, "2 files checked, nothing found\n", left)


def test_nothing_but_vocabularies_is_a_mistake(project, capsys):
    Path("words").mkdir()
    Path("words/words.rules").write_text(WORDS)
    status, out, err = run(capsys, "test", "words")
    assert (status, out) == (2, "")
    assert "error[R0733]: there are vocabularies, and no rulebook\n --> words\n" in err


def test_what_is_known_to_be_in_form_is_not_parsed_again(project, capsys, monkeypatch):
    assert run(capsys, "fmt", "laws")[0] == 0
    parsed = []
    format_it = batch_format.formatted
    monkeypatch.setattr(
        batch_format, "formatted", lambda *given: parsed.append(given[0]) or format_it(*given)
    )
    assert run(capsys, "fmt", "--check", "laws") == (0, "", "4 files in form already\n")
    assert parsed == []
    Path("laws/one.rules").write_text(BOOK.format("one").replace(" {", "{"))
    assert run(capsys, "fmt", "--check", "laws")[0] == 1
    assert parsed == ["laws/one.rules"]
    # A cache that is odd knows nothing.
    for text in ("", "[]", '{"program": "another", "digests": []}'):
        parsed.clear()
        (project / ".cache" / "in_form").write_text(text)
        assert run(capsys, "fmt", "--check", "laws")[0] == 1
        assert len(parsed) == 3  # two of the four are the same text


@pytest.mark.parametrize("verb", ["check", "test"])
def test_after_a_change_it_is_done_again(verb, project, capsys, monkeypatch):
    changes = [BOOK.format("one").replace("always p", "always q"), BOOK.format("one")]
    waits = []

    def change(_):
        waits.append(None)
        if len(waits) % 2 == 0:  # in between nothing changes, and nothing is done
            if not changes:
                raise KeyboardInterrupt
            Path("laws/words.rules").with_name("one.rules").write_text(changes.pop(0))

    monkeypatch.setattr(watching, "sleep", change)
    status, out, err = run(capsys, verb, "laws", "--watch")
    assert status == 130
    assert err.splitlines().count("watching 4 files; Ctrl-C ends it") == 3
    assert (out + err).count("error[R0202]: nothing is called `q`") == 1
    done = "4 files checked, nothing found" if verb == "check" else "4 examples: 4 passed, 0 failed"
    assert out.count(done) == 2


def test_standard_input_is_not_watched(project, capsys):
    status, _, err = run(capsys, "check", "-", "--watch")
    assert status == 2
    assert "`-` is standard input and does not change" in err
