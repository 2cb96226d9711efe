"""A rulebook as a Markdown document for lawyers; ``html_page`` makes HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import groupby

from rulec.analysis.audit.provision_coverage import provisions_of
from rulec.analysis.audit.rulebook_audit import articles_of, used_declarations
from rulec.analysis.lineage.rule_lineage import BookLineage, ConstantHistory
from rulec.logic.english.wording import listed, spoken
from rulec.logic.printing import formula_text
from rulec.report.rulebooks.audit_report import progress, provision_table
from rulec.report.rulebooks.book_rule import WIDTH, rule_heading, rule_section
from rulec.report.rulebooks.spoken_rules import spoken_book
from rulec.report.text import markdown
from rulec.report.text.formula_lines import formula_lines
from rulec.report.text.markdown import Block, Heading, code, escaped, fenced, linked, table
from rulec.rulebook.loader import Loaded
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.rulebook.rulebook_model import Rulebook
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_in_force
from rulec.version import __version__
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal

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
    names = markdown.anchors([heading.text for heading in headings])
    places = {id(heading): name for heading, name in zip(headings, names, strict=True)}
    contents = "\n".join(
        f"{'  ' * (heading.level - 2)}- [{escaped(heading.text)}](#{places[id(heading)]})"
        for heading in (*body, index)
        if isinstance(heading, Heading) and heading.level in (2, 3)
    )
    rules = {heading.text: places[id(heading)] for heading in headings if heading.level == 3}
    sources = ", ".join(code(source.name) for source in rulebook.sources)
    made_from = f"Made by rulec {__version__} from {sources}. {NO_ADVICE}"
    end = (*_index(rulebook, inherited, index, rules), "---", made_from)
    return markdown.written([*top, contents, *body, *end])


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
    if rulebook.extends:
        inherited = sum(bool(rule.inherited_from) for rule in rulebook.rules)
        own = f"{len(rulebook.rules) - inherited:,} rules; {inherited:,} inherited, not confirmed"
        rows.append(["own law", own])
    yield table(["about", "this rulebook"], rows)


def _body(loaded: Loaded, inherited: BookLineage) -> Iterator[Block]:
    rulebook = spoken_book(loaded.rulebook)
    yield Heading(2, "Rules")
    yield (
        "A hard rule must never be violated, a soft rule may yield to others. In the examples a "
        "value in parentheses is not mentioned: it is the default."
        if rulebook.rules
        else "None."
    )
    for rule in rulebook.rules:
        yield from rule_section(rule, inherited, rulebook)
    yield from _values_section(inherited, rulebook.at)
    yield from _definitions_section(inherited)
    yield from _left_out_section(inherited, rulebook.at)
    yield from _words_section(loaded)
    yield from _articles_section(rulebook)


def _articles_section(rulebook: Rulebook) -> Iterator[Block]:
    provisions = provisions_of(rulebook)
    if provisions:
        yield Heading(2, "Articles of the law")
        pages = dict.fromkeys((article.link, article.as_of) for article in provisions)
        for link, as_of in pages:
            yield linked(f"{link} , as of {as_of}" if as_of else link)
        yield f"Dealt with: {progress(provisions)}."
        yield provision_table(provisions)


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


def _values_section(inherited: BookLineage, at: str) -> Iterator[Block]:
    rows = [
        row
        for provision in inherited.provisions
        if provision.kind != "definition" and provision.used
        for row in _values(provision)
    ]
    if rows:
        yield Heading(2, "Options and parameters")
        yield f"The value that counts on {at} is the one with a mark."
        head = ["name", "kind", "value", "counts", "in force", "given by", "note"]
        yield table(head, rows)


def _values(constant_history: ConstantHistory) -> Iterator[list[str]]:
    for setting in constant_history.settings:
        dates = print_in_force(tree.InForce(setting.since, setting.until))
        yield [
            code(constant_history.name),
            constant_history.kind,
            code(setting.text),
            "✔" if setting.current else "",
            dates.removeprefix("in force").strip() or "always",
            code(setting.book),
            escaped(setting.note),
        ]


def _definitions_section(inherited: BookLineage) -> Iterator[Block]:
    definitions = [
        provision
        for provision in inherited.provisions
        if provision.kind == "definition" and provision.used
    ]
    if definitions:
        yield Heading(2, "Definitions")
    for definition in definitions:
        *earlier, last = definition.settings
        before = [f"in {code(setting.book)} {code(setting.text)}" for setting in earlier]
        was = f" It was {listed(before)}." if before else ""
        note = f" {escaped(last.note)}" if last.note else ""
        yield f"{code(definition.name)} is defined by {code(last.book)}.{was}{note}"
        written = f"define {definition.head} = {last.text}"
        if len(written) > WIDTH:
            meaning = "\n  ".join(formula_lines(last.text, WIDTH - 2))
            written = f"define {definition.head} =\n  {meaning}"
        yield fenced(written, "rulec")


def _left_out_section(inherited: BookLineage, at: str) -> Iterator[Block]:
    rows = list(_left_out(inherited, at))
    if rows:
        yield Heading(2, "What this rulebook leaves out")
        yield table(["rule or topic", "what happened", "why"], rows)


def _left_out(inherited: BookLineage, at: str) -> Iterator[list[str]]:
    for rule in inherited.rules:
        last = rule.last
        if last.deed == "dropped":
            yield [code(rule.name), f"dropped by {code(last.book)}", escaped(last.because)]
        elif last.deed == "silent":
            yield [code(rule.name), f"{code(last.book)} is silent on it", escaped(last.because)]
        elif rule.rule is not None and not in_force(rule.rule.in_force, at):
            assert rule.rule.in_force is not None, "what has no dates is in force"
            dates = print_in_force(rule.rule.in_force)
            yield [code(rule.name), f"not in force on {at}", dates]


def _words_section(loaded: Loaded) -> Iterator[Block]:
    rulebook = loaded.rulebook
    used = used_declarations(rulebook)
    described = _descriptions(loaded)
    rows = [
        [code(name), _about(word), _kind(word) + _marks(word), escaped(described.get(name, ""))]
        for name, word in rulebook.vocabulary.declarations.items()
        if name in used
    ]
    if rows:
        yield Heading(2, "Vocabulary")
        yield "What the rules speak of, and what it can be; the default is in parentheses."
        yield table(["word", "is about", "what it can be", "description"], rows)
    if rulebook.axioms:
        yield Heading(2, "What always holds")
        yield "Whatever the rules say, this is so in every state:"
        axioms = [f"fact {formula_text(axiom.formula)}" for axiom in rulebook.axioms]
        yield fenced("\n".join(axioms), "rulec")


def _descriptions(loaded: Loaded) -> Mapping[str, str]:
    result: dict[str, str] = {}
    for file in (*loaded.vocabularies, *loaded.books):
        for item in file.items:
            match item:
                case tree.SignalItem(signals=signals):
                    result |= {signal.name.text: description(item.span) for signal in signals}
                case tree.EnumerationItem(name=name) | tree.QuantityItem(name=name):
                    result[name.text] = description(item.span)
    return result


def _about(item: Declaration) -> str:
    types = " and ".join(code(spoken(parameter)) for parameter in item.parameters)
    return f"every {types}" if types else "the world"


def _marks(item: Declaration) -> str:
    """What else is declared of it, behind its values."""
    said = {"never changes": item.constant, "presumed": item.presumed}
    return "".join(f"; {mark}" for mark, holds in said.items() if holds)


def _kind(item: Declaration) -> str:
    match item:
        case Enumeration(values=values, default=default):
            shown = [f"({code(value)})" if value == default else code(value) for value in values]
            return f"one of {listed(shown)}"
        case Signal(default=default):
            return {None: "yes or no", True: "(yes) or no", False: "yes or (no)"}[default]
        case Quantity(unit=unit, default=default):
            usual = "" if default is None else f" ({repr(default).removesuffix('.0')})"
            return f"a number of {code(unit)}{usual}"
