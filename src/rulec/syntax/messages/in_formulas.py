"""Help inside formulas and expressions."""

from __future__ import annotations

import re
from typing import Final
from unicodedata import numeric

from rulec.diagnostics import did_you_mean
from rulec.syntax import keywords
from rulec.syntax.messages.in_sentences import EGO, advise_on_sentence
from rulec.syntax.messages.literals import how_hours_are_written
from rulec.syntax.messages.parse_context import COMPARISONS, ParseContext

_OTHER_SPELLINGS: Final = {
    "implies": ("=>", "==>", "-->", "→", "⇒", "⟹", "⟶"),
    "iff": ("<=>", "===", "↔", "⇔", "⟺", "≡"),
    "and": ("∧", "und", "og", "och", "en", "et", "oraz"),
    "or": ("∨", "oder", "eller", "of", "ou", "lub"),
    "not": ("¬", "~", "nicht", "ikke", "inte", "niet", "nie", "pas", "non"),
    "always": ("□", "◻", "globally"),
    "eventually": ("◇", "◊", "⋄", "finally"),
    "next": ("○", "◯", "@"),
    "until": ("𝒰",),
    "once": ("◆", "⧫"),
    "historically": ("■", "◼"),
    "previously": ("●",),
    "since": ("𝒮",),
}
_MEANT: Final = {spelling: word for word, group in _OTHER_SPELLINGS.items() for spelling in group}
_SIGNS: Final = {
    **dict.fromkeys(("≤", "=<", "⩽"), "<="),
    **dict.fromkeys(("≥", "⩾", ">=="), ">="),
    **dict.fromkeys(("≠", "<>", "!=="), "!="),
    **dict.fromkeys(("×", "·"), "*"),
    **dict.fromkeys(("−", "–"), "-"),
    "÷": "/",
}
_QUANTIFIERS: Final = {
    **dict.fromkeys(("exists", "any", "∃", "there"), "some"),
    **dict.fromkeys(("forall", "all", "each", "∀", "for"), "every"),
    **dict.fromkeys(("number", "sum", "#"), "count"),
}
_IN_WORDS: Final[dict[tuple[str, ...], str]] = {
    ("less", "than"): "<",
    ("more", "than"): ">",
    ("greater", "than"): ">",
    ("at", "least"): ">=",
    ("at", "most"): "<=",
    ("equal", "to"): "=",
    ("below",): "<",
    ("above",): ">",
}
IN_DIGITS: Final = {
    name: number
    for number, name in enumerate(
        ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"), start=1
    )
}
RELATIONS: Final = ("<", "<=", "=", "!=", ">=", ">")
AGGREGATES: Final = ("some", "every", "count")


def advise_on_formula(scene: ParseContext) -> str:
    """Advice on a mistake in a formula; empty if there is none."""
    if not (scene.operand or scene.operator or scene.quantity or "AND" in scene.accepted):
        return _arguments(scene)
    for advice in (_conditionals, advise_on_sentence, _numbers, _comparisons, _operators, _joined):
        way_out = advice(scene)
        if way_out:
            return way_out
    return ""


def sign_in_words(before: str, text: str) -> str:
    """The sign for two words, such as `at least`; empty for others."""
    return _IN_WORDS.get((before, text), "")


def advise_on_aggregate(scene: ParseContext) -> str:
    """At ``some``, ``every``, ``count``, and what others call them."""
    text, before = scene.text, scene.text_before
    if scene.operator and before == "at" and scene.text_behind in ("time", "times"):
        return f"for `at {text} {scene.text_behind}` write `always`"
    if scene.operator and before == "no" and scene.is_word():
        named = scene.text_behind if scene.text_behind.isidentifier() else ""
        plain = "" if named else f"`not {text}`, of objects "
        # `no vehicle v`, or `no vehicle beside`
        said = f"{named}: {text} (…)"
        if len(named) != 1:
            said = f"x: {text} ({f'{named}(x)' if named else '…'})"
        return f"for `no {text}` write {plain}`not some {said}`"
    if text == "every" and scene.operator and scene.is_number(scene.at + 1):
        return "for `p every 4 h` write `always eventually[<= 4 h] p`"
    word = _QUANTIFIERS.get(text) or (_QUANTIFIERS.get(before) if scene.operator else None)
    if word and (scene.operand or scene.operator) and scene.unexpected is not None:
        if any(scene.is_number(scene.at + number) for number in range(1, 4)) and text == "for":
            past = scene.text_at(scene.at + 2) in ("last", "past", "previous")
            word = "historically" if past else "always"
            return f"for how long stands in a bound, such as `{word}[<= 3 s] p`"
        at = scene.at + (text in _QUANTIFIERS)
        own = scene.text_at(at + 1) == ":" and scene.text_at(at + 2).isidentifier()
        variable = f"{scene.text_at(at)}: {scene.text_at(at + 2)}" if own else "x: vehicle"
        return f"write `{word} {variable} (…)`"
    if before in AGGREGATES and scene.accepted == {"NAME"}:
        return f"it is written `{before} x: vehicle (…)`"
    is_head = scene.text_at(scene.at - 2) == "(" and scene.text_at(scene.at - 3) != "fact"
    if text == ":" and scene.operator and is_head:
        said = f"{before}: {scene.text_at(scene.at + 1)}"
        return (
            f"write `every {said} (…)` or `some {said} (…)`, or declare it behind the rule's name"
        )
    if (
        text in keywords.UNARY_OPERATORS
        and scene.operator
        and scene.first not in ("unless", "also")
    ):
        if scene.text_behind in ("", "}"):
            return f"it stands before what it is about: `{text} p`"
        return f"it stands before what it is about, such as `{text} (speed > 50 km/h)`"
    heads = [index for index in range(scene.at) if scene.text_at(index) in AGGREGATES]
    if not heads or scene.at - heads[-1] > 4:
        return ""
    word = scene.text_at(heads[-1])
    if text == "," and scene.accepted <= {"COLON", "LPAR"}:
        return f"it has one variable; put one inside the other: `{word} x: T ({word} y: T (…))`"
    if scene.accepted == {"LPAR"}:
        return f"what is said of it stands in parentheses: `{word} x: vehicle (…)`"
    if scene.accepted == {"COLON"}:
        return f"it is written `{word} x: vehicle (…)`"
    return ""


def _arguments(scene: ParseContext) -> str:
    opened = scene.opened("(", ")")
    if opened is None or scene.kind not in ("clause", "formula", "item"):
        return ""
    if opened and scene.accepted == {"COMMA", "RPAR"} and scene.text != ")":
        # `nevr (p and q)` reads as a name with arguments
        near = did_you_mean(scene.text_at(opened - 1), keywords.UNARY_OPERATORS)
        if near:
            return near
    if scene.accepted == {"NAME"} and scene.text_before == "(" and scene.text == ")":
        return "without arguments there are no parentheses"
    if scene.accepted == {"NAME"} and scene.text_before == "," and scene.text == ")":
        return "delete the `,`"
    if scene.accepted == {"COMMA", "RPAR"} and scene.text == ":":
        return f"types stand where variables are declared: leave out `: {scene.text_behind}`"
    if scene.accepted == {"COMMA", "RPAR"} and scene.text == "(":
        if opened and scene.text_at(opened - 1).casefold() in ("abs", "absolute", "magnitude"):
            return _ABSOLUTE
        way_out = "an argument is a name; it has no arguments of its own"
        spaced = opened and scene.tokens[opened - 1].end < scene.tokens[opened].start
        # `nie (p(x) …)` is meant for an operator
        return (
            f"{way_out}; no operator is called `{scene.text_at(opened - 1)}`" if spaced else way_out
        )
    joins = scene.text in keywords.PRECEDENCE or scene.text in (
        *keywords.SYMBOLS.values(),
        *RELATIONS,
    )
    if opened and scene.accepted == {"COMMA", "RPAR"} and joins:
        named = "".join(token.text for token in scene.tokens[opened - 1 : scene.at])
        way_out = f"close the parenthesis behind the name: `{named.replace(',', ', ')})`"
        if "," in named:
            return f"an argument is a name: `define` one for what is more, or {way_out}"
        return way_out
    quantifier = _QUANTIFIERS.get(scene.text_before, "")
    if opened and scene.accepted == {"COMMA", "RPAR"} and scene.is_word() and quantifier:
        return f"write `{quantifier} x: {scene.text} ({scene.text_at(opened - 1)}(x))`"
    if scene.accepted == {"COMMA", "RPAR"} and scene.is_word():
        return "separate the names by `,`"
    return ""


