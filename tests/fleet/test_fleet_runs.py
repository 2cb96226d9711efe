"""Runs over a fleet: the same findings however it is cut, killed, resumed, or shared out."""

import fcntl
import json
import os
import random
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import duckdb
import pyarrow
import pytest
from pyarrow import compute, parquet

import rulec
from rulec.batch.jobs import Jobs
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.extraction.selection import RequestedDrives
from rulec.fleet import FleetJudge
from rulec.fleet.drive_rows import judged_by
from rulec.fleet.finding_columns import COLUMNS
from rulec.fleet.fleet_judge import carried
from rulec.fleet.runs import unit_work
from rulec.fleet.runs import work_units as units_module
from rulec.fleet.runs.fleet_folder import FleetFolder
from rulec.fleet.runs.fleet_run import FleetSettings, fleet_inputs, judged_locally, run_fleet
from rulec.fleet.runs.fleet_summary import as_text
from rulec.fleet.runs.work_units import work_units
from rulec.recordings.recording_format import RecordingSource
from rulec.trace.formats.arrow.parquet import rows_of_columns
from support.builders.fleet_inputs import fleet_file, fleet_rules, lanes, trace_table, tracks
from support.builders.interrupted_runs import DyingWorker
from support.builders.recorded_cars import three_cars

LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
DRIVES = 10
PROGRAM = Path(__file__).resolve().parents[1] / "support/builders/interrupted_runs.py"


def settings(road_map=None, **more):
    return FleetSettings(RequestedDrives(), RecordingSource(Path("-"), road_map), **more)


def run(inputs, folder, **more):
    return run_fleet([str(path) for path in inputs], fleet_rules(), folder, settings(**more))


def found_in(folder):
    """All rows in a folder of findings, in an order of their own."""
    paths = sorted(folder.glob("book=*/*.parquet"))
    return in_order(pyarrow.concat_tables([parquet.read_table(path) for path in paths]))


def _rows(folder):
    """The rows of findings about drives and rules in a folder."""
    (path,) = folder.glob("book=*/*.parquet")
    return parquet.read_table(path).to_pylist()


def in_order(table):
    return sorted(map(repr, table.to_pylist()))


