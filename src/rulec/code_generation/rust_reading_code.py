"""Reading of digits in Rust; the functions that it calls are in ``rust_texts/readings.rs``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rulec.code_generation.reading_code import NAME, ReadingCode, unread

_KINDS = {"double": "f64", "uint8_t": "u8", "uint16_t": "u16", "uint32_t": "u32", "int64_t": "i64"}


class RustReadingCode(ReadingCode):
    """The same readings in Rust."""

    _input = "input"

    def _name(self, about: str, number: int) -> str:
        return f"{about}_{number}" if about in ("count", "sum") else f"{about.upper()}_{number}"

    def _word(self, name: str) -> str:
        return name

    def _call(self, name: str, *arguments: str) -> str:
        return f"{name}({', '.join(arguments)})"

    def _whole(self, number: int) -> str:
        return str(number)

    def _expression(self, name: str, places: Sequence[str]) -> str:
        field = self._fields.identifiers[name]
        if not places:
            return f"input.{field}"
        if len(places) == 1:
            return f"input.objects[{places[0]}].{field}"
        return f"of_{field}({', '.join(['input', *places])})"

    def _is_same(self, left: str, right: str) -> str:
        return f"if {left} == {right} {{ YES }} else {{ NO }}"

    def _array(self, kind: str, about: str, items: Sequence[float]) -> str:
        own = f"[{_KINDS[kind]}; {len(items)}]"
        content = ", ".join(map(repr, items))
        return f"&{self._defined(about, f'static {NAME}: {own} = [{content}];')}"

    def _shaped(self, *arrays: str | None, sizes: tuple[int, int]) -> str:
        del sizes
        names = ("factors", "limits", "inclusive", "whole_factors", "whole_limits")
        parts = [f"{name}: {array or '&[]'}" for name, array in zip(names, arrays, strict=True)]
        name = self._defined("shape", f"static {NAME}: Shape = Shape {{ {', '.join(parts)} }};")
        return f"&{name}"

    def _returning(self, value: str) -> list[str]:
        return [value]

    def _counting(self, counts: str) -> list[str]:
        start = "let mut found = 0;\n    for each in 0..input.objects.len() {"
        return [start, f"    found += {counts};", "}", "found"]

    def _weighing(self, values: Sequence[str], counted: Sequence[bool], shape: str) -> list[str]:
        lines = []
        for number, (value, is_count) in enumerate(zip(values, counted, strict=True)):
            lines.append(f"let term{number} = {value};")
            if is_count:
                low, high = f"f64::from(term{number} & 0xffff)", f"f64::from(term{number} >> 16)"
            else:
                low = high = f"term{number}"
            lines.append(f"let term{number} = ({low}, {high});")
        terms = ", ".join(f"term{number}" for number in range(len(values)))
        return [*lines, f"weigh(&[{terms}], {shape})"]

    def _function_pattern(self, kind: str, parameters: Sequence[str], lines: Sequence[str]) -> str:
        given = "".join(f", {name}: usize" for name in parameters)
        code = "\n    ".join([*ignored_in_rust(unread(parameters, lines)), *lines])
        return f"fn {NAME}(input: &Input{given}) -> {_KINDS[kind]} {{\n    {code}\n}}"


def ignored_in_rust(parameters: Iterable[str]) -> list[str]:
    """Statements for parameters that are not read, of which compilers would warn."""
    return [f"let _ = {name};" for name in parameters]
