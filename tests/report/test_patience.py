"""What long work says of itself on standard error."""

import signal

import pytest

from rulec.cli.main import main
from rulec.report.text import console as module
from rulec.report.text.console import patience, progress

NEVER_SILENT_FOR_S = 2


def test_no_silence_reaches_its_limit_even_if_a_line_comes_late():
    assert module._FIRST_S < NEVER_SILENT_FOR_S
    assert module._AGAIN_S <= 0.8 * NEVER_SILENT_FOR_S


@pytest.fixture
def soon(monkeypatch):
    monkeypatch.delenv(module.QUIET)
    monkeypatch.setattr(module, "_FIRST_S", 0.01)
    monkeypatch.setattr(module, "_AGAIN_S", 0.01)


def said(capfd, text):
    """Wait until a line says this; the test would end by its time limit if none did."""
    heard = ""
    while text not in heard:
        heard += capfd.readouterr().err
    return heard


def test_it_says_what_it_is_doing_until_it_is_done(soon, capfd):
    with patience(["diff", "de", "fr\x1b[1m"]):
        assert "\x1b" not in said(capfd, "rulec: at work on `rulec diff de fr")
        with progress("comparing", 8) as tell:
            said(capfd, "rulec: comparing, for ")
            tell(2)
            said(capfd, "rulec: comparing: 25%, for ")
        with progress("analyzing de", None) as tell:
            tell(1234)
            said(capfd, "rulec: analyzing de: 1,234 so far, for ")
        said(capfd, "rulec: at work on")
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    capfd.readouterr()
    sum(range(10**6))
    assert capfd.readouterr().err == ""


def test_many_arguments_are_not_listed(soon, capfd):
    with patience(["check", *(f"rulebooks/book_{k}.rules" for k in range(99))]):
        line = said(capfd, "rulec: at work on `rulec check rulebooks").splitlines()[0]
    assert len(line) < 80


@pytest.mark.parametrize("words", [["diff", "-q"], ["test", "--quiet"], ["lsp"], ["monitor", "de"]])
def test_who_is_quiet_or_waits_says_nothing(words, soon):
    with patience(words):
        assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_a_line_that_is_due_when_all_is_done_does_no_harm(soon, monkeypatch):
    def stop_late(which, first_s, again_s=0.0):
        if not first_s:
            signal.raise_signal(signal.SIGALRM)
        return original(which, first_s, again_s)

    original = signal.setitimer
    monkeypatch.setattr(signal, "setitimer", stop_late)
    with patience(["diff", "de", "fr"]):
        pass


def test_a_program_of_its_own_keeps_its_signals(soon, capsys):
    assert main(["list", "--quiet"]) == main(["--quiet", "list"]) == 0
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL
