"""Rates of violations by rule and group, with their intervals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from rulec.rates.drive_counts import Counted, DriveCounts, GroupKey, RuleTitle
from rulec.rates.exact_intervals import (
    DRIVES_TOGETHER,
    REPLICATES,
    ClusterSizes,
    Interval,
    Sums,
    binomial_interval,
    bootstrapped,
    clustered_interval,
    percentile_interval,
    poisson_interval,
)
from rulec.rates.finding_rows import FindingRow, finding_files, finding_rows
from rulec.value_display import Rows, short_repr

S_PER_HOUR = 3600.0

SHORTEST = 1e-9
"""A drive's duration (h) or distance (km) below this counts as 0: a rate might be infinite."""


@dataclass(frozen=True, slots=True)
class Rate:
    """A rate from ``least`` to ``most``, which differ if some verdict is open.

    ``exact`` is its interval if events are independent. ``bootstrap`` is the interval over drives,
    None if it says nothing: without violations, or for fewer than two drives. ``clustered`` is the
    interval if only drives are independent, and may violate at every opportunity.
    """

    least: float
    most: float
    exact: Interval
    bootstrap: Interval | None
    clustered: Interval


@dataclass(frozen=True, slots=True)
class RuleRates:
    """How often a rule was put to the test in a group of drives, and how often violated.

    ``drives`` are those in which it was judged, ``hours`` and ``km`` their total duration and
    distance; ``km`` is None if no distance is known. Opportunities and violations are the certain
    ones, and with ``perhaps_`` the most possible; ``exposed_h`` are the hours with an opportunity.
    A rate is None if there was nothing to divide by.
    """

    __repr__ = short_repr

    group: tuple[str, ...]
    rulebook: str
    rule: str
    provision: str
    strength: str
    drives: int
    hours: float
    km: float | None
    opportunities: int
    perhaps_opportunities: int
    exposed_h: float
    perhaps_exposed_h: float
    violated: int
    perhaps_violated: int
    per_hour: Rate | None
    per_1000_km: Rate | None
    per_opportunity: Rate | None


@dataclass(frozen=True)
class ViolationRates(Rows):
    """Rates of all rules, grouped ``by`` some properties.

    ``drives`` and ``not_judged`` are the numbers of drives with and without a verdict,
    ``judged_by`` says what they were judged by, ``confidence`` is that of the intervals.
    """

    __repr__ = short_repr

    by: tuple[GroupKey, ...]
    drives: int
    not_judged: int
    judged_by: tuple[FindingRow, ...]
    confidence: float
    replicates: int
    seed: int
    rules: tuple[RuleRates, ...]

    def rows(self) -> list[dict[str, Any]]:
        """One row per rule and group."""
        return [_as_row(rule, self.by) for rule in self.rules]


def violation_rates(
    counted: Counted, *, confidence: float = 0.95, seed: int = 0, replicates: int = REPLICATES
) -> ViolationRates:
    """The rates from counted findings. Raises RulecError R0717 without scipy."""
    groups: dict[tuple[str, tuple[str, ...]], list[DriveCounts]] = {}
    for (rulebook, *_), drive in sorted(counted.drives.items()):
        groups.setdefault((rulebook, drive.group), []).append(drive)
    result, called = [], _names(counted)
    for (rulebook, group), drives in sorted(groups.items(), key=lambda item: item[0][1]):
        rules = counted.rules.get(rulebook, {})
        name = called[rulebook]
        pairs = zip(counted.by, group, strict=True)
        group = tuple([name if key == "rulebook" else value for key, value in pairs])
        sums = _rule_sums(drives, list(rules), confidence, (seed, replicates))
        for own, (rule, title) in zip(sums, rules.items(), strict=True):
            result.append(_rule_rates(group, name, (rule, title), own))
    return ViolationRates(
        by=counted.by,
        drives=len(counted.drives),
        not_judged=counted.not_judged,
        judged_by=tuple(counted.judged_by.values()),
        confidence=confidence,
        replicates=replicates,
        seed=seed,
        rules=tuple(result),
    )


def _names(counted: Counted) -> dict[str, str]:
    """The name of each rulebook by its hash, with which it has to be told from one of its name."""
    names = {own: row.rulebook for own, row in counted.judged_by.items()}
    times = Counter(names.values())
    return {own: name if times[name] == 1 else f"{name} ({own[:8]})" for own, name in names.items()}


_COLUMNS = (
    "drives",
    "hours",
    "far",
    "km",
    "opportunities",
    "perhaps_opportunities",
    "exposed_h",
    "perhaps_exposed_h",
    "violated",
    "perhaps_violated",
    "violated_far",
    "perhaps_violated_far",
    "most_opportunities",
)
"""The columns summed over drives for each rule; ``far`` counts drives whose distance is known.

``most_opportunities`` is the number of certain opportunities, or of possible violations if larger.
"""

_AT = {name: place for place, name in enumerate(_COLUMNS)}


def _rule_sums(
    drives: Sequence[DriveCounts], rules: Sequence[str], confidence: float, drawn: tuple[int, int]
) -> Iterator[_RuleSums]:
    """The sums of each rule over drives, and over resampled ones: ``drawn`` are seed and number."""
    n_columns = len(rules) * len(_COLUMNS)

    def blocks() -> Iterator[Sums]:
        """The values (drives x columns) of the drives, block by block."""
        for begin in range(0, len(drives), DRIVES_TOGETHER):
            part = drives[begin : begin + DRIVES_TOGETHER]
            block = np.array([_numbers(drive, rules) for drive in part], dtype=np.float64)
            yield block.reshape(len(part), n_columns)

    total, squares, largest = np.zeros((3, n_columns))
    for block in blocks():
        total += block.sum(axis=0)
        squares += (block**2).sum(axis=0)
        np.maximum(largest, block.max(axis=0, initial=0.0), out=largest)
    # With fewer than two drives, drawing again says nothing.
    again = bootstrapped(len(drives), n_columns, blocks(), *drawn) if len(drives) > 1 else None
    for begin in range(0, n_columns, len(_COLUMNS)):
        own = slice(begin, begin + len(_COLUMNS))
        resampled = None if again is None else again[:, own]
        yield _RuleSums(total[own], squares[own], largest[own], resampled, confidence)


def _numbers(drive: DriveCounts, rules: Sequence[str]) -> list[float]:
    is_far = drive.distance_m is not None
    lengths = drive.duration_s / S_PER_HOUR, (drive.distance_m or 0.0) / 1000
    hours, km = (length if length >= SHORTEST else 0.0 for length in lengths)
    numbers: list[float] = []
    for rule in rules:
        if rule in drive.not_judged:
            numbers += [0.0] * len(_COLUMNS)
            continue
        counts = drive.rules.get(rule)
        numbers += (1.0, hours, is_far, km)
        if counts is None:
            numbers += [0.0] * (len(_COLUMNS) - 4)
            continue
        least, most = counts.violated
        numbers += (
            *counts.opportunities,
            *(seconds / S_PER_HOUR for seconds in counts.exposed_s),
            least,
            most,
            least * is_far,
            most * is_far,
            max(counts.opportunities[0], most),
        )
    return numbers


