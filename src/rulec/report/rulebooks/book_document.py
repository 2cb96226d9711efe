"""A rulebook as a Markdown document for lawyers; ``html_page`` makes HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import groupby

from rulec.analysis.audit.rulebook_audit import articles_of
from rulec.analysis.lineage.rule_lineage import BookLineage
from rulec.report.rulebooks import book_sections
from rulec.report.rulebooks.book_rule import rule_heading, rule_section
from rulec.report.text.markdown import Block, Heading, anchors, code, escaped, table, written
from rulec.rulebook.loader import Loaded
from rulec.rulebook.rulebook_model import Rulebook
from rulec.version import __version__

NO_ADVICE = (
    "**This is no legal advice.** It paraphrases law so that a machine can read it. What counts is "
    "the law itself."
)

CONTENTS = "Contents"

_ENDS = {
    "stutter": "judged as if its last state went on for ever",
    "finite": "judged as it is: after its last state there is nothing",
}


def title_of(rulebook: Rulebook) -> str:
    """Its title, or its name if it has none."""
    return rulebook.title or rulebook.name


def as_markdown(loaded: Loaded, inherited: BookLineage) -> str:
    """The whole document."""
    rulebook = loaded.rulebook
    top: list[Block] = [Heading(1, title_of(rulebook)), *_top(rulebook), Heading(2, CONTENTS)]
    body = list(_body(loaded, inherited))
    index = Heading(2, "Index of provisions")
    headings = [heading for heading in (*top, *body, index) if isinstance(heading, Heading)]
    names = anchors([heading.text for heading in headings])
    places = {id(heading): name for heading, name in zip(headings, names, strict=True)}
    contents = "\n".join(
        f"{'  ' * (heading.level - 2)}- [{escaped(heading.text)}](#{places[id(heading)]})"
        for heading in (*body, index)
        if isinstance(heading, Heading) and heading.level in (2, 3)
    )
    rules = {heading.text: places[id(heading)] for heading in headings if heading.level == 3}
    end = (*_index(rulebook, inherited, index, rules), *_made_from(rulebook))
    return written([*top, contents, *body, *end])


def _top(rulebook: Rulebook) -> Iterator[Block]:
    law = f"{rulebook.law}, as of {rulebook.as_of}" if rulebook.as_of else rulebook.law
    n_hard = sum(rule.strength == "hard" for rule in rulebook.rules)
    yield NO_ADVICE
    rows = [
        ["rulebook", code(rulebook.name)],
        ["law", escaped(law) if law else "none is named"],
        ["shown as of", rulebook.at],
        ["builds upon", ", then ".join(map(code, rulebook.extends)) or "no other rulebook"],
        ["traffic", f"drives on the {rulebook.traffic}" if rulebook.traffic else "side not stated"],
        ["a trace is", _ENDS[rulebook.semantics]],
        ["rules", f"{n_hard:,} hard, {len(rulebook.rules) - n_hard:,} soft"],
    ]
    yield table(["about", "this rulebook"], rows)


def _body(loaded: Loaded, inherited: BookLineage) -> Iterator[Block]:
    rulebook = loaded.rulebook
    yield Heading(2, "Rules")
    yield (
        "A hard rule must never be violated, a soft rule may yield to others. In the examples a "
        "value in parentheses is not mentioned: it is the default."
        if rulebook.rules
        else "None."
    )
    for rule in rulebook.rules:
        yield from rule_section(rule, inherited, rulebook.vocabulary)
    yield from book_sections.values_section(inherited, rulebook.at)
    yield from book_sections.definitions_section(inherited)
    yield from book_sections.left_out_section(inherited, rulebook.at)
    yield from book_sections.words_section(loaded)


def _index(
    rulebook: Rulebook, inherited: BookLineage, heading: Heading, places: Mapping[str, str]
) -> Iterator[Block]:
    yield heading
    laws = {book.name: book.law or book.title or book.name for book in inherited.books}
    articles = articles_of(rulebook.rules, inherited)
    if not articles:
        yield "No provision is cited."
    links = {
        rule.name: f"[{code(rule.name)}](#{places[rule_heading(rule)]})" for rule in rulebook.rules
    }
    for book, cited in groupby(articles, key=lambda article: article.book):
        yield f"{escaped(laws[book])}:"
        rows = [
            [escaped(article.cite), ", ".join(links[name] for name in article.rules)]
            for article in cited
        ]
        yield table(["provision", "rules"], rows)


def _made_from(rulebook: Rulebook) -> Iterator[Block]:
    names = ", ".join(code(source.name) for source in rulebook.sources)
    yield "---"
    yield f"Made by rulec {__version__} from {names}. {NO_ADVICE}"
