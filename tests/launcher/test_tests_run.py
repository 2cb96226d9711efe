"""tests/run and .ci/run: the same environment with the test dependencies, then every check."""

import pytest

CHECKS = ["ruff", "ruff", "mypy", "lint-imports", "pytest"]


def run(checkout, *arguments, **options):
    return checkout.call(*arguments, command=[checkout.folder / "tests/run"], **options)


def tools(checkout):
    return [call["tool"] for call in checkout.calls()]


def test_test_dependencies_come_first_then_every_check(checkout):
    result = run(checkout)
    assert result.returncode == 0
    assert tools(checkout) == ["venv", "pip", "pip", *CHECKS]
    assert "\npytest==" in checkout.calls("pip")[0]["requirements"]
    assert "adding" not in result.stderr
    assert result.stdout.splitlines() == [
        "formatting ... green",
        "lints ... green",
        "types ... green",
        "import layers ... green",
        "pytest chatters",
    ]


def test_dependencies_are_added_to_the_launchers_environment_once(ready):
    assert "adding what the tests need" in run(ready).stderr
    assert tools(ready) == ["pip", "pip", *CHECKS]
    assert run(ready).stderr == ""
    assert tools(ready) == ["pip", "pip", *CHECKS, *CHECKS]
    assert ready.call().stderr == ""


def test_launcher_is_content_with_the_tests_environment(checkout):
    run(checkout)
    assert checkout.call().stderr == ""


def test_changed_pyproject_counts_for_both(ready):
    run(ready)
    (ready.folder / "pyproject.toml").write_text("# pulled\n")
    assert "has changed" in ready.call().stderr
    assert "adding what the tests need" in run(ready).stderr


@pytest.mark.parametrize(
    ("tool", "name"),
    [("ruff", "formatting, lints"), ("mypy", "types"), ("lint-imports", "import layers")],
)
def test_red_check_is_shown_and_the_others_still_run(ready, tool, name):
    ready.tell(tool, status=1, says="what is wrong")
    result = run(ready)
    assert result.returncode == 1
    assert "RED\nwhat is wrong\n" in result.stdout
    assert result.stderr.splitlines()[-1] == f"red: {name}"
    assert tools(ready)[2:] == CHECKS


@pytest.mark.parametrize("status", [1, 5])
def test_red_tests_are_red(ready, status):
    ready.tell("pytest", status=status)
    result = run(ready)
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1] == "red: tests"


def test_arguments_go_to_pytest_alone(ready):
    ready.tell("pytest", status=4)
    assert run(ready, "tests/a b", "-k", "x or y").returncode == 4
    assert tools(ready) == ["pip", "pip", "pytest"]
    assert ready.calls("pytest")[0]["arguments"] == ["-m", "pytest", "tests/a b", "-k", "x or y"]


@pytest.mark.parametrize("arguments", [["--long"], ["-x", "--long", "tests/a b"]])
def test_long_sets_the_profile(ready, arguments):
    run(ready, *arguments)
    call = ready.calls("pytest")[0]
    assert call["environment"]["RULEC_TEST_PROFILE"] == "long"
    own = [one for one in arguments if one != "--long"]
    assert call["arguments"][2:] == (own or ["-n", "auto", "--dist", "worksteal"])


def test_tests_see_no_modules_from_elsewhere(ready):
    run(ready, PYTHONPATH="/x")
    assert "PYTHONPATH" not in ready.calls("pytest")[0]["environment"]


def test_without_environment_nothing_is_run(checkout):
    checkout.tell("pip", status=1, says="dns error")
    result = run(checkout)
    assert result.returncode == 2
    assert result.stdout == ""


def test_ci_runs_the_same_from_anywhere(checkout, tmp_path):
    result = checkout.call(command=[checkout.folder / ".ci/run"], cwd=tmp_path)
    assert result.returncode == 0
    assert tools(checkout) == ["venv", "pip", "pip", *CHECKS]
    assert {call["folder"] for call in checkout.calls(*CHECKS)} == {str(checkout.folder)}
