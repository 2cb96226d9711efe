"""Help and completion of a verb wait for nothing that only its run needs."""

import subprocess
import sys

from rulec.cli.exit_status import ExitStatus
from rulec.cli.main import VERBS

HEAVY = {
    "lark",
    "markdown_it",
    "msgspec",
    "numpy",
    "pint",
    "rich",
    "shapely",
    "rulec.api.session",
    "rulec.api.rulebook_compilation",
    "rulec.monitoring.verdict",
    "rulec.partition",
    "rulec.rulebook.loader",
    "rulec.scenario",
    "rulec.syntax",
}


def test_no_verb_imports_at_its_top_what_only_its_run_needs():
    verbs = [f"rulec.cli.commands.{verb}" for verb in VERBS if verb != "list"]
    program = (
        "import sys; from importlib import import_module\n"
        f"for verb in {verbs}: import_module(verb)\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert HEAVY & set(done.stdout.decode().split()) == set()


def test_what_was_not_answered_outweighs_what_failed():
    assert ExitStatus.after(failed=False) is ExitStatus.OK
    assert ExitStatus.after(failed=True) is ExitStatus.FOUND
    assert ExitStatus.after(answered=False, failed=True) is ExitStatus.NOT_ANSWERED
    assert ExitStatus.after(answered=False, failed=False) is ExitStatus.NOT_ANSWERED
