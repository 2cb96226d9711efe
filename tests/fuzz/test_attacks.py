"""Small inputs that once took minutes or gigabytes, each in a process of its own."""

import gzip
import io
import json
import os

import numpy
import pyarrow
import pyarrow.parquet
import pytest

from rulec.api.named_monitor import Monitor
from rulec.rulebook.loader import parse_rulebook
from support.builders.recorded_cars import car
from support.builders.recordings import ROAD_XML
from support.builders.rulebooks import compile_here
from support.own_process import cost_of

MOST_MIB = 500
MOST_CPU_S = 2
LITTLE_CPU_S = 0.5
"""What `rulec verify` takes for a short trace where nothing else runs; more where much does."""

IS_LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"

SOON = """rulebook soon
signal p, q default false
hard rule soon { require always (p implies eventually[<= 1 s] q) }
"""
CROWD = """rulebook crowd
type car
signal beside(a: car), stopped(a: car) default false
hard rule six (a: car, b: car, c: car, d: car, e: car, f: car) {
  require always not (beside(a) and beside(b) and beside(c)
                      and stopped(d) and stopped(e) and stopped(f))
}
"""


def traces(*lines):
    return "".join(f"{json.dumps(line)}\n" for line in lines)


def of_states(states, **more):
    return {"step_s": 1, "states": states, **more}


def saved(step):
    """A saved monitor of ``SOON``, with this for its step."""
    monitor = Monitor(compile_here(parse_rulebook(SOON), 1), 1)
    monitor.step({"p": True}, {})
    return json.dumps({**monitor.snapshot(), "step_s": step})


def recorded(last):
    """A recording of one car whose last state is at this step."""
    cars = car(7, 10, 0, 12).replace("<exact>29</exact>", f"<exact>{last}</exact>")
    head, tail = ROAD_XML.index("  <obstacle"), ROAD_XML.index("  <planning")
    return ROAD_XML[:head] + cars + ROAD_XML[tail:]


def parquet_of_no_text():
    table = pyarrow.table({"trace": ["tQQ"], "step": [0], "p": [True]})
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, sink, compression="none")
    return sink.getvalue().to_pybytes().replace(b"tQQ", b"t\xff\xff")


def parquet_of_other_statistics():
    """Its statistics count what is missing in a column; its schema says that nothing can be."""
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table({"trace": ["a"], "step": [0], "p": [True]}), sink)
    optional, required = b"\x25\x02\x18\x05trace", b"\x25\x00\x18\x05trace"
    data = sink.getvalue().to_pybytes()
    assert optional in data
    return data.replace(optional, required)


def parquet_of_one_trace(n_states):
    steps = pyarrow.array(numpy.arange(n_states))
    same = pyarrow.DictionaryArray.from_arrays(
        pyarrow.array(numpy.zeros(n_states, numpy.int8)), ["a"]
    )
    sink = io.BytesIO()
    pyarrow.parquet.write_table(
        pyarrow.table({"trace": same, "step": steps}),
        sink,
        compression="zstd",
        use_dictionary=["trace"],
        column_encoding={"step": "DELTA_BINARY_PACKED"},
    )
    return sink.getvalue()


def parquet_of_refused(n_rows):
    """As many traces of one state, each with a value that there is not."""
    table = {
        "trace": [f"t{number}" for number in range(n_rows)],
        "step": pyarrow.array(numpy.zeros(n_rows, numpy.int8)),
        "p": pyarrow.array(numpy.arange(n_rows)),
    }
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table(table), sink)
    return sink.getvalue().to_pybytes()