def test_several_rulebooks_side_by_side(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    head, rule = "rulebook {}\nuse road\n", "hard rule slow {{ require always speed <= {} m/s }}\n"
    for name, most in (("one", 5), ("two", 50)):
        Path(f"{name}.rules").write_text((head + rule).format(name, most))
    states = [{"speed": 20}, {"speed": 22}]  # in km/h
    Path("t.jsonl").write_text(json.dumps({"id": "a", "step_s": 1, "states": states}) + "\n")
    rulec.write_traces(rulec.read_traces("t.jsonl"), "t.parquet")
    assert main(["fleet", "t.parquet", "-r", "./one.rules", "-r", "./two.rules", "-o", "f"]) == 1
    (table,) = re.findall(r"by +one +two\n[\s\S]*", capsys.readouterr().out)
    assert [line.split() for line in table.splitlines() if "─" not in line] == [
        ["by", "one", "two"],
        ["slow", "1", "kept"],
        ["satisfied", "0", "1"],
        ["violated", "1", "0"],
        ["rules", "not", "judged", "0", "0"],
    ]
    outcomes = {
        name: {row["outcome"] for row in _rows(tmp_path / "f" / name)} for name in ("one", "two")
    }
    assert outcomes == {"one": {"violated"}, "two": {"kept"}}


def test_editions_of_one_rulebook_have_columns_of_their_own(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rule = "rulebook depot\nuse road\nhard rule slow {{ require always speed <= {} km/h }}\n"
    for name, most in (("old", 10), ("new", 50)):
        Path(f"{name}.rules").write_text(rule.format(most))
    Path("t.jsonl").write_text(json.dumps({"id": "a", "states": [{"speed": 20}]}) + "\n")
    rulec.write_traces(rulec.read_traces("t.jsonl"), "t.parquet")
    assert main(["fleet", "t.parquet", "-r", "./old.rules", "-r", "./new.rules", "-o", "f"]) == 1
    table = capsys.readouterr().out.splitlines()
    assert "by                depot (old.rules)  depot (new.rules)" in table
    assert "slow                              1               kept" in table


def test_what_was_left_alone_in_a_folder_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("one.rules").write_text(
        "rulebook one\nuse road\nhard rule r { require always built_up }\n"
    )
    Path("drives").mkdir()
    Path("t.jsonl").write_text(json.dumps({"id": "a", "states": [{"built_up": True}]}) + "\n")
    rulec.write_traces(rulec.read_traces("t.jsonl"), "drives/t.parquet")
    Path("t.jsonl").rename("drives/t.jsonl")
    Path("drives/notes.txt").write_text("no traffic")
    assert main(["fleet", "drives", "-r", "./one.rules", "-o", "f"]) == 0
    assert (
        "left alone  1 without recorded traffic (drives/notes.txt); "
        "1 of rulec's own (drives/t.jsonl)" in capsys.readouterr().out.splitlines()
    )


@pytest.fixture(scope="module")
def traces():
    return trace_table(range(DRIVES))


@pytest.fixture(scope="module")
def expected(traces):
    return in_order(FleetJudge(fleet_rules())(traces))


def cut_into(table, folder, seed):
    """The table in files cut at random, with random row groups; in every third case shuffled."""
    chosen = random.Random(seed)
    if seed % 3 == 0:
        table = table.take(chosen.sample(range(len(table)), len(table)))
    folder.mkdir()
    places = sorted(chosen.sample(range(1, len(table)), chosen.randint(0, 4)))
    for number, (start, stop) in enumerate(pairwise([0, *places, len(table)])):
        path = folder / f"{number}.parquet"
        parquet.write_table(
            table.slice(start, stop - start), path, row_group_size=chosen.randint(3, 60)
        )
    return folder


@pytest.mark.parametrize("chunk", range(40 if LONG else 1))
def test_any_cut_into_files_and_row_groups_has_the_same_findings(
    chunk, traces, expected, tmp_path, monkeypatch
):
    for seed in range(chunk * 25, chunk * 25 + 25):
        # Files are cut into pieces, too, and pieces into slices
        monkeypatch.setattr(units_module, "MOST_ROWS", 20 + seed % 50)
        monkeypatch.setattr(unit_work, "MOST_TOGETHER", 10 + seed % 70)
        folder = cut_into(traces, tmp_path / f"in{seed}", seed)
        run([folder], tmp_path / f"out{seed}")
        assert found_in(tmp_path / f"out{seed}") == expected, seed


def test_recordings_that_are_cut_are_put_together(tmp_path, monkeypatch):
    monkeypatch.setattr(units_module, "MOST_ROWS", 30)
    monkeypatch.setattr(unit_work, "MOST_TOGETHER", 40)
    table = pyarrow.table(tracks([0, 1]))
    whole = FleetJudge(fleet_rules(), lanes(tmp_path))(table)
    done = run([cut_into(table, tmp_path / "in", 3)], tmp_path / "out", road_map=lanes(tmp_path))
    assert found_in(tmp_path / "out") == in_order(whole)
    assert done.units > 2
    assert done.tally.drives.total() == 6


@pytest.fixture
def folder_of(traces, tmp_path):
    """A folder of five tables, the drives of which go over from each to the next."""
    for number, start in enumerate(range(0, len(traces), len(traces) // 4)):
        path = tmp_path / "in" / f"{number}.parquet"
        path.parent.mkdir(exist_ok=True)
        parquet.write_table(traces.slice(start, len(traces) // 4), path)
    return tmp_path / "in"


def test_a_worker_that_is_killed_changes_nothing(folder_of, expected, tmp_path):
    rules = carried(fleet_rules())
    by = judged_by(rules.read(), RequestedDrives())
    folder = FleetFolder(tmp_path / "out", by)
    inputs = sorted(map(str, folder_of.iterdir()))
    folder.open(inputs, RecordingSource(Path("-")))
    units = list(work_units(inputs, []))[:2]
    worker = DyingWorker(rules, RequestedDrives(), RecordingSource(Path("-")), None, folder)
    tallies = list(judged_locally(worker, units, Jobs(2)))
    assert len(list(folder.path.glob("*.begun"))) == 1
    assert len(tallies) == len(units)
    run([folder_of], folder.path)
    assert found_in(folder.path) == expected


@pytest.mark.parametrize("moment", range(20) if LONG else (0, 3, 10))
def test_what_was_killed_goes_on_where_it_was(moment, folder_of, expected, tmp_path):
    out = tmp_path / "out"
    command = [sys.executable, PROGRAM, str(moment), folder_of, fleet_file(tmp_path), out]
    paths = os.pathsep.join([str(PROGRAM.parents[2]), *sys.path])
    done = subprocess.run(command, check=False, env={**os.environ, "PYTHONPATH": paths})
    assert done.returncode == -9
    before = {path: path.stat().st_mtime_ns for path in out.glob("book=*/*.parquet")}
    assert run([folder_of], out).before == len(before)
    assert found_in(out) == expected
    assert {path: path.stat().st_mtime_ns for path in before} == before
    left = [path.name for path in out.rglob("*") if path.name.endswith(".part")]
    assert left == []


def test_what_is_done_is_not_done_again_and_what_has_changed_is(folder_of, traces, tmp_path):
    out = tmp_path / "out"
    first, again = run([folder_of], out), run([folder_of], out)
    assert (first.before, again.before) == (0, 5)
    assert as_text(first).splitlines()[-1] == f"wrote 5 files of findings to {first.findings}"
    assert as_text(again).splitlines()[-1] == (
        f"wrote 0 files of findings to {first.findings}; 5 more were there before"
    )
    last = sorted(folder_of.iterdir())[-1]
    os.utime(last, ns=(1, 1))
    assert run([folder_of], out).before == 3  # that one, and the one whose drive goes over to it
    parquet.write_table(trace_table([98]), folder_of / "9.parquet")
    more = run([folder_of], out)
    assert (more.before, more.units, more.tally.judged) == (5, 6, DRIVES + 1)


def test_what_was_read_beside_a_table_counts_too(tmp_path):
    """A map that a table names, not the command: with another one, units are judged again."""
    table, roads = pyarrow.table(tracks([0, 1])), lanes(tmp_path)
    named = table.append_column("map", [[str(roads)] * len(table)])
    for number in (0, 1):
        rows = named.filter(compute.equal(named["recording"], f"r{number:03d}"))
        parquet.write_table(rows, tmp_path / f"{number}.parquet")
    inputs = [tmp_path / "0.parquet", tmp_path / "1.parquet"]
    run(inputs, tmp_path / "out")
    judged = found_in(tmp_path / "out")
    assert run(inputs, tmp_path / "out").before == 2
    roads.write_text("lane,x,y\nr,0,0\nr,400,0\n")
    assert run(inputs, tmp_path / "out").before == 0
    assert found_in(tmp_path / "out") != judged
    roads.unlink()
    (why,) = run(inputs, tmp_path / "out").tally.reasons
    assert "no such file" in why


def test_a_damaged_file_of_findings_is_written_again(folder_of, expected, tmp_path):
    out = tmp_path / "out"
    run([folder_of], out)
    part = sorted(out.glob("book=*/*.parquet"))[0]
    part.write_bytes(part.read_bytes()[:-10])
    assert run([folder_of], out).before == 4
    assert found_in(out) == expected


def test_a_bit_that_changes_in_findings_is_noticed(folder_of, expected, tmp_path):
    """In the pages of the file, which have checksums; their headers have none."""
    folder = tmp_path / "out"
    run([folder_of], folder)
    # A part of a file has no rows if the drives that begin in it are another part's
    part = max(folder.glob("book=*/*.parquet"), key=lambda path: path.stat().st_size)
    whole, group = part.read_bytes(), parquet.read_metadata(part).row_group(0)
    columns = [group.column(number) for number in range(group.num_columns)]
    ends = [
        (column.dictionary_page_offset or column.data_page_offset) + column.total_compressed_size
        for column in columns
    ]
    assert len(ends) > 20
    for end in ends:
        data = bytearray(whole)
        data[end - 2] ^= 4
        part.write_bytes(data)
        with pytest.raises(RulecError, match="R0509"):
            list(rows_of_columns(part, COLUMNS))
    again = run([folder_of], folder)
    assert again.units - again.before == 1
    assert found_in(folder) == expected


def test_a_folder_that_another_run_writes_into_is_refused(folder_of, expected, tmp_path):
    """It would take away what the other one is about to write."""
    out = tmp_path / "out"
    run([folder_of], out)
    handle = os.open(out, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        with pytest.raises(RulecError, match="another run of rulec is writing into the folder"):
            run([folder_of], out)
    finally:
        os.close(handle)
    assert run([folder_of], out).before == 5
    assert found_in(out) == expected


def test_a_folder_of_another_fleet_is_refused(folder_of, tmp_path):
    out = tmp_path / "out"
    run([folder_of], out)
    other = rulec.compile_rulebook("esterle2019")
    with pytest.raises(RulecError, match=r"its rulebook is `fleet_rules`.*R0712"):
        run_fleet([str(folder_of)], other, out, settings())
    with pytest.raises(RulecError, match="its assumptions is none, and would be `ends=complete`"):
        run([folder_of], out, ends="complete")
    with pytest.raises(RulecError, match="its map is none, and would be"):
        run([folder_of], out, road_map=lanes(tmp_path))
    some = FleetSettings(RequestedDrives(egos=("a",)))
    with pytest.raises(RulecError, match="its egos is none, and would be `a`"):
        run_fleet([str(folder_of)], fleet_rules(), out, some)
    with pytest.raises(RulecError, match=r"also has findings of `.*0.parquet` and 3 more"):
        run([sorted(folder_of.iterdir())[-1]], out)
    with pytest.raises(RulecError, match=r"are no findings of a fleet: .*no _manifest"):
        run([folder_of], folder_of)
    sound = (out / "_manifest.json").read_text()
    damaged = json.dumps({**json.loads(sound), "inputs": 5})
    for text in ("[", "[" * 100_000, damaged):
        (out / "_manifest.json").write_text(text)
        with pytest.raises(RulecError, match="cannot be read"):
            run([folder_of], out)


def test_pipes_and_devices_are_no_files_of_a_fleet(tmp_path):
    os.mkfifo(tmp_path / "pipe.parquet")
    for path in (str(tmp_path / "pipe.parquet"), "/dev/zero"):
        found = fleet_inputs([path])
        assert found.paths == ()
        assert [one.code for error in found.problems for one in error.diagnostics] == ["R0731"]


def test_files_that_hold_no_drives_are_named_and_the_others_are_judged(folder_of, tmp_path):
    (tmp_path / "notes.txt").write_text("nothing")
    broken = tmp_path / "broken.parquet"
    broken.write_bytes(b"PAR1 nothing PAR1")
    recording = tmp_path / "cars.csv"
    recording.write_text("track,t,x,y\na,0,zero,1\na,1,0,1\n")
    done = run([folder_of, tmp_path / "notes.txt", broken, recording], tmp_path / "out")
    assert [one.diagnostics[0].code for one in done.problems] == ["R0710", "R0710"]
    assert done.tally.judged == DRIVES
    assert done.tally.unread == 1
    (why,) = done.tally.reasons
    assert "its column `x` holds `zero`" in why
    with pytest.raises(RulecError, match="no such file"):
        run([tmp_path / "nothing.parquet"], tmp_path / "none")
    assert not (tmp_path / "none").exists()
    assert f"not judged  1:\n  1: {why} ({recording})\n" in as_text(done)
    # Of several the first by name stands for all
    (tmp_path / "a.csv").write_bytes(recording.read_bytes())
    done = run([recording, tmp_path / "a.csv"], tmp_path / "both")
    assert f"  2: {why} (as in {tmp_path / 'a.csv'})\n" in as_text(done)


def test_a_file_with_two_columns_of_one_name_is_named(folder_of, tmp_path):
    twice = pyarrow.Table.from_arrays([[0.0], ["t"], [0], [1.0]], ["v", "trace", "step", "v"])
    parquet.write_table(twice, tmp_path / "twice.parquet")
    done = run([folder_of, tmp_path / "twice.parquet"], tmp_path / "out")
    ((problem,),) = [one.diagnostics for one in done.problems]
    assert problem.place.file == str(tmp_path / "twice.parquet")
    assert problem.message == "the table has two columns `v`"
    assert done.tally.judged == DRIVES
    with pytest.raises(RulecError, match=r"two columns `v` \[R0710\]"):
        FleetJudge(fleet_rules())(twice)


def test_a_file_whose_drives_have_no_readable_names_is_named(folder_of, tmp_path):
    texts = pyarrow.array([b"t0", b"\xe3"], pyarrow.binary()).view(pyarrow.string())
    odd = pyarrow.table({"trace": texts, "step": [0, 0], "speed": [1.0, 2.0]})
    parquet.write_table(odd, tmp_path / "odd.parquet")
    done = run([folder_of, tmp_path / "odd.parquet"], tmp_path / "out")
    ((problem,),) = [one.diagnostics for one in done.problems]
    assert problem.place.file == str(tmp_path / "odd.parquet")
    assert problem.message.endswith("the column `trace` has a text that is not UTF-8")
    assert done.tally.judged == DRIVES


def test_of_a_table_that_says_no_files_a_recording_is_named(tmp_path):
    path, columns = tmp_path / "tracks.parquet", tracks([0])
    columns["x"][3] = None
    parquet.write_table(pyarrow.table(columns), path)
    done = run_fleet([str(path)], fleet_rules(), tmp_path / "out", settings(lanes(tmp_path)))
    (why,) = done.tally.reasons
    assert f"not judged  1:\n  1: {why} (r000)\n" in as_text(done)


def test_a_table_without_rows_has_no_drives(folder_of, expected, traces, tmp_path):
    empty = tmp_path / "empty.parquet"
    parquet.write_table(traces.slice(0, 0), empty)
    done = run([folder_of, empty], tmp_path / "out")
    assert (done.tally.judged, done.problems) == (DRIVES, ())
    assert found_in(tmp_path / "out") == expected
    assert not run([empty], tmp_path / "none").is_complete


def test_a_file_that_is_meant_twice_is_judged_once(folder_of, expected, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paths = sorted(folder_of.glob("*.parquet"))
    (tmp_path / "link.parquet").symlink_to(paths[0])
    spelt = [folder_of, paths[0], os.path.relpath(paths[-1]), tmp_path / "link.parquet"]
    assert fleet_inputs([str(one) for one in spelt]).tables == tuple(map(str, paths))
    run(spelt, tmp_path / "out")
    assert found_in(tmp_path / "out") == expected


def test_texts_may_be_views_and_names_may_end_in_capitals(expected, traces, tmp_path):
    views = [
        (one.name, pyarrow.string_view() if one.type == pyarrow.string() else one.type)
        for one in traces.schema
    ]
    (tmp_path / "in").mkdir()
    parquet.write_table(traces.cast(pyarrow.schema(views)), tmp_path / "in/A.PARQUET")
    run([tmp_path / "in"], tmp_path / "out")
    assert found_in(tmp_path / "out") == expected
    judge = FleetJudge(fleet_rules())
    assert in_order(judge(traces.cast(pyarrow.schema(views)))) == in_order(judge(traces))
    few = list(rulec.read_traces(tmp_path / "in/A.PARQUET"))
    assert len(few) == DRIVES


PAGE = (Path(__file__).resolve().parents[2] / "docs/fleet.md").read_text(encoding="utf-8")


def asked_of_duckdb(out):
    """What the page asks, of this folder of findings."""
    questions = re.findall(r"^```sql\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    return [duckdb.sql(text.replace("'findings/", f"'{out}/")) for text in questions]


def rates_of_duckdb(out):
    """The rates that the page asks for, by rule; they are those of rulec."""
    found = asked_of_duckdb(out)[2]
    rates = [dict(zip(found.columns, row, strict=True)) for row in found.fetchall()]
    expected = {row["rule"]: row for row in rulec.rates_of_findings(out).rows()}
    assert {row["rule"] for row in rates} <= expected.keys()
    for row in rates:
        own = {name: expected[row["rule"]][name] for name in row}
        assert row == pytest.approx(own, nan_ok=False), row["rule"]
    return {row["rule"]: row for row in rates}


def test_rates_of_duckdb_are_those_of_rulec(folder_of, tmp_path):
    """Traces, whose distance nobody knows, and tracks; of 22 drives 14 break some rule."""
    parquet.write_table(pyarrow.table(tracks([0, 1, 3, 6])), folder_of / "tracks.parquet")
    run([folder_of], tmp_path / "out", road_map=lanes(tmp_path))
    by_rule = rates_of_duckdb(tmp_path / "out")
    # Two of three vehicles in each recording that is too fast, and each third trace.
    assert (by_rule["slowly"]["violated"], by_rule["slowly"]["drives"]) == (2 * 3 + 4, 22)
    assert by_rule["slowly"]["per_1000_km"] > 0
    assert any(row["perhaps_violated"] > row["violated"] for row in by_rule.values())


def test_a_rule_that_may_have_applied_and_was_then_kept_has_the_same_rate(folder_of, tmp_path):
    run([folder_of], tmp_path / "out")
    idle = rates_of_duckdb(tmp_path / "out")["never_so_fast"]
    assert idle["opportunities"] == 0 < idle["perhaps_opportunities"]
    assert idle["perhaps_per_opportunity"] == 0


def test_what_the_page_asks_duckdb_is_what_the_summary_says(folder_of, tmp_path):
    done = run([folder_of], tmp_path / "out")
    rules = done.tally.rules
    counts, found_ones, _, twice = (found.fetchall() for found in asked_of_duckdb(tmp_path / "out"))
    outcomes = ("violated", "open", "not_judged")
    assert counts == [
        (name, *(rules[name, one] for one in outcomes)) for name in sorted({x for x, _ in rules})
    ]
    assert len(found_ones) == sum(n for (_, outcome), n in rules.items() if outcome == "violated")
    assert rules["slowly", "violated"] == len(range(0, DRIVES, 3))
    assert rules["distance", "violated"] == len(range(1, DRIVES, 3))
    assert twice == []


def test_engines_that_are_not_installed_say_how_to_get_them(folder_of, tmp_path, monkeypatch):
    for engine, module in (("ray", "ray"), ("spark", "pyspark.sql")):
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(RulecError, match="R0713") as raised:
            run([folder_of], tmp_path / engine, engine=engine)
        assert f"[{engine}]'`" in raised.value.diagnostics[0].help
        assert not (tmp_path / engine).exists()


def test_drives_are_judged_without_pandas(folder_of, tmp_path):
    """It is not asked for, and would take a third of a second and 40 MB of each process."""
    parquet.write_table(pyarrow.table(tracks([0, 1])), folder_of / "tracks.parquet")
    (tmp_path / "pandas.py").write_text("raise SystemExit('pandas is imported')")
    inputs = [folder_of, "-r", fleet_file(tmp_path), "--map", lanes(tmp_path), "-o", "out"]
    call = [sys.executable, "-m", "rulec", "fleet", *inputs, "-j", "1"]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (1, b"")
    assert b"16 judged" in done.stdout


def test_without_arrow_nothing_is_written(folder_of, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(RulecError, match=r"takes the package `pyarrow`.*R0706"):
        run([folder_of], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_recording_whose_name_is_no_text(tmp_path):
    """A folder holds names in any encoding, of which Python makes halves of surrogate pairs."""
    drives = tmp_path / "drives"
    drives.mkdir()
    Path(three_cars(drives)).rename(drives / os.fsdecode(b"k\xf8re.xml"))
    first, again = (run([drives], tmp_path / "found") for _ in range(2))
    assert (first.before, first.units, first.problems) == (0, 1, ())
    assert (again.before, again.units) == (1, 1)


def csv_of(columns):
    names = ",".join(columns)
    rows = [",".join(map(str, row)) for row in zip(*columns.values(), strict=True)]
    return "\n".join([names, *rows, ""])


@pytest.mark.parametrize("name", ["recording", "RECORDING", "recordng", "recording_id"])
def test_recordings_of_one_table_never_share_a_road(name, tmp_path, monkeypatch):
    """Only Parquet has several recordings; elsewhere cars would follow those of other ones."""
    monkeypatch.chdir(tmp_path)
    lanes(tmp_path)
    columns = tracks([0, 1])
    columns = {name: columns.pop("recording"), **columns}
    columns["track"] = [f"{a}{b}" for a, b in zip(columns[name], columns["track"], strict=True)]
    Path("t.csv").write_text(csv_of(columns))
    inputs = ["t.csv"]
    if name != "recording":
        Path("tables").mkdir()
        parquet.write_table(pyarrow.table(columns), "tables/t.parquet")
        inputs.append("tables")
    done = run(inputs, tmp_path / "out", road_map=Path("fleet.lanes.csv"))
    assert done.tally.judged == 0
    assert done.tally.reasons.total() == len(inputs)
    assert all("has the tracks of 2 recordings" in why for why in done.tally.reasons)
    with pytest.raises(RulecError, match="they would be taken to share one road"):
        rulec.read_recording("t.csv", "fleet.lanes.csv")
    # Of one recording, the column may be there
    one = {own: values[: columns[name].index("r001")] for own, values in columns.items()}
    Path("t.csv").write_text(csv_of(one))
    assert rulec.read_recording("t.csv", "fleet.lanes.csv").participants


def test_a_damaged_table_in_a_folder_is_reported(tmp_path, capsys):
    folder = tmp_path / "tables"
    folder.mkdir()
    for number in (0, 1):
        parquet.write_table(pyarrow.table(tracks([number])), folder / f"r{number}.parquet")
    (folder / "r1.parquet").write_bytes((folder / "r1.parquet").read_bytes()[:-40])
    (folder / "r2.parquet").write_bytes(b"")
    command = ["fleet", str(folder), "--map", str(lanes(tmp_path)), "-r", "esterle2019"]
    assert main([*command, "-o", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    for name in ("r1", "r2"):
        assert f" --> {folder / name}.parquet\n" in err
    assert "r0" not in err


def test_what_is_odd_about_recordings_is_told(tmp_path):
    columns = tracks([0])
    columns["speed"] = [20 * 1.6 if name == "a" else 8 * 1.6 for name in columns["track"]]
    path = tmp_path / "t.parquet"
    parquet.write_table(pyarrow.table(columns), path)
    done = run([path], tmp_path / "out", road_map=lanes(tmp_path))
    (remark,) = (own for own in done.tally.remarks if "what places and times say" in own)
    assert done.tally.remarks[remark] == 3
    assert f"note        3 drives: {remark} (as in " in as_text(done)
    rows = _rows(tmp_path / "out")
    assert {tuple(row["remarks"]) for row in rows if row["kind"] == "drive"} == {
        tuple(done.tally.remarks)
    }
    assert {tuple(row["remarks"]) for row in rows if row["kind"] != "drive"} == {()}


@pytest.mark.parametrize("book", ["de", "esterle2019", "./mixed.rules"])
def test_drives_are_counted_as_by_verify(book, tmp_path, capsys, monkeypatch):
    """Violated, open, nothing found and only soft rules, of the same drives."""
    samples = Path("docs/samples").resolve()
    monkeypatch.chdir(tmp_path)
    Path("mixed.rules").write_text(
        "rulebook mixed\nuse road\nhard rule dry { require never wet }\n"
        "soft rule slow { require always speed <= 40 km/h }\n"
    )
    files = [str(samples / name) for name in ("following.xml", "passing.fcd.xml")]
    main(["fleet", *files, "-r", book, "-o", "found", "--map", str(samples / "passing.net.xml")])
    (line,) = [x for x in capsys.readouterr().out.splitlines() if x.startswith("drives ")]
    main(["verify", *files, "-r", book, "--map", str(samples / "passing.net.xml")])
    last = capsys.readouterr().out.splitlines()[-1]
    counts = re.sub(r", \d+ not judged$", "", last.partition(": ")[2])
    assert line.partition("judged: ")[2] == counts
