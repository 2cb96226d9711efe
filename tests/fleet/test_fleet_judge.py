"""A table of tracks or traces in, a table of findings out: whatever the order, wherever it runs."""

import pickle
import random
import subprocess
import sys
from pathlib import Path

import pyarrow
import pytest
from pyarrow import compute

import rulec
from rulec.fleet import FleetJudge, arrow_schema
from support.builders.fleet_inputs import fleet_file, fleet_rules, lanes, trace_table, tracks

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fleet")


@pytest.fixture(scope="module")
def judge(folder):
    return FleetJudge(fleet_file(folder), lanes(folder))


@pytest.fixture(scope="module")
def table():
    return pyarrow.table(tracks([0, 1]))


@pytest.fixture(scope="module")
def findings(judge, table):
    return judge(table)


@pytest.fixture(scope="module")
def traces():
    return trace_table(range(12))


def shuffled(table, seed):
    places = list(range(len(table)))
    random.Random(seed).shuffle(places)
    return table.take(places)


def rows_of(table, kind="drive", *names):
    rows = (row for row in table.to_pylist() if row["kind"] == kind)
    return [tuple(row[name] for name in names) for row in rows]


def test_every_recording_of_a_table_is_judged_by_itself(findings):
    assert findings.schema == arrow_schema()
    drives = rows_of(findings, "drive", "recording", "vehicle", "outcome")
    # The first recording has two that are too fast, the second one that is too near
    assert drives == [
        ("r000", "a", "violated"),
        ("r000", "b", "violated"),
        ("r000", "c", "kept"),
        ("r001", "a", "violated"),
        ("r001", "b", "kept"),
        ("r001", "c", "kept"),
    ]
    lost = rows_of(findings, "finding", "recording", "vehicle", "rule", "other", "outcome")
    assert [row for row in lost if row[-1] == "violated"] == [
        ("r000", "a", "slowly", [], "violated"),
        ("r000", "b", "slowly", [], "violated"),
        ("r001", "a", "distance", ["b"], "violated"),
    ]


def test_rows_may_be_in_any_order_and_the_judge_may_be_a_copy(judge, table, findings, traces):
    copy = pickle.loads(pickle.dumps(judge))
    assert copy(shuffled(table, 1)).equals(findings)
    assert copy(shuffled(traces, 2)).equals(judge(traces))
    assert repr(copy) == repr(judge)


def test_compiled_rulebooks_in_whatever_form_judge_alike(folder, traces, judge):
    expected = judge(traces)
    path = fleet_file(folder)
    for rules in (str(path), path.read_bytes(), fleet_rules(), rulec.compile_rulebook(path)):
        assert FleetJudge(rules)(traces).equals(expected)


def test_a_trace_is_judged_as_verify_judges_it(traces, judge, tmp_path):
    found = rows_of(judge(traces), "finding", "vehicle", "rule", "outcome", "state")
    file = tmp_path / "traces.parquet"
    pyarrow.parquet.write_table(traces, file)
    expected = []
    for trace in rulec.read_traces(file):
        verdict = rulec.verify(trace, fleet_rules())
        expected += [(trace.id, x.rule, "violated", x.step) for x in verdict.violations]
        expected += [(trace.id, x.rule, "open", None) for x in verdict.open]
    assert sorted(found, key=str) == sorted(expected, key=str)
    assert {outcome for _, _, outcome, _ in found} == {"violated", "open"}


def test_an_empty_batch_has_no_findings(judge, table):
    assert judge(table.slice(0, 0)).equals(arrow_schema().empty_table())
    (batch,) = table.to_batches()
    assert judge(batch.slice(0, 0)).num_rows == 0