THIRTY = {f"o{number}": "car" for number in range(30)}
FEW = {"beside": {"o1": True, "o2": True, "o3": True}}
FEW_OF = ("beside", "stopped")
PARITY = " xor ".join(f"p{number}" for number in range(14))
SIGNALS = ", ".join(f"p{number}" for number in range(14))
CHAIN = "type t0\n" + "".join(f"type t{n} is t{n - 1}\n" for n in range(1, 5000))
ALIKE = "rulebook b{}\nsignal p default false\n" + "".join(
    f"hard rule r{n} {{{{ require always p }}}}\n" for n in range(5)
)
SURFACES = "".join(
    f'[[road.surface]]\ntype = "crossing"\ns = [{n}.0, {n}.5]\n' for n in range(30_000)
)
ROAD = "[road]\ns = [0.0, 90000.0]\nlanes = [-1.75, 1.75]\n[ego]\ns = 0.0\nd = 0.0\n"
OBSTACLES = "".join(
    f"[[obstacle]]\nid = 'a{n}'\ntype = 'vehicle'\nlength = 1\nwidth = 1\ns = {30 + n}\nd = 0\n"
    for n in range(500)
)
CITES = "rulebook cites\nsignal p default false\n" + "".join(
    f'hard rule r{n} {{ cite "Article 1({n}) no. {n}" require always p }}\n' for n in range(1, 100)
)
LONG_LAW = "### Article 1 Passing\n" + "(1) aa.\n" * 600_000
RESTORE = ["monitor", "./soon.rules", "--restore", "m.json"]

