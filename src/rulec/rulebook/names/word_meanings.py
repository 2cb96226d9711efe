"""Words of a vocabulary by their meaning, to suggest one for an unknown name.

A word is described by the parts of its own name and of its phrases, which are reduced to stems and
to one representative of each group of synonyms. A name is described by its parts in the same way;
rare parts weigh more than frequent ones (Robertson and Spärck Jones, 1976). A word that covers
nearly all of a name, more than any other word, is suggested as what was meant; words that cover
most of it are suggested as candidates.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import log
from typing import Final
from unicodedata import combining, normalize

from rulec.diagnostics import did_you_mean
from rulec.diagnostics.ways_out import Help, offering
from rulec.rulebook.vocabulary_phrases import (
    phrases_in,
    synonyms_of_the_field,
    vocabularies_with_phrases,
)

_NAME, _PHRASE, _TRANSLATED = 1.0, 0.8, 0.6
"""The weights of the parts of a word's name, of its phrase, and of that in other languages."""

_MEANT: Final = 0.75
_LEAD: Final = 0.1
_CANDIDATE: Final = 0.65
"""The least share of a name that a word must cover: to be meant, with this lead, or a candidate.

Of a hundred names, made up after the synonyms, of which half have a word, these thresholds gave a
suggestion for 32, three of them wrong, and none for the other half.
"""

_MOST_CANDIDATES: Final = 3

_SAYING_NOTHING: Final = (
    "a about ahead an and any are as at be being by can cannot do does ego egos for from get goes "
    "going has have he i in into is it its left may me must my near next no not now of off on one "
    "or other right s she should so than that the their there they this to up was way which who "
    "will with you"
)
_EMPTY: Final = frozenset(_SAYING_NOTHING.split())
_PART: Final = re.compile(r"[A-Z]?[^\W\d_A-Z]+|[A-Z]+(?![^\W\d_A-Z])|\d+")
_ENDINGS: Final = ("ings", "ing", "ers", "ies", "ed", "es", "en", "er", "s", "e", "y")
_SHORTEST_STEM: Final = 4


@dataclass(frozen=True, slots=True)
class DescribedWord:
    """A word, its phrase in English, and its phrases in other languages."""

    name: str
    phrase: str = ""
    translations: tuple[str, ...] = ()


def described(names: Iterable[str], vocabularies: Iterable[str]) -> tuple[DescribedWord, ...]:
    """Words with their phrases in shipped vocabularies; words without phrases have their names."""
    in_english, *others = (
        {
            word: text
            for vocabulary in vocabularies
            for word, text in phrases_in(vocabulary, language).items()
        }
        for language in ("en", "de", "fr")
    )
    return tuple(
        DescribedWord(
            name, in_english.get(name, ""), tuple(other.get(name, "") for other in others)
        )
        for name in names
    )


def in_other_letters(name: str, known: Iterable[str]) -> Help:
    """Help that names the known word that looks like a name; empty if there is none."""
    if name.isascii():
        return ""
    # Late import: these are the parser's messages, which no file without mistakes loads.
    from rulec.syntax.messages.lookalikes import skeleton_of

    skeleton = skeleton_of(name)
    alike = next((word for word in known if skeleton_of(word) == skeleton), "")
    text = f"did you mean `{alike}`? Some letters of `{name}` are of another script"
    return offering(text, alike) if alike else ""


def offer(name: str, words: tuple[DescribedWord, ...]) -> Help:
    """Help that names the words which mean what ``name`` says; empty if none certainly does."""
    stems = set(_stems(name))
    about = {word.name: _about(word) for word in words}
    if not stems or not about:
        return ""
    weight = {part: _rarity(part, about.values()) for part in stems}
    total = sum(weight.values())
    covered = {
        word: sum(weight[part] * parts.get(part, 0.0) for part in stems) / total
        for word, parts in about.items()
    }
    ranked = sorted(covered, key=lambda word: (-covered[word], len(about[word]), word))
    best, second = (*(covered[word] for word in ranked[:2]), 0.0)[:2]
    shown = {word.name: _shown(word) for word in words}
    if best >= _MEANT and best - second >= _LEAD:
        return offering(f"did you mean {shown[ranked[0]]}?", ranked[0])
    # What a short name says is what it is about; longer ones are about something else, too.
    plainest = sorted(ranked, key=lambda word: word.count("_"))
    near = [word for word in plainest if covered[word] >= _CANDIDATE]
    if not near or (len(near) > _MOST_CANDIDATES and best < _MEANT):
        return ""
    near = near[:_MOST_CANDIDATES]
    return offering(f"words that may mean it: {', '.join(map(shown.__getitem__, near))}", *near)


