"""Rates of small tables of findings, worked out by hand."""

import json

import pytest
from scipy import stats

from rulec.diagnostics import RulecError
from rulec.rates.rule_rates import rates_of_findings
from rulec.report.rates.rates_table import as_text
from rulec.trace.formats.arrow.parquet import write_parquet

BY = {"rulebook": "de", "rulebook_hash": "abcdefgh1", "rulec": "1.0", "thresholds": ""}


def drive(name, *rules, hours=1.0, km=50.0, file="a.xml", **own):
    """A drive's row and those of its rules: name, opportunities and how many were taken."""
    shared = {**BY, "file": file, "vehicle": name, **own}
    far = {} if km is None else {"distance_m": 1000 * km}
    rows = [{**shared, "kind": "drive", "outcome": "kept", "duration_s": 3600 * hours, **far}]
    for rule, opportunities, violated, *perhaps in rules:
        row = {**shared, "kind": "rule", "rule": rule, "outcome": "kept", "strength": "hard"}
        if opportunities is None:
            row["outcome"] = "not_judged"
        else:
            row |= {"opportunities": opportunities, "violated": violated, "opportunities_s": 36.0}
            if perhaps:
                row |= {"perhaps_opportunities": perhaps[0], "perhaps_violated": perhaps[1]}
        rows.append(row)
    return rows


@pytest.fixture
def write(tmp_path):
    def written(*drives, name="found.jsonl"):
        lines = [json.dumps(row) for rows in drives for row in rows]
        path = tmp_path / name
        path.write_text("\n".join([*lines, ""]))
        return str(path)

    return written


def only(path, by=(), **settings):
    (rule,) = rates_of_findings([path], by, **settings).rules
    return rule


def test_rates_by_hand(write):
    """10 violations in 4 h, 200 km and 40 opportunities."""
    found = only(
        write(*[drive(f"v{n}", ("stop", 10, taken)) for n, taken in enumerate([4, 3, 3, 0])])
    )
    assert (found.drives, found.hours, found.km) == (4, 4.0, 200.0)
    assert (found.opportunities, found.violated, found.exposed_h) == (40, 10, pytest.approx(0.04))
    assert found.per_hour.least == found.per_hour.most == 2.5
    # Poisson's interval for 10 is 4.795 to 18.390, Clopper and Pearson's for 10 of 40 12.69 to
    # 41.20 %.
    assert found.per_hour.exact == pytest.approx((4.795 / 4, 18.390 / 4), abs=1e-3)
    assert found.per_1000_km.least == 50
    assert found.per_1000_km.exact == pytest.approx((5 * 4.795, 5 * 18.390), abs=5e-3)
    assert found.per_opportunity.least == 0.25
    assert found.per_opportunity.exact == pytest.approx((0.1269, 0.4120), abs=5e-5)
    low, high = found.per_opportunity.bootstrap
    # No four drives have fewer than none violated or more than four of ten each.
    assert 0 <= low < 0.25 < high <= 0.4
    # Fay and Feuer's: 10 violations, whose squares sum up to 34, and a drive of 10 not seen.
    low, high = found.per_hour.clustered
    assert low == pytest.approx(stats.gamma.ppf(0.025, 100 / 34) * 3.4 / 4)
    assert high == pytest.approx(stats.gamma.ppf(0.975, 400 / 134) * 6.7 / 4)
    assert found.per_1000_km.clustered == pytest.approx((20 * low, 20 * high))
    # Twelve of ten opportunities is more than all.
    assert found.per_opportunity.clustered == (pytest.approx(low / 10), 1.0)


def test_what_is_open_gives_two_rates(write):
    """2 of 10 violated for sure; 3 more may have been opportunities, 4 more may be violated."""
    found = only(write(drive("v", ("stop", 10, 2, 13, 6), hours=2.0)))
    assert (found.per_hour.least, found.per_hour.most) == (1.0, 3.0)
    assert found.per_opportunity.least == pytest.approx(2 / 13)
    assert found.per_opportunity.most == pytest.approx(6 / 10)
    low, high = found.per_opportunity.exact
    assert low < 2 / 13
    assert high > 6 / 10


def test_no_violation_has_an_upper_bound_and_no_bootstrap(write):
    found = only(write(drive("v", ("stop", 10, 0)), drive("w", ("stop", 0, 0))))
    assert found.per_hour.exact == pytest.approx((0.0, 3.689 / 2), abs=1e-3)
    assert found.per_opportunity.exact == pytest.approx((0.0, 0.3085), abs=1e-4)
    assert found.per_hour.bootstrap is None
    # Poisson's for none is 3.689, of drives that violate ten times each.
    assert found.per_hour.clustered == pytest.approx((0.0, 36.89 / 2), abs=1e-2)
    assert found.per_opportunity.clustered == (0.0, 1.0)


def test_drives_in_which_a_rule_is_not_judged_are_none_of_its_exposure(write):
    found = only(write(drive("v", ("stop", 1, 1)), drive("w", ("stop", None, None), hours=9.0)))
    assert (found.drives, found.hours, found.km) == (1, 1.0, 50.0)


def test_violations_of_drives_of_unknown_length_are_no_part_of_the_rate_of_distance(write):
    found = only(write(drive("v", ("stop", 1, 1)), drive("w", ("stop", 1, 1), km=None)))
    assert (found.violated, found.km) == (2, 50.0)
    assert found.per_1000_km.least == 20


