"""A rulebook as a Markdown document for lawyers; ``html_page`` makes HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import groupby

from rulec.analysis.audit.provision_coverage import provisions_of
from rulec.analysis.audit.rulebook_audit import articles_of, used_declarations
from rulec.analysis.lineage.rule_lineage import BookLineage, ConstantHistory
from rulec.logic.printing import formula_text
from rulec.logic.sentences.wording import listed, spoken
from rulec.report.rulebooks.audit_report import progress, provision_table
from rulec.report.rulebooks.document.book_rule import (
    CERTAINTY,
    WIDTH,
    ExamplePicture,
    rule_heading,
    rule_section,
    time_in_force,
)
from rulec.report.rulebooks.document_language import IN_ENGLISH, DocumentLanguage
from rulec.report.text import markdown
from rulec.report.text.formula_lines import formula_lines
from rulec.report.text.markdown import Block, Heading, code, escaped, fenced, linked, table
from rulec.rulebook.loader import Trees
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.rulebook.rulebook_model import Rulebook
from rulec.syntax import tree
from rulec.version import __version__
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal

NO_ADVICE = (
    "**This is no legal advice.** It paraphrases law so that a machine can read it. What counts is "
    "the law itself."
)

ABOUT_RULES = (
    "A hard rule must never be violated, a soft rule may yield to others. In the examples a value "
    "in parentheses is not mentioned: it is the default."
)

_SIDES = {
    "right": "drives on the right",
    "left": "drives on the left",
    "": "side not stated",
}

_ENDS = {
    "stutter": "judged as if its last state went on for ever",
    "finite": "judged as it is: after its last state there is nothing",
}


def title_of(rulebook: Rulebook) -> str:
    """The rulebook's title, or its name if it has none."""
    return rulebook.title or rulebook.name


def contents_heading(words: DocumentLanguage) -> str:
    """The heading of the list of contents."""
    return words.say("Contents")


def as_markdown(
    rulebook: Rulebook,
    inherited: BookLineage,
    trees: Trees,
    words: DocumentLanguage = IN_ENGLISH,
    picture: ExamplePicture | None = None,
) -> str:
    """The whole document; ``picture`` gives for an example the address of its image."""
    top: list[Block] = [Heading(1, title_of(rulebook)), *_top(rulebook, words)]
    contents = contents_heading(words)
    body = list(_body(rulebook, inherited, trees, words, picture))
    index = Heading(2, words.say("Index of provisions"))
    headings = markdown.placed([*top, Heading(2, contents), *body])
    rules = {heading.text: place for heading, place in headings if heading.level == 3}
    body += _index(rulebook, inherited, index, rules, words)
    sources = ", ".join(code(source.name) for source in rulebook.sources)
    made_from = words.say("Made by rulec {} from {}.", __version__, sources)
    advice = f"{made_from} {words.say(NO_ADVICE)}"
    return markdown.written([*markdown.with_contents(top, contents, body), "---", advice])


def _top(rulebook: Rulebook, words: DocumentLanguage) -> Iterator[Block]:
    say = words.say
    law = escaped(rulebook.law)
    if rulebook.as_of:
        law = say("{}, as of {}", law, rulebook.as_of)
    n_hard = sum(rule.strength == "hard" for rule in rulebook.rules)
    n_soft = len(rulebook.rules) - n_hard
    bases = say(", then ").join(map(code, rulebook.extends))
    yield say(NO_ADVICE)
    rows = [
        [say("rulebook"), code(rulebook.name)],
        [say("law"), law or say("none is named")],
        [say("shown as of"), rulebook.at],
        [say("builds upon"), bases or say("no other rulebook")],
        [say("traffic"), say(_SIDES[rulebook.traffic])],
        [say("a trace is"), say(_ENDS[rulebook.semantics])],
        [say("rules"), say("{} hard, {} soft", f"{n_hard:,}", f"{n_soft:,}")],
    ]
    if rulebook.extends:
        n_inherited = sum(bool(rule.inherited_from) for rule in rulebook.rules)
        n_own = len(rulebook.rules) - n_inherited
        own = say("{} rules; {} inherited, not confirmed", f"{n_own:,}", f"{n_inherited:,}")
        rows.append([say("own law"), own])
    yield table([say("about"), say("this rulebook")], rows)


