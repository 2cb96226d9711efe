"""The tree-sitter grammar and its queries, generated from ``grammar/rulec.lark``.

``tree-sitter generate`` accepts the JSON directly, in place of a ``grammar.js``.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, Final

from lark import Tree
from lark.grammar import Terminal

from rulec.report.text import pygments_lexer as words
from rulec.syntax.keywords import RESERVED
from rulec.version import __version__
from tools.language_tokens import (
    compound_units,
    language_rules,
    patterns,
    spellings,
)

Node = dict[str, Any]

START: Final = "file"
VALUES: Final = {"NUMBER": "numeral"}
"""Terminals renamed because a rule of the language's grammar has their name."""


_SPACES = "[{}]".format("".join(f"\\u{code:04x}" for code in range(1 << 16) if chr(code).isspace()))
"""What Python takes for a space: tree-sitter's own class lacks the no-break space, among others."""


def tree_sitter_grammar() -> str:
    """Generate ``grammar.json``."""
    hidden = {name for name, _, stands_for_child in language_rules() if stands_for_child}
    rules: dict[str, Node] = {}
    for name, tree, _ in language_rules():
        rules.update(_Rule(name, hidden).rules(tree))
    needed = _reachable(rules, START)
    # A word after a number is its unit wherever it can be one.
    rules["number"] = {"type": "PREC_RIGHT", "value": 0, "content": rules["number"]}
    values = {_value(name): _pattern(text) for name, text in patterns().items() if name != "UNIT"}
    unit = _choice([_symbol("name"), _string("step"), _pattern(compound_units())])
    grammar = {
        "name": "rulec",
        "word": "name",
        "rules": {
            **{name: rule for name, rule in rules.items() if name in needed},
            **values,
            "unit": unit,
            "comment": _pattern(r"#[^\n]*"),
        },
        "extras": [_pattern(_SPACES), _symbol("comment")],
        "conflicts": [],
        "precedences": [],
        "externals": [],
        "inline": [],
        "supertypes": [],
        "reserved": {"global": [_string(word) for word in sorted(RESERVED)]},
    }
    return json.dumps(grammar, indent=1, ensure_ascii=False) + "\n"


class _Rule:
    """One rule of Lark's grammar, and the rules made of its named alternatives."""

    def __init__(self, name: str, hidden: set[str]) -> None:
        self.name = name
        self.hidden = hidden
        self.aliased: dict[str, list[Node]] = {}

    def rules(self, tree: Tree[Any]) -> Iterator[tuple[str, Node]]:
        """This rule first, then those of its named alternatives."""
        own = self._node(tree)
        yield self._shown(self.name), own
        for alias, alternatives in self.aliased.items():
            yield f"{self.name}_{alias}", _choice(alternatives)

    def _shown(self, name: str) -> str:
        return f"_{name}" if name in self.hidden else name

    def _node(self, part: Any) -> Node:
        if not isinstance(part, Tree):
            if isinstance(part, Terminal):
                return _terminal(str(part.name))
            return _symbol(self._shown(str(part.name)))
        if part.data == "alias":
            content: Any = part.children[0]
            alias: Any = part.children[1]
            return self._node(content) if alias is None else self._aliased(content, str(alias.name))
        if part.data == "expr":
            content, sign = part.children
            inner = self._node(content)
            if sign == "?":
                return _choice([inner, {"type": "BLANK"}])
            return {"type": "REPEAT" if sign == "*" else "REPEAT1", "content": inner}
        nodes = [self._node(child) for child in part.children]
        return _choice(nodes) if part.data == "expansions" else _sequence(nodes)

    def _aliased(self, content: Any, alias: str) -> Node:
        # tree-sitter would alias each symbol of a sequence separately, so the sequence becomes a
        # rule.
        first = alias not in self.aliased
        self.aliased.setdefault(alias, []).append(self._node(content))
        symbol = _symbol(f"{self.name}_{alias}")
        named = {"type": "ALIAS", "content": symbol, "named": True, "value": alias}
        return named if first else {"type": "CHOICE", "members": []}


