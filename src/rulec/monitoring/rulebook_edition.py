"""Which text of which law a verdict rests on."""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any, NamedTuple

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.logic.printing import formula_text


class Edition(NamedTuple):
    """A rulebook's law, the day of its text, the day that was asked for (ISO), and its hash."""

    rulebook: str
    law: str
    as_of: str
    at: str
    rulebook_hash: str


def edition_of(rules: CompiledRulebook) -> Edition:
    """The edition of a rulebook; the one that is judged by, with all of its rules or some."""
    known: Edition | None = rules.prepared.get(Edition)
    if known is None:
        known = Edition(rules.name, rules.law, rules.as_of, rules.at, rulebook_hash(rules))
        rules.prepared[Edition] = known
    return known


def rulebook_hash(rules: CompiledRulebook) -> str:
    """SHA-256 (hexadecimal) of everything that decides verdicts and opportunities.

    That is the rules, facts and vocabulary. The hash is the same for a rulebook's source and its
    compiled file, at any step: texts for people and automata do not count.
    """
    # Late import: the schema of compiled files (20 ms), which verdicts without a hash do not need.
    from rulec.automata.bundle.bundle_schema import as_builtins

    vocabulary = rules.vocabulary
    content = [
        rules.name,
        rules.semantics,
        rules.traffic,
        [
            [rule.name, rule.strength, rule.level, str(rule.weight), _variables(rule)]
            for rule in rules.rules
        ],
        [formula_text(rule.formula) for rule in rules.rules],
        [rule.trigger and formula_text(rule.trigger) for rule in rules.rules],
        sorted([_variables(axiom), formula_text(axiom.formula)] for axiom in rules.axioms),
        sorted(rules.priorities),
        sorted((item.name, item.parent or "") for item in vocabulary.types.values()),
        [as_builtins(item) for item in vocabulary.declarations.values()],
    ]
    return sha256(json.dumps(content, ensure_ascii=False).encode()).hexdigest()


def _variables(about: Any) -> list[list[str]]:
    return [[variable.name, variable.type] for variable in about.variables]
