"""``rulec explain``: what the code of a message means."""

from __future__ import annotations

import click

from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shell_completion import complete_codes
from rulec.cli.options.verb_class import Verb
from rulec.cli.output import put_answer
from rulec.diagnostics import nearest_name
from rulec.diagnostics.code import Code
from rulec.report.findings import code_registry
from rulec.report.text.terminal_text import first_of
from rulec.settings import search_path


@click.command(cls=Verb)
@click.argument("names", nargs=-1, metavar="[CODE]...", shell_complete=complete_codes)
@click.option("--all", "every", is_flag=True, help="Explain every code.")
@output_options(
    endings_of("full", "json", "markdown"),
    "the explanation: text, JSON, or Markdown (with --all the page docs/codes.md)",
)
def command(names: tuple[str, ...], every: bool, to: Output) -> None:
    """Explain each CODE, such as R0104: what it means, a bad example, and the mended one."""
    if every == bool(names):
        raise click.UsageError("give a code, or --all")
    codes = [*dict.fromkeys(map(_named, names))] or [*code_registry.all_codes().values()]
    match to.form:
        case "json":
            # Only this format needs msgspec, 8 of the 54 ms that the command takes.
            from rulec.report.findings.diagnostics_json import codes_as_json

            text = codes_as_json(codes)
        case "markdown" if names:
            text = "\n\n".join(
                f"# {one.code}: {one.title}\n\n{code_registry.as_markdown(one)}" for one in codes
            )
        case "markdown":
            text = code_registry.as_page()
        case _:
            text = "\n\n\n".join(map(code_registry.as_text, codes))
    put_answer(text, to)


def _named(name: str) -> Code:
    code = code_registry.code_named(name.upper())
    if code is None:
        raise click.UsageError(f"there is no code `{name}`; {_way_out(name)}")
    return code


def _way_out(name: str) -> str:
    """Where something else of this name is explained, or a code that may be meant."""
    # Looking for files and their rules, 60 ms: only for what is no code.
    from rulec.rulebook.files.catalogue import rulebooks_with_rule
    from rulec.rulebook.files.search_path import available_rulebooks
    from rulec.rulebook.files.words_in_files import vocabularies_with

    if near := nearest_name(name.upper(), code_registry.all_codes()):
        return f"did you mean `{near}`?"
    if name in available_rulebooks(search_path()):
        return f"it is a rulebook, which `rulec show {name}` explains"
    if books := rulebooks_with_rule(name, search_path()):
        more = f" (also of {first_of(books[1:], 3)})" if books[1:] else ""
        return f"it is a rule, which `rulec show {books[0]} {name}` explains{more}"
    if vocabularies := vocabularies_with(name):
        return f"it is a word of the vocabulary `{vocabularies[0]}`, whose file says what it means"
    return (
        "`rulec list codes` shows them all; `rulec show RULEBOOK RULE` explains a rule, `rulec "
        "verify` a violation"
    )
