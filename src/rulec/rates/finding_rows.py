"""The rows of drives and of rules in files of findings."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from rulec.files.read_files import is_folder, opened
from rulec.files.work_trees import refuse_link_out, tree_of
from rulec.rates.rates_messages import no_findings
from rulec.trace.formats.arrow.parquet import rows_of_columns
from rulec.value_display import short_repr

LARGEST = 1e12
"""No drive has this many metres or seconds; sums of larger numbers would overflow."""

_JSON_LINES = (".jsonl", ".ndjson")
_PARQUET = (".parquet", ".pq")


@dataclass(frozen=True, slots=True)
class FindingRow:
    """The columns of a row of findings that rates need; see docs/fleet.md.

    A row of kind ``drive`` has a drive's duration and distance, a row of kind ``rule`` a rule's
    counts in it. Where a column does not apply, a text is empty and a number None.
    """

    __repr__ = short_repr

    kind: str
    file: str = ""
    recording: str = ""
    vehicle: str = ""
    rulebook: str = ""
    rule: str = ""
    provision: str = ""
    strength: str = ""
    outcome: str = ""
    source: str = ""
    country: str = ""
    road: str = ""
    duration_s: float | None = None
    distance_m: float | None = None
    opportunities: int | None = None
    perhaps_opportunities: int | None = None
    opportunities_s: float | None = None
    perhaps_opportunities_s: float | None = None
    violated: int | None = None
    perhaps_violated: int | None = None
    rulebook_hash: str = ""
    rulec: str = ""
    thresholds: str = ""
    assumptions: str = ""


_FIELDS = {field.name: field.type for field in fields(FindingRow)}
COLUMNS = tuple(_FIELDS)


def finding_files(paths: Sequence[str]) -> Iterator[Path]:
    """The files of findings: those named, and the Parquet files in and below folders.

    Raises RulecError R0716 for a folder without any, R0730 for a link that leads out of it.
    """
    for name in paths:
        path = Path(name)
        if not is_folder(path):
            yield path
            continue
        inside = [x for x in sorted(path.rglob("*")) if x.suffix in _PARQUET and _counts(x, path)]
        for file in inside:
            refuse_link_out(file, tree=tree_of(path))
        if not inside:
            raise no_findings(name, "there are no Parquet files in the folder")
        yield from inside


def _counts(file: Path, folder: Path) -> bool:
    """Whether no part of the path begins with a sign that engines skip (``.`` or ``_``)."""
    return not any(part.startswith((".", "_")) for part in file.relative_to(folder).parts)


def finding_rows(path: Path) -> Iterator[FindingRow]:
    """The rows of drives and of rules in a file.

    Raises RulecError R0701 for an unreadable file, R0706 without pyarrow, R0716 without findings.
    """
    name = path.name.lower().removesuffix(".gz")
    if name.endswith(_PARQUET):
        rows = rows_of_columns(path, COLUMNS)
    elif name.endswith(_JSON_LINES):
        rows = _json_rows(path)
    elif name.endswith(".csv"):
        rows = _csv_rows(path)
    else:
        with opened(path):  # A missing file is reported as missing, whatever its name.
            raise no_findings(str(path), "it ends in none of .jsonl, .csv and .parquet")
    for number, row in enumerate(rows, 1):
        if row.get("kind") in ("drive", "rule"):
            yield _row(row, path, number)
        elif "kind" not in row:
            why = "its rows do not say of what kind they are: it was written without `--exposure`"
            raise no_findings(str(path), why)


def _row(row: Mapping[str, Any], path: Path, number: int) -> FindingRow:
    values = {name: value for name, value in row.items() if name in _FIELDS and value is not None}
    for name, value in values.items():
        is_text = _FIELDS[name] == "str"
        if not (_is_text(value) if is_text else _is_amount(value)):
            wanted = "text" if is_text else f"number from 0 to {LARGEST:,.0f}"
            raise no_findings(str(path), f"row {number} has no {wanted} as its `{name}`")
    return FindingRow(**values)


def _is_text(value: object) -> bool:
    # JSON may contain lone surrogates, which cannot be written as output.
    return isinstance(value, str) and not any("\ud800" <= sign <= "\udfff" for sign in value)


def _is_amount(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value <= LARGEST


def _json_rows(path: Path) -> Iterator[Mapping[str, Any]]:
    with opened(path) as stream:
        for number, line in enumerate(stream, 1):
            if not line.strip():
                continue
            try:
                row = json.loads(line)
            except (ValueError, RecursionError):
                raise no_findings(str(path), f"line {number} is no JSON") from None
            if not isinstance(row, dict):
                raise no_findings(str(path), f"line {number} is no row of a table")
            yield row


def _csv_rows(path: Path) -> Iterator[Mapping[str, Any]]:
    with opened(path) as stream, io.TextIOWrapper(stream, "utf-8-sig", newline="") as text:
        try:
            for number, row in enumerate(csv.DictReader(text), 2):
                yield {
                    name: _value(name, cell, path, number)
                    for name, cell in row.items()
                    if name in _FIELDS and isinstance(cell, str)
                }
        except (csv.Error, UnicodeDecodeError) as problem:
            raise no_findings(str(path), f"it cannot be read as CSV: {problem}") from None


def _value(name: str, cell: str, path: Path, number: int) -> str | float | None:
    if _FIELDS[name] == "str":
        # An apostrophe keeps spreadsheets from evaluating text that begins like a formula.
        return cell[1:] if cell.startswith("'") else cell
    if not cell:
        return None
    try:
        return float(cell) if "float" in str(_FIELDS[name]) else int(cell)
    except ValueError:
        raise no_findings(str(path), f"line {number} has `{cell}` for its `{name}`") from None