def _body(
    rulebook: Rulebook,
    inherited: BookLineage,
    trees: Trees,
    words: DocumentLanguage,
    picture: ExamplePicture | None,
) -> Iterator[Block]:
    yield Heading(2, words.say("Rules"))
    yield words.say(ABOUT_RULES if rulebook.rules else "None.")
    own = [rule for rule in rulebook.rules if not rule.inherited_from]
    others = [rule for rule in rulebook.rules if rule.inherited_from]
    for rule in own:
        yield from rule_section(rule, inherited, rulebook, words, picture)
    if own and others:
        yield Heading(2, words.say("Rules inherited, not confirmed"))
    for rule in others:
        yield from rule_section(rule, inherited, rulebook, words, picture)
    yield from _values_section(inherited, rulebook.at, words)
    yield from _definitions_section(inherited, words)
    yield from _left_out_section(inherited, rulebook.at, words)
    yield from _words_section(rulebook, trees, words)
    yield from _articles_section(rulebook, words)


def _articles_section(rulebook: Rulebook, words: DocumentLanguage) -> Iterator[Block]:
    provisions = provisions_of(rulebook)
    if provisions:
        yield Heading(2, words.say("Articles of the law"))
        pages = dict.fromkeys(
            (provision.link, provision.as_of, provision.certainty) for provision in provisions
        )
        for link, as_of, certainty in pages:
            yield linked(words.say("{} , as of {}", link, as_of) if as_of else link)
            # The link may never have been opened: the sources of rules say what they were read in.
            yield words.say(
                "There is the official text; what was read may be a copy of it. This list: {}.",
                words.say(CERTAINTY[certainty]),
            )
        yield words.say("Dealt with: {}.", progress(provisions, words))
        yield provision_table(provisions, words)


def _index(
    rulebook: Rulebook,
    inherited: BookLineage,
    heading: Heading,
    anchors: Mapping[str, str],
    words: DocumentLanguage,
) -> Iterator[Block]:
    yield heading
    laws = {book.name: book.law or book.title or book.name for book in inherited.books}
    articles = articles_of(rulebook.rules, inherited)
    if not articles:
        yield words.say("No provision is cited.")
    links = {
        rule.name: f"[{escaped(words.title(rule.name))}](#{anchors[rule_heading(rule, words)]})"
        for rule in rulebook.rules
    }
    for book, cited in groupby(articles, key=lambda article: article.book):
        yield f"{escaped(laws[book])}:"
        rows = [
            [escaped(article.cite), ", ".join(links[name] for name in article.rules)]
            for article in cited
        ]
        yield table([words.say("provision"), words.say("rules")], rows)


def _values_section(inherited: BookLineage, at: str, words: DocumentLanguage) -> Iterator[Block]:
    rows = [
        row
        for provision in inherited.provisions
        if provision.kind != "definition" and provision.used
        for row in _values(provision, words)
    ]
    if rows:
        yield Heading(2, words.say("Options and parameters"))
        yield words.say("The value that counts on {} is the one with a mark.", at)
        head = ["name", "kind", "value", "counts", "in force", "given by", "provision", "note"]
        yield table([*map(words.say, head)], rows)


def _values(constant_history: ConstantHistory, words: DocumentLanguage) -> Iterator[list[str]]:
    for setting in constant_history.settings:
        yield [
            code(constant_history.name),
            words.say(constant_history.kind),
            code(setting.text),
            "✔" if setting.current else "",
            time_in_force(setting.since, setting.until, words) or words.say("always"),
            code(setting.book),
            escaped(setting.cite),
            escaped(setting.note),
        ]


