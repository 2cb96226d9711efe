"""Rates of the drives in files of findings."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.rates.drive_counts import Counted, GroupKey
from rulec.rates.finding_rows import finding_files, finding_rows
from rulec.rates.rule_rates import ViolationRates, violation_rates


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
