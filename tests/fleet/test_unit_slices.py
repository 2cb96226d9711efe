"""A unit's drives in slices: whole, found wherever their rows are, and few rows at a time."""

import random

import pyarrow
import pytest
from pyarrow import parquet

from rulec.diagnostics import RulecError
from rulec.fleet.runs import unit_work
from rulec.fleet.runs import work_units as units_module
from rulec.fleet.runs.unit_work import slices_of_unit
from rulec.fleet.runs.work_units import work_units

MOST, AT_ONCE = 60, 25


@pytest.fixture(autouse=True)
def _small(monkeypatch):
    monkeypatch.setattr(unit_work, "MOST_TOGETHER", MOST)
    monkeypatch.setattr(unit_work, "_FEWEST_MERGED", 10)
    monkeypatch.setattr(units_module, "ROWS_AT_ONCE", AT_ONCE)
    monkeypatch.setattr(units_module, "MOST_ROWS", 200)


def table_of(drives, rows):
    """A table of so many drives with so many rows each, every row told apart."""
    names = [f"t{drive}" for drive in range(drives) for _ in range(rows)]
    numbers = list(range(drives * rows))
    return pyarrow.table({"trace": names, "step": [n % rows for n in numbers], "n": numbers})


def written(folder, table, cuts, row_group):
    """The table in files that end at the cuts."""
    ends = [*cuts, len(table)]
    for number, (start, stop) in enumerate(zip([0, *cuts], ends, strict=True)):
        path = folder / f"{number}.parquet"
        parquet.write_table(table.slice(start, stop - start), path, row_group_size=row_group)
    return sorted(map(str, folder.glob("*.parquet")))


def slices_in(paths):
    """The slices of all units of some files."""
    return [part for unit in work_units(paths, []) for part in slices_of_unit(unit)]


def checked(parts, drives, rows):
    """Each drive is whole and in one slice only, its rows in order; a slice is small."""
    seen = {}
    for number, part in enumerate(parts):
        assert len(part) <= max(MOST, rows)
        own = {}
        for name, n in zip(part["trace"].to_pylist(), part["n"].to_pylist(), strict=True):
            assert seen.setdefault(name, number) == number
            own.setdefault(name, []).append(n)
        for name, numbers in own.items():
            first = int(name[1:]) * rows
            assert sorted(numbers) == list(range(first, first + rows))
    assert len(seen) == drives


@pytest.mark.parametrize("seed", range(16))
def test_slices_hold_whole_drives_however_they_are_cut_and_mixed(seed, tmp_path):
    chosen = random.Random(seed)
    drives, rows = chosen.randint(1, 20), chosen.choice([1, 7, 20, 70])
    table = table_of(drives, rows)
    if seed % 2:
        table = table.take(chosen.sample(range(len(table)), len(table)))
    cuts = sorted(chosen.sample(range(1, len(table)), min(chosen.randint(0, 3), len(table) - 1)))
    parts = slices_in(written(tmp_path, table, cuts, chosen.choice([8, 50, 10_000])))
    checked(parts, drives, rows)


def test_a_drive_that_goes_on_with_columns_of_other_types_is_said(tmp_path):
    table = table_of(3, 20)
    first, last = table.slice(0, 30), table.slice(30)
    texts = last.set_column(2, "n", last["n"].cast(pyarrow.string()))
    paths = [*written(tmp_path, first, [], 100), str(tmp_path / "later.parquet")]
    parquet.write_table(texts, paths[-1])
    units = list(work_units(paths, []))
    with pytest.raises(RulecError, match=r"0.parquet.*other types.*incompatible types.*R0710"):
        list(slices_of_unit(units[0]))
    assert [part["trace"].to_pylist() for part in slices_of_unit(units[1])] == [["t2"] * 20]


@pytest.mark.parametrize("drives", [10, 100, 1_000])
def test_rows_that_are_held_do_not_grow_with_the_number_of_drives(drives, tmp_path, monkeypatch):
    """Drives that stand together in one row group: each row is read once, and few at a time."""
    rows = 4
    read = []
    most = []
    theirs = unit_work.keyed_rows

    def watched(source, groups, path, *, whole):
        for some in theirs(source, groups, path, whole=whole):
            if whole:
                read.append(len(some.codes))
            most.append(len(some.codes))
            yield some

    monkeypatch.setattr(unit_work, "keyed_rows", watched)
    parts = slices_in(written(tmp_path, table_of(drives, rows), [], 1 << 20))
    checked(parts, drives, rows)
    assert max(most) <= AT_ONCE
    assert sum(read) == drives * rows
    assert max(map(len, parts)) <= MOST