_ABSOLUTE: Final = (
    "there is no absolute value: say both limits, such as `-3 km/h <= x and x <= 3 km/h`"
)


def _conditionals(scene: ParseContext) -> str:
    text, before = scene.text, scene.text_before
    behind = [token.text for token in scene.tokens[scene.at :]]
    otherwise = "else" in behind
    then = behind.index("then") if "then" in behind else None
    truths = then is not None and not scene.is_number(scene.at + then + 1)
    if (scene.operator and text == "else") or (
        text == "if" and scene.operand and otherwise and truths
    ):
        return "write `(p implies q) and (not p implies r)` for `if p then q else r`"
    if text == "?" or (otherwise and text == "if"):
        if scene.operator and text == "if":
            return "a conditional stands in parentheses: `(1.5 m if built_up else 2 m)`"
        return "a conditional is written `(1.5 m if built_up else 2 m)`"
    if text == "if" and scene.operator:
        return "write `q implies p` for `p if q`"
    if text == "if" or before == "if":
        return "write `p implies q` for `if p then q`"
    if scene.accepted >= {"ELSE"} and "if" in behind:
        instead = "in place of `,`" if text == "," else f"before `{text}`"
        return f"`else` chains: write it {instead}, as in `3 m if wet else 2 m if dark else 1 m`"
    if scene.accepted >= {"ELSE"}:
        return "a conditional ends with what holds otherwise: `1.5 m if built_up else 2 m`"
    return ""


def _numbers(scene: ParseContext) -> str:
    token, text = scene.unexpected, scene.text
    if token is None or not (scene.operator or scene.quantity):
        return ""
    if text == ":" and scene.is_number(scene.at - 1) and scene.is_number(scene.at + 1):
        return how_hours_are_written(f"{scene.text_before}:{scene.text_behind}")
    if len(scene.text_before) == 1 and numeric(scene.text_before, 0) % 1:
        return f"write `{numeric(scene.text_before):g}` for `{scene.text_before}`"
    around = scene.is_number(scene.at - 1) and scene.is_number(scene.at + 1)
    if text == "," and around:
        return scene.with_a_point()
    if text == "." and scene.quantity and scene.is_number(scene.at + 1):
        return f"write `0.{scene.text_behind}`"
    grouped = "_" in scene.text_before or scene.is_number(scene.at)
    if (scene.is_number(scene.at - 1) and grouped) or (text.startswith("'") and around):
        return "a number's digits stand together, such as `1000`"
    if not scene.operator:
        return ""
    if scene.is_number(scene.at) and (
        scene.text_before == ")" or scene.text_before not in keywords.RESERVED
    ):
        return "a quantity is compared by `<`, `<=`, `=`, `!=`, `>=` or `>`"
    factor = scene.is_word() and text not in keywords.RESERVED
    if factor and scene.is_number(scene.at - 2) and scene.text_before == "%":
        return f"write `{scene.text_at(scene.at - 2)} % * {text}` for a product"
    if factor and scene.is_number(scene.at - 2) and scene.before and scene.before.kind == "word":
        return f"write `{scene.text_before} * {text}` for a product"
    return ""


