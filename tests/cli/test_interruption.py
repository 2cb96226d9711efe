"""Ctrl-C at any moment: status 130, no traceback, nothing left behind."""

import subprocess
import sys
from random import Random
from signal import SIGINT
from time import monotonic, sleep

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
        "rulec.cli.commands.traffic.verify",
        "rulec.automata.bundle.compiled_rulebook",
    ],
)
def test_while_modules_are_imported(module):
    status, out, err = ended(AT_AN_IMPORT, module, *VERIFY)
    assert (status, out) == (130, b"")
    assert err in (b"", b"rulec: interrupted")


AN_ERROR_OF_ITS_OWN = """
import os, signal, sys
from rulec.cli import entry_point, main
def interrupted(*_, **__):
    try:
        os.kill(os.getpid(), signal.SIGINT)
        signal.sigtimedwait([], 1)
    except KeyboardInterrupt:
        raise eval(sys.argv.pop(1))("multiarray failed to import") from None
sys.modules["rulec.cli.main"].rulec.main = interrupted
sys.exit(entry_point.run())
"""


@pytest.mark.parametrize("error", ["ImportError", "RuntimeError", "OSError", "SystemError"])
def test_what_libraries_make_of_an_interrupt_is_one(error):
    assert ended(AN_ERROR_OF_ITS_OWN, error, *VERIFY) == (130, b"", b"rulec: interrupted")


TERMINATED_IN_A_FINALIZER = """
import os, signal, sys, time
from rulec.cli import entry_point, main
class Terminated:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)
class Unfinished:
    def __del__(self):
        raise ValueError("write to closed file")
def interrupted():
    unfinished = Unfinished()
    Terminated()
    time.sleep(60)
main.main = interrupted
sys.exit(entry_point.run())
"""


def test_a_signal_to_end_where_nothing_can_be_raised():
    assert ended(TERMINATED_IN_A_FINALIZER) == (143, b"", b"")


ON_A_BUSY_MACHINE = """
import threading, time
start = threading.Thread.start
def slowly(thread):
    start(thread)
    if thread.interval < 0.1:
        time.sleep(0.1)
threading.Thread.start = slowly
"""


@pytest.mark.parametrize("before", ["", ON_A_BUSY_MACHINE])
def test_where_nothing_can_be_raised(before):
    assert ended(before + IN_A_FINALIZER) == (130, b"", b"")


STARTED = """
import sys
from rulec.cli.entry_point import run
print("begun", file=sys.stderr, flush=True)
sys.exit(run())
"""

FIVE_VERBS = [
    VERIFY,
    ["draw", "trace", "docs/samples/traces.jsonl", "-r", "esterle2019", "-o", "OUT.svg"],
    ["check", "de", "--no-cache"],
    ["maneuvers", "s1", "-r", "esterle2019"],
    ["compile", "esterle2019", "-o", "OUT"],
]


@pytest.mark.long
@pytest.mark.parametrize("verb", FIVE_VERBS, ids=lambda verb: verb[0])
def test_at_random_moments(verb, tmp_path):
    """From rulec's first line on: what comes before, Python says itself."""
    arguments = [item.replace("OUT", str(tmp_path / "out")) for item in verb]
    command = [sys.executable, "-c", STARTED, *arguments]
    begun = monotonic()
    whole = subprocess.run(command, capture_output=True, check=False)
    longest = monotonic() - begun
    chance = Random(1)
    for _ in range(100):
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=as_from_a_terminal,
        )
        assert process.stderr.readline() == b"begun\n"
        sleep(chance.uniform(0, longest))
        process.send_signal(SIGINT)
        _, err = process.communicate()
        assert process.returncode in (130, whole.returncode)
        if process.returncode == 130:
            assert err.strip() in (b"", b"rulec: interrupted")
        assert not list(tmp_path.rglob("*.part"))
