"""``rulec show --audit`` as its user meets it."""

import json

import pytest

import rulec
from rulec.cli.main import main
from rulec.report.rulebooks.audit_report import render
from support.builders import rulebook_family as island

CLEAN = """\
rulebook clean
signal horn default false
hard rule quiet {
  cite "§ 1"
  certainty verified
  require never horn
  accept { not horn }
  reject { horn }
}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    island.write(tmp_path)
    (tmp_path / "clean.rules").write_text(CLEAN, encoding="utf-8")
    return tmp_path


def run(capsys, *arguments):
    status = main(["show", "--audit", "--all", *arguments])
    return status, *capsys.readouterr()


def test_each_kind_of_finding_is_counted(folder, capsys):
    assert main(["show", "--audit", "island.rules", "--examples"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "island: Rules of the island"
    for title, names in (
        ("softened (1): an inherited hard rule that was made soft", "softer"),
        ("dropped (1): an inherited rule that was dropped", "taken_out"),
        # What an option has asked for comes in full.
        ("failing (1): an example does not have the result that it states", "changed  example 1"),
    ):
        assert lines[lines.index(title) + 1] == f"  {names}"
    assert "no sirens" not in "".join(lines)
    assert lines[-1].startswith("`--all` has every note")


def test_an_overview_fits_on_a_screen(capsys):
    assert main(["show", "--audit", "de"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 80


def test_nothing_to_find(folder, capsys):
    status, out, err = run(capsys, "clean.rules", "--at", "2024-01-01", "--fail-on", "any")
    assert (status, err) == (0, "")
    assert (
        out
        == """\
clean
  law                              no law is named
  judged by the law of             2024-01-01
  rules                            1 (1 hard, 0 soft)
  with a provision cited           1 of 1
  with examples for both verdicts  1 of 1
  own law, not merely inherited    1 of 1
  verified in the law itself       1 of 1
  examples                         2
  provisions of the law            1
  words of the vocabulary in use   1 of 1

provisions cited in clean, and the rules they are in
  § 1  quiet
"""
    )


def test_findings_by_kind(folder, capsys):
    status, out, _ = run(capsys, "island.rules")
    assert status == 0
    assert "\nsoftened: an inherited hard rule that was made soft\n  softer  only recomm" in out
    assert "\ndropped: an inherited rule that was dropped\n  taken_out  there are no s" in out


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], 0),
        (["--fail-on", "dropped"], 1),
        (["--fail-on", "failing"], 2),
        (["--fail-on", "failing", "--examples"], 1),
        (["--fail-on", "uncited", "--fail-on", "silent"], 1),
        (["--fail-on", "uncited"], 0),
        (["--fail-on", "any"], 1),
    ],
)
def test_fail_on(folder, arguments, expected, capsys):
    # On the island a speed of 20 km/h is not slow any more.
    assert run(capsys, "island.rules", *arguments)[0] == expected


def test_an_example_that_fails(folder, capsys):
    out = run(capsys, "island.rules", "--examples")[1]
    assert (
        "failing: an example does not have the result that it states\n  changed  example 1\n" in out
    )


def test_a_law_s_text_that_has_changed_since(folder, capsys):
    for name, how in (("old.md", "slow"), ("new.md", "slower")):
        text = f"### § 10a Slowness\n\nBe {how}.\n\n### § 11 Horns\n\nBe quiet.\n"
        (folder / name).write_text(text, encoding="utf-8")
    laws = ("--law", "old.md", "--law-now", "new.md", "--fail-on", "law-changed")
    status, out, _ = run(capsys, "island.rules", *laws)
    assert status == 1
    assert "\n  cites found in old.md            2 of 2\n" in out
    assert "\n  articles dealt with              50 % ██████████░░░░░░░░░░ 1 of 2: " in out
    assert "\n  § 10a  Slowness: covered by changed\n  § 12   Fees: to do\n" in out
    assert run(capsys, "island.rules", "--law", "old.md", *laws[4:])[0] == 2
    data = json.loads(run(capsys, "island.rules", *laws, "--output-format", "json")[1])["audits"][0]
    assert (data["law_text"], data["counts"]["cites_found"]) == ("old.md", 2)
    assert [article["state"] for article in data["provisions"]] == ["covered", "to do"]


def test_articles_of_two_years_and_whether_they_were_read(folder, capsys):
    listed = """\
