"""The parser's tables, ``grammar/rulec.tables.json``, generated from ``grammar/rulec.lark``."""

from __future__ import annotations

from rulec.resources import grammar_file
from rulec.syntax.table_generation import tables_of


def parser_tables() -> str:
    """Generate the tables, so that the parser need not compute them at each start."""
    return tables_of(grammar_file("rulec.lark").read_text(encoding="utf-8"))
