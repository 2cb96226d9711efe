"""Help and completion of a verb wait for nothing that only its run needs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rulec.cli.exit_status import ExitStatus
from rulec.cli.verb_table import COMMANDS
from support.builders.sumo_files import body, data, moment, written
from support.snapshots import timeless

HEAVY = {
    "lark",
    "markdown_it",
    "msgspec",
    "numpy",
    "pint",
    "rich",
    "shapely",
    "rulec.api.session",
    "rulec.api.rulebook_compilation",
    "rulec.monitoring.verdict",
    "rulec.partition",
    "rulec.rulebook.loader",
    "rulec.scenario",
    "rulec.syntax",
}


def test_no_verb_imports_at_its_top_what_only_its_run_needs():
    verbs = [
        f"rulec.cli.commands.{file}" for file, _ in COMMANDS.values() if file != "reading.list"
    ]
    program = (
        "import sys; from importlib import import_module\n"
        f"for verb in {verbs}: import_module(verb)\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert HEAVY & set(done.stdout.decode().split()) == set()


def test_what_was_not_answered_outweighs_what_failed():
    assert ExitStatus.after(failed=False) is ExitStatus.OK
    assert ExitStatus.after(failed=True) is ExitStatus.FOUND
    assert ExitStatus.after(answered=False, failed=True) is ExitStatus.NOT_ANSWERED
    assert ExitStatus.after(answered=False, failed=False) is ExitStatus.NOT_ANSWERED


NOT_FOR_A_RECORDING = {
    "gzip",
    "lark",
    "matplotlib",
    "msgspec",
    "networkx",
    "pyarrow",
    "spot",
    "rulec.automata.bundle.bundle_file",
    "rulec.automata.compiler",
    "rulec.cli.trace_run",
    "rulec.monitoring.uncertainty.uncertain_verdict",
    "rulec.partition",
    "rulec.scenario.scenario_files",
    "rulec.syntax",
    "rulec.trace.formats.json_lines",
}


def test_a_recording_is_judged_with_what_has_been_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    written(tmp_path, data(*(moment(k / 2, body(x=20 + 5 * k, lane="in_1")) for k in range(9))))
    source = tmp_path / "soon.rules"
    source.write_text(
        "rulebook soon\nuse road\nhard rule slow { require eventually[<= 1 s] speed < 90 km/h }\n"
    )
    program = (
        "import gc, sys; from rulec.cli.main import main\n"
        f"status = main(['verify', {str(tmp_path / 'fcd.xml')!r}, '-r', {str(source)!r},"
        f" '--map', {str(tmp_path / 'road.net.xml')!r}])\n"
        "print(status, gc.get_freeze_count() > 10_000, *sys.modules)"
    )
    runs = []
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
        *shown, last = done.stdout.decode().splitlines()
        runs.append((shown, set(last.split())))
    assert runs[0][0] == runs[1][0]
    assert "rulec.syntax.grammar" in runs[0][1]
    assert "lark" not in runs[0][1]
    assert runs[1][1] & (NOT_FOR_A_RECORDING | {"0", "True"}) == {"0", "True"}


NOT_FOR_TRACES = {
    "pyarrow",
    "shapely",
    "rulec.logic.sentences.english",
    "rulec.monitoring.explain.explanation",
    "rulec.syntax",
}


def test_a_trace_is_judged_by_a_compiled_rulebook_with_what_that_needs(tmp_path):
    (tmp_path / "held.rules").write_text(
        "rulebook held_p\nsignal p\nhard rule held { require always p }\n"
    )
    (tmp_path / "t.jsonl").write_text('{"states": [{"p": true}, {"p": true}]}')
    program = (
        "import sys; from rulec.cli.main import main\n"
        "main('compile held.rules -o . --step 1'.split())"
    )
    judge = (
        "import sys; from rulec.cli.main import main\n"
        "main('verify t.jsonl -r held_p.json --explain 0 -o f.jsonl'.split())\n"
        "print(*sys.modules)"
    )
    done = [
        subprocess.run([sys.executable, "-c", one], capture_output=True, cwd=tmp_path, check=True)
        for one in (program, judge)
    ]
    assert b"1 trace: " in done[1].stdout
    assert set() == NOT_FOR_TRACES & set(done[1].stdout.decode().split())


BOOK = """\
rulebook {}
use road
hard rule slow {{
    require always (fast implies eventually[<= 1 s] not fast)
    accept {{ speed = 9 km/h }}
}}
define fast = speed > {} km/h
"""
ASKED_AGAIN = [
    *("test one.rules", "show one.rules", "audit one.rules", "diff one.rules two.rules"),
    *("monitor one.rules", "verify drive.xml -r one.rules", "compile one.rules -o out"),
]


def test_what_is_asked_again_is_neither_parsed_nor_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    samples = Path(__file__).parents[2] / "docs" / "samples"
    (tmp_path / "drive.xml").write_bytes((samples / "following.xml").read_bytes())
    for name, speed in (("one", 80), ("two", 90)):
        (tmp_path / f"{name}.rules").write_text(BOOK.format(name, speed))
    program = (
        "import sys; from rulec.cli.main import main; from rulec.automata import compiler\n"
        "from rulec.syntax import grammar\n"
        "begun, start = [], compiler._started\n"
        "compiler._started = lambda choice: begun.append(choice) or start(choice)\n"
        f"for line in {ASKED_AGAIN}:\n"
        "    status = main(line.split())\n"
        "    parsed = grammar._tables.cache_info().currsize > 0\n"
        "    print('@', line, status, parsed, begun, file=sys.stderr)\n"
    )
    runs = []
    for _ in range(2):
        call = [sys.executable, "-c", program]
        state = b'{"state": {}}'
        done = subprocess.run(call, capture_output=True, input=state, cwd=tmp_path, check=True)
        asked = [line for line in done.stderr.decode().splitlines() if line.startswith("@")]
        runs.append((timeless(done.stdout.decode()), asked))
    assert runs[0][0] == runs[1][0]
    assert all(" 2 True" not in line for line in runs[0][1])
    assert runs[0][1][-1].endswith("True ['', 'diagrams']")
    assert [line[-8:] for line in runs[1][1]] == ["False []"] * len(ASKED_AGAIN)


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_a_large_table_is_read_without_pandas(tmp_path, form):
    pyarrow = pytest.importorskip("pyarrow")
    # Arrow, which may not be installed.
    from pyarrow import csv, parquet

    write = csv.write_csv if form == "csv" else parquet.write_table
    n_rows = 1 << 16
    columns = {
        "trace": [f"t{row >> 12}" for row in range(n_rows)],
        "step": [row & 4095 for row in range(n_rows)],
        "p": [True] * n_rows,
    }
    write(pyarrow.table(columns), tmp_path / f"traces.{form}")
    (tmp_path / "pandas.py").write_text("raise SystemExit('pandas is imported')")
    (tmp_path / "held.rules").write_text(
        "rulebook held_p\nsignal p\nhard rule held { require always p }\n"
    )
    call = ["-m", "rulec", "verify", f"traces.{form}", "-r", "held.rules"]
    done = subprocess.run([sys.executable, *call], cwd=tmp_path, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"16 traces: 16 satisfied, 0 violated" in done.stdout


ENDING = """
import atexit, sys, threading, time
class Kept:
    def __del__(self):
        print("taken apart")