provisions "https://a.example" as of 1989-01-01 certainty verified { "reg. 1 (1989)" "Horns" }
provisions "https://a.example" certainty unverified { "reg. 1 (2017)" "Quiet"; "reg. 2 (2017)" "" }
hard"""
    text = CLEAN.replace("§ 1", "reg. 1, 2 (2017)").replace("hard", listed, 1)
    (folder / "clean.rules").write_text(text, encoding="utf-8")
    out = run(capsys, "clean.rules")[1]
    assert "\n  listed articles that were read   1 of 3\n" in out
    assert "\n  reg. 1 (1989)  Horns: to do\n  reg. 1 (2017)  Quiet (from memory): covered" in out
    assert "\n  reg. 2 (2017)   (from memory): covered by quiet\n" in out


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["island.rules", "--law-now", "odd.md"], "--law-now needs --law"),
        (["island.rules", "clean.rules", "--law", "odd.md"], "--law is the law of one rulebook"),
        (["island.rules", "--law", "odd.md"], "no article was found in this text"),
    ],
)
def test_laws_that_cannot_be_looked_into(folder, capsys, arguments, why):
    (folder / "odd.md").write_text("Drive with care.\n")
    status, _, err = run(capsys, *arguments)
    assert status == 2
    assert why in err


def test_markdown_is_a_table(folder, capsys):
    (folder / "odd.rules").write_text(
        CLEAN.replace("§ 1", "a|b *c*").replace("verified", "secondary")
    )
    out = run(capsys, "odd.rules", "--output-format", "markdown", "--at", "2024-01-01")[1]
    assert out.startswith("# Audit of `clean`\n")
    assert "\n| secondary | quiet |  |\n" in out
    assert "\n| a\\|b \\*c\\* | `clean` | `quiet` |\n" in out


def test_json(folder, capsys):
    out = run(capsys, "clean.rules", "island.rules", "--output-format", "json")[1]
    clean, other = json.loads(out)["audits"]
    assert clean["findings"] == []
    assert clean["changes"] is None
    assert clean["articles"] == [{"book": "clean", "cite": "§ 1", "rules": ["quiet"]}]
    assert {"kind": "dropped", "name": "taken_out", "note": "there are no sirens"} in (
        other["findings"]
    )


def test_compared_with_an_older_audit_only_what_is_new_counts(folder, capsys):
    old = run(capsys, "clean.rules", "--output-format", "json")[1]
    (folder / "old.json").write_text(old)
    same = ("clean.rules", "--compare", "old.json", "--fail-on", "any")
    status, out, _ = run(capsys, *same)
    assert status == 0
    assert out.endswith("changed: + is new, - is gone\n  nothing\n")
    (folder / "clean.rules").write_text(CLEAN.replace('  cite "§ 1"\n', ""))
    status, out, _ = run(capsys, *same)
    assert status == 1
    assert out.endswith("changed: + is new, - is gone\n  + uncited: quiet\n")


def test_compared_with_another_rulebook(folder, capsys):
    status, out, _ = run(capsys, "island.rules", "--compare", "mainland.rules")
    assert status == 0
    assert "\n  + dropped: taken_out\n" in out
    # `taken_out` was uncited on the mainland.
    assert "\n  - uncited: taken_out\n" in out
    markdown = run(
        capsys, "island.rules", "--compare", "mainland.rules", "--output-format", "markdown"
    )[1]
    assert "\n| new | dropped | taken\\_out |\n" in markdown


@pytest.mark.parametrize("text", ["", "{}", "[", "[" * 100_000, '{"audits": [1]}', "\udcff"])
def test_what_is_no_audit(folder, text, capsys):
    (folder / "old.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    status, out, err = run(capsys, "clean.rules", "--compare", "old.json")
    assert (status, out) == (2, "")
    assert "R0705" in err


def test_an_older_audit_that_is_not_there(folder, capsys):
    status, out, err = run(capsys, "clean.rules", "--compare", "none.json")
    assert (status, out) == (2, "")
    assert "R0701" in err


def test_one_bad_rulebook_does_not_hide_the_others(folder, capsys):
    (folder / "bad.rules").write_text("rulebook bad hard rule r { require always q }")
    status, out, err = run(capsys, "bad.rules", "clean.rules")
    assert status == 2
    assert out.startswith("clean\n")
    assert "R0201" in err or "R0202" in err


def test_the_treaty_and_a_country(capsys):
    fatal = [word for kind in ("uncited", "untested", "failing") for word in ("--fail-on", kind)]
    status, out, err = run(capsys, "vienna", "at", "--examples", *fatal)
    assert (status, err) == (0, "")
    assert "\nprovisions cited in at, and the rules they are in\n" in out
    # The railways' law, which says it in Austria, and nothing of the treaty alone.
    own = out.split("\nat: ")[1]
    assert "\n  Eisenbahnkreuzungsverordnung 2012 § 96(1) Z 1, 2 " in own
    assert "\nprovisions cited in vienna" not in own


def test_provisions_of_the_treaty_that_a_country_inherits(capsys):
    status, out, err = run(capsys, "it")
    assert (status, err) == (0, "")
    assert "\n  Art. 17(1) " in out.split("\nprovisions cited in vienna")[1]


def test_provisions_are_counted_by_whose_law_they_are(folder, capsys):
    # Of those that its rules cite, § 9 and § 2 are mainland's.
    _, out, _ = run(capsys, "village.rules", "--at", "2024-06-01")
    assert "\n  provisions of the law            2\n  provisions of inherited law      2\n" in out


def test_a_compiled_rulebook_is_not_enough(folder, capsys):
    status, out, err = run(capsys, "clean.json")
    assert (status, out) == (2, "")
    assert "`clean.json` is compiled and cannot be audited; give its source" in err


def test_a_narrow_page():
    text = render([rulec.audit("at")], {}, "text", 80, in_full=True)
    assert all(len(line) <= 80 for line in text.splitlines())
    assert (
        """
  overtaking_against_a_sign         copy of the consolidated text, which has the
                                    amendments up to BGBl. I 52/2024; the sign
                                    from memory, to be checked
"""
        in text
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--fail-on", "failing"], "--fail-on failing needs --examples: without, none is found"),
        (["--fail-on", "uncited", "--fail-on", "failing"], "failing needs --examples"),
        (["--fail-on", "not-found"], "--fail-on not-found needs --law: "),
        (["--fail-on", "unread"], "--fail-on unread needs --law: "),
        (["--fail-on", "law-changed"], "--fail-on law-changed needs --law-now: "),
        (["--map", "m.xml"], "are about a recording: name it by --source"),
        (["--scenario", "s"], "are about a recording: name it by --source"),
        (["--input-format", "commonroad"], "are about a recording: name it by --source"),
    ],
)
def test_an_option_that_would_have_no_effect_is_refused(options, words, capsys):
    assert main(["show", "--audit", "esterle2019", *options]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err
