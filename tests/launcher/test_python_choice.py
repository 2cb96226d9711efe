"""Which Python the environment is made with, and what is said when none will do."""

import shutil

import pytest

ALL = "python3 python3.13 python3.12 python3.11 python3.10 python3.14 python"
WAY_OUT = "or set RULEC_PYTHON to one, and call again."


def chosen(checkout):
    """The version named when the environment was made."""
    result = checkout.call()
    assert result.returncode == 0, result.stderr
    return result.stderr.split("(Python ")[1][:4]


def refused(checkout, **variables):
    """The one sentence of a refusal that leaves nothing behind."""
    result = checkout.call(**variables)
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert result.stderr.endswith(f"{WAY_OUT}\n")
    assert not checkout.environment.exists()
    return result.stderr


@pytest.mark.parametrize("minor", [10, 11, 12, 13, 14])
def test_every_supported_version_is_taken(checkout, minor):
    checkout.add_tool("python3", version=[3, minor, 0])
    assert chosen(checkout) == f"3.{minor}"


@pytest.mark.parametrize("version", [[2, 7, 18], [3, 9, 0], [3, 15, 0], [4, 10, 0]])
def test_other_versions_are_refused_by_name(checkout, version):
    checkout.add_tool("python3", version=version)
    assert f"; python3 is {version[0]}.{version[1]}. " in refused(checkout)


def test_wrong_or_broken_ones_are_passed_over(checkout):
    checkout.add_tool("python3", version=[3, 15, 0])
    checkout.add_script("python3.13", "echo 'pyenv: python3.13: command not found' >&2; exit 127")
    checkout.add_tool("python3.12", version=[3, 12, 1])
    assert chosen(checkout) == "3.12"


def test_order_is_that_of_the_manual(checkout):
    for name in ALL.split()[1:]:
        checkout.add_tool(name, version=[3, 12, 0])
    checkout.add_tool("python3", version=[3, 10, 0])
    assert chosen(checkout) == "3.10"


def test_every_unfit_one_is_named(checkout):
    checkout.add_tool("python3", version=[3, 15, 0])
    checkout.add_script("python3.12", "exit 1")
    checkout.add_tool("python", version=[2, 7, 18])
    said = refused(checkout)
    assert "python3 is 3.15, python3.12 does not run, python is 2.7." in said


def test_none_at_all(checkout):
    (checkout.tools / "python3").unlink()
    assert "there is none on PATH" in refused(checkout)


def test_uv_could_bring_one(checkout):
    checkout.add_tool("python3", version=[3, 15, 0])
    checkout.add_tool("uv")
    assert "Install one (uv python install 3.13), or set" in refused(checkout)


def test_rulec_python_comes_first(checkout):
    other = checkout.add_tool("other", version=[3, 13, 0])
    result = checkout.call(RULEC_PYTHON=str(other))
    assert "(Python 3.13," in result.stderr


def test_rulec_python_may_be_a_name(checkout):
    checkout.add_tool("other", version=[3, 13, 0])
    assert "(Python 3.13," in checkout.call(RULEC_PYTHON="other").stderr


@pytest.mark.parametrize(
    ("asked", "fault"),
    [
        ("other", "other is 3.8."),
        ("/no/python", "/no/python is not found."),
        ("cat", "cat does not run."),
        ("./folder", "./folder does not run."),
        ("./text", "./text does not run."),
        ("./hangs", "./hangs does not answer."),
        ("./lies", "./lies does not run."),
        ("", "python3 does not run."),
    ],
)
def test_unfit_rulec_python_is_not_replaced_by_another(checkout, asked, fault):
    checkout.add_tool("other", version=[3, 8, 0])
    (checkout.folder / "folder").mkdir()
    (checkout.folder / "text").write_text("not a program")
    for name, body in ("hangs", "exec sleep 60"), ("lies", "exit 0"):
        checkout.add_script(name, body).rename(checkout.folder / name)
    if asked == "./hangs":
        checkout.add_script("sleep", f"[ $1 != 20 ] || set 0.1; exec {shutil.which('sleep')} $1")
    if not asked:
        checkout.add_script("python3", "exit 1")
    assert fault in refused(checkout, RULEC_PYTHON=asked)


@pytest.mark.parametrize(
    ("looks", "fault"),
    [({"implementation": "PyPy"}, "3.11 PyPy."), ({"free_threaded": 1}, "3.11 free-threaded.")],
)
def test_spot_needs_plain_cpython(checkout, looks, fault):
    checkout.add_tool("python3", **looks)
    assert fault in refused(checkout)


def test_python_without_venv_is_refused_with_the_package_to_install(checkout):
    checkout.add_tool("python3", ensurepip=False)
    said = refused(checkout)
    assert "python3 (3.11) lacks venv and ensurepip" in said
    assert "apt install python3.11-venv" in said


def test_python_without_venv_gives_way_to_a_whole_one(checkout):
    checkout.add_tool("python3", ensurepip=False)
    checkout.add_tool("python3.10", version=[3, 10, 0])
    assert chosen(checkout) == "3.10"


def test_python_without_venv_will_do_where_uv_is(checkout):
    checkout.add_tool("python3", ensurepip=False)
    checkout.add_tool("uv")
    assert chosen(checkout) == "3.11"