COSTLY = {
    "a saved monitor with a step of 1e9999999": (
        {"m.json": lambda: saved("1e9999999")},
        RESTORE,
        2,
        "R0510",
    ),
    "a saved monitor with an infinite step": (
        {"m.json": lambda: saved(float("inf"))},
        RESTORE,
        2,
        "R0510",
    ),
    "a past with a step of 1e9999999": (
        {"m.json": lambda: saved("1e9999999")},
        ["maneuvers", "s1", "-r", "esterle2019", "--after", "m.json"],
        2,
        "R0510",
    ),
    "a recording of one state at step 20,000,000": (
        {"ZAM_Road-1_1_T-1.xml": lambda: recorded(20_000_000)},
        ["verify", "ZAM_Road-1_1_T-1.xml", "-r", "esterle2019"],
        2,
        "R0610",
    ),
    "a recording of one state at step 10^300": (
        {"ZAM_Road-1_1_T-1.xml": lambda: recorded(10**300)},
        ["verify", "ZAM_Road-1_1_T-1.xml", "-r", "esterle2019"],
        2,
        "R0610",
    ),
    "427 million choices of objects, in a trace": (
        {"t.jsonl": lambda: traces(of_states([FEW] * 3, objects=THIRTY))},
        ["verify", "t.jsonl", "-r", "./crowd.rules"],
        0,
        "1 satisfied",
    ),
    "427 million choices of objects, state by state": (
        {"-": lambda: traces(*[{"objects": THIRTY, "state": FEW}] * 3)},
        ["monitor", "./crowd.rules"],
        0,
        "holds so far",
    ),
    "30 objects of which everything is true, for six variables": (
        {
            "t.jsonl": lambda: traces(
                of_states([{name: dict.fromkeys(THIRTY, True) for name in FEW_OF}], objects=THIRTY)
            )
        },
        ["verify", "t.jsonl", "-r", "./crowd.rules"],
        2,
        "R0718",
    ),
    "a state of 300,000 names that nobody has declared": (
        {"t.jsonl": lambda: traces(of_states([{f"p{n}": True for n in range(300_000)}]))},
        ["verify", "t.jsonl", "-r", "./soon.rules"],
        2,
        "R0502",
    ),
    "30 objects of which everything is true, for six variables, state by state": (
        {
            "-": lambda: traces(
                {
                    "objects": THIRTY,
                    "state": {name: dict.fromkeys(THIRTY, True) for name in FEW_OF},
                }
            )
        },
        ["monitor", "./crowd.rules"],
        2,
        "R0718",
    ),
    "an example of 100,000 states": (
        {
            "long.rules": lambda: (
                "rulebook long\nsignal p default false\nhard rule r {\n  require always p\n"
                f"  accept {{ {'; '.join(['p'] * 100_000)} }}\n}}\n"
            )
        },
        ["check", "./long.rules"],
        1,
        "R0111",
    ),
    "100,000 objects in a state": (
        {"-": lambda: traces({"objects": {f"o{n}": "car" for n in range(100_000)}, "state": {}})},
        ["monitor", "./crowd.rules"],
        2,
        "--limit objects=",
    ),
    "500 obstacles for 9,990 layers": (
        {"s.toml": lambda: f"horizon_s = 9990\nstep_s = 1\n{ROAD}{OBSTACLES}"},
        ["maneuvers", "s.toml", "-r", "esterle2019"],
        2,
        "--limit places=",
    ),
    "a tree of 120 rulebooks with five rules each, compared with each other": (
        {f"b{n}.rules": lambda n=n: ALIKE.format(n) for n in range(120)},
        ["diff", "--all", "--rule", "r*", *(f"./b{n}.rules" for n in range(120))],
        2,
        "--limit comparisons=",
    ),
    "a parity of 14 signals, drawn": (
        {
            "wide.rules": lambda: (
                f"rulebook wide\nsignal {SIGNALS}\nhard rule r {{ require always ({PARITY}) }}\n"
            )
        },
        ["show", "./wide.rules"],
        2,
        "R0718",
    ),
    "a violation at the end of 300,000 states": (
        {"t.jsonl": lambda: traces(of_states([{"p": False}] * 300_000 + [{"p": True}] * 3))},
        ["verify", "t.jsonl", "-r", "./soon.rules"],
        1,
        "1 violated",
    ),
    "5,000 types, each of the one before": (
        {"deep.rules": lambda: f"rulebook deep\n{CHAIN}signal p\nhard rule r {{ require p }}\n"},
        ["check", "./deep.rules"],
        1,
        "R0718",
    ),
    "30,000 surfaces of a road": (
        {"s.toml": lambda: ROAD + SURFACES},
        ["maneuvers", "s.toml", "-r", "esterle2019"],
        2,
        "R0604",
    ),
    "Parquet with a text that is none": (
        {"t.parquet": parquet_of_no_text},
        ["verify", "t.parquet", "-r", "./soon.rules"],
        2,
        "R0509",
    ),
    "Parquet with statistics of another schema": (
        {"t.parquet": parquet_of_other_statistics},
        ["verify", "t.parquet", "-r", "./soon.rules"],
        2,
        "R0509",
    ),
    "100 kB of patterns that git would ignore by, and files that nearly match": (
        {
            ".gitignore": lambda: "".join(f"{'*a' * 115}{n:06}b\n" for n in range(400)),
            **{
                f"{'a' * 240}{n:03}.rules": lambda: "rulebook a\nhard rule r { require true }\n"
                for n in range(60)
            },
        },
        ["check", "."],
        0,
        "1 warning",
    ),
    "a threshold of 1e308": (
        {"ZAM_Road-1_1_T-1.xml": lambda: recorded(29)},
        ["verify", "ZAM_Road-1_1_T-1.xml", "-r", "de", "--threshold", "smoothing_s=1e308"],
        2,
        "smoothing_s",
    ),
    "a law's text of gigabytes, packed": (
        {"law.md": lambda: gzip.compress(bytes(200_000_000), 1)},
        ["show", "--audit", "./soon.rules", "--law", "law.md"],
        2,
        "R0736",
    ),
    "a law of two million paragraphs, and as many places as rules": (
        {"cites.rules": lambda: CITES, "law.md": lambda: LONG_LAW},
        ["show", "--audit", "./cites.rules", "--law", "law.md"],
        2,
        "--limit cites=",
    ),
    "a provision of a million digits, and one that is a digit to no number": (
        {
            "digits.rules": lambda: (
                "rulebook digits\nsignal p default false\n"
                f'hard rule r {{ cite "Article {"9" * 1_000_000}(1)" require always p }}\n'
                'hard rule s { cite "Article 1" require always p }\n'
                'hard rule t { cite "\u00b2" require always p }\n'
            )
        },
        ["show", "--audit", "./digits.rules", "-o", "digits.json"],
        0,
        "wrote",
    ),
    "moments of a formula that looks back for three million years": (
        {"t.jsonl": lambda: traces(of_states([{"p": True}] * 2))},
        ["find", "once[<= 99999999999999 s] p", "t.jsonl", "-r", "./soon.rules"],
        2,
        "--limit lookback=",
    ),
    "a compiled rulebook of gigabytes, packed": (
        {"book.json": lambda: gzip.compress(b"{" + b" " * 200_000_000, 1)},
        ["compile", "--check", "book.json"],
        2,
        "R0736",
    ),
    "a saved audit of gigabytes, packed": (
        {"old.json": lambda: gzip.compress(b" " * 100_000_000, 1)},
        ["show", "--audit", "./soon.rules", "--compare", "old.json"],
        2,
        "R0736",
    ),
    "settings of gigabytes, packed": (
        {"rulec.toml": lambda: gzip.compress(b"#" * 50_000_000, 1)},
        ["check", "./soon.rules"],
        2,
        "R0736",
    ),
    "settings with a folder's name of 300 characters": (
        {"rulec.toml": lambda: f'search_path = ["{"a" * 300}"]\n'},
        ["check", "./soon.rules"],
        2,
        "R0704",
    ),
}


