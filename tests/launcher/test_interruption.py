"""Set-ups that are interrupted, killed, or run at the same time."""

import os
import signal
import time
from pathlib import Path

import pytest

STATUS = {signal.SIGHUP: 129, signal.SIGINT: 130, signal.SIGTERM: 143}


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def installers_end(checkout):
    pids = checkout.installers()
    return checkout.comes_true(lambda: not any(is_running(pid) for pid in pids))


def stop_waiting(checkout, tool):
    """From now on the tool does its work at once."""
    checkout.tell(tool)
    (checkout.tools / f"{tool} is waiting").unlink()


@pytest.mark.parametrize(
    ("tool", "sent"),
    [("pip", sent) for sent in STATUS]
    + [(tool, signal.SIGINT) for tool in ("venv", "uv venv", "uv pip")],
)
def test_interruption_leaves_nothing_behind(checkout, tool, sent):
    if tool.startswith("uv"):
        checkout.add_tool("uv")
    checkout.tell(tool, waits=True)
    process = checkout.start("./rulec")
    checkout.wait_until_waiting(tool)
    process.send_signal(sent)  # to the launcher alone, as a supervisor does
    out, err = process.communicate(timeout=20)
    assert process.returncode == STATUS[sent]
    assert out == ""
    assert err.splitlines()[-1] == "rulec: interrupted; the unfinished environment is removed."
    assert not checkout.environment.exists()
    assert installers_end(checkout)
    stop_waiting(checkout, tool)
    assert checkout.call().returncode == 0


@pytest.mark.parametrize("to_all", [True, False])
@pytest.mark.parametrize("delay_ms", range(20, 300, 20))
def test_interrupted_at_any_moment_it_says_so_in_a_sentence(checkout, delay_ms, to_all):
    """To all, as from a terminal, or to the launcher alone, as from a supervisor."""
    process = checkout.start("./rulec", RULEC_SET_UP="run")
    time.sleep(delay_ms / 1000)
    (os.killpg if to_all else os.kill)(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert out == ""
    assert process.returncode in (130, -signal.SIGINT, 0)
    said = err.splitlines()
    assert all(line.startswith("rulec: ") for line in said)
    assert (process.returncode == 130) == (said[-1:] != [] and "interrupted" in said[-1])
    assert checkout.environment.exists() == (process.returncode == 0)


def test_interrupted_while_waiting_for_another_call_it_removes_nothing(checkout):
    checkout.tell("venv", waits=True)
    first = checkout.start("./rulec")
    checkout.wait_until_waiting("venv")
    second = checkout.start("./rulec")
    second.stderr.readline()
    os.killpg(second.pid, signal.SIGINT)
    assert second.communicate(timeout=20) == ("", "rulec: interrupted.\n")
    assert second.returncode == 130
    checkout.let_go_on()
    first.communicate(timeout=20)
    assert first.returncode == 0


def test_interrupted_renewal_leaves_nothing_behind(ready):
    (ready.folder / "pyproject.toml").write_text("# pulled\n")
    ready.tell("pip", waits=True)
    process = ready.start("./rulec")
    ready.wait_until_waiting("pip")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert not ready.environment.exists()


def test_killed_set_up_is_started_over_after_its_installer_has_ended(checkout):
    checkout.tell("pip", waits=True)
    first = checkout.start("./rulec")
    checkout.wait_until_waiting("pip")
    first.kill()
    first.communicate(timeout=20)
    assert checkout.environment.exists()  # nobody was there to remove it
    stop_waiting(checkout, "pip")
    second = checkout.start("./rulec")
    assert second.stderr.readline().startswith("rulec: another call is setting up; waiting")
    checkout.let_go_on()
    _, err = second.communicate(timeout=20)
    assert second.returncode == 0
    assert "did not finish; starting over" in err
    assert [call["tool"] for call in checkout.calls()] == ["venv", "pip", "venv", "pip", "pip"]
    assert checkout.call().stderr == ""


def test_killed_with_its_installer_it_is_started_over_at_once(checkout):
    checkout.tell("venv", waits=True)
    first = checkout.start("./rulec")
    checkout.wait_until_waiting("venv")
    first.kill()
    first.communicate(timeout=20)
    for pid in checkout.installers():
        os.kill(pid, signal.SIGKILL)
    assert installers_end(checkout)
    stop_waiting(checkout, "venv")
    again = checkout.call()
    assert again.returncode == 0
    assert "another call" not in again.stderr
    assert "did not finish; starting over" in again.stderr


def test_two_first_calls_make_one_environment(checkout):
    checkout.tell("venv", waits=True)
    first = checkout.start("./rulec", "first")
    checkout.wait_until_waiting("venv")
    second = checkout.start("./rulec", "second")
    assert second.stderr.readline().startswith("rulec: another call is setting up; waiting")
    assert len(checkout.calls("venv")) == 1
    checkout.let_go_on()
    for process, word in (first, "first"), (second, "second"):
        out, err = process.communicate(timeout=20)
        assert process.returncode == 0, err
        assert f"'arguments': ['{word}']" in out
    assert [call["tool"] for call in checkout.calls()] == ["venv", "pip", "pip"]


def test_second_takes_over_where_the_first_is_interrupted(checkout):
    checkout.tell("venv", waits=True)
    first = checkout.start("./rulec")
    checkout.wait_until_waiting("venv")
    second = checkout.start("./rulec")
    second.stderr.readline()
    checkout.tell("venv")
    first.send_signal(signal.SIGTERM)
    first.communicate(timeout=20)
    second.communicate(timeout=20)
    assert (first.returncode, second.returncode) == (143, 0)
    assert checkout.call().stderr == ""
