"""Folders, patterns and what a project excludes, in the verbs that take sources; ``--watch``."""

import json
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
    status, out, err = run(capsys, "test", "-v", *references)
    assert (status, err) == (0, "")
    assert out.splitlines()[-1].startswith("4 examples passed in ")
    assert {line.split()[1] for line in out.splitlines()[:-1]} == {"one", "two"}


@pytest.mark.parametrize("words", [["show", "--audit"], ["analyze"], ["show", "--tree"]])
def test_other_verbs_take_folders_too(words, project, capsys):
    both = run(capsys, *words, "laws/one.rules", "laws/old/two.rules", "--json")
    folder = run(capsys, *words, "laws", "--json")
    assert sorted(folder[1]) == sorted(both[1])  # in the folder's order
    assert (folder[0], folder[2]) == (both[0], both[2])


def test_every_two_of_a_folder_are_compared(project, capsys):
    assert run(capsys, "diff", "--all", "laws")[0] == 0


def test_what_is_excluded_is_left_alone_in_folders_and_taken_by_name(project, capsys, monkeypatch):
    Path("rulec.toml").write_text('exclude = ["old/", "*.draft.rules"]\n')
    Path("laws/new.draft.rules").write_text("rulebook")
    left = "left alone: 2 excluded (laws/old, laws/new.draft.rules)\n"
    assert run(capsys, "check", "laws") == (
        0,
        (
            "2 files checked, no mistakes found; `rulec test` runs the examples\n"
            "rule `r` cites no provision\n"
        ),
        left,
    )
    assert run(capsys, "fmt", "--check", "laws")[2].endswith(left)
    assert run(capsys, "test", "laws")[1].startswith("2 examples passed in ")
    assert run(capsys, "test", "-v", "laws/old/two.rules")[1].count("pass  two") == 2
    # Its patterns are relative to the file of settings, wherever one is.
    monkeypatch.chdir("laws/old")
    left = "left alone: 2 excluded (../old, ../new.draft.rules)\n"
    assert run(capsys, "check", "..") == (
        0,
        (
            "2 files checked, no mistakes found; `rulec test` runs the examples\n"
            "rule `r` cites no provision\n"
        ),
        left,
    )


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
    assert run(capsys, "fmt", "--check", "laws") == (0, "", "4 files already formatted\n")
    assert parsed == []
    Path("laws/one.rules").write_text(BOOK.format("one").replace(" {", "{"))
    assert run(capsys, "fmt", "--check", "laws")[0] == 1
    assert parsed == ["laws/one.rules"]
    # A cache that is odd knows nothing.
    for data in (b"", b"[]", bytes(100)):
        parsed.clear()
        for path in (project / ".cache").glob("*.form"):
            path.write_bytes(data)
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
    done = (
        "4 files checked, no mistakes found; `rulec test` runs the examples"
        if verb == "check"
        else "4 examples passed"
    )
    assert out.count(done) == 2


def test_standard_input_is_not_watched(project, capsys):
    status, _, err = run(capsys, "check", "-", "--watch")
    assert status == 2
    assert "`-` is standard input and does not change" in err


def test_a_document_of_each_goes_to_a_folder(project, capsys):
    both = run(capsys, "doc", "laws", "-o", "documents/")
    assert both == (0, "wrote documents/one.html\nwrote documents/two.html\n", "")
    alone = run(capsys, "doc", "./laws/one.rules")[1]
    assert Path("documents/one.html").read_text() == alone
    markdown = ("-o", "documents", "--output-format", "markdown")
    assert run(capsys, "doc", "./laws/one.rules", *markdown)[1] == "wrote documents/one.md\n"
    status, _, err = run(capsys, "doc", "laws")
    assert (status, "give a folder for their documents, as in `-o laws/`" in err) == (2, True)


@pytest.mark.parametrize("verb", ["doc", "compile"])
def test_two_of_one_name_are_not_written_over_each_other(verb, project, capsys):
    Path("laws/old/one.rules").write_text(BOOK.format("one"))
    status, out, err = run(capsys, verb, "laws", "-o", "out/")
    assert (status, out) == (2, "")
    assert "`laws/one.rules` and `laws/old/one.rules` would be written to the same files" in err