COSTLY_TO_MAKE = {
    "200 traces of as many steps": (
        {
            "t.jsonl": lambda: traces(
                *({"step_s": 1 / (n + 1), "states": [{"p": True}]} for n in range(200))
            )
        },
        ["verify", "t.jsonl", "-r", "./soon.rules"],
        2,
        "R0718",
    ),
    "a row of 200 MB, packed": (
        {
            "t.csv.gz": lambda: gzip.compress(
                b"trace,step,p\na,0,true\nb,0," + bytes(200_000_000).replace(b"\0", b","), 1
            )
        },
        ["verify", "t.csv.gz", "-r", "./soon.rules"],
        2,
        "R0509",
    ),
    "a trace of 20 million states, packed": (
        {"t.jsonl.gz": lambda: gzip.compress(b'{"states": [' + b"{}," * 20_000_000 + b"{}]}\n", 1)},
        ["verify", "t.jsonl.gz", "-r", "./soon.rules"],
        2,
        "R0718",
    ),
    "a trace of 20 million rows in half a megabyte of Parquet": (
        {"t.parquet": lambda: parquet_of_one_trace(20_000_000)},
        ["verify", "t.parquet", "-r", "./soon.rules"],
        2,
        "R0718",
    ),
    "300,000 rows of Parquet that are each refused": (
        {"t.parquet": lambda: parquet_of_refused(300_000)},
        ["verify", "t.parquet", "-r", "./soon.rules"],
        2,
        "20,001 traces one after the other that cannot be judged",
    ),
    "a row of 200,000 columns": (
        {
            "t.csv": lambda: (
                "trace,step,"
                + ",".join(f"p{n}" for n in range(200_000))
                + "\na,0"
                + ",true" * 200_000
            )
        },
        ["verify", "t.csv", "-r", "./soon.rules"],
        2,
        "R0502",
    ),
}


@pytest.mark.parametrize(
    "attack", [*COSTLY, *(pytest.param(one, marks=pytest.mark.long) for one in COSTLY_TO_MAKE)]
)
def test_what_is_small_takes_little(attack, tmp_path, record_property):
    """In a process of its own, so that its memory is its own; without a traceback."""
    files, arguments, status, says = {**COSTLY, **COSTLY_TO_MAKE}[attack]
    made = {name: make() for name, make in files.items()}
    standard_input = made.pop("-", "")
    for name, data in {"soon.rules": SOON, "crowd.rules": CROWD, **made}.items():
        (tmp_path / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    cost = cost_of(arguments, tmp_path, standard_input)
    record_property("processor seconds", cost.cpu_s)
    assert (cost.status, says in cost.said, "Traceback" in cost.said) == (status, True, False), cost
    assert cost.peak_mib < MOST_MIB
    if IS_LONG:
        (tmp_path / "t.jsonl").write_text('{"states": [{}]}\n')
        little = cost_of(["verify", "t.jsonl", "-r", "./soon.rules"], tmp_path)
        assert cost.cpu_s < MOST_CPU_S * max(1, little.cpu_s / LITTLE_CPU_S)
