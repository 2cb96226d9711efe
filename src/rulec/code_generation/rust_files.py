"""A Rust crate around the monitor in C: without the standard library or dependencies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from rulec.code_generation.c_files import c_header, c_source, head_lines, in_own_names
from rulec.code_generation.input_fields import RULE, TYPE, FieldSpelling, meaning
from rulec.code_generation.monitor_layout import MonitorLayout
from rulec.code_generation.written_names import in_comment, prefix_of, rust_string
from rulec.files.text_templates import filled
from rulec.vocabulary import Declaration

_TEXTS = Path(__file__).parent / "rust_texts"

_SPELLING = FieldSpelling("u8", "f64", "UNKNOWN", "UNKNOWN_NUMBER")

_PUBLIC = ("RULES", "TYPES", "SEATS")
_OF_STATE = frozenset(
    ("VARIABLES", "INSTANCES", "WORDS", "STATE_WORDS", "CELL_WORDS", "CLASS_WORDS", "DIGITS")
)
"""The sizes of arrays in the monitor's state, by their names in the code."""


def crate_texts(layout: MonitorLayout) -> dict[str, str]:
    """The files of the crate, by their paths in its folder."""
    name = prefix_of(layout.rulebook.name)
    named = {"name": name}
    return {
        "Cargo.toml": filled(_TEXTS / "Cargo.toml.in", named),
        "build.rs": filled(_TEXTS / "build.rs", named),
        f"c/{name}.h": c_header(layout),
        f"c/{name}.c": c_source(layout),
        "src/lib.rs": rust_source(layout),
        "tests/steps.rs": filled(_TEXTS / "steps.rs", named),
    }


def rust_source(layout: MonitorLayout) -> str:
    """The code that gives the monitor in C the types of Rust."""
    fields, names = layout.fields, layout.fields.identifiers
    world, own, several = (list(fields.about(number)) for number in range(3))
    none = [(names[item.name], "None") for item in several]
    places = {
        "head": (f"// {line}".rstrip() for line in head_lines(layout)),
        "sizes": (
            f"{'pub ' if name in _PUBLIC else ''}const {name}: usize = {size};"
            for name, size in layout.array_sizes.items()
            if name in _PUBLIC or name in _OF_STATE
        ),
        "variables": ", ".join(str(len(own.rule.variables)) for own in layout.rules),
        "names": _numbers(layout),
        "texts": _texts(layout),
        "own_fields": (line for item in own for line in _field(item, layout)),
        "world_fields": _world_fields(layout),
        "own_defaults": _inits(_initials(own, layout, defaults=True)),
        "own_unknown": _inits(_initials(own, layout, defaults=False)),
        "world_defaults": _inits([*_initials(world, layout, defaults=True), *none]),
        "world_unknown": _inits([*_initials(world, layout, defaults=False), *none]),
        "pairs": _pairs(layout),
        "c_fields": [
            *(f"{names[item.name]}: {_SPELLING.kind(item)}," for item in world),
            *(f"{names[item.name]}: *const {_SPELLING.kind(item)}," for item in several),
        ],
        "c_values": [
            *(f"{names[item.name]}: input.{names[item.name]}," for item in world),
            *(
                f"{name}: input.{name}.map_or(core::ptr::null(), <[_]>::as_ptr),"
                for name, _ in none
            ),
        ],
    }
    return in_own_names(filled(_TEXTS / "monitor.rs", places), layout)


def _numbers(layout: MonitorLayout) -> Iterator[str]:
    fields = layout.fields
    for name, number in fields.numbered(RULE, fields.rules):
        yield f"// {in_comment(layout.rules[number].about)}"
        yield f"pub const {name}: usize = {number};"
    of_values = (fields.numbered(item.name, item.values) for item in fields.enumerations())
    for numbered in (fields.numbered(TYPE, fields.types), *of_values):
        yield from (f"pub const {name}: u8 = {number};" for name, number in numbered)


def _texts(layout: MonitorLayout) -> Iterator[str]:
    digests = [f"{source.name} {source.sha256}" for source in layout.rulebook.sources]
    for name, texts in (
        ("RULE_NAMES", [own.rule.name for own in layout.rules]),
        ("RULE_ARTICLES", [own.rule.cite for own in layout.rules]),
        ("SOURCE_DIGESTS", digests),
    ):
        listed = ", ".join(map(rust_string, texts))
        yield f"pub static {name}: [&str; {len(texts)}] = [{listed}];"


def _world_fields(layout: MonitorLayout) -> Iterator[str]:
    for item in layout.fields.about(0):
        yield from _field(item, layout)
    for item in layout.fields.about(2):
        yield "// For all choices of objects, the last index varying fastest; None: defaults"
        yield from _field(item, layout, f"Option<&'a [{_SPELLING.kind(item)}]>")


def _field(item: Declaration, layout: MonitorLayout, kind: str = "") -> Iterator[str]:
    name, about = (in_comment(text).replace("`", " ") for text in (item.name, meaning(item)))
    yield f"/// `{name}`{' ' if item.parameters else ''}{about}"
    yield f"pub {layout.fields.identifiers[item.name]}: {kind or _SPELLING.kind(item)},"


def _initials(
    items: Iterable[Declaration], layout: MonitorLayout, *, defaults: bool
) -> list[tuple[str, str]]:
    names = layout.fields.identifiers
    return [(names[item.name], _SPELLING.initial(item, defaults=defaults)) for item in items]


def _inits(initials: Iterable[tuple[str, str]]) -> str:
    # A word may be called like a constant: clippy wants such a field without its value
    return "".join(f", {name}" + f": {value}" * (name != value) for name, value in initials)


def _pairs(layout: MonitorLayout) -> Iterator[str]:
    several = list(layout.fields.about(2))
    if not several:
        yield "let _ = input;"
    for item in several:
        field, n = layout.fields.identifiers[item.name], len(item.parameters)
        yield f"let (given, n) = (input.{field}, {n});"
        yield "if given.is_some_and(|all| all.len() != input.objects.len().pow(n)) {"
        yield "    return false;"
        yield "}"