def test_each_is_compiled_into_a_folder_of_its_own(project, capsys):
    status, out, _ = run(capsys, "compile", "laws", "-o", "out", "--no-certificate")
    wrote = [
        f"wrote out/{book}/{file}" for book in ("one", "two") for file in ("r.hoa", f"{book}.json")
    ]
    assert (status, out.splitlines()) == (0, wrote)
    Path("laws/one.rules").write_text("rulebook one\nuse nothing\n")
    status, out, err = run(capsys, "compile", "laws", "-o", "again", "--no-certificate")
    assert (status, "R0703" in err, Path("again/two/two.json").exists()) == (2, True, True)


def test_one_that_is_named_is_compiled_into_the_folder_itself(project, capsys):
    run(capsys, "compile", "./laws/one.rules", "-o", "out", "--no-certificate")
    assert sorted(path.name for path in Path("out").iterdir()) == ["one.json", "r.hoa"]


def test_a_rule_is_shown_as_it_is_in_each(project, capsys):
    Path("laws/old/two.rules").write_text(BOOK.format("two").replace("rule r", "rule q"))
    status, out, err = run(capsys, "show", "laws", "r")
    assert (status, err) == (0, "rulec: two has no rule `r`; it has `q`\n")
    assert "hard rule r\n" in out
    assert "hard rule q\n" not in out
    lines = run(capsys, "show", "laws", "--json")[1].splitlines()
    assert [json.loads(line)["rulebook"] for line in lines] == ["one", "two"]
    status, out, err = run(capsys, "show", "laws", "s")
    assert (status, out, "has no rule `s`" in err) == (2, "", True)
    status, _, err = run(capsys, "show", "laws", "r", "--automaton", "text")
    assert (status, "an automaton is of one rule" in err) == (2, True)


def test_a_rule_of_another_rulebook_is_named(capsys):
    assert "nl has no rule `R3`; there is one in esterle2019" in run(capsys, "show", "nl", "R3")[2]


def test_verdicts_by_the_rulebooks_of_a_folder(project, capsys):
    Path("states.jsonl").write_text('{"id": "t", "states": [{"p": true}]}\n')
    status, out, _ = run(capsys, "verify", "states.jsonl", "-r", "laws")
    assert status == 0
    assert ["by", "one", "two"] in [line.split() for line in out.splitlines()]


def test_maneuvers_of_several_scenarios_by_several_rulebooks(project, capsys):
    books = ("-r", "esterle2019", "-r", "nl")
    fields = ("scenario", "rulebook", "traces", "satisfying", "open", "violating")
    status, out, _ = run(capsys, "maneuvers", "s1", "s2", *books)
    rows = [line.split() for line in out.splitlines()[-4:]]
    assert status == 0
    lines = run(capsys, "maneuvers", "s1", "s2", *books, "--json")[1].splitlines()
    assert rows == [[f"{json.loads(line)[field]}" for field in fields] for line in lines]
    alone = json.loads(run(capsys, "maneuvers", "s2", "-r", "esterle2019", "--json")[1])
    assert rows[2] == [f"{alone[field]}" for field in fields]


def test_a_scenario_that_is_not_there_stops_no_other(project, capsys):
    status, out, err = run(capsys, "maneuvers", "s9", "s1", "-r", "esterle2019")
    assert (status, "there is no scenario `s9`" in err) == (2, True)
    assert out.splitlines()[-1].split()[0] == "s1"
    run(capsys, "maneuvers", "s9", "s8", "-r", "esterle2019", "-o", "counts.txt")
    assert not Path("counts.txt").exists()


def test_all_scenarios_of_a_folder(project, capsys):
    Path("drives").mkdir()
    status, _, err = run(capsys, "maneuvers", "drives", "-r", "esterle2019")
    assert (status, "there is no recorded traffic in this folder" in err) == (2, True)