@dataclass(frozen=True, slots=True)
class _RuleSums:
    """The ``_COLUMNS`` of one rule: sums, sums of squares, largest values of a drive.

    ``drawn`` are the sums over resampled drives (replicates x columns).
    """

    total: Sums
    squares: Sums
    largest: Sums
    drawn: Sums | None
    confidence: float

    def __getitem__(self, name: str) -> float:
        return float(self.total[_AT[name]])

    def count(self, name: str) -> int:
        """A sum of whole numbers, as an int."""
        return round(self[name])

    def per_length(self, violated: tuple[str, str], length: str, scale: float) -> Rate | None:
        """The rate per ``scale`` units of a duration (h) or distance (km); None if that is 0."""
        if not self[length]:
            return None
        least, most = (self.count(name) for name in violated)
        factor = scale / self[length]
        low, high = poisson_interval(least, most, self.confidence)
        bootstrap = self._bootstrap(violated, (length, length))
        if bootstrap is not None:
            bootstrap = bootstrap[0] * scale, bootstrap[1] * scale
        fewest, highest = self._clustered(violated)
        return Rate(
            least * factor,
            most * factor,
            (low * factor, high * factor),
            bootstrap,
            (fewest * factor, highest * factor),
        )

    def per_opportunity(self) -> Rate | None:
        """The share of opportunities that were violated; None without opportunities."""
        if not self["most_opportunities"] and not self["perhaps_opportunities"]:
            return None
        violated, of = _VIOLATED, ("perhaps_opportunities", "most_opportunities")
        least, most = ((self.count(v), self.count(n)) for v, n in zip(violated, of, strict=True))
        fewest, highest = self._clustered(violated)
        return Rate(
            least[0] / least[1] if least[1] else 0.0,
            most[0] / most[1] if most[1] else 0.0,
            binomial_interval(least, most, self.confidence),
            self._bootstrap(violated, of),
            (
                min(fewest / least[1], 1.0) if least[1] else 0.0,
                min(highest / most[1], 1.0) if most[1] else 1.0,
            ),
        )

    def _clustered(self, violated: tuple[str, str]) -> Interval:
        """The interval of the expected number of violations, with drives as clusters."""
        least, most = (ClusterSizes(self[x], float(self.squares[_AT[x]])) for x in violated)
        most_of_a_drive = ("perhaps_opportunities", "most_opportunities")
        largest = max(float(self.largest[_AT[name]]) for name in most_of_a_drive)
        return clustered_interval(least, most, largest, self.confidence)

    def _bootstrap(self, violated: tuple[str, str], of: tuple[str, str]) -> Interval | None:
        if self.drawn is None or not self[violated[1]]:
            return None
        drawn = self.drawn
        least, most = (
            (drawn[:, _AT[v]], drawn[:, _AT[n]]) for v, n in zip(violated, of, strict=True)
        )
        return percentile_interval(least, most, self.confidence)


_VIOLATED = ("violated", "perhaps_violated")
_VIOLATED_FAR = ("violated_far", "perhaps_violated_far")


def _rule_rates(
    group: tuple[str, ...], rulebook: str, named: tuple[str, RuleTitle], sums: _RuleSums
) -> RuleRates:
    rule, title = named
    return RuleRates(
        group,
        rulebook,
        rule,
        title.provision,
        title.strength,
        drives=sums.count("drives"),
        hours=sums["hours"],
        km=sums["km"] if sums["far"] else None,
        opportunities=sums.count("opportunities"),
        perhaps_opportunities=sums.count("perhaps_opportunities"),
        exposed_h=sums["exposed_h"],
        perhaps_exposed_h=sums["perhaps_exposed_h"],
        violated=sums.count("violated"),
        perhaps_violated=sums.count("perhaps_violated"),
        per_hour=sums.per_length(_VIOLATED, "hours", 1.0),
        per_1000_km=sums.per_length(_VIOLATED_FAR, "km", 1000.0),
        per_opportunity=sums.per_opportunity(),
    )


def _as_row(rates: RuleRates, by: Sequence[GroupKey]) -> dict[str, Any]:
    row: dict[str, Any] = dict(zip(by, rates.group, strict=True))
    row |= {field.name: getattr(rates, field.name) for field in _PLAIN}
    for name in RATES:
        rate: Rate | None = getattr(rates, name)
        row[name] = None if rate is None else rate.least
        row[f"perhaps_{name}"] = None if rate is None else rate.most
        for kind, interval in (
            ("", "exact"),
            ("_drives", "bootstrap"),
            ("_clustered", "clustered"),
        ):
            low, high = getattr(rate, interval, None) or (None, None)
            row |= {f"{name}{kind}_low": low, f"{name}{kind}_high": high}
    return row


RATES = ("per_hour", "per_1000_km", "per_opportunity")
_PLAIN = [field for field in fields(RuleRates) if field.name not in (*RATES, "group")]


def rates_of_findings(
    paths: Sequence[str], by: Sequence[GroupKey] = (), *, confidence: float = 0.95, seed: int = 0
) -> ViolationRates:
    """The rates of all drives in some files, and in the Parquet files of folders.

    Raises RulecError R0701 for a file that cannot be read, R0715 if drives were judged differently,
    R0716 for files without drives, R0706 without pyarrow, R0717 without scipy.
    """
    counted = Counted(tuple(dict.fromkeys(by)))
    for file in finding_files(paths):
        counted.add(str(file), finding_rows(file))
    counted.close(paths)
    return violation_rates(counted, confidence=confidence, seed=seed)
