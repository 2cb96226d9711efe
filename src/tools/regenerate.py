"""Write the repository's generated files, or name those that are out of date.

``python -m tools.regenerate [--check]``. Exit status: 0, or 1 with ``--check`` if any is.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from rulec.files.written_files import written_whole
from tools.emacs_mode import emacs_mode
from tools.json_schemas import SCHEMAS, schema_text
from tools.parser_tables import parser_tables
from tools.textmate import textmate_grammar
from tools.tree_sitter import folds, highlights, tree_sitter_grammar, tree_sitter_manifest
from tools.vscode import language_configuration, package_manifest

ROOT = Path(__file__).resolve().parents[2]
GENERATED: Mapping[str, Callable[[], str]] = {
    "grammar/rulec.tables.json": parser_tables,
    "grammar/rulec.tmLanguage.json": textmate_grammar,
    "src/editors/vscode/syntaxes/rulec.tmLanguage.json": textmate_grammar,
    "src/editors/vscode/language-configuration.json": language_configuration,
    "src/editors/vscode/package.json": package_manifest,
    "src/editors/tree_sitter/src/grammar.json": tree_sitter_grammar,
    "src/editors/tree_sitter/queries/highlights.scm": highlights,
    "src/editors/tree_sitter/queries/folds.scm": folds,
    "src/editors/tree_sitter/tree-sitter.json": tree_sitter_manifest,
    "src/editors/emacs/rulec-mode.el": emacs_mode,
    **{f"docs/schemas/{name}.json": partial(schema_text, name) for name in SCHEMAS},
}
"""Path from the root -> the function that generates its text."""


def is_current(name: str) -> bool:
    """Compare a generated file with what would be generated now."""
    path = ROOT / name
    return path.is_file() and path.read_text(encoding="utf-8") == GENERATED[name]()


def main(arguments: Sequence[str]) -> int:
    """Write every file that is out of date; with ``--check`` only name them."""
    outdated = [name for name in GENERATED if not is_current(name)]
    for name in outdated:
        print(f"{name} is out of date" if "--check" in arguments else f"wrote {name}")
        if "--check" not in arguments:
            (ROOT / name).parent.mkdir(parents=True, exist_ok=True)
            with written_whole(ROOT / name) as stream:
                stream.write(GENERATED[name]().encode())
    return int(bool(outdated) and "--check" in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
