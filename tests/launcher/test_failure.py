"""Set-ups that cannot be finished: one clear sentence, status 2, nothing left behind."""

import os

import pytest

NETWORK = "the package index cannot be reached"
TRUST = "certificate that is not trusted here"
DISK = "the disk is full, it seems"
OTHER = "its hash differs, so nothing of it was installed"
OLD = "lacks a release that the lock names"
INSTALLERS_WORDS = [
    ("WARNING: Retrying … NewConnectionError('… Temporary failure in name resolution')", NETWORK),
    ("WARNING: Retrying … [Errno 101] Network is unreachable", NETWORK),
    ("WARNING: Retrying … ProxyError('Cannot connect to proxy.')", NETWORK),
    ("WARNING: Retrying … ReadTimeoutError: Read timed out.", NETWORK),
    ("error: Failed to fetch\n  cause: error sending request for url (https://pypi.org/)", NETWORK),
    ("SSLCertVerificationError: certificate verify failed: self-signed certificate", TRUST),
    ("  cause: invalid peer certificate: UnknownIssuer", TRUST),
    ("ERROR: Could not install packages: [Errno 28] No space left on device", DISK),
    ("OSError: [Errno 122] Disk quota exceeded", DISK),
    ("", DISK),
]


def lines(result):
    assert result.returncode == 2
    assert result.stdout == ""
    said = result.stderr.splitlines()
    assert all(line.startswith(("rulec: ", "  | ")) for line in said)
    return said


@pytest.mark.parametrize(
    ("tool", "words", "reason"),
    [("venv", *INSTALLERS_WORDS[0])] + [("pip", *case) for case in INSTALLERS_WORDS],
)
def test_known_reason_is_one_sentence_with_the_way_out(checkout, tool, words, reason):
    checkout.tell(tool, status=1, says=words)
    said = lines(checkout.call())
    assert reason in said[-1]
    assert said[-1].endswith("and call again.")
    assert not any(line.startswith("  | ") for line in said)
    assert not checkout.environment.exists()


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM THE REQUIREMENTS FILE.", OTHER),
        ("error: Hash mismatch for `lark==1.3.1`", OTHER),
        ("ERROR: No matching distribution found for lark==1.3.1", OLD),
        ("  x No solution found when resolving dependencies:", OLD),
    ],
)
def test_what_the_lock_refuses_is_shown_with_the_way_out(checkout, words, reason):
    checkout.tell("pip", status=1, says=words)
    said = lines(checkout.call())
    assert said[-2] == f"  | {words}"
    assert reason in said[-1]
    assert not checkout.environment.exists()


def test_unknown_reason_shows_the_installers_last_words(checkout):
    checkout.tell("pip", status=1, says="\n".join(f"word {n}" for n in range(1, 31)))
    said = lines(checkout.call())
    assert [line for line in said if line.startswith("  | ")] == [
        f"  | word {n}" for n in range(11, 31)
    ]
    assert said[-1].startswith("rulec: the installation failed with the output above.")
    assert not checkout.environment.exists()


def test_failure_can_be_mended(checkout):
    checkout.tell("pip", status=1)
    lines(checkout.call())
    checkout.tell("pip")
    assert checkout.call().returncode == 0


def test_both_installers_failing_is_one_failure(checkout):
    checkout.add_tool("uv")
    for tool in "uv venv", "venv":
        checkout.tell(tool, status=1, says="dns error")
    said = lines(checkout.call())
    assert NETWORK in said[-1]
    assert not checkout.environment.exists()


@pytest.mark.parametrize(
    ("words", "reason"), [("name resolution", NETWORK), ("certificate", TRUST)]
)
@pytest.mark.parametrize("uv", [False, True])
def test_renewal_without_network_keeps_the_environment(ready, words, reason, uv):
    before = (ready.folder / "pyproject.toml").read_text()
    if uv:
        ready.add_tool("uv")
    for tool in "pip", "uv pip":
        ready.tell(tool, status=1, says=words)
    (ready.folder / "pyproject.toml").write_text("# pulled\n")
    for _ in "first", "second":
        assert reason in lines(ready.call())[-1]
    (ready.folder / "pyproject.toml").write_text(before)
    assert ready.call().stderr == ""


def test_renewal_that_breaks_off_removes_the_environment(ready):
    ready.tell("pip", status=1, says="No space left on device")
    (ready.folder / "pyproject.toml").write_text("# pulled\n")
    assert DISK in lines(ready.call())[-1]
    assert not ready.environment.exists()


def test_renewal_that_breaks_off_in_uv_is_made_anew_with_pip(ready):
    ready.add_tool("uv")
    ready.tell("uv pip", status=1, says="half of the files written")
    (ready.folder / "pyproject.toml").write_text("# pulled\n")
    assert ready.call().returncode == 0
    assert [call["tool"] for call in ready.calls()] == ["uv pip", "venv", "pip", "pip"]


def test_too_small_a_disk_is_told_before_anything_is_written(checkout):
    checkout.add_script("df", "echo head; echo disk 9000000 8897600 102400 99% /")
    said = lines(checkout.call())
    assert "100 MB left. Make room and call again." in said[-1]
    assert checkout.calls() == []
    assert not checkout.environment.exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_read_only_checkout(checkout):
    checkout.folder.chmod(0o555)
    said = lines(checkout.call())
    checkout.folder.chmod(0o755)
    assert said[-1].startswith(f"rulec: cannot write to {checkout.folder}")
    assert checkout.calls() == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_read_only_checkout_whose_python_is_out_of_reach(ready):
    python = ready.environment / "bin/python"
    python.unlink()
    python.symlink_to("/root/python")
    ready.folder.chmod(0o555)
    said = lines(ready.call())
    ready.folder.chmod(0o755)
    assert said[-1].startswith("rulec: cannot reach the Python of its environment")


@pytest.mark.parametrize(
    "settings",
    [
        {"PYTHONIOENCODING": "nonsense"},
        {"PYTHONUTF8": "7"},
        {"PYTHONMALLOC": "nonsense"},
        {"PYTHONHASHSEED": "nonsense"},
        {"PYTHONTRACEMALLOC": "nonsense"},
        {"PYTHONINTMAXSTRDIGITS": "3"},
    ],
)
def test_python_that_does_not_start_with_its_variables_is_no_violation(ready, settings):
    said = lines(ready.call(**settings))
    assert len(said) == 1
    assert said[0].endswith("Correct or unset them, and call again.")
    assert ready.call(PYTHONIOENCODING="latin-1").returncode == 0


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_read_only_checkout_that_is_ready_runs(ready):
    ready.folder.chmod(0o555)
    result = ready.call()
    ready.folder.chmod(0o755)
    assert (result.returncode, result.stderr) == (0, "")
