"""Messages about rates."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code, missing_package
from rulec.files.read_files import what_reads

JUDGED_OTHERWISE = Code("R0715")

NO_FINDINGS = Code("R0716")

RATES_UNAVAILABLE = Code("R0717")


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
