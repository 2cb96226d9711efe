"""When the environment is made, renewed, completed, or made anew."""

import shutil

import pytest

INSTALLED = ["pip", "pip"]
"""What the lock names, and then the project alone."""
MADE = ["venv", *INSTALLED]


def tools(checkout):
    return [call["tool"] for call in checkout.calls()]


def test_first_call_makes_the_environment_and_says_what_it_does(checkout):
    result = checkout.call()
    assert tools(checkout) == MADE
    needed, project = checkout.calls("pip")
    assert needed["arguments"][-3:-1] == ["--require-hashes", "-r"]
    assert project["arguments"][-4:] == ["--no-deps", "--no-build-isolation", "-e", "."]
    assert {needed["folder"], project["folder"]} == {str(checkout.folder)}
    environment = f"{checkout.environment} (Python 3.11, venv and pip)"
    assert result.stderr.splitlines() == [
        f"rulec: making a private environment in {environment} ...",
        "rulec: installing rulec and what it needs ...",
        "rulec: ready.",
    ]
    assert len(result.stdout.splitlines()) == 1  # the command's own line


@pytest.mark.parametrize("version", [(3, 10, 9), (3, 11, 7), (3, 12, 1), (3, 13, 0)])
def test_the_lock_of_the_python_is_installed(checkout, version):
    checkout.add_tool("python3", version=version)
    checkout.call()
    lock = checkout.folder / f"src/launcher/locks/python3.{version[1]}.txt"
    assert checkout.calls("pip")[0]["requirements"] == lock.read_text()


def test_a_changed_lock_is_installed_once(ready):
    with (ready.folder / "src/launcher/locks/python3.11.txt").open("a") as file:
        file.write("# pulled\n")
    assert "installing again" in ready.call().stderr
    assert tools(ready) == INSTALLED
    assert ready.call().stderr == ""


def test_unlocked_the_newest_releases_are_asked_for(checkout):
    assert checkout.call(RULEC_UNLOCKED="1", PIP_CONSTRAINT="own.txt").returncode == 0
    (call,) = checkout.calls("pip")
    assert call["arguments"][-2:] == ["-e", "."]
    assert call["environment"]["PIP_CONSTRAINT"] == "own.txt"


def test_no_constraint_of_others_meets_the_lock(checkout):
    checkout.call(PIP_CONSTRAINT="own.txt", UV_CONSTRAINT="own.txt")
    asked = [call["environment"].keys() for call in checkout.calls("pip")]
    assert not {"PIP_CONSTRAINT", "UV_CONSTRAINT"} & set().union(*asked)


def test_set_up_leaves_nothing_but_the_environment(checkout):
    before = {file.name for file in checkout.folder.iterdir()}
    checkout.call()
    assert {file.name for file in checkout.folder.iterdir()} == before | {".venv"}
    assert [file.name for file in (checkout.environment / ".rulec").iterdir()] == ["run"]


def test_changed_pyproject_is_installed_once(ready):
    with (ready.folder / "pyproject.toml").open("a") as file:
        file.write("\n# pulled\n")
    assert "pyproject.toml has changed; installing again" in ready.call().stderr
    assert tools(ready) == INSTALLED
    assert ready.call().stderr == ""


def test_touched_pyproject_is_no_change(ready):
    (ready.folder / "pyproject.toml").touch()
    assert ready.call().stderr == ""


@pytest.mark.parametrize("name", ["moved", "copied"])
def test_environment_of_another_place_is_made_anew(ready, tmp_path, name):
    home = tmp_path / name
    (shutil.move if name == "moved" else shutil.copytree)(ready.folder, home)
    result = ready.call(command=[home / "rulec"], cwd=tmp_path)
    assert f"was made for {ready.folder}; making a new one" in result.stderr
    assert tools(ready) == MADE
    assert ready.call(command=[home / "rulec"], cwd=tmp_path).stderr == ""


def test_half_made_environment_is_made_anew(ready):
    (ready.environment / ".rulec" / "run").unlink()
    (ready.environment / "rubbish").touch()
    assert "the last set-up did not finish; starting over" in ready.call().stderr
    assert tools(ready) == MADE
    assert not (ready.environment / "rubbish").exists()


