""".ci/task: every task of the developers, in the launcher's environment."""

import re

import pytest

CHECKS = ["ruff", "ruff", "mypy", "lint-imports"]


def run(checkout, *arguments, **options):
    return checkout.call(*arguments, command=[checkout.folder / ".ci/task"], **options)


def tools(checkout):
    return [call["tool"] for call in checkout.calls()]


@pytest.mark.parametrize(
    ("task", "called"),
    [
        ("check", CHECKS),
        ("test", [*CHECKS, "pytest"]),
        ("long", [*CHECKS, "pytest"]),
        ("bench", ["every.py"]),
        ("docs", ["sphinx"]),
        ("release", ["tools.release"]),
        ("regenerate", ["tools.regenerate"]),
        ("lock", ["tools.lock"]),
        ("playground", ["tools.playground"]),
        ("coverage", ["coverage"] * 5),
    ],
)
def test_a_task_calls_its_tools_from_anywhere(ready, tmp_path, task, called):
    result = run(ready, task, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert tools(ready) == ["pip", "pip", *called]
    assert {call["folder"] for call in ready.calls()} == {str(ready.folder)}


def test_every_task_of_the_list_is_there(ready):
    result = run(ready)
    assert result.returncode == 2
    names = re.findall(r"^  \.ci/task (\w+)", result.stderr, re.MULTILINE)
    assert names == [
        "check",
        "test",
        "long",
        "coverage",
        "bench",
        "mutations",
        "fuzz",
        "worlds",
        "playground",
        "docs",
        "release",
        "regenerate",
        "lock",
    ]
    assert tools(ready) == []


def test_a_task_that_there_is_not_is_refused_with_the_list(ready):
    result = run(ready, "cofee")
    assert result.returncode == 2
    assert result.stderr.startswith("There is no task cofee. The tasks are:\n  .ci/task check ")
    assert tools(ready) == []


def test_arguments_go_to_pytest(ready):
    run(ready, "test", "tests/a b", "-k", "x or y")
    assert ready.calls("pytest")[0]["arguments"] == ["-m", "pytest", "tests/a b", "-k", "x or y"]


def test_the_long_profile(ready):
    run(ready, "long")
    (call,) = ready.calls("pytest")
    assert call["environment"]["RULEC_TEST_PROFILE"] == "long"


def test_a_red_task_is_red(ready):
    ready.tell("sphinx", status=1)
    assert run(ready, "docs").returncode == 1


def test_without_environment_no_task_runs(checkout):
    checkout.tell("pip", status=1, says="dns error")
    assert run(checkout, "docs").returncode == 2
    assert tools(checkout) == ["venv", "pip"]
