"""Identity of a judgement: rulebook, version, thresholds and assumptions, as texts.

Findings of a fleet may be added up only if all of these are the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traffic_thresholds import USUAL
from rulec.monitoring.rulebook_edition import rulebook_hash
from rulec.trace import Value
from rulec.value_display import short_repr
from rulec.version import __version__


@dataclass(frozen=True, slots=True)
class JudgedBy:
    """The rulebook's name and hash, the version of rulec, and the options chosen.

    ``thresholds`` are those that differ from this version's defaults, such as ``near_m=200``;
    ``assumptions`` are values, ``defaults``, ``as recorded`` and ``ends=cut``: both sorted,
    separated by ``; `` and written as options are.
    """

    __repr__ = short_repr

    rulebook: str
    rulebook_hash: str
    rulec: str = __version__
    thresholds: str = ""
    assumptions: str = ""

    def columns(self) -> dict[str, str]:
        """The fields as columns of a table of findings."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def judged_by(rules: CompiledRulebook, request: RequestedDrives, ends: str = "") -> JudgedBy:
    """What drives are judged by; ``ends`` is how traces are assumed to end, if that is chosen."""
    given = request.thresholds
    chosen = {
        field.name: getattr(given, field.name)
        for field in fields(given)
        if getattr(given, field.name) != getattr(USUAL, field.name)
    }
    flags = {"defaults": request.defaults, "as recorded": request.as_recorded}
    assumed = [*_pairs(request.assumed), *(name for name, holds in flags.items() if holds)]
    return JudgedBy(
        rules.name,
        rulebook_hash(rules),
        thresholds="; ".join(_pairs(chosen)),
        assumptions="; ".join([*assumed, *([f"ends={ends}"] if ends else [])]),
    )


def _pairs(values: Mapping[str, Value]) -> list[str]:
    return [f"{name}={_written(value)}" for name, value in sorted(values.items())]


def _written(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)
