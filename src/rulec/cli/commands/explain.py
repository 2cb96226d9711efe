"""``rulec explain``: what the code of a message means."""

from __future__ import annotations

import click

from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.shell_completion import complete_codes
from rulec.cli.output import put_answer
from rulec.diagnostics import nearest_name
from rulec.report.findings import code_registry


@click.command()
@click.argument("code", required=False, shell_complete=complete_codes)
@click.option("--all", "every", is_flag=True, help="Explain every code.")
@output_options(
    endings_of("full", "json", "markdown"),
    "the explanation: text, JSON, or Markdown (with --all the page docs/codes.md)",
)
def command(code: str | None, every: bool, to: Output) -> None:
    """Explain CODE, such as R0104: what it means, a bad example, and the mended one."""
    if every == (code is not None):
        raise click.UsageError("give one code, or --all")
    named = None if code is None else code_registry.code_named(code.upper())
    if code is not None and named is None:
        near = nearest_name(code.upper(), code_registry.all_codes())
        raise click.UsageError(
            f"there is no code `{code}`; "
            + (f"did you mean `{near}`?" if near else "`rulec list codes` shows them all")
        )
    codes = [*code_registry.all_codes().values()] if named is None else [named]
    match to.form:
        case "json":
            # Only this format needs msgspec, 8 of the 54 ms that the command takes.
            from rulec.report.findings.diagnostics_json import codes_as_json

            text = codes_as_json(codes)
        case "markdown" if named is not None:
            text = f"# {named.code}: {named.title}\n\n{code_registry.as_markdown(named)}"
        case "markdown":
            text = code_registry.as_page()
        case _:
            text = "\n\n\n".join(map(code_registry.as_text, codes))
    put_answer(text, to)