def test_half_written_stamp_does_not_count(ready):
    stamp = ready.environment / ".rulec" / "run"
    stamp.write_text(stamp.read_text()[:5])
    assert ready.call().returncode == 0
    assert tools(ready) == MADE


def test_leftovers_of_a_killed_removal_are_cleared(checkout):
    (checkout.folder / ".venv.gone" / "bin").mkdir(parents=True)
    checkout.environment.mkdir()
    assert checkout.call().returncode == 0
    assert not (checkout.folder / ".venv.gone").exists()


@pytest.mark.parametrize("kind", ["folder", "link", "file"])
def test_environment_of_someone_else_is_left_alone(checkout, tmp_path, kind):
    theirs = tmp_path / "theirs"
    (theirs / "bin").mkdir(parents=True)
    match kind:
        case "folder":
            theirs.rename(checkout.environment)
        case "link":
            checkout.environment.symlink_to(theirs)
        case "file":
            checkout.environment.touch()
    result = checkout.call()
    assert result.returncode == 2
    assert "not made by rulec" in result.stderr
    assert "Move it away or delete it, and call again." in result.stderr
    assert tools(checkout) == []
    assert checkout.environment.exists()


def test_vanished_python_is_noticed(ready):
    (ready.environment / "bin" / "python").unlink()
    assert "the environment's Python is gone" in ready.call().stderr
    assert tools(ready) == MADE


def test_python_asked_for_later_is_honoured_and_kept(ready):
    other = str(ready.add_tool("other", version=[3, 12, 0]))
    assert "another one is requested" in ready.call(RULEC_PYTHON=other).stderr
    assert ready.call(RULEC_PYTHON=other).stderr == ""
    assert ready.call().stderr == ""  # asked once, kept
    (ready.folder / "pyproject.toml").write_text("# pulled\n")
    ready.call()
    assert tools(ready) == [*MADE, *INSTALLED]
    assert ready.call(RULEC_PYTHON=other).stderr == ""


def test_uv_is_taken_where_it_is(checkout):
    checkout.add_tool("uv")
    result = checkout.call()
    assert tools(checkout) == ["uv venv", "uv pip", "uv pip"]
    assert "(Python 3.11, uv)" in result.stderr
    made, filled, _ = checkout.calls()
    assert str(checkout.tools / "python3") in made["arguments"]
    assert str(checkout.environment / "bin/python") in filled["arguments"]


@pytest.mark.parametrize("failing", ["uv venv", "uv pip"])
def test_where_uv_fails_pip_starts_afresh(checkout, failing):
    checkout.add_tool("uv")
    checkout.tell(failing, status=1, says="invalid peer certificate: UnknownIssuer")
    result = checkout.call()
    assert result.returncode == 0
    assert "uv failed; trying venv and pip" in result.stderr
    assert "UnknownIssuer" not in result.stderr
    assert tools(checkout)[-3:] == MADE


def test_settings_of_pip_that_choose_the_source_hold_for_both(checkout):
    mirror, extra = "https://mirror.example/simple", "https://extra.example/simple"
    settings = {"PIP_INDEX_URL": mirror, "PIP_EXTRA_INDEX_URL": extra}
    checkout.add_tool("uv")
    checkout.tell("uv pip", status=1)
    assert checkout.call(**settings).returncode == 0
    environment = checkout.calls("pip")[0]["environment"]
    assert environment["PIP_INDEX_URL"] == mirror
    assert environment["PIP_EXTRA_INDEX_URL"] == extra
    environment = checkout.calls("uv pip")[0]["environment"]
    assert environment["UV_DEFAULT_INDEX"] == mirror
    assert environment["UV_INDEX"] == extra


def test_settings_of_pip_that_lead_astray_are_dropped(checkout):
    astray = ["PIP_TARGET", "PIP_PREFIX", "PIP_REQUIRE_VIRTUALENV", "PIP_NO_DEPS", "PYTHONPATH"]
    checkout.call(**dict.fromkeys(astray, "1"), PIP_USER="1")
    environment = checkout.calls("pip")[0]["environment"]
    assert not set(astray) & set(environment)
    assert environment["PIP_USER"] == "0"