def test_traces_that_are_cut_are_refused(traces, folder):
    first = len(traces.filter(compute.equal(traces["trace"], "t000")))
    for part, why in (
        (traces.slice(first // 2), r"`t000` is cut: it begins with step [1-9]"),
        (traces.filter(compute.not_equal(traces["step"], 3)), "`t000` is cut: step 3 is missing"),
    ):
        with pytest.raises(rulec.RulecError, match=why):
            FleetJudge(fleet_rules())(part)


def test_rows_of_a_drive_in_two_batches_are_refused(table, traces, folder):
    for whole, cut in ((table, 20), (traces, 9)):
        fresh = FleetJudge(fleet_rules(), lanes(folder))
        with pytest.raises(rulec.RulecError, match="is cut"):
            (fresh(whole.slice(0, cut)), fresh(whole.slice(cut)))


def test_a_batch_that_comes_again_is_judged_again(table, findings, judge):
    assert judge(table).equals(findings)


def test_a_column_that_counts_rows_shows_what_is_missing_at_once(table, traces, folder):
    for whole, key, name in ((table, "recording", "r000"), (traces, "trace", "t000")):
        counts = compute.value_counts(whole[key]).to_pylist()
        rows = {one["values"]: one["counts"] for one in counts}
        known = whole.append_column("rows", [[rows[one] for one in whole[key].to_pylist()]])
        own = known.filter(compute.equal(known[key], name))
        assert FleetJudge(fleet_rules(), lanes(folder))(own).num_rows
        part = own.slice(0, len(own) - 1)
        with pytest.raises(
            rulec.RulecError, match=rf"{len(own) - 1} of {len(own)} rows are there \[R0709\]"
        ):
            FleetJudge(fleet_rules(), lanes(folder))(part)
        reported = FleetJudge(fleet_rules(), lanes(folder), grouped=True)(part)
        (row,) = rows_of(reported, "drive", "outcome", "because")
        assert row == ("not_judged", f"{len(own) - 1} of {len(own)} rows are there")


def test_where_all_rows_are_there_a_gap_is_reported_and_the_others_are_judged(traces):
    gap = compute.and_(compute.equal(traces["trace"], "t001"), compute.equal(traces["step"], 3))
    judge = FleetJudge(fleet_rules(), grouped=True)
    names = ("vehicle", "outcome", "because")
    found = {
        name: about
        for name, *about in rows_of(judge(traces.filter(compute.invert(gap))), "drive", *names)
    }
    assert found.pop("t001") == ["not_judged", "step 3 is missing"]
    whole = {name: about for name, *about in rows_of(judge(traces), "drive", *names)}
    assert whole.pop("t001") == ["violated", ""]
    assert found == whole


def test_another_step_is_reported_with_its_reason(traces, folder):
    column = traces.column_names.index("step_s")
    slower = traces.set_column(column, "step_s", pyarrow.array([0.25] * len(traces)))
    for_one_step = rulec.compile_rulebook(fleet_file(folder), step_s=0.1)
    found = FleetJudge(for_one_step)(slower)
    rows = rows_of(found, "drive", "outcome", "because")
    assert len(rows) == 12
    (row,) = set(rows)
    assert row[0] == "not_judged"
    assert "steps of 0.1 s; the trace has steps of 0.25 s" in row[1]


def test_a_recording_that_cannot_be_read_is_reported_and_the_next_is_judged(table, judge, folder):
    names, x = table["recording"].to_pylist(), table["x"].to_pylist()
    far = [value + 1e6 * (name == "r000") for name, value in zip(names, x, strict=True)]
    moved = table.set_column(3, "x", pyarrow.array(far))
    found = FleetJudge(fleet_rules(), lanes(folder))(moved)
    drives = rows_of(found, "drive", "recording", "outcome", "because")
    assert drives[0][:2] == ("r000", "not_judged")
    assert "nobody is near the roads" in drives[0][2]
    assert [row[:2] for row in drives[1:]] == [("r001", x) for x in ("violated", "kept", "kept")]


def with_no_text(table, name, row, *, packed):
    """A table of which one cell, of a column of texts, holds bytes that are not UTF-8."""
    cells = [None if cell is None else cell.encode() for cell in table[name].to_pylist()]
    cells[row] = b"\xe3(x"
    texts = pyarrow.array(cells, pyarrow.binary()).view(pyarrow.string())
    texts = texts.dictionary_encode() if packed else texts
    return table.set_column(table.column_names.index(name), name, texts)


@pytest.mark.parametrize("packed", [False, True])
def test_a_drive_with_a_text_that_is_not_utf8_is_reported_and_the_others_are_judged(
    table, traces, folder, findings, packed
):
    judge = FleetJudge(fleet_rules(), lanes(folder))
    names = ("vehicle", "outcome", "because")
    row = traces["trace"].to_pylist().index("t004")
    for name in ("object", "type"):
        odd = with_no_text(traces, name, row, packed=packed)
        found = {drive: about for drive, *about in rows_of(judge(odd), "drive", *names)}
        why = f"the column `{name}` has a text that is not UTF-8"
        assert found.pop("t004") == ["not_judged", why]
        whole = {drive: about for drive, *about in rows_of(judge(traces), "drive", *names)}
        assert whole.pop("t004")[0] == "violated"
        assert found == whole
    found = FleetJudge(fleet_rules(), lanes(folder))(with_no_text(table, "track", 0, packed=packed))
    first, *others = rows_of(found, "drive", "recording", "outcome", "because")
    assert first == ("r000", "not_judged", "the column `track` has a text that is not UTF-8")
    assert others == rows_of(findings, "drive", "recording", "outcome", "because")[3:]


@pytest.mark.parametrize("packed", [False, True])
def test_a_table_whose_drives_have_no_readable_names_is_refused(table, traces, judge, packed):
    for own, name in ((table, "recording"), (traces, "trace")):
        message = rf"column `{name}` has a text that is not UTF-8 \[R0710\]"
        with pytest.raises(rulec.RulecError, match=message):
            judge(with_no_text(own, name, 1, packed=packed))


def test_a_table_may_name_its_map_and_its_file(table, folder, findings):
    more = table.append_column("map", [[str(lanes(folder))] * len(table)])
    more = more.append_column("file", [["a.parquet"] * len(table)])
    found = FleetJudge(fleet_rules())(more)
    assert set(rows_of(found, "finding", "file")) == {("a.parquet",)}
    at = found.column_names.index("file")
    assert found.set_column(at, "file", findings["file"]).equals(findings)
    (row,) = set(rows_of(FleetJudge(fleet_rules())(table), "drive", "outcome"))
    assert row == ("not_judged",)


def test_what_is_no_table_of_drives_is_refused(judge, tmp_path):
    with pytest.raises(
        rulec.RulecError, match=r"neither tracks nor traces; its columns are `a` \[R0710\]"
    ):
        judge(pyarrow.table({"a": [1]}))
    with pytest.raises(TypeError, match=r"not a dict; with Ray.*batch_format='pyarrow'"):
        judge({"trace": ["a"]})
    with pytest.raises(rulec.RulecError, match=r"`de` is no compiled rulebook \[R0711\]"):
        FleetJudge("de")
    with pytest.raises(rulec.RulecError, match="not a compiled rulebook"):
        FleetJudge(b"{}")


JUDGE_ALONE = """
import sys
for name in ("spot", "buddy", "lark", "pint"):
    sys.modules[name] = None
import pyarrow.parquet
from rulec.fleet import FleetJudge
folder = sys.argv[1]
judge = FleetJudge(f"{folder}/fleet_rules.json", f"{folder}/fleet.lanes.csv")
for name in ("tracks", "traces"):
    table = pyarrow.parquet.read_table(f"{folder}/{name}.parquet")
    pyarrow.parquet.write_table(judge(table), f"{folder}/{name}.found.parquet")
"""


def test_neither_spot_nor_a_parser_is_needed(folder, table, traces, findings, judge):
    fleet_file(folder)
    pyarrow.parquet.write_table(table, folder / "tracks.parquet")
    pyarrow.parquet.write_table(traces, folder / "traces.parquet")
    subprocess.run([sys.executable, "-c", JUDGE_ALONE, folder], check=True, cwd=ROOT)
    for name, expected in (("tracks", findings), ("traces", judge(traces))):
        assert pyarrow.parquet.read_table(folder / f"{name}.found.parquet").equals(expected)
