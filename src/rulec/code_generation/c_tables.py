"""The tables of a monitor as static constants in C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate

from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.code_generation.monitor_layout import MonitorLayout, RuleLayout
from rulec.code_generation.written_names import c_string, in_comment

_RULE = """\
typedef struct {
    uint32_t first_cell;
    uint32_t first_entry;
    uint32_t first_instance;
    uint32_t n_instances;
    uint32_t first_word; /* of the sets of states */
    uint16_t n_cells;
    uint16_t n_classes;
    uint16_t n_states;
    uint16_t n_variables;
    uint16_t last; /* variable, if there are any */
    uint16_t first_together;
    uint16_t n_together;
    uint16_t seats_first[RULEC_VARIABLES];
    uint16_t seats_end[RULEC_VARIABLES];
    uint8_t types[RULEC_VARIABLES];
    uint8_t start; /* the verdict before the first state */
    uint8_t hard;
    uint8_t facts; /* facts exclude some letters */
} rulec_rule;
"""


def type_tables(layout: MonitorLayout) -> Iterator[str]:
    """Which types are subtypes of which, and the seats of each."""
    kinds, vocabulary = layout.fields.types, layout.fields.vocabulary
    yield "/* By type, and the type of an object; nobody fits none. */"
    yield "static const uint8_t rulec_fits[RULEC_TYPES][RULEC_TYPES + 1u] = {"
    for of in kinds:
        fits = [int(own == of or vocabulary.is_subtype(own, of)) for own in kinds]
        yield f"    {{{_listed(f'{each}u' for each in [*fits, 0])}}},"
    yield "};"
    for name, place in (("first", 0), ("end", 1)):
        seats = _listed(f"{layout.seats[kind][place]}u" for kind in kinds)
        yield f"static const uint16_t rulec_{name}[RULEC_TYPES] = {{{seats}}};"


def rule_tables(layout: MonitorLayout) -> Iterator[str]:
    """The cells and entries of all rules, and where each rule's begin."""
    rules, needed = layout.rules, layout.array_sizes
    # Padding, so that even a wrong place reads within the array.
    behind = needed["NODES"] + needed["MOST_DIGIT"] + 1
    yield from _stretches("cells", rules, [rule.cells for rule in rules], behind)
    yield "/* The state reached times 4, and the verdict: by state and class of letters. */"
    yield from _stretches("entries", rules, [rule.entries for rule in rules])
    together = [place for rule in rules for place in rule.together]
    together += [0] * max(1, *[len(rule.together) for rule in rules])
    yield f"static const uint16_t rulec_together[{len(together)}u] = {{"
    yield from _lines(together)
    yield "};"
    sizes = [size for own in layout.sizes for size in own]
    world, own, _ = map(len, layout.sizes)
    sizes += [0] * (needed["PLACES"] + 1)
    yield f"static const uint8_t rulec_sizes[{len(sizes)}u] = {{"
    yield from _lines(sizes)
    yield "};"
    of = [0, *[world] * 6, world + own, *[0] * 8]
    starts = _listed(f"{n}u" for n in of)
    yield f"static const uint16_t rulec_sizes_of[RULEC_SOURCES] = {{{starts}}};"
    yield ""
    yield _RULE
    yield "static const rulec_rule rulec_rules[RULEC_RULES] = {"
    yield from _rows(layout)
    yield "};"


def text_tables(layout: MonitorLayout) -> Iterator[str]:
    """Names, articles, and digests of the sources, as constants."""
    book = layout.rulebook
    digests = [f"{source.name} {source.sha256}" for source in book.sources] or [""]
    for name, size, texts in (
        ("rule_names", "RULEC_RULES", [own.rule.name for own in layout.rules]),
        ("rule_articles", "RULEC_RULES", [own.rule.cite for own in layout.rules]),
        ("sources", "RULEC_N_SOURCES", digests),
    ):
        yield f"const char *const rulec_{name}[{size}] = {{"
        for text in texts:
            yield f"    {c_string(text)},"
        yield "};"
    numbers = _listed(f"{len(own.rule.variables)}u" for own in layout.rules)
    yield f"const uint8_t rulec_rule_variables[RULEC_RULES] = {{{numbers}}};"


def _rows(layout: MonitorLayout) -> Iterator[str]:
    rules, kinds = layout.rules, layout.fields.types
    firsts = zip(
        _firsts(len(own.cells) for own in rules),
        _firsts(len(own.entries) for own in rules),
        _firsts(own.n_instances for own in rules),
        _firsts(own.n_words for own in rules),
        _firsts(len(own.together) for own in rules),
        strict=True,
    )
    for own, (cell, entry, instance, word, together) in zip(rules, firsts, strict=True):
        machine, n = own.rule.machine, layout.n_variables
        types = [kinds.index(variable.type) for variable in own.rule.variables]
        numbers = [
            *(cell, entry, instance, own.n_instances, word, len(own.cells)),
            *(len(machine.successors[0]), len(machine.successors), len(own.seats)),
            *(max(0, len(own.seats) - 1), together, len(own.together)),
        ]
        lists = [
            _listed(f"{number}u" for number in (*column, *[0] * (n - len(column))))
            for column in ([x for x, _ in own.seats], [x for _, x in own.seats], types)
        ]
        flags = own.start, int(own.rule.strength == "hard"), int(IMPOSSIBLE in machine.letters)
        yield f"    /* {in_comment(own.rule.name)}: {in_comment(own.rule.cite)} */"
        yield (
            f"    {{{_listed(f'{number}u' for number in numbers)}, "
            + ", ".join(f"{{{column}}}" for column in lists)
            + f", {_listed(f'{flag}u' for flag in flags)}}},"
        )


def _stretches(
    name: str, rules: Sequence[RuleLayout], stretches: Sequence[Sequence[int]], behind: int = 0
) -> Iterator[str]:
    size = sum(map(len, stretches)) + behind
    yield f"static const uint16_t rulec_{name}[{size}u] = {{"
    for own, stretch in zip(rules, stretches, strict=True):
        yield f"    /* {in_comment(own.rule.name)} */"
        yield from _lines(stretch)
    if behind:
        yield "    /* behind what is read */"
    yield from _lines([0] * behind)
    yield "};"


def _lines(numbers: Sequence[int]) -> Iterator[str]:
    for start in range(0, len(numbers), 14):
        yield "    " + "".join(f"{number}u, " for number in numbers[start : start + 14]).rstrip()


def _listed(items: Iterable[str]) -> str:
    return ", ".join(items)


def _firsts(lengths: Iterable[int]) -> list[int]:
    return list(accumulate(lengths, initial=0))[:-1]
