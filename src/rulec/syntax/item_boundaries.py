"""Finds the boundaries of items and clauses from a few nearby tokens."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.diagnostics import nearest_name
from rulec.syntax import keywords
from rulec.syntax.scanner import Token

_COMPLETE_WORDS = frozenset(("true", "false", "throughout", "initially"))
_OPEN_SYMBOLS = frozenset(
    (
        *("(", ",", ":", ";", "{", "[", "..", "]"),
        *("!", "&", "&&", "|", "||", "->", "<->", "^", "[]", "<>"),
        *("=", "=>", "<", "<=", "!=", ">=", ">", "+", "-", "*", "/"),
    )
)

_FORMULA_SIGNS = _OPEN_SYMBOLS - {",", ":", ";", "{"}
_PAIRS = (
    *(("force", ("from",)), ("silent", ("on",)), ("traffic", ("left", "right"))),
    *(("at", ("start", "end")), ("some", ("point",))),
)
"""Keywords, with the words that continue them although each might be a name."""

_TEXTS = ("string", "quoted", "unterminated")


@dataclass(frozen=True, slots=True)
class Landmarks:
    """Questions about the tokens of one file, by index."""

    tokens: list[Token]

    def _text(self, index: int, kind: str) -> str:
        token = self.tokens[index] if 0 <= index < len(self.tokens) else None
        return token.text if token is not None and token.kind == kind else ""

    def symbol(self, index: int) -> str:
        """The symbol at a place, outside of quotes; empty if there is none."""
        return self._text(index, "symbol")

    def is_symbol(self, index: int, text: str) -> bool:
        """Whether a token is this symbol, outside of quotes."""
        return self.symbol(index) == text

    def is_word(self, index: int, *texts: str) -> bool:
        """Whether a token is one of these words."""
        return self._text(index, "word") in texts

    def is_name(self, index: int) -> bool:
        """Whether a token is a word that may be a name."""
        word = self._text(index, "word")
        return word != "" and word not in keywords.RESERVED

    def _is_number(self, index: int) -> bool:
        return self._text(index, "number") != ""

    def wants_more(self, index: int) -> bool:
        """Whether the text must continue after a token."""
        if index < 0:
            return False
        token = self.tokens[index]
        if token.kind == "word":
            return token.text in keywords.RESERVED and token.text not in _COMPLETE_WORDS
        return token.kind == "symbol" and token.text in _OPEN_SYMBOLS

    def begins_rule(self, index: int) -> bool:
        """Whether a rule begins here.

        It does with ``hard``, ``soft``, ``override``, ``confirm``, ``rule``, or a misspelt word
        before ``rule``.
        """
        if self.is_word(index, *keywords.RULE_WORDS, *keywords.CHANGE_WORDS, "rule"):
            return True
        return self.is_name(index) and self.is_word(index + 1, "rule")

    def begins_item(self, index: int) -> bool:
        """Whether an item begins at a token outside of braces."""
        token = self.tokens[index]
        if token.kind != "word":
            return False
        follows_on = self.wants_more(index - 1) and not token.first
        if token.text in keywords.ITEM_WORDS:
            return not follows_on and not self._is_part_of_item(index)
        if token.text in keywords.RESERVED or self.goes_on(index):
            return False
        if not self.wants_more(index - 1):
            return token.first or self._begins_enumeration(index, "one")
        if not token.first or self.is_word(index - 1, "type"):
            return False
        return (
            self._is_glued(index) or self.begins_misspelt(index) or self._begins_enumeration(index)
        )

    def _is_part_of_item(self, index: int) -> bool:
        """Whether an item's keyword is inside another item."""
        token = self.tokens[index]
        if token.text == "rule":
            return not token.first or self._heads_a_rule(index - 1)
        if token.text in keywords.RULE_WORDS:
            return self.is_word(index - 1, *keywords.CHANGE_WORDS)
        if token.text == "extends":
            # `type car extends vehicle` is a mistake about the type.
            return not token.first and self.is_word(index - 2, "type")
        if token.text == "step" and not token.first:
            # `next[1 step]`: a unit; but `as of 2020-01-01 step 1 s`.
            return self._is_number(index - 1) and not self._is_number(index + 1)
        return False

    def goes_on(self, index: int) -> bool:
        """Whether a possible name continues the line before."""
        if self.is_word(index, "weight"):
            return self._is_number(index + 1)
        if self.is_word(index, "at"):
            return self.is_word(index + 1, "start", "some", "end")
        return any(
            self.is_word(index - 1, before) and self.is_word(index, *words)
            for before, words in _PAIRS
        ) or (self.is_word(index - 1, "on") and self.is_word(index - 2, "silent"))

    def _is_glued(self, index: int) -> bool:
        """Whether two names follow where only one can be."""
        glued = self.is_name(index + 1) and not self.tokens[index + 1].first
        glued = glued and not self.is_word(index + 1, "weight")
        if not glued or not self._in_formula(index - 1):
            return glued
        return nearest_name(self.tokens[index].text, keywords.ITEM_WORDS) is not None

    def _in_formula(self, index: int) -> bool:
        token = self.tokens[index]
        return token.text in _FORMULA_SIGNS or self.is_word(index, *keywords.OPERATOR_WORDS)

    def begins_item_inside(self, index: int) -> bool:
        """Whether an item begins here although braces are still open.

        That takes more evidence: its own line after something complete or before a name, or ``hard
        rule``.
        """
        token = self.tokens[index]
        if token.kind != "word":
            return False
        if (token.first or self._heads_a_rule(index)) and self.is_word(index + 1, "rule"):
            return not self.is_word(index - 1, *keywords.CHANGE_WORDS, *keywords.RULE_WORDS)
        if not token.first or self._heads_a_rule(index - 1):
            return False
        if token.text == "silent" and self.is_word(index + 1, "because"):
            return False
        if token.text == "topics" and not self.is_symbol(index + 1, "{"):
            return False
        if token.text in keywords.ITEM_WORDS:
            return not self.wants_more(index - 1) or self.is_name(index + 1)
        return self._begins_enumeration(index)

    def _heads_a_rule(self, index: int) -> bool:
        words = (*keywords.RULE_WORDS, *keywords.CHANGE_WORDS, "drop", "soften")
        return self.is_word(index, *words)

    def begins_misspelt(self, index: int) -> bool:
        """Whether a misspelt keyword begins a line here."""
        if index + 1 >= len(self.tokens) or not self.tokens[index].first:
            return False
        if self.is_word(index - 1, "certainty"):
            return False
        text = self.tokens[index + 1].kind in _TEXTS
        return self.is_name(index) and (text or self.is_symbol(index + 1, "{"))

    def begins_clause(self, index: int) -> bool:
        """Whether a clause begins at a token."""
        token = self.tokens[index]
        if token.kind != "word":
            return False
        if token.text not in keywords.CLAUSE_WORDS:
            return token.text == "in" and self._begins_in_force(index)
        if token.text == "unless" and self.is_word(index - 1, "also"):
            return False
        if token.first or not self.wants_more(index - 1):
            return True
        return self.is_symbol(index - 1, "{") and not self._stands_alone(index)

    def _begins_in_force(self, index: int) -> bool:
        """Whether this ``in`` begins ``in force`` and not a level named ``force``."""
        if not self.is_word(index + 1, "force"):
            return False
        if self.is_symbol(index + 2, "{") or self.is_word(index + 2, "weight"):
            return False
        return self.tokens[index].first or not self.wants_more(index - 1)

    def _stands_alone(self, index: int) -> bool:
        return any(self.is_symbol(index + 1, text) for text in (";", "}", "&")) or self.is_word(
            index + 1, "and"
        )

    def _begins_enumeration(self, index: int, *behind_is: str) -> bool:
        """Whether this is ``name is`` or ``name(…) is``, followed by one of some words."""
        if not self.is_name(index):
            return False
        behind = index + 1
        if self.is_symbol(behind, "("):
            behind += 1
            while behind < len(self.tokens) and self._fits_parameters(behind):
                behind += 1
            if not self.is_symbol(behind, ")"):
                return False
            behind += 1
        return self.is_word(behind, "is") and (
            not behind_is or self.is_word(behind + 1, *behind_is)
        )

    def _fits_parameters(self, index: int) -> bool:
        token = self.tokens[index]
        return self.is_name(index) or (token.kind == "symbol" and token.text in (",", ":"))
