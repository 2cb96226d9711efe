"""``rulec help --completion``: the script that makes a shell complete rulec's commands."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

from rulec.cli.options.verb_class import argument, verb
from rulec.report.text.console import print_result


@verb
@click.pass_context
def command(
    context: click.Context,
    *,
    shell: str = argument(type=click.Choice(["bash", "fish", "zsh"])),
) -> None:
    """Print the script for SHELL: bash (4.4 or later), zsh or fish.

    \b
    bash:  rulec help --completion bash > ~/.local/share/bash-completion/completions/rulec
    zsh:   rulec help --completion zsh > "${fpath[1]}/_rulec"
    fish:  rulec help --completion fish > ~/.config/fish/completions/rulec.fish
    """  # noqa: D301 - click reads the backspace
    kind = get_completion_class(shell)
    assert kind is not None, "these shells are click's own"
    program = kind(context.find_root().command, {}, "rulec", "_RULEC_COMPLETE")
    # Not `source()`, which for bash first runs this machine's bash to get its version.
    script = (program.source_template % program.source_vars()).strip()
    # In an answer such as `plain,check<tab>Check rulebooks, and …` only the first comma separates;
    # click's script for fish would drop the text after the second.
    print_result(script.replace('string split ","', 'string split --max 1 ","'))
