"""Rates as JSON."""

from __future__ import annotations

from types import GenericAlias
from typing import get_type_hints

from rulec.rates.rule_rates import RuleRates, ViolationRates
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled, made_class


class JudgedByData(JsonPart, frozen=True, kw_only=True):
    """What drives were judged by."""

    rulebook: str
    rulebook_hash: str
    rulec: str
    thresholds: str
    assumptions: str


RuleRatesData = made_class(
    "RuleRatesData",
    {**get_type_hints(RuleRates), "group": dict[str, str]},
    "The rates of a rule in a group; see docs/rates.md.",
)
_PARTS = {"judged_by": list[JudgedByData], "rules": GenericAlias(list, RuleRatesData)}
RatesDocument = made_class(
    "RatesDocument",
    {**get_type_hints(ViolationRates), **_PARTS},
    "The output of ``rulec rates --json``.",
    JsonDocument,
)


def as_json(rates: ViolationRates) -> str:
    """Write rates over several lines."""
    rules = [
        filled(RuleRatesData, rule, group=dict(zip(rates.by, rule.group, strict=True)))
        for rule in rates.rules
    ]
    return as_indented(filled(RatesDocument, rates, rules=rules))
