"""Edits whose words a help text states, in one of a few known forms.

Help is written for readers, and most of the words that it quotes are examples, or about what is
there already. So an edit is made only where the form of the help says what is to be written where.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

from rulec.diagnostics import Diagnostic, nearest_name
from rulec.language_server.names.renaming import TextChange
from rulec.syntax.keywords import CLAUSE_WORDS, DECLARATION_WORDS, OPERATOR_LETTERS, RESERVED

_WORD = re.compile(r"[^\W\d]\w*")
_NUMBER = re.compile(r"(?<![\w.,])\d+(?:[.,]\d+)*")
_QUOTED = re.compile(r"`([^`]+)`")

_LIST = r"`[^`…]+`(?:(?:, or | or |, )`[^`…]+`)*"
"""Words in quotes, of which one is meant."""

_REPLACEMENT = re.compile(
    rf"^(?:(?:did you mean|words that may mean it:|write the one you mean:) ({_LIST})"
    rf"|(?:.*: )?write ({_LIST})"
    r"(?=$|[,;:]| (?:with parentheses|to speak|for one that|between|without quotes)))"
)
"""Help that begins with what belongs in place of the marked words."""

_FOR_OTHER = re.compile(
    r"\bfor `([^`…]+)` write `([^`…]+)`"
    r"|\bwrite `([^`…]+)`(?: or `[^`]+`)? for `([^`…]+)`"
)
"""Help that also says for which words, so that these are replaced, wherever the mark is."""

_PLACEHOLDER = re.compile(r"\b[A-Za-z]\b")
"""A name of one letter in help, which stands for any formula."""

_BEFORE = re.compile(
    r"^(?:close (?:it|the bound|the list of variables)|end the (?:rule|example)) with `([)\]}])`"
    r"|^write `(\{)` before them|^put a `(;)` between|^separate the \w+ by `(,)`"
)
"""Help that names a sign which is missing before the marked place."""

_OF_TWO_KINDS = re.compile(
    r"^states are separated by `(;)`, the facts of one state by `(and)`$"
    r"|^quantities are compared by `(=)`, formulas by `(iff)`"
)
_IN_HEADER = re.compile(r"`((?:use|traffic) \w+)`")
_DECLARED = re.compile(rf"`((?:{'|'.join(sorted(DECLARATION_WORDS))}) [^`…]+)`")
_WITH_UNIT = re.compile(r"^write the unit, such as `([^`]+)`$")
_LENGTHS = re.compile(r"^write `([^`]+)`, or, as a speed makes a length of a time: `([^`]+)`$")
_OVERRIDE = re.compile(r"^write `(override rule \w+)`")
_RULE_HEAD = re.compile(r"(?:hard|soft)\s+rule\s+$")

_LEAVE_OUT = re.compile(
    r"^(?:delete|leave out) (?:the |another )?`([^`]+)`|^leave `([^`]+)` out"
    r"|^(?:delete it\b|delete the (?:character|comment)|leave (?:it|the comment) out"
    r"|leave the variables? out|leave one of the lines out)"
    r"|[,;] or leave it out(?: here)?$|: leave its `extends` line out$"
)
"""Help by which the marked words, or those that it quotes, are too much."""

_ITEM_LINES = {
    "extends",
    *DECLARATION_WORDS,
    *("option", "define", "redefine", "priority", "use", "set", "drop", "soften", "silent"),
    *("constant", "presumed", "param"),
}
"""The beginnings of lines that can be left out whole; no law is on them."""


def stated_edits(
    finding: Diagnostic, text: str, start: int, end: int
) -> Iterator[tuple[str, TextChange]]:
    """The edits for a finding about ``text[start:end]``, the most likely first."""
    help_text, own = finding.help, text[start:end]
    if "`unverified`" in finding.expected:
        yield from _write(["unverified"], own, start, end)  # more is to be found out, not written
        return
    if finding.expected.startswith('expected `"`') and not text[end : end + 1].strip():
        yield 'Put `"` behind it', TextChange(end, end, '"')
    if _LEAVE_OUT.search(help_text):
        yield from _deletions(help_text, text, start, end)
    if match := _WITH_UNIT.match(help_text):
        if match[1].startswith(f"{own} "):
            yield f"Write `{match[1]}`", TextChange(start, end, match[1])
        return
    if match := _LENGTHS.match(help_text):
        yield from _write([match[1], match[2]], own, start, end)
        return
    if match := _FOR_OTHER.search(help_text):
        was, words = (match[1], match[2]) if match[1] else (match[4], match[3])
        if not (" " in was and _PLACEHOLDER.search(was)):
            yield from _in_place_of(was, words, text, start, end)
    elif match := _OVERRIDE.match(help_text):
        line = text.rfind("\n", 0, start) + 1
        if written := _RULE_HEAD.search(text, line, start):
            yield f"Write `{match[1]}`", TextChange(*written.span(), "override rule ")
    elif match := _BEFORE.match(help_text):
        yield from _sign_before(next(filter(None, match.groups())), text, start, end)
    elif match := _OF_TWO_KINDS.match(help_text):
        yield from _in_place_of_sign([one for one in match.groups() if one], text, start, end)
    elif match := _REPLACEMENT.match(help_text):
        words = [word for word in _QUOTED.findall(match[1] or match[2]) if not _is_sign_for(word)]
        if help_text.startswith("did you mean"):
            yield from _misspelt(words[0] if words else "", text, start, end)
        yield from _replacing(words, text, start, end)
    yield from _at_their_place(help_text, text, start)


def keeps_the_rest(before: str, after: str) -> bool:
    """Whether an edit leaves all numbers and clauses of a text as they are."""
    clauses = [
        Counter(word for word in _WORD.findall(one) if word in CLAUSE_WORDS)
        for one in (before, after)
    ]
    numbers = [Counter(_NUMBER.findall(one)) for one in (before, after)]
    return numbers[0] == numbers[1] and clauses[0] <= clauses[1]


def short(text: str) -> str:
    """A text on one line, for a title."""
    line = " ".join(text.split())
    return line if len(line) <= 50 else f"{line[:49]}…"


def _is_sign_for(word: str) -> bool:
    """Whether a word is the other spelling of an operator, which help names beside its word."""
    return word in OPERATOR_LETTERS or word in ("->", "<->", "&", "|", "!", "&&", "||")


def _write(words: list[str], own: str, start: int, end: int) -> Iterator[tuple[str, TextChange]]:
    for word in dict.fromkeys(words):
        if word != own:
            yield f"Write `{short(word)}`", TextChange(start, end, word)


def _in_place_of_sign(
    words: list[str], text: str, start: int, end: int
) -> Iterator[tuple[str, TextChange]]:
    for word in words:
        touches = word.isalpha() and text[start - 1 : start].isalnum()
        put = f"{' ' * touches}{word}"
        yield f"Write `{word}`", TextChange(start, end, put)


def _replacing(
    words: list[str], text: str, start: int, end: int
) -> Iterator[tuple[str, TextChange]]:
    """The words in place of the marked ones, where nothing is said twice then, or comes in."""
    for word in words:
        first, last = _with_own_words(word, text, start, end)
        if _repeats_what_is_beside(word, text, first, last) or word == "_":
            continue
        own = set(_WORD.findall(text[first:last]))
        several = len(_WORD.findall(word)) > 1
        strange = {*_WORD.findall(_NUMBER.sub("0", word))} - own - RESERVED if several else set()
        is_name = bool(_WORD.fullmatch(text[first:last])) and text[first:last] not in RESERVED
        typed = re.fullmatch(r"(\w+): \w+", word)
        is_strange = strange and not _only_adds_unit(word)
        if typed and typed[1] == text[first:last]:
            is_strange = False
        if is_strange or (is_name and not _WORD.search(word)):
            continue
        yield from _write([word], text[first:last], first, last)


def _only_adds_unit(word: str) -> bool:
    return re.fullmatch(r"-?\d[\d.]* [\w/%^]+", word) is not None


def _repeats_what_is_beside(word: str, text: str, start: int, end: int) -> bool:
    """Whether words begin or end with what is next to the place, which would stand there twice."""
    # Parentheses may stand beside others, which enclose more.
    sign = r"\w+|[^\w\s()]"
    before = re.search(rf"({sign})\s*$", text[:start])
    behind = re.match(rf"\s*({sign})", text[end:])
    first, last = re.match(sign, word), re.search(rf"({sign})$", word)
    return bool(before and first and before[1] == first[0]) or bool(
        behind and last and behind[1] == last[0]
    )


def _with_own_words(word: str, text: str, start: int, end: int) -> tuple[int, int]:
    """A place with the words behind it that a replacement repeats."""
    own = text[start:end]
    behind = word.rpartition(own)[2] if own and own in word else ""
    is_repeated = behind.startswith(" ") and text.startswith(behind, end)
    return (start, end + len(behind)) if is_repeated else (start, end)


def _in_place_of(
    was: str, words: str, text: str, start: int, end: int
) -> Iterator[tuple[str, TextChange]]:
    """An edit of the words for which others are to be written, at or around the place."""
    pattern = r"\s+".join(map(re.escape, was.split()))
    for match in re.finditer(pattern, text[: end + len(was)]):
        is_around = match.start() <= start and end <= match.end()
        if is_around or (match.end() <= start and not text[match.end() : start].strip()):
            yield f"Write `{short(words)}`", TextChange(*match.span(), words)
            return


def _sign_before(sign: str, text: str, start: int, end: int) -> Iterator[tuple[str, TextChange]]:
    if sign == "}":
        first = text.rfind("\n", 0, start) + 1
        blank = not text[first:start].strip()
        put = f"{sign}\n" if blank and first else f"\n{sign}\n"
        yield f"Put `{sign}` here", TextChange(*((first, first) if blank else (end, end)), put)
        return
    joint = text[start:end]
    if sign in (",", ";") and joint in (",", ";", "and", "or", "|"):
        yield f"Write `{sign}`", TextChange(start, end, sign)
        return
    at = len(text[:start].rstrip())
    put = f" {sign}" if sign == "{" else sign
    yield f"Put `{sign}` before it", TextChange(at, at, put)


def _misspelt(word: str, text: str, start: int, end: int) -> Iterator[tuple[str, TextChange]]:
    """The word at the place, or before it on its line, that is most similar to the one meant."""
    line = text.rfind("\n", 0, start) + 1
    for first, last in ((start, end), (line, start)):
        words = {match[0]: match.span() for match in _WORD.finditer(text, first, last)}
        near = nearest_name(word, words)
        if near is not None and near != word:
            yield f"Write `{word}`", TextChange(*words[near], word)
            return


def _deletions(help_text: str, text: str, start: int, end: int) -> Iterator[tuple[str, TextChange]]:
    match = _LEAVE_OUT.search(help_text)
    quoted = (match[1] or match[2]) if match else None
    if quoted is not None:
        # What is too much is marked, or comes right before what is marked.
        at = re.compile(re.escape(quoted))
        found = [one.span() for one in at.finditer(text, 0, max(end, start + len(quoted)))]
        near = [span for span in found if not text[span[1] : start].strip()]
        if not near:
            return
        start, end = near[-1]
    shown = short(text[start:end])
    if text.startswith("#", start):
        line = text.find("\n", start)
        yield "Leave out the comment", TextChange(start, len(text) if line < 0 else line, "")
        return
    first = text.rfind("\n", 0, start) + 1
    last = text.find("\n", end) + 1 or len(text)
    behind = re.compile(r"\s*,\s*").match(text, end)
    before = re.search(r"\s*,\s*$", text[:start])
    empty_rule = re.search(r"\{\s*\}\s*$", text[first:last])
    begins = _WORD.match(text[first:last].lstrip())
    is_line = begins is not None and (
        begins[0] in _ITEM_LINES or (begins[0] == "override" and empty_rule is not None)
    )
    name = quoted is None and _WORD.fullmatch(text[start:end]) is not None
    if before:
        yield f"Leave out `{shown}`", TextChange(before.start(), end, "")
    elif behind:
        yield f"Leave out `{shown}`", TextChange(start, behind.end(), "")
    elif is_line and (name or "line" in help_text):
        yield f"Leave out the line of `{shown}`", TextChange(first, last, "")
    elif (opened := re.search(r"\s*\(\s*$", text[:start])) and text[end:].lstrip()[:1] == ")":
        closed = text.index(")", end) + 1
        yield f"Leave out `({shown})`", TextChange(opened.start(), closed, "")
    else:
        yield f"Leave out `{shown}`", TextChange(start, end, "")


def _at_their_place(help_text: str, text: str, start: int) -> Iterator[tuple[str, TextChange]]:
    """Lines that are missing in the header, and declarations above the item."""
    head = text.find("\n") + 1 or len(text)
    for line in _IN_HEADER.findall(help_text):
        title = f"Use `{line[4:]}`" if line.startswith("use ") else f"Say `{line}`"
        if not re.search(rf"^{line}$", text, re.MULTILINE):
            yield title, TextChange(head, head, f"{line}\n")
    for words in _DECLARED.findall(help_text):
        if not re.search(r"\b[A-Z]{3,}\b", words):
            at = _line_of_item(text, start)
            yield f"Declare `{short(words)}`", TextChange(at, at, f"{words}\n")


def _line_of_item(text: str, offset: int) -> int:
    """The beginning of the item at a character, including the comments above it."""
    start = text.rfind("\n", 0, offset) + 1
    while start > 0 and (text[start] in " \t}" or text[start] == "\n"):
        start = text.rfind("\n", 0, start - 1) + 1
    while start > 0:
        above = text.rfind("\n", 0, start - 1) + 1
        if not text.startswith("#", above):
            break
        start = above
    return start