def suggestion(name: str, known: Sequence[str], alike: float = 0.6) -> str:
    """Help with the known word that is spelt like a name, or else with those that may mean it."""
    with_phrases = described(known, vocabularies_with_phrases())
    phrased = tuple(word for word in with_phrases if word.phrase)
    return did_you_mean(name, known, alike) or str(offer(name, phrased))


def _shown(word: DescribedWord) -> str:
    phrase = re.sub(r"\[([^|\]]*)\|[^\]]*\]", r"\1", word.phrase).replace("{}", "…")
    return f"`{word.name}` ({phrase})" if phrase else f"`{word.name}`"


@cache
def _about(word: DescribedWord) -> Mapping[str, float]:
    """The parts that describe a word, with their weights."""
    parts: dict[str, float] = {}
    texts = [
        (word.name, _NAME),
        (word.phrase, _PHRASE),
        *((text, _TRANSLATED) for text in word.translations),
    ]
    for text, surely in texts:
        for part in _stems(text):
            parts.setdefault(part, surely)
    return parts


def _rarity(part: str, about: Iterable[Mapping[str, float]]) -> float:
    known = [part in parts for parts in about]
    return log((len(known) + 1) / (sum(known) + 0.5))


@cache
def _by_form() -> tuple[Mapping[str, str], int]:
    """The main word of each form and of its stem, and the number of parts of the longest form."""
    forms = [
        (form, main) for main, others in synonyms_of_the_field().items() for form in (main, *others)
    ]
    # A form as it is written goes before the stem of another one: `speeding` before `speed`.
    main_of = {_joined(form): main for form, main in forms} | dict(forms)
    return main_of, max((form.count("_") + 1 for form in main_of), default=1)


def _stems(text: str) -> Iterator[str]:
    """The stems of a name's or text's parts, with synonyms replaced by their representative."""
    main_of, longest = _by_form()
    parts = [_without_accents(part.casefold()) for part in _PART.findall(text)]
    stems = [_stem(part) for part in parts]
    at = 0
    while at < len(parts):
        for size in range(min(longest, len(parts) - at), 0, -1):
            form, stem = ("_".join(words[at : at + size]) for words in (parts, stems))
            main = main_of.get(form) or main_of.get(stem)
            if main is not None:
                yield main
                at += size
                break
        else:
            is_letter = parts[at].isascii() and len(parts[at]) == 1
            if parts[at] not in _EMPTY and not parts[at].isdigit() and not is_letter:
                yield stems[at]
            at += 1


def _joined(form: str) -> str:
    return "_".join(_stem(part) for part in form.split("_"))


_LETTERS: Final = str.maketrans(
    {"ä": "ae", "æ": "ae", "ö": "oe", "ø": "oe", "ü": "ue", "å": "aa", "ł": "l"}
)


def _without_accents(part: str) -> str:
    """The text without accents, as the synonyms are written: `å` is `aa`, `é` is `e`."""
    if part.isascii():
        return part
    plain = normalize("NFKD", part.translate(_LETTERS))
    return normalize("NFC", "".join(letter for letter in plain if not combining(letter)))


@cache
def _stem(part: str) -> str:
    """A word without its ending: `crossings` and `crossed` are `cross`."""
    for ending in _ENDINGS:
        if part.endswith(ending) and len(part) - len(ending) >= _SHORTEST_STEM:
            return part.removesuffix(ending)
    return part
