"""Messages about rates."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code, missing_package
from rulec.files.read_files import what_reads

JUDGED_OTHERWISE = Code(
    "R0715",
    title="findings were judged differently and cannot be added up",
    why="A rate says how often a rule is violated, so all drives must be judged by the same rules "
    "and version of rulec, with the same thresholds and assumptions. Different rulebooks can be "
    "kept apart by `--by rulebook`.",
    bad="""\
echo '{"kind": "drive", "vehicle": "v", "rulec": "1.0", "duration_s": 60}' > found.jsonl
echo '{"kind": "drive", "vehicle": "w", "rulec": "2.0", "duration_s": 60}' >> found.jsonl
rulec rates found.jsonl""",
    good="""\
echo '{"kind": "drive", "vehicle": "v", "rulec": "2.0", "duration_s": 60}' > found.jsonl
echo '{"kind": "drive", "vehicle": "w", "rulec": "2.0", "duration_s": 60}' >> found.jsonl
rulec rates found.jsonl""",
    kind="command",
)

NO_FINDINGS = Code(
    "R0716",
    title="a file has no findings from which rates can be computed",
    why="Rates are computed from the rows of drives and rules that `rulec fleet` writes, and "
    "`rulec verify --exposure -o FILE` as JSON Lines, CSV or Parquet. Violations alone do not "
    "show how long anybody drove. No drive may occur twice.",
    bad="""\
echo '{"rule": "stop_sign", "outcome": "violated"}' > found.jsonl
rulec rates found.jsonl""",
    good="""\
echo '{"kind": "drive", "vehicle": "v", "outcome": "kept", "duration_s": 60}' > found.jsonl
rulec rates found.jsonl""",
    kind="command",
)

RATES_UNAVAILABLE = Code(
    "R0717",
    title="intervals need a package that is not installed",
    why="Exact intervals need the package `scipy`, which is installed on request: "
    "`.venv/bin/python -m pip install -e '.[rates]'` in the checkout.",
    kind="circumstance",
)


def no_findings(file: str, why: str) -> RulecError:
    traffic = file if what_reads(file)[:13] in ("", "it has traces") else "TRAFFIC"
    return NO_FINDINGS.error(
        SourceLocation(file),
        why,
        help=f"judge first, then count: `rulec verify {traffic} -r de --exposure -o found.csv`, "
        "and `rulec rates found.csv`",
    )


def judged_otherwise(file: str, first: str, column: str, values: tuple[str, str]) -> RulecError:
    own, other = [value or "none" for value in values]
    return JUDGED_OTHERWISE.error(
        SourceLocation(file),
        f"the {column} differ from those of {first}: {own} here, {other} there",
        help="judge all drives alike" + (", or add `--by rulebook`" if column == "rules" else ""),
    )


def twice(file: str, first: str, drive: str) -> RulecError:
    where = f"in {first}, too" if first != file else "twice in it"
    return NO_FINDINGS.error(
        SourceLocation(file),
        f"drive `{drive}` is {where}",
        help="give the findings of each drive once",
    )


def no_scipy() -> RulecError:
    return missing_package(RATES_UNAVAILABLE, "an exact interval", "scipy", "rates")
