"""Ctrl-C at any moment: status 130, no traceback, nothing left behind."""

import subprocess
import sys

import pytest

from support.builders.terminal_signals import as_from_a_terminal

VERIFY = ["verify", "docs/samples/traces.jsonl", "-r", "esterle2019"]

AT_AN_IMPORT = """
import os, signal, sys
module = sys.argv.pop(1)
class Interrupting:
    def find_spec(self, name, path, target=None):
        if name == module:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupting())
from rulec.cli.entry_point import run
sys.exit(run())
"""

IN_A_FINALIZER = """
import sys, time
from rulec.cli import entry_point, main
class Interrupted:
    def __del__(self):
        raise KeyboardInterrupt
def interrupted():
    Interrupted()
    time.sleep(60)
main.main = interrupted
sys.exit(entry_point.run())
"""


def ended(program, *arguments):
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        capture_output=True,
        check=False,
        preexec_fn=as_from_a_terminal,
    )
    return done.returncode, done.stdout, done.stderr.strip()


@pytest.mark.parametrize(
    "module",
    [
        "rulec.version",
        "click",
        "rulec.cli.commands.verify",
        "rulec.automata.bundle.compiled_rulebook",
    ],
)
def test_while_modules_are_imported(module):
    status, out, err = ended(AT_AN_IMPORT, module, *VERIFY)
    assert (status, out) == (130, b"")
    assert err in (b"", b"rulec: interrupted")


def test_where_nothing_can_be_raised():
    assert ended(IN_A_FINALIZER) == (130, b"", b"")
