"""Once the environment is there, the launcher is invisible."""

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
AWKWARD = ["", "two words", "*", "$HOME", "'\"", "-x", "--", "ä\nb"]


def seen(result):
    return ast.literal_eval(result.stdout.splitlines()[0])


def test_arguments_arrive_untouched(ready):
    result = ready.call(*AWKWARD)
    assert seen(result)["arguments"] == AWKWARD
    assert result.stderr == ""


def test_status_and_standard_input_are_the_commands(ready):
    result = ready.call("seven", stdin="a trace\n")
    assert result.returncode == 7
    assert result.stdout.endswith("a trace\n")


def test_standard_input_survives_the_first_call(checkout):
    assert checkout.call(stdin="a trace\n").stdout.endswith("a trace\n")


def test_no_installer_runs_again(ready):
    ready.call()
    assert ready.calls() == []


def test_command_stays_in_the_callers_folder(ready, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    assert seen(ready.call(cwd=elsewhere))["folder"] == str(elsewhere)
    assert seen(ready.call(command=["../checkout/rulec"], cwd=elsewhere))["folder"] == str(
        elsewhere
    )


def test_command_is_found_through_relative_and_absolute_links(ready, tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "rule").symlink_to("../checkout/rulec")
    (tmp_path / "link").symlink_to(tmp_path / "bin" / "rule")
    result = ready.call(command=[tmp_path / "link"], cwd=tmp_path)
    assert seen(result)["script"] == str(ready.environment / "bin/rulec")


def test_modules_from_elsewhere_are_kept_out(ready):
    assert seen(ready.call(PYTHONPATH="/x", PYTHONHOME="/x"))["strangers"] == []


@pytest.mark.parametrize("first", [True, False])
def test_command_inherits_no_descriptor_of_the_set_up(checkout, first):
    if not first:
        checkout.call()
    assert seen(checkout.call())["descriptors"] == []


@pytest.mark.parametrize("name", ["it's größe $x", "-dash"])
def test_any_folder_name_will_do(checkout, tmp_path, name):
    home = tmp_path / name
    checkout.folder.rename(home)
    for _ in "first", "second":
        result = checkout.call("a b", command=[home / "rulec"], cwd=tmp_path)
        assert result.returncode == 0, result.stderr
        assert seen(result)["script"] == str(home / ".venv/bin/rulec")
    assert result.stderr == ""


@pytest.mark.parametrize("locale", [{"LC_ALL": "C"}, {"LC_ALL": "POSIX"}, {"LC_ALL": "none"}, {}])
def test_environment_starts_in_any_locale(checkout, tmp_path, locale):
    """Its link to the checkout is put into an environment of the real Python: 3.11 reads links in
    the locale's encoding."""
    checkout.folder.rename(tmp_path / "weiß und blau")
    checkout.folder = tmp_path / "weiß und blau"
    checkout.call()
    (link,) = checkout.environment.rglob("*.pth")
    assert link.read_bytes().isascii()
    real = tmp_path / "größe/.venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", real], check=True)
    (packages,) = real.glob("lib/python3*/site-packages")
    shutil.copy(link, packages)
    (real.parent / "src").symlink_to(ROOT / "src")
    command = [real / "bin/python", "-c", "import rulec.version"]
    subprocess.run(command, env=locale, cwd="/", check=True)


SHELLS = ["sh", "dash", "bash --posix", "busybox sh"]


@pytest.mark.parametrize("shell", [s for s in SHELLS if shutil.which(s.split()[0])])
def test_any_posix_shell_will_do(checkout, shell):
    name, *options = shell.split()
    command = [shutil.which(name), *options, "rulec"]
    for _ in "first", "second":
        result = checkout.call("a b", command=command)
        assert result.returncode == 0, result.stderr
        assert seen(result)["arguments"] == ["a b"]
    assert result.stderr == ""


def test_copied_out_of_its_checkout_it_says_so(checkout, tmp_path):
    alone = shutil.copy(checkout.folder / "rulec", tmp_path / "rulec")
    result = checkout.call(command=[alone])
    assert result.returncode == 2
    assert result.stderr == (
        f"rulec: {alone} is not in a checkout of rulec. Link to a checkout's rulec instead.\n"
    )
