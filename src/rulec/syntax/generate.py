"""``python -m rulec.syntax.generate grammar/rulec.tables.json`` makes the parser's tables anew."""

from __future__ import annotations

import sys
from pathlib import Path

from rulec.files import written_whole
from rulec.resources import grammar_file
from rulec.syntax.grammar import tables_of

if __name__ == "__main__":
    with written_whole(Path(sys.argv[1])) as stream:
        stream.write(tables_of(grammar_file("rulec.lark").read_text(encoding="utf-8")).encode())
