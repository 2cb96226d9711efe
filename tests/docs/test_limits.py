"""The page of limits, against the limits in the code."""

import re
from pathlib import Path

import pytest

from rulec.automata import compiler_jobs, tables
from rulec.automata.clocks import clocked_machine
from rulec.automata.worker import compiler_worker
from rulec.cli.main import main
from rulec.extraction import traffic_thresholds
from rulec.files import read_files
from rulec.rates import finding_rows
from rulec.recordings import recording, recording_inputs
from rulec.recordings.encodings.arrow import arrow_tables
from rulec.recordings.opendrive import lane_lines, opendrive_map
from rulec.report.findings.code_registry import all_codes
from rulec.resource_limits import LIMITS, MOST_DIGITS
from rulec.rulebook.arithmetic import size_limits
from rulec.rulebook.files import referenced_files, source_walk
from rulec.rulebook.overlay import priorities
from rulec.scenario import scenario_files, time_grid
from rulec.scenario.toml import schema
from rulec.syntax import parser, scanner
from rulec.trace.formats import json_line_problems, table_reader
from rulec.trace.formats.arrow import parquet

PAGE = (Path(__file__).parents[2] / "docs" / "limits.md").read_text(encoding="utf-8")

FIXED = {
    "bytes of a rulebook or vocabulary": read_files.MAX_SOURCE_BYTES,
    "bytes of a law's text, of a saved audit": read_files.MAX_LAW_BYTES,
    "bytes of a compiled rulebook, of a saved monitor": read_files.MAX_SAVED_BYTES,
    "folders inside one another that are walked for sources": source_walk.DEEPEST_FOLDER,
    "folders inside one another that are walked for recordings": recording_inputs.DEEPEST_FOLDER,
    "bytes of `rulec.toml`": read_files.MAX_SETTINGS_BYTES,
    "words and signs of a source": scanner.MAX_TOKENS,
    "states of an example": parser.MOST_EXAMPLE_STATES,
    "operators, atoms and comparisons of a rule, definitions put in": size_limits.MOST_PARTS,
    "operators inside one another, definitions put in": size_limits.DEEPEST,
    "rulebooks that one builds upon, one upon another": referenced_files.MOST_BASES,
    "levels of priority": priorities.MOST_LEVELS,
    "digits of a number in compiled files and saved monitors": MOST_DIGITS,
    "states of a rule's automaton while it is built": tables.MOST_STATES,
    "edges of it": tables.MOST_EDGES,
    "states of it beside a clock": clocked_machine.MOST_PAIRS,
    "operators of a rule with each `then` written out": compiler_jobs.MOST_OPERATORS,
    "bytes of memory for it": compiler_worker.MEMORY_LIMIT_BYTES,
    "steps of a bound, which are states of it": tables.MOST_STEPS_AHEAD,
    "bytes of a packed file, unpacked": read_files.LARGEST_UNPACKED,
    "bytes of one line of traces": json_line_problems.LONGEST_LINE_BYTES,
    "characters of a row of CSV": table_reader.LONGEST_ROW,
    "bytes of a row group of Parquet, unpacked, beside 1,024 a cell": parquet.LARGEST_GROUP,
    "time steps of a recording, from the first to the last": recording.MOST_STEPS,
    "time steps of a recording for one that is in it": recording.SPARSEST,
    "places on the borders of one road of an OpenDRIVE map": lane_lines.MOST_PLACES,
    "places on the borders of all its roads": opendrive_map.MOST_PLACES,
    "cells of a table of a recording in Parquet, its rows times the columns that are read": (
        arrow_tables.MOST_CELLS
    ),
    "a number in findings that `rates` reads": finding_rows.LARGEST,
    "`--threshold`, in its unit": traffic_thresholds.LARGEST,
    "bytes of a scenario in TOML": scenario_files.LARGEST_BYTES,
    "obstacles of a scenario": schema.MOST_OBSTACLES,
    "surfaces of a scenario's road, and missing stretches of its lanes": schema.MOST_STRETCHES,
    "layers of a scenario's graph": time_grid.MAX_LAYERS,
}


def rows(heading):
    """The rows of the table below a heading, without its head."""
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    table = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]


def number(text):
    return int(text.replace(",", ""))


def test_the_page_lists_the_limits_that_can_be_lifted():
    listed = {
        row[0].strip("`"): (number(row[1]), row[2]) for row in rows("Limits that can be lifted")
    }
    assert listed == {limit.name: (limit.usual, limit.counted) for limit in LIMITS.values()}


def test_the_page_lists_the_limits_that_are_fixed():
    assert {row[0]: number(row[1]) for row in rows("Limits that are fixed")} == FIXED
    codes = {code for row in rows("Limits that are fixed") for code in re.findall(r"R\d+", row[2])}
    assert codes <= all_codes().keys()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("chices=3", "did you mean `choices`?"),
        ("choices=many", "write it as in `choices=1000000`"),
        ("choices", "a whole number, not ``"),
    ],
)
def test_a_limit_that_is_none_is_refused(given, words, capsys):
    assert main(["--limit", given, "list"]) == 2
    said = capsys.readouterr().err
    assert "R0719" in said
    assert words in said
