"""The rules of grammar/rulec.lark in Markdown, words as they are written."""

import re

from rulec.syntax.messages.parse_context import spelling

SECTION = re.compile(r"^// ([A-Z][^.\n]*)(?:\..*)?\n(?=(?://.*\n)*\n)", re.MULTILINE)
RULE = re.compile(r"^\??([a-z_]+): *(.*(?:\n +\|.*)*)", re.MULTILINE)
CLASSES = frozenset(("BOOK", "NAME", "STRING", "DATE", "NUMBER", "UNIT"))
"""The tokens that are no fixed words; docs/grammar.md says what they are."""


def sections(text: str) -> list[tuple[str, dict[str, str]]]:
    """Titles with their rules: name -> what it stands for, as in the file."""
    body = text[text.index("\nfile:") :]
    used = set(re.findall(r"\w+", " ".join(text for _, text in RULE.findall(body)))) | {"file"}
    first, *rest = SECTION.split(body)
    found = [
        (title, {name: rule for name, rule in RULE.findall(text) if name in used})
        for title, text in zip(["Files", *rest[::2]], [first, *rest[1::2]], strict=True)
    ]
    return [(title, rules) for title, rules in found if rules]


def production(text: str) -> list[str]:
    """The alternatives of a rule, with links to other rules and words in quotes."""
    text = re.sub(r"\s*-> *\w+", "", text)
    text = re.sub(r"\b[a-z][a-z_]+\b", r"`\g<0>`", text)
    text = re.sub(
        r"\b[A-Z][A-Z_]+\b",
        lambda kind: kind[0] if kind[0] in CLASSES else f'"{spelling(kind[0])}"',
        text,
    )
    return [line.strip() for line in text.split("\n")]


def grammar(text: str) -> str:
    """A heading for each section of the grammar, with the rules below it."""
    parts = []
    for title, rules in sections(text):
        lines = ["```{eval-rst}", ".. productionlist::"]
        for name, text in rules.items():
            first, *others = production(text)
            lines += [f"   {name}: {first}", *(f"      : {other}" for other in others)]
        parts.append("\n".join([f"## {title}", "", *lines, "```"]))
    return "\n\n".join(parts)
