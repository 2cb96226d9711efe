"""The language of a document: its grammar, its fixed texts, and the titles of rules."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.diagnostics import Source
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.french import FRENCH
from rulec.logic.sentences.german import GERMAN
from rulec.logic.sentences.language import Language, LanguageCode, TypeWords
from rulec.logic.sentences.wording import spoken
from rulec.rulebook.files.reference_messages import NAME_NOT_FOUND
from rulec.rulebook.rulebook_model import Rulebook
from rulec.rulebook.vocabulary_phrases import titles_in, topics_in, types_of
from rulec.toml import parsed_toml

if TYPE_CHECKING:
    from rulec.analysis.lineage.rule_lineage import BookLineage, LineageStep, RuleHistory

_FOLDER = Path(__file__).parent / "texts"


@dataclass(frozen=True, slots=True)
class DocumentLanguage:
    """The texts of a document.

    ``texts``: English text -> its translation, empty for English itself; ``titles``: rule -> title;
    ``topics``: topic -> title.
    """

    language: Language
    texts: Mapping[str, str]
    titles: Mapping[str, str]
    topics: Mapping[str, str]

    def say(self, text: str, *values: object) -> str:
        """The translation of an English text, with values in place of its ``{}``."""
        return self.texts.get(text, text).format(*values)

    def title(self, rule: str) -> str:
        """The title of a rule; without one, its name as words."""
        name = spoken(rule)
        return self.titles.get(rule, f"{name[:1].upper()}{name[1:]}")


IN_ENGLISH = DocumentLanguage(ENGLISH, {}, {}, {})


def document_language(rulebook: Rulebook, code: LanguageCode) -> DocumentLanguage:
    """The language of a document about a rulebook, by its code, such as ``de``."""
    titles = titles_in(code)
    if code == "en":
        return replace(IN_ENGLISH, titles=titles)
    types = {name: TypeWords(*words) for name, words in types_of(rulebook, code).items()}
    language = replace(GERMAN if code == "de" else FRENCH, types=types)
    return DocumentLanguage(language, _texts(code), titles, topics_in(code))


@cache
def _texts(code: LanguageCode) -> Mapping[str, str]:
    path = _FOLDER / f"{code}.toml"
    source = Source(str(path), path.read_text(encoding="utf-8"))
    return parsed_toml(source, NAME_NOT_FOUND, 'write `"text in English" = "…"`')


def provenance(
    rule_history: RuleHistory, inherited: BookLineage, words: DocumentLanguage = IN_ENGLISH
) -> str:
    """How a chain's last book has a rule: own, inherited, overridden or dropped; and why."""
    say = words.say
    book, last = inherited.book, rule_history.last
    open_law = say(", not confirmed") if inherited.inherited_from(rule_history) else ""
    because = open_law + say(", because {}", last.because) if last.because else open_law
    here = last.book == book
    base = rule_history.steps[-2].book if len(rule_history.steps) > 1 else ""
    clauses = _clauses(last, words)
    match last.deed:
        case "declared":
            return say("own") if here else say("inherited from {}", last.book) + because
        case "overridden" if here:
            return say("overrides {}: {}", base, clauses) + because
        case "overridden":
            how = say("inherited from {}, which overrides {}: {}", last.book, base, clauses)
            return how + because
        case "confirmed" if here:
            return say("confirms {}: {}", base, clauses)
        case "confirmed":
            how = say("inherited from {}, which confirms {}: {}", last.book, base, clauses)
            return how + because
        case "softened":
            return (say("softened") if here else say("softened by {}", last.book)) + because
        case "dropped":
            return (say("dropped") if here else say("dropped by {}", last.book)) + because
        case "silent":
            return (say("silent") if here else say("silent, as {} is", last.book)) + because


def _clauses(step: LineageStep, words: DocumentLanguage) -> str:
    return ", ".join(step.clauses) if step.clauses else words.say("nothing changes")
