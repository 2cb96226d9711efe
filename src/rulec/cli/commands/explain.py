"""``rulec explain``: what the code of a message means."""

from __future__ import annotations

import click

from rulec.cli.options.shell_completion import complete_codes


@click.command()
@click.argument("code", required=False, shell_complete=complete_codes)
@click.option("--all", "every", is_flag=True, help="Explain every code.")
@click.option(
    "--output-format",
    type=click.Choice(["full", "json", "markdown"]),
    default="full",
    show_default=True,
    help="Text, JSON, or Markdown (with --all the page docs/codes.md).",
)
def command(code: str | None, every: bool, output_format: str) -> None:
    """Explain CODE, such as R0104: what it means, a bad example, and the mended one."""
    from rulec.diagnostics import nearest_name
    from rulec.diagnostics.codes import CODES
    from rulec.report.findings import code_pages
    from rulec.report.text.console import print_result

    if every == (code is not None):
        raise click.UsageError("give one code, or --all")
    codes = list(CODES) if code is None else [code.upper()]
    if codes[0] not in CODES:
        near = nearest_name(codes[0], CODES)
        raise click.UsageError(
            f"there is no code `{code}`; "
            + (f"did you mean `{near}`?" if near else "`rulec list codes` shows them all")
        )
    match output_format:
        case "json":
            print_result(code_pages.as_json(codes))
        case "markdown" if every:
            print_result(code_pages.as_page())
        case "markdown":
            print_result(f"# {codes[0]}: {CODES[codes[0]]}\n\n{code_pages.as_markdown(codes[0])}")
        case _:
            print_result("\n\n\n".join(code_pages.as_text(code) for code in codes))