def _terminal(name: str) -> Node:
    if name not in spellings():
        return _symbol(_value(name))
    return _choice(
        [_sequence([_string(word) for word in text.split()]) for text in spellings()[name]]
    )


def _value(name: str) -> str:
    return VALUES.get(name, name.lower())


def _symbol(name: str) -> Node:
    return {"type": "SYMBOL", "name": name}


def _string(text: str) -> Node:
    return {"type": "STRING", "value": text}


def _pattern(text: str) -> Node:
    return {"type": "PATTERN", "value": text}


def _choice(nodes: list[Node]) -> Node:
    members = [node for node in nodes if node.get("members") != []]
    return members[0] if len(members) == 1 else {"type": "CHOICE", "members": members}


def _sequence(nodes: list[Node]) -> Node:
    return nodes[0] if len(nodes) == 1 else {"type": "SEQ", "members": nodes}


def _reachable(rules: dict[str, Node], start: str) -> set[str]:
    found: set[str] = set()
    waiting = [start]
    while waiting:
        name = waiting.pop()
        if name in rules and name not in found:
            found.add(name)
            waiting.extend(_symbols(rules[name]))
    return found


def _symbols(node: Node) -> Iterator[str]:
    if node["type"] == "SYMBOL":
        yield node["name"]
    for inner in [*node.get("members", ()), *([node["content"]] if "content" in node else ())]:
        yield from _symbols(inner)


def highlights() -> str:
    """Generate ``queries/highlights.scm``."""
    taken = {word for texts in spellings().values() for text in texts for word in text.split()}
    brackets, separators = set("{}()[]"), set(",;:")
    signs = {text for text in taken if not text[0].isalpha()} - brackets - separators
    groups = {
        "keyword": (set(words.STRUCTURE_WORDS) | set(words.CLAUSES) | set(words.JOINING_WORDS)),
        "keyword.operator": set(words.OPERATORS),
        "operator": signs,
        "punctuation.bracket": brackets,
        "punctuation.delimiter": separators,
    }
    lines = ["; Made by `.ci/task regenerate` from the words that the parser knows.", ""]
    for capture, texts in groups.items():
        listed = " ".join(json.dumps(text) for text in sorted(texts & taken))
        lines.append(f"[{listed}] @{capture}")
    placed = taken - set().union(*groups.values()) - set(words.CONSTANTS)
    lines += [
        f"[{' '.join(json.dumps(text) for text in sorted(placed))}] @keyword.modifier",
        "",
        "(truth) @boolean",
        "(comment) @comment",
        "(string) @string",
        "(numeral) @number",
        "(date) @string.special",
        "(unit) @type",
        "(book) @module",
        "(use_line (name) @module)",
        "(vocabulary_line (name) @module)",
        '(rule_head "rule" . (name) @function)',
        '(drop_item "rule" . (name) @function)',
        '(soften_item "rule" . (name) @function)',
        '(define_item . ["define" "redefine"] . (name) @function)',
        '(param_item "param" . (name) @constant)',
        '(option_item "option" . (name) @constant)',
        "(type_item (name) @type)",
        '(parameter ":" (name) @type)',
        '(variable ":" (name) @type)',
        "(parameter . (name) @variable.parameter)",
        "(variable . (name) @variable.parameter)",
        "(atom . (name) @variable)",
    ]
    return "\n".join(lines) + "\n"


def folds() -> str:
    """Generate ``queries/folds.scm``."""
    return "[(rule) (example) (topics_item) (provisions_item) (vocabulary_file)] @fold\n"


def tree_sitter_manifest() -> str:
    """Generate ``tree-sitter.json``, which describes the grammar to tools."""
    language = {
        "name": "rulec",
        "scope": "source.rulec",
        "file-types": ["rules"],
        "highlights": "queries/highlights.scm",
        "injection-regex": "^rulec$",
    }
    metadata = {
        "version": __version__,
        "license": "GPL-3.0-or-later",
        "description": "The rulec language",
        "authors": [{"name": "The rulec authors"}],
    }
    return json.dumps({"grammars": [language], "metadata": metadata}, indent=2) + "\n"
