"""``rulec compile --check`` as its user meets it."""

import gzip
import json
from pathlib import Path

import pytest

from rulec.cli.main import main
from support import hidden_spot
from support.builders.compiled_files import sealed


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("build")
    source = folder / "b.rules"
    source.write_text("rulebook b signal p, q hard rule r { require always (p implies next q) }")
    assert main(["compile", str(source), "-o", str(folder)]) == 0
    return folder / "b.json"


def test_what_is_proved(file, capsys):
    assert main(["compile", "--check", str(file), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    (of_file,) = answer["files"]
    assert answer["version"] == 1
    assert of_file["file"] == str(file)
    assert of_file["rules"] == [
        {
            "rule": "r",
            "step_s": None,
            "proved": True,
            "because": None,
            "states": [],
            "compilers_agree": hidden_spot.is_there(),
        }
    ]


def test_what_is_not_proved(file, tmp_path, capsys):
    data = json.loads(file.read_text())
    machine = data["rules"][0]["machine"]
    machine["accepting"][0][0] = not machine["accepting"][0][0]
    data["rules"][0]["name"] = "r\x1b[2J"
    (tmp_path / "changed.json").write_bytes(sealed(data))
    assert main(["compile", "--check", str(file), str(tmp_path / "changed.json")]) == 1
    out = capsys.readouterr().out
    assert "changed.json: rule r" in out
    assert "\x1b" not in out
    assert "not proved, because a trace of one state is violated by its table, kept by its" in out
    assert "  state 0: p: " in out
    assert out.endswith("2 rules: 1 proved, 1 not proved\n")


def test_folders_and_patterns(file, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for place in ("one/b.json", "one/deep/c.json", "one/.hidden/d.json"):
        Path(place).parent.mkdir(parents=True, exist_ok=True)
        Path(place).write_bytes(file.read_bytes())
    Path("one/notes.json").write_text("{}")
    Path("one/link").symlink_to("deep", target_is_directory=True)
    for named in (["one"], ["one/b*.json", "one/d*", "one/b.json"], ["one/b.json", "one/deep"]):
        assert main(["compile", "--check", *named, "--json"]) == 0
        files = json.loads(capsys.readouterr().out)["files"]
        assert [one["file"] for one in files] == ["one/b.json", "one/deep/c.json"]
    Path("none").mkdir()
    for named in ("none", "one/*.rules"):
        assert main(["compile", "--check", named]) == 2
        assert "error[R0733]" in capsys.readouterr().err


def test_what_may_have_been_a_compiled_rulebook_is_not_passed_over(file, tmp_path, capsys):
    data, folder = file.read_bytes(), tmp_path / "build"
    folder.mkdir()
    (folder / "b.json").write_bytes(data)
    (folder / "b2.json.gz").write_bytes(gzip.compress(data))
    (folder / "notes.json").write_text('{"a": [1, 2]}')
    assert main(["compile", "--check", str(folder)]) == 0
    out, err = capsys.readouterr()
    assert out.endswith("2 rules: 2 proved, 0 not proved\n")
    assert err == f"rulec: passed over, as other JSON: {folder / 'notes.json'}\n"
    flipped = data.replace(b"rulec compiled", b"rulec bompiled", 1)
    for content in (b"", data[:40], bytes(20_000), flipped):
        (folder / "damaged.json").write_bytes(content)
        for named in (folder, folder / "*.json"):
            assert main(["compile", "--check", str(named)]) == 2
            assert f" --> {folder / 'damaged.json'}" in capsys.readouterr().err


def test_files_that_are_none(file, tmp_path, capsys):
    text = file.read_text()
    bad = {
        "R0404": b"[]",
        "R0410": text.replace("true", "false").encode(),
        "R0411": b'{"format": "rulec compiled rulebook", "version": 5}',
    }
    for code, content in bad.items():
        (tmp_path / "bad.json").write_bytes(content)
        assert main(["compile", "--check", str(tmp_path / "bad.json"), str(file)]) == 2
        out, err = capsys.readouterr()
        assert f"[{code}]" in err
        assert "1 rule: 1 proved" in out
    assert main(["compile", "--check", str(tmp_path / "missing.json")]) == 2
    assert "R0701" in capsys.readouterr().err


def test_a_source_is_to_be_compiled_first_and_a_compiled_file_is_none(tmp_path, capsys):
    source = tmp_path / "a.rules"
    source.write_text("rulebook a\nsignal p\nhard rule r { require always p }\n")
    assert main(["compile", "--check", str(source)]) == 2
    assert f"help: compile it first: `rulec compile {source} -o DIR`" in capsys.readouterr().err
    assert main(["compile", str(source), "-o", str(tmp_path)]) == 0
    assert main(["check", str(tmp_path / "a.json")]) == 1
    assert "help: give the source that it was compiled from\n" in capsys.readouterr().out