def _comparisons(scene: ParseContext) -> str:
    text, before = scene.text, scene.text_before
    numbers = scene.is_number(scene.at + 1) or scene.is_number(scene.at - 1)
    if scene.operator and text == "=>" and numbers:
        return "write `>=` for at least; `=>` would be `implies`"
    if scene.operator and text == "is":
        words = (scene.text_behind, scene.text_at(scene.at + 2))
        said = words[:1] if words[:1] in _IN_WORDS else words
        if sign := _IN_WORDS.get(said):
            return f"for `is {' '.join(said)}` write `{sign}`"
        if words[0].isidentifier() and words[0] not in keywords.RESERVED:
            about = f"`{words[0]}({before})`"
            if re.search(rf"\b{re.escape(before)}\s*:", scene.source.text):
                return f"what is of an object is written {about}"
            return f"a value stands alone, such as `{words[0]}`; of an object it is {about}"
        return "quantities are compared by `<`, `<=`, `=`, `!=`, `>=` or `>`"
    if scene.operator and scene.is_number(scene.at + 1) and (sign := _IN_WORDS.get((before, text))):
        return f"how many stands behind what is counted: `count x: vehicle (…) {sign} 3`"
    meant = sign_in_words(text, scene.text_behind) if scene.operator and text == "at" else ""
    if meant and scene.is_number(scene.at + 2):
        lasting = (
            f"how long something lasts stands in a bound, such as `historically[{meant} 3 s] p`"
        )
        return f"for `at {scene.text_behind}` write `{meant}`; {lasting}"
    if scene.operator and text == "==":
        value = scene.text_behind if scene.text_behind.isidentifier() else ""
        alone = f"; one of several values stands alone: `{value}`" if value else ""
        return f"quantities are compared by `=`, formulas by `iff`{alone}"
    if (scene.operator or scene.quantity) and text in _SIGNS:
        return f"write `{_SIGNS[text]}`"
    if before == "-" and text == ">":
        return "write `->` without a space"
    if before == "=" and text == "!":
        return "write `!=`"
    if text == "**" or (before == "^" and scene.is_number(scene.at)):
        return "powers cannot be written; arithmetic is linear"
    if scene.operator and text in RELATIONS and not scene.accepted & COMPARISONS:
        return _chain(scene)
    if scene.operator and text == "in" and scene.text_behind in ("{", "(", "["):
        return _any_value(scene)
    ahead = any(scene.is_number(scene.at + number) for number in (1, 2))
    if scene.operator and text in ("between", "in") and ahead:
        return "write `a <= x and x <= b`"
    if text == "+" and scene.quantity:
        return "delete the `+`"
    if text in ("|", "||") and scene.quantity:
        closing = (token for token in scene.tokens[scene.at + 1 :] if token.text in ("|", "||"))
        return _ABSOLUTE if any(closing) else ""
    return ""


def _operators(scene: ParseContext) -> str:
    if scene.unexpected is None:
        return ""
    text, before = scene.text, scene.text_before
    if scene.operator and len(before) > 1 and set(before) <= set(keywords.PREFIX_LETTERS):
        return f"`{before}` is read as one name; write `{' '.join(before)}`"
    if text == "then" and before == "and":
        return "`then` stands alone between two phases: write `p then q`"
    if text == "as" and scene.text_behind == "soon":
        return "for `as soon as p, q` write `always (p implies q)`, or `eventually[<= 2 s] q` in it"
    if scene.operator and _MEANT.get(before) == "not":
        return f"write `not` or `!` for `{before}`"
    word = _MEANT.get(text) or (
        text.casefold() if text.casefold() in keywords.OPERATOR_WORDS else None
    )
    fits = scene.operand if word in keywords.UNARY_OPERATORS else "AND" in scene.accepted
    if word is not None and text != word and fits:
        symbol = keywords.SYMBOLS.get(word, word)
        return f"write `{word}` or `{symbol}`" if symbol != word else f"write `{word}`"
    if "weak" in (before, text):
        return "`weak` stands before `until`, `next` or `previously`"
    if "strong" in (before, text):
        return "`strong` stands before `release`"
    if scene.operand and text == "{":
        return "a formula stands in parentheses, or alone, but not in braces"
    if scene.operand and text in RELATIONS and text != "=":
        return "say what is compared, such as `speed <= 50 km/h`"
    return ""