def test_one_drive_is_no_sample_of_drives(write):
    assert only(write(drive("v", ("stop", 2, 1)))).per_hour.bootstrap is None


def test_a_drive_without_a_verdict_is_counted_apart(write):
    (row, _) = drive("w", ("stop", 0, 0))
    rates = rates_of_findings(
        [write(drive("v", ("stop", 1, 0)), [row | {"outcome": "not_judged"}])]
    )
    assert (rates.drives, rates.not_judged) == (1, 1)


def test_groups(write):
    path = write(
        drive("v", ("stop", 2, 1), country="DEU", road="motorway"),
        drive("w", ("stop", 4, 0), country="DEU", road="built-up"),
        drive("x", ("stop", 1, 1), country="USA", road="motorway"),
    )
    found = rates_of_findings([path], ["country", "road"])
    assert [(one.group, one.opportunities, one.violated) for one in found.rules] == [
        (("DEU", "built-up"), 4, 0),
        (("DEU", "motorway"), 2, 1),
        (("USA", "motorway"), 1, 1),
    ]
    assert [row["road"] for row in found.rows()] == ["built-up", "motorway", "motorway"]


def test_order_and_files_make_no_difference(write, tmp_path):
    drives = [drive(f"v{n}", ("stop", 3, n % 2), ("give_way", n, 0)) for n in range(5)]
    together = rates_of_findings([write(*drives)])
    rows = [row for rows in reversed(drives) for row in reversed(rows)]
    (tmp_path / "fleet" / "part").mkdir(parents=True)
    columns = {name: type(value) for row in rows for name, value in row.items()}
    for number, part in enumerate((rows[:4], rows[4:])):
        with (tmp_path / "fleet" / "part" / f"{number}.parquet").open("wb") as stream:
            table = [[row.get(name) for name in columns] for row in part]
            write_parquet(table, list(columns.items()), stream, "p")
    (tmp_path / "fleet" / "_half").mkdir()
    (tmp_path / "fleet" / "_half" / "unfinished.parquet").write_bytes(b"PAR1")
    apart = rates_of_findings([str(tmp_path / "fleet")])
    key = lambda rule: rule.rule  # noqa: E731 - said once, used twice
    assert sorted(together.rules, key=key) == sorted(apart.rules, key=key)


@pytest.mark.parametrize("field", ["rulebook_hash", "rulec", "thresholds", "assumptions"])
def test_what_was_judged_otherwise_is_not_added_up(write, field):
    first = write(drive("v", ("stop", 1, 0)))
    second = write(drive("w", ("stop", 1, 0), **{field: "other"}), name="other.jsonl")
    with pytest.raises(RulecError) as refused:
        rates_of_findings([first, second])
    (told,) = refused.value.diagnostics
    assert told.code == "R0715"
    assert told.place.file == second
    assert first in told.message


def test_rulebooks_that_are_told_apart_are_rated_side_by_side(write):
    path = write(
        drive("v", ("stop", 1, 0)), drive("v", ("stop", 2, 0), rulebook="gb", rulebook_hash="x")
    )
    found = rates_of_findings([path], ["rulebook"])
    assert [(one.rulebook, one.opportunities) for one in found.rules] == [("de", 1), ("gb", 2)]


def test_versions_of_one_rulebook_are_told_apart_by_their_hashes(write):
    path = write(drive("v", ("stop", 1, 0)), drive("v", ("stop", 2, 0), rulebook_hash="0123456789"))
    found = rates_of_findings([path], ["rulebook"])
    names = ["de (01234567)", "de (abcdefgh)"]
    assert sorted((one.rulebook, one.group) for one in found.rules) == [(x, (x,)) for x in names]


ONE = drive("v", ("stop", 1, 0))
REFUSED = {
    "a drive twice": [*ONE, *ONE],
    "a rule without its drive": ONE[1:],
    "no drives": [{"kind": "finding", "rule": "stop"}],
    "no kinds": [{"file": "a.xml", "rule": "stop", "outcome": "violated"}],
    "a text for a number": [ONE[0] | {"duration_s": "long"}],
    "a number that is none": [ONE[0] | {"duration_s": float("nan")}],
    "more violated than there were": [ONE[0], ONE[1] | {"violated": 2}],
    "a negative one": [ONE[0], ONE[1] | {"opportunities": -1}],
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_table_of_drives_is_refused(write, case):
    with pytest.raises(RulecError) as refused:
        rates_of_findings([write(REFUSED[case])])
    assert {told.code for told in refused.value.diagnostics} == {"R0716"}


@pytest.mark.parametrize("text", ["no JSON", "[1]", "[" * 100_000])
def test_a_file_of_something_else_is_refused(tmp_path, text):
    path = tmp_path / "a.jsonl"
    path.write_text(text)
    with pytest.raises(RulecError):
        rates_of_findings([str(path)])


def test_a_folder_without_tables_is_refused(tmp_path):
    with pytest.raises(RulecError):
        rates_of_findings([str(tmp_path)])


@pytest.mark.parametrize("width", [60, 80, 120])
def test_rates_fit_a_width(write, width):
    name = "a_rule_with_a_name_that_takes_more_than_half_of_a_line_of_eighty"
    path = write(
        *[drive(f"v{n}", (name, 10, taken), ("stop", 9, 1)) for n, taken in enumerate([4, 3])]
    )
    text = as_text(rates_of_findings([path], ()), width)
    assert max(map(len, text.splitlines())) <= width
    for column in ("opportunities", "violated", "per hour", "per 1000 km", "per opportunity"):
        assert column in text
