"""The paper's Tables I to V, typed from its print. (Table I: tests/logic/test_semantics.py.)"""

import json

import pytest

from rulec import compile_rulebook
from rulec.book_tests.example_runs import example_trace
from rulec.cli.main import main
from rulec.monitoring.batch.verify import verify
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.trace import Trace

RULES = compile_rulebook("esterle2019")
SOURCE = load_rulebook("esterle2019")

# Each row: the states as "surface position", without the surface where the paper omits it.
TABLE_II = {  # R1
    1: ("b b l f", True),
    2: ("b l l b", True),
    3: ("b b r b", True),
    4: ("r r f f", True),
    5: ("b r r f", False),
    6: ("b r f f", False),
    7: ("b r f r", False),
    8: ("b r r b r f", False),
}
TABLE_III = {  # R2
    1: ("cw,b cw,b cw,l cw,f", True),
    2: ("cw,b pc,b cw,l cw,f", True),
    3: ("cw,b cw,b cw,l pc,f", False),
}
TABLE_IV = {  # R3
    1: ("cw,r cw,f cw,f pc,l", True),
    2: ("cw,l cw,f cw,f pc,r", True),
    3: ("cw,l pc,f pc,f cw,r", False),
}
TABLES = {"R1": ("vehicle", TABLE_II), "R2": ("vehicle", TABLE_III), "R3": ("pedestrian", TABLE_IV)}
ROWS = [
    (rule, number, kind, *row)
    for rule, (kind, table) in TABLES.items()
    for number, row in table.items()
]


def state(text, name="o"):
    surface, _, position = text.rpartition(",")
    return {"position": {name: position}} | ({"surface": f"R_{surface}"} if surface else {})


@pytest.mark.parametrize(("rule", "number", "kind", "states", "satisfied"), ROWS)
def test_tables_ii_to_iv(rule, number, kind, states, satisfied):
    trace = Trace("t", 1.0, {"o": kind}, tuple(state(text) for text in states.split()))
    violated = [violation.rule for violation in verify(trace, RULES).violations]
    assert (rule not in violated) == satisfied


@pytest.mark.parametrize("rule", TABLES)
def test_the_rulebooks_examples_are_the_tables_rows(rule):
    (source,) = (one for one in SOURCE.rules if one.name == rule)
    kind, table = TABLES[rule]
    (variable,) = source.variables
    assert variable.type == kind
    written = [
        (tuple(example_trace(source, example).states), example.accepts)
        for example in source.examples
    ]
    printed = [
        (tuple(state(text, variable.name) for text in states.split()), satisfied)
        for states, satisfied in table.values()
    ]
    assert written == printed


def test_congested_traffic_may_pass_on_the_right():
    for congested in (True, False):
        states = tuple({**state(p), "CONGESTED": congested} for p in ("b", "r", "r", "f"))
        verdict = verify(Trace("t", 1.0, {"o": "vehicle"}, states), RULES)
        assert verdict.satisfied == congested


TABLE_V = {
    ("s1", "1"): (20, 32, 16, 16),
    ("s1", "0.5"): (36, 70, 672, 640),
    ("s2", "1"): (35, 124, 139, 83),
    ("s2", "0.5"): (63, 248, 75441, 35531),
    ("s3", "1"): (20, 40, 76, 61),
    ("s3", "0.5"): (36, 80, 4240, 1840),
}


@pytest.mark.parametrize(("scenario", "step"), TABLE_V)
def test_table_v_by_counting(scenario, step, capsys):
    status = main(["maneuvers", scenario, "--step", step, "--rulebook", "esterle2019", "--json"])
    found = json.loads(capsys.readouterr().out)
    assert status == 0
    counts = tuple(found[key] for key in ("nodes", "edges", "traces", "satisfying"))
    assert counts == TABLE_V[scenario, step]
    assert found["horizon_s"] == 4


@pytest.mark.parametrize(
    ("scenario", "step"),
    [
        pytest.param(*asked, marks=[pytest.mark.long] if counts[2] > 5000 else [])
        for asked, counts in TABLE_V.items()
    ],
)
def test_table_v_by_enumerating(scenario, step, capsys, tmp_path):
    file = str(tmp_path / "traces.jsonl")
    assert main(["maneuvers", "--traces", scenario, "--step", step, "-o", file]) == 0
    capsys.readouterr()
    _, _, traces, satisfying = TABLE_V[scenario, step]
    status = main(["verify", file, "--rulebook", "esterle2019", "--json"])
    verdicts = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len({verdict["trace"] for verdict in verdicts}) == traces
    assert sum(verdict["satisfied"] for verdict in verdicts) == satisfying
    assert status == (0 if satisfying == traces else 1)