def _any_value(scene: ParseContext) -> str:
    """Advice on ``lateral(v) in {left_of, right_of}``: each value is true or false by itself."""
    values: list[str] = []
    for token in scene.tokens[scene.at + 2 :]:
        if token.kind == "word":
            values.append(token.text)
        elif token.text != ",":
            break
    opened = next((n for n in range(scene.at - 1, 0, -1) if scene.text_at(n) == "("), None)
    of = ""
    if scene.text_before == ")" and opened is not None:
        of = "".join(token.text for token in scene.tokens[opened : scene.at])
    said = " or ".join(f"{value}{of}" for value in values[:3])
    return f"each value stands for itself: write `{said}`" if values else ""


def _joined(scene: ParseContext) -> str:
    behind = scene.token(scene.at + 1)
    member = behind is not None and behind.kind == "word" and behind.text not in keywords.RESERVED
    if scene.operator and scene.text == "." and member and scene.before and scene.touches():
        if scene.text_before in EGO:
            return f"what is ego's stands alone: write `{scene.text_behind}`"
        return f"what is of an object is written `{scene.text_behind}({scene.text_before})`"
    more = behind is not None and behind.text not in {")", *keywords.CLAUSE_WORDS}
    if scene.operator and more and scene.text in (",", ";", "."):
        return "write `or` where one of them is enough, `and` where it takes all"
    words = (scene.before, scene.unexpected)
    is_word = scene.is_word() and scene.text not in keywords.RESERVED
    if scene.operator and scene.text_before == ")" and is_word:
        return "between two formulas stands an operator, such as `and`, `or` or `implies`"
    if scene.operator and all(
        token is not None and token.kind == "word" and token.text not in keywords.RESERVED
        for token in words
    ):
        joined = "between two words stands an operator, such as `and`"
        if len(scene.text) == 1:
            of_object = f"{scene.text_before}({scene.text})"
            return f"{joined}; what is of an object is written `{of_object}`"
        return f"{joined}, `or` or `implies`; a name is one word"
    return ""


def _chain(scene: ParseContext) -> str:
    """Advice on ``a < b < c``: compare two at a time."""
    last = next((at for at in range(scene.at - 1, -1, -1) if scene.text_at(at) in RELATIONS), None)
    if last is None:
        return ""

    def part(first: int, behind: int) -> str:
        return scene.source.text[scene.tokens[first].start : scene.tokens[behind - 1].end]

    left, right = _back(scene, last), _forward(scene, scene.at + 1)
    if left == last or last + 1 >= scene.at or right == scene.at + 1:
        return "compare two at a time: `a < b and b < c`"
    middle = part(last + 1, scene.at)
    first, second = part(left, scene.at), part(scene.at, right)
    whole = f"{first} and {middle} {second}"
    return "compare two at a time: " + (
        f"write `{whole}`" if len(whole) <= 60 and "\n" not in whole else "`a < b and b < c`"
    )


def _belongs_to_side(scene: ParseContext, at: int) -> bool:
    token = scene.token(at)
    if token is None:
        return False
    if token.kind == "word":
        return token.text not in keywords.RESERVED
    return token.kind == "number" or token.text in ("+", "-", "*", "/", ".", ",", "(", ")", "^")


def _back(scene: ParseContext, at: int) -> int:
    depth = 0
    while _belongs_to_side(scene, at - 1):
        depth += (scene.text_at(at - 1) == ")") - (scene.text_at(at - 1) == "(")
        if depth < 0:
            break
        at -= 1
    return at


def _forward(scene: ParseContext, at: int) -> int:
    depth = 0
    while _belongs_to_side(scene, at):
        depth += (scene.text_at(at) == "(") - (scene.text_at(at) == ")")
        if depth < 0:
            break
        at += 1
    return at