def _definitions_section(inherited: BookLineage, words: DocumentLanguage) -> Iterator[Block]:
    definitions = [
        provision
        for provision in inherited.provisions
        if provision.kind == "definition" and provision.used
    ]
    if definitions:
        yield Heading(2, words.say("Definitions"))
    for definition in definitions:
        *earlier, last = definition.settings
        before = [words.say("in {} {}", code(value.book), code(value.written)) for value in earlier]
        now = words.say("{} is defined by {}.", code(definition.name), code(last.book))
        was = words.say(" It was {}.", listed(before, words.language)) if before else ""
        notes = [f" {escaped(text)}" for text in (last.cite and f"{last.cite}.", last.note) if text]
        yield f"{now}{was}{''.join(notes)}"
        written = f"define {definition.head} = {last.text}"
        if len(written) > WIDTH:
            meaning = "\n  ".join(formula_lines(last.text, WIDTH - 2))
            written = f"define {definition.head} =\n  {meaning}"
        yield fenced(written, "rulec")


def _left_out_section(inherited: BookLineage, at: str, words: DocumentLanguage) -> Iterator[Block]:
    rows = list(_left_out(inherited, at, words))
    if rows:
        yield Heading(2, words.say("What this rulebook leaves out"))
        yield table([*map(words.say, ("rule or topic", "what happened", "why"))], rows)


def _left_out(inherited: BookLineage, at: str, words: DocumentLanguage) -> Iterator[list[str]]:
    say = words.say
    for rule in inherited.rules:
        last = rule.last
        if last.deed == "dropped":
            yield [code(rule.name), say("dropped by {}", code(last.book)), escaped(last.because)]
        elif last.deed == "silent":
            how = say("{} is silent on it", code(last.book))
            yield [code(rule.name), how, escaped(last.because)]
        elif rule.rule is not None and not in_force(rule.rule.in_force, at):
            assert rule.rule.in_force is not None, "what has no dates is in force"
            dates = rule.rule.in_force
            when = say("in force {}", time_in_force(dates.since, dates.until, words))
            yield [code(rule.name), say("not in force on {}", at), when]


def _words_section(rulebook: Rulebook, trees: Trees, words: DocumentLanguage) -> Iterator[Block]:
    say = words.say
    used = used_declarations(rulebook)
    described = _descriptions(trees)
    rows = [
        [code(name), _about(item, words), _kind(item, words), escaped(described.get(name, ""))]
        for name, item in rulebook.vocabulary.declarations.items()
        if name in used
    ]
    if rows:
        yield Heading(2, say("Vocabulary"))
        yield say("What the rules speak of, and what it can be; the default is in parentheses.")
        yield table([*map(say, ("word", "is about", "what it can be", "description"))], rows)
    if rulebook.axioms:
        yield Heading(2, say("What always holds"))
        yield say("Whatever the rules say, this is so in every state:")
        axioms = [f"fact {formula_text(axiom.formula)}" for axiom in rulebook.axioms]
        yield fenced("\n".join(axioms), "rulec")


def _descriptions(trees: Trees) -> Mapping[str, str]:
    result: dict[str, str] = {}
    for file in (*trees.vocabularies, *trees.books):
        for item in file.items:
            match item:
                case tree.SignalItem(signals=signals):
                    result |= {signal.name.text: description(item.span) for signal in signals}
                case tree.EnumerationItem(name=name) | tree.QuantityItem(name=name):
                    result[name.text] = description(item.span)
    return result


def _about(item: Declaration, words: DocumentLanguage) -> str:
    types = words.say(" and ").join(code(spoken(parameter)) for parameter in item.parameters)
    return words.say("every {}", types) if types else words.say("the world")


def _kind(item: Declaration, words: DocumentLanguage) -> str:
    """What values a word can have, and other properties declared for it."""
    remarks = {"; never changes": item.constant, "; presumed": item.presumed}
    return _values_of(item, words) + "".join(words.say(x) for x, holds in remarks.items() if holds)


def _values_of(item: Declaration, words: DocumentLanguage) -> str:
    match item:
        case Enumeration(values=values, default=default):
            shown = [f"({code(value)})" if value == default else code(value) for value in values]
            return words.say("one of {}", listed(shown, words.language))
        case Signal(default=default):
            texts = {None: "yes or no", True: "(yes) or no", False: "yes or (no)"}
            return words.say(texts[default])
        case Quantity(unit=unit, default=default):
            usual = "" if default is None else f" ({repr(default).removesuffix('.0')})"
            return words.say("a number of {}", code(unit)) + words.language.decimals(usual)
