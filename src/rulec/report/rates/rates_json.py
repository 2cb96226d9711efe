"""Rates as JSON."""

from __future__ import annotations

from rulec.rates.drive_counts import GroupKey
from rulec.rates.rule_rates import Rate, ViolationRates
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled


class JudgedByData(JsonPart, frozen=True, kw_only=True):
    """What drives were judged by."""

    rulebook: str
    rulebook_hash: str
    rulec: str
    thresholds: str
    assumptions: str


class RuleRatesData(JsonPart, frozen=True, kw_only=True):
    """The rates of a rule in a group; see docs/rates.md."""

    group: dict[str, str]
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


class RatesDocument(JsonDocument, frozen=True, kw_only=True):
    """The output of ``rulec rates --json``."""

    by: tuple[GroupKey, ...]
    drives: int
    not_judged: int
    judged_by: list[JudgedByData]
    confidence: float
    replicates: int
    seed: int
    rules: list[RuleRatesData]


def as_json(rates: ViolationRates) -> str:
    """Write rates over several lines."""
    document = filled(
        RatesDocument,
        rates,
        rules=[
            filled(RuleRatesData, rule, group=dict(zip(rates.by, rule.group, strict=True)))
            for rule in rates.rules
        ],
    )
    return as_indented(document)
