"""One rule for all verbs: the ending of a file says what is written into it."""

import os

import click
import pytest

from rulec.cli.main import main
from rulec.cli.options.output_options import TABLES, chosen_format

PICTURES = {"svg": (".svg",), "png": (".png",)}


@pytest.mark.parametrize(
    ("endings", "file", "form"),
    [
        (PICTURES, "a.svg", "svg"),
        (PICTURES, "b/a.PNG", "png"),
        (PICTURES, "-", "svg"),
        (PICTURES, None, "svg"),
        (TABLES, "a.jsonl", "jsonl"),
        (TABLES, "a.ndjson", "jsonl"),
        (TABLES, "a.pq", "parquet"),
        # Nothing ends a device's name.
        (TABLES, os.devnull, "jsonl"),
    ],
)
def test_the_ending_decides(endings, file, form):
    assert chosen_format(endings, file, None) == form


def test_what_is_named_comes_first():
    assert chosen_format(PICTURES, "a.svg", "png") == "png"
    assert chosen_format(PICTURES, "a.txt", "png") == "png"


@pytest.mark.parametrize("file", ["a", "a.txt", "a.svg.bak", "png"])
def test_an_ending_that_says_nothing_is_refused_with_those_that_do(file):
    with pytest.raises(click.UsageError) as refused:
        chosen_format(PICTURES, file, None)
    assert "Let it end in one of .svg, .png, or name the format" in refused.value.message


@pytest.mark.parametrize(
    "arguments",
    [
        ["traces", "s1"],
        ["envelopes", "s1", "-r", "esterle2019"],
        ["draw", "graph", "s1"],
        ["doc", "esterle2019"],
        ["diff", "de", "fr"],
        ["verify", "docs/samples/traces.jsonl", "-r", "esterle2019"],
        ["formats"],
    ],
)
def test_every_verb_refuses_it(arguments, capsys, tmp_path):
    file = tmp_path / "answer.xyz"
    assert main([*arguments, "-o", str(file)]) == 2
    assert "does not say by its ending what to write" in capsys.readouterr().err
    assert not file.exists()


@pytest.mark.parametrize("name", ["--output-format", "--format"])
def test_the_former_name_is_taken_and_not_shown(name, capsys, tmp_path):
    file = tmp_path / "traces"
    assert main(["traces", "s1", "-o", str(file), name, "csv", "--limit", "1"]) == 0
    assert file.read_text().startswith("trace,step,")
    capsys.readouterr()
    assert main(["traces", "--help"]) == 0
    assert "--format " not in capsys.readouterr().out
