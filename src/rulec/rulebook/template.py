"""A rulebook to start from: on its own, or extending another one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import date
from pathlib import Path
from textwrap import wrap

from rulec.diagnostics import RulecError
from rulec.files.text_templates import filled
from rulec.rulebook.loader import parse_rulebook, read_trees, resolve_trees
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.rulebook_messages import no_name
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.rulebook.rules.rule_topics import by_group
from rulec.syntax import decode, parse, tree

_NEW = Path(__file__).with_name("new_rulebook.txt")
_UPON = Path(__file__).with_name("new_rulebook_upon.txt")

_WIDTH = 96
"""The width of lists of names, in characters."""


def new_rulebook(name: str, today: date) -> str:
    """Text of a new rulebook that checks, tests and compiles.

    Raises RulecError R0738 if a rulebook cannot have this name.
    """
    _refuse(name)
    text = filled(_NEW, {"name": name, "today": today.isoformat()})
    parse_rulebook(text, f"{name}.rules")
    return text


def new_rulebook_upon(name: str, base: str, today: date, search_path: Sequence[Path] = ()) -> str:
    """The text of a new rulebook that extends another one, with possible changes as comments.

    Raises RulecError if a rulebook cannot have this name (R0738), or if the base cannot be read.
    """
    _refuse(name)
    trees = read_trees(base, search_path)
    inherited = resolve_trees(trees).rulebook
    head = filled(_UPON, {"name": name, "base": base, "today": today.isoformat()})
    text = "\n".join([head, *_changes(inherited, trees.books)])
    parse_rulebook(text, f"{name}.rules", search_path)
    return text


def _refuse(name: str) -> None:
    """Raise RulecError R0738 if this is no name of a rulebook."""
    try:
        source = decode(name, f"rulebook {name}\n{_ANY}".encode("utf-8", "replace"))
        if parse(source)[1]:
            raise no_name(name)
    except RulecError:
        raise no_name(name) from None


_ANY = "signal p\nhard rule r { require p }\n"


def _changes(base: Rulebook, books: Sequence[tree.File]) -> Iterator[str]:
    if base.traffic:
        other = "left" if base.traffic == "right" else "right"
        yield f"# traffic {other}   # belongs into the header; `{base.name}` says {base.traffic}"
        yield ""
    options = _options(books)
    if options:
        more = f"`rulec show --tree {base.name} --all` has numbers to set, too."
        yield f"# What laws differ in; {more}"
        yield from (*options, "")
    if base.rules:
        yield "# A rule becomes your own law by its article, is left out, or may yield, as these:"
        yield from _changed(base.rules)
        yield f"# The rules of `{base.name}`, whose sentences `rulec show {base.name}` has:"
        for heading, names in by_group([base]).items():
            yield from wrap(
                f"{heading}: {', '.join(names)}",
                _WIDTH,
                initial_indent="#   ",
                subsequent_indent="#     ",
                break_on_hyphens=False,
            )
        yield ""
    yield '# silent on TOPIC because "…"'
    yield ""


def _options(books: Sequence[tree.File]) -> list[str]:
    """The options as they are set, each with what is said about it."""
    values: dict[str, tuple[bool, str]] = {}
    for item in (item for book in books for item in book.items):
        if isinstance(item, tree.OptionItem | tree.SetItem) and isinstance(item.value, bool):
            _, known = values.get(item.name.text, (False, ""))
            notes = (item.cite.value if item.cite else ""), description(item.span)
            values[item.name.text] = item.value, ": ".join(filter(None, notes)) or known
    return [
        f'# set {name} = {"on" if value else "off"} cite "…"{note and f"  # {note}"}'
        for name, (value, note) in values.items()
    ]


def _changed(rules: Sequence[Rule]) -> Iterator[str]:
    """The ways to change a rule, shown for the first one, and for a hard one."""
    first = rules[0]
    about = ", ".join(f"{variable.name}: {variable.type}" for variable in first.variables)
    yield f'# override rule {first.name}{f" ({about})" if about else ""} {{ cite "…" }}'
    yield f'# drop rule {first.name} because "…"'
    hard = next((rule.name for rule in rules if rule.strength == "hard"), "")
    yield from [f'# soften rule {hard} because "…"'] if hard else []
