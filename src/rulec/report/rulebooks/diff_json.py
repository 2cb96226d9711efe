"""How two rulebooks differ, as JSON; docs/commands.md describes it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from rulec.analysis.diff.rulebook_comparison import OneSided, RulebookDiff, RulePair
from rulec.logic.printing import number_in_words
from rulec.rulebook.model import Rule, Rulebook
from rulec.trace.formats.json_lines import as_record


def as_json(found: RulebookDiff) -> str:
    """One object."""
    document = {
        "first": _book(found.first),
        "second": _book(found.second),
        "rules": [_pair(pair) for pair in found.pairs],
        "only_first": _only(found.only_first),
        "only_second": _only(found.only_second),
        "settings": [asdict(one) for one in found.settings],
    }
    return json.dumps(document, ensure_ascii=False, indent=2)


def _book(book: Rulebook) -> dict[str, Any]:
    return {"name": book.name, "title": book.title, "at": book.at}


def _pair(pair: RulePair) -> dict[str, Any]:
    found = pair.comparison
    return {
        "rule": pair.name,
        "relation": pair.relation,
        "undecided": found.undecided or None,
        "first": _rule(pair.first),
        "second": _rule(pair.second),
        "common_types": list(found.common) or None,
        "on_common_types": found.on_common,
        "first_forbids": [as_record(trace) for trace in found.first_forbids],
        "second_forbids": [as_record(trace) for trace in found.second_forbids],
    }


def _rule(rule: Rule) -> dict[str, Any]:
    return {
        "strength": rule.strength,
        "variables": [{"name": one.name, "type": one.type} for one in rule.variables],
        "level": rule.level or None,
        "weight": number_in_words(rule.weight),
        "cite": rule.cite,
        "says": rule.says,
        "certainty": rule.certainty,
        "book": rule.book,
    }


def _only(rules: Sequence[OneSided]) -> list[dict[str, Any]]:
    return [
        {
            "rule": one.rule.name,
            **_rule(one.rule),
            "remark": one.remark.kind if one.remark else None,
            "because": one.remark.because if one.remark else None,
        }
        for one in rules
    ]