def waited():
    threading.main_thread().join()  # until the end begins, however long the start takes
    time.sleep(0.1)
    print("waited for")
kept = Kept()
atexit.register(print, "at the end")
threading.Thread(target=waited).start()
from rulec.cli.entry_point import run
sys.argv = ["rulec", "--version"]
sys.exit(run())
"""


@pytest.mark.parametrize(
    ("options", "ending"), [([], []), (["-X", "dev"], ["taken apart"])], ids=["usual", "watched"]
)
def test_what_lives_until_the_end_is_not_taken_apart_then(options, ending):
    call = [sys.executable, *options, "-c", ENDING]
    done = subprocess.run(call, capture_output=True, check=True, text=True)
    assert done.stdout.splitlines()[1:] == ["waited for", "at the end", *ending]
    assert done.stderr == ""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="says what threads there are")
@pytest.mark.parametrize(("given", "expected"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_products_of_matrices_have_one_thread_unless_somebody_says_otherwise(given, expected):
    usual = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    program = (
        "import os, rulec.cli.entry_point, numpy as np\n"
        "a = np.ones((500, 500)); a @ a\n"
        "print(os.environ['OPENBLAS_NUM_THREADS'], len(os.listdir('/proc/self/task')))"
    )
    call = [sys.executable, "-c", program]
    done = subprocess.run(call, capture_output=True, check=True, env=usual | given)
    said, threads = done.stdout.decode().split()
    assert said == expected
    assert threads == "1" or given


def test_there_is_room_for_the_frames_of_all_that_the_program_calls():
    program = (
        "import resource\n"
        "from rulec.cli import entry_point, main\n"
        "\n"
        "def nothing():\n"
        "    pass\n"
        "\n"
        "def deep(left):\n"
        "    for _ in range(1000):\n"
        "        nothing()\n"
        "    if left:\n"
        "        deep(left - 1)\n"
        "\n"
        "def count(_=None):\n"
        "    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt\n"
        "    deep(500)\n"
        "    print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)\n"
        "    return 0\n"
        "\n"
        "main.main = count\n"
        "entry_point.run()"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    # A new piece for each call at its boundary is a fault of a page, a thousand times
    assert int(done.stdout) < 1000


NOT_WHERE_ALL_IS_KNOWN = {
    "rulec.planning.probability.rule_probability",
    "rulec.planning.trace_history",
}


def test_maneuvers_of_which_all_is_known_need_nothing_for_what_is_not():
    program = (
        "import sys; from rulec.cli.main import main\n"
        "main(['maneuvers', 's2', '--step', '0.5', '-r', 'esterle2019'])\n"
        "print(*sys.modules)"
    )
    for _ in range(2):  # the first may have to compile
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert NOT_WHERE_ALL_IS_KNOWN & set(done.stdout.decode().split()) == set()
