"""Each verb that is given a file of another verb's kind says which verb is meant."""

from pathlib import Path

import pytest

from rulec.cli.main import main

SAMPLES = Path(__file__).resolve().parents[2] / "docs" / "samples"
FILES = {
    "traces.jsonl": "rulec verify",
    "traces.csv": "rulec verify",
    "found.jsonl": "rulec rates",
    "found.csv": "rulec rates",
    "verdicts.json": "verdicts of `rulec verify`",
    "book.rules": "rulec check",
    "esterle2019.json": "rulec verify TRAFFIC -r",
    "scene.toml": "rulec maneuvers",
}
VERBS = {
    "check": ["check", "FILE"],
    "test": ["test", "FILE"],
    "audit": ["show", "--audit", "FILE"],
    "maneuvers": ["maneuvers", "FILE", "-r", "esterle2019"],
    "draw drive": ["draw", "drive", "FILE", "-r", "esterle2019", "-o", "x.html", "--ego", "1"],
    "fleet": ["fleet", "FILE", "-r", "esterle2019", "-o", "out"],
}
OWN = {
    *(("check", "book.rules"), ("test", "book.rules"), ("audit", "book.rules")),
    *(("maneuvers", "scene.toml"), ("check", "esterle2019.json")),
    *(("test", "esterle2019.json"), ("audit", "esterle2019.json")),
    *(("test", "verdicts.json"), ("audit", "verdicts.json")),
}
"""What the verbs read, and JSON, which they take for a compiled rulebook without its source."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    own = tmp_path_factory.mktemp("kinds")
    (own / "traces.jsonl").write_bytes((SAMPLES / "traces.jsonl").read_bytes())
    (own / "traces.csv").write_text("trace,step,surface\nt,0,R_cw\n")
    (own / "book.rules").write_text(
        "# mine\nrulebook book\nuse paper\nhard rule r { require true }\n"
    )
    (own / "scene.toml").write_text("[road]\nlanes = 2\n")
    outputs = [part for name in ("found.jsonl", "found.csv") for part in ("-o", str(own / name))]
    traces = str(own / "traces.jsonl")
    judged = ["verify", traces, "-r", "esterle2019", "--exposure", *outputs]
    assert main([*judged, "-o", str(own / "verdicts.json")]) == 1
    assert main(["compile", "esterle2019", "-o", str(own)]) == 0
    return own


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("name", FILES)
def test_the_verb_that_is_meant_is_named(verb, name, folder, monkeypatch, capsys):
    if (verb, name) in OWN:
        return
    monkeypatch.chdir(folder)
    status = main([name if word == "FILE" else word for word in VERBS[verb]])
    captured = capsys.readouterr()
    assert status == 2
    assert FILES[name] in captured.err + captured.out


@pytest.mark.parametrize("name", ["traces.jsonl", "recording.xml", "book.rules"])
def test_rates_are_of_what_has_been_judged(name, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    Path("recording.xml").write_bytes((SAMPLES / "following.xml").read_bytes())
    assert main(["rates", name]) == 2
    traffic = "TRAFFIC" if name == "book.rules" else name
    first = f"`rulec verify {traffic} -r de --exposure -o found.csv`"
    assert (
        f"judge first, then count: {first}, and `rulec rates found.csv`" in capsys.readouterr().err
    )
