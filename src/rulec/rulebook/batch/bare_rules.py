"""Finds the rules of a text that lack a provision or an example, without parsing it.

This serves for a remark on files without mistakes; `rulec show --audit` and `rulec test` give
details.
"""

from __future__ import annotations

import re

# What cites an empty text cites nothing.
_COMMENT_OR_TEXT = re.compile(r'\bcite\s*"[ \t]*"|"[^"\n]*"|#[^\n]*')
_RULE = re.compile(r"(?:^|[\s}])(override\s+)?(?:hard|soft)\s+rule\s+(\w+)|\bconfirm\s+rule\b")
_CITE = re.compile(r"\bcite\b")
_EXAMPLE = re.compile(r"\b(?:accept|reject)\b")


def bare_rules(text: str) -> tuple[list[str], list[str]]:
    """The rules that cite nothing, and those that have no example; overrides are left out."""
    plain = _COMMENT_OR_TEXT.sub(" ", text)
    heads = [*_RULE.finditer(plain)]
    ends = [*[head.start() for head in heads], len(plain)][1:]
    rules = [
        (head[2], plain[head.end() : end])
        for head, end in zip(heads, ends, strict=True)
        if head[2] and not head[1]
    ]
    return (
        [name for name, body in rules if not _CITE.search(body)],
        [name for name, body in rules if not _EXAMPLE.search(body)],
    )
