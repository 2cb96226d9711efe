"""What all pages share: a head, a style that follows the reader's theme, no script."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

_STYLE = """
:root { color-scheme: light dark; --line: #8886; --soft: #8882; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; margin: .5em 0 1em; font-variant-numeric: tabular-nums; }
th, td { border: 1px solid var(--line); padding: .2em .6em; text-align: left; }
thead th, .name { background: var(--soft); }
h2 { margin-top: 2em; font-size: 1.1em; }
.wide { overflow-x: auto; }
.equal { color: light-dark(#176b2c, #7ed491); }
.stricter { color: light-dark(#a1260d, #ff9b85); }
.laxer { color: light-dark(#0b539b, #86bdf5); }
.incomparable { color: light-dark(#7b1fa2, #dba1f2); }
.undecided { color: light-dark(#7a5b00, #e6c45c); }
"""


def page(title: str, parts: Iterable[str]) -> str:
    """A whole document; ``parts`` are HTML already."""
    body = "\n".join(parts)
    return (
        "<!doctype html>\n"
        '<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n"
        f"<body>\n<h1>{escape(title)}</h1>\n{body}\n</body>\n</html>"
    )


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the cells are HTML already, the first one of each row names it."""
    lines = ['<div class="wide"><table>', "<thead>", _row(head, "th"), "</thead>", "<tbody>"]
    lines += [_named(row) for row in rows]
    return "\n".join([*lines, "</tbody>", "</table></div>"])


def _row(cells: Sequence[str], tag: str) -> str:
    return f"<tr>{''.join(f'<{tag}>{cell}</{tag}>' for cell in cells)}</tr>"


def _named(cells: Sequence[str]) -> str:
    first, *rest = cells
    others = "".join(f"<td>{cell}</td>" for cell in rest)
    return f'<tr><th scope="row" class="name">{first}</th>{others}</tr>'
