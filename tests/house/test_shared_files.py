"""Files for GitHub, pre-commit and Docker: they are read, and the commands that they name run."""

import os
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from rulec.diagnostics import Source
from rulec.toml import parsed_toml

ROOT = Path(__file__).resolve().parents[2]
YAML_FILES = [*(ROOT / ".github").rglob("*.yml"), *ROOT.glob(".pre-commit-*.yaml")]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
ACTION = yaml.safe_load((ROOT / ".github/actions/rulec/action.yml").read_text(encoding="utf-8"))
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
OWN_HOOKS = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
PYPROJECT = Source("pyproject.toml", (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = parsed_toml(PYPROJECT, "R0601", "")["project"]
BUILD_TOOLS = parsed_toml(PYPROJECT, "R0601", "")["build-system"]["requires"]
LOCKS = ROOT / "src" / "launcher" / "locks"
PYTHONS = re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["classifiers"]))

GOOD = """rulebook lane
use paper

hard rule no_passing (v: vehicle) {
  require always not (b(v) and eventually f(v))
  accept  "stays"  { b(v); b(v) }
  reject  "passes" { b(v); l(v); f(v) }
}
"""
UNTIDY = GOOD.replace("  require", "      require")
MISSPELT = GOOD.replace("eventually f(v)", "eventually g(v)")
FAILING = GOOD.replace('"stays"  { b(v); b(v) }', '"stays"  { b(v); f(v) }')


def test_an_environment_that_is_a_link_stays_out_of_commits():
    # With a slash behind it a pattern is about folders alone, and git takes a link for a file
    assert ".venv" in (ROOT / ".gitignore").read_text(encoding="utf-8").split()


@pytest.mark.parametrize("path", YAML_FILES, ids=lambda path: path.name)
def test_a_yaml_file_is_read(path):
    assert yaml.safe_load(path.read_text(encoding="utf-8"))


def steps(workflow):
    """The steps of all jobs of a workflow."""
    jobs = yaml.safe_load(workflow.read_text(encoding="utf-8"))["jobs"]
    return [step for job in jobs.values() for step in job["steps"]]


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_runs_what_is_in_the_repository(workflow):
    tasks = set(re.findall(r"^#   \.ci/task (\w+)", (ROOT / ".ci/task").read_text(), re.MULTILINE))
    for step in steps(workflow):
        if step.get("uses", "").startswith("./"):
            assert (ROOT / step["uses"] / "action.yml").is_file()
            assert set(step["with"]) <= set(ACTION["inputs"])
        program, *arguments = step.get("run", "python").split()
        if program.startswith(".ci/"):
            assert os.access(ROOT / program, os.X_OK)
        if program == ".ci/task":
            assert arguments[0] in tasks


def test_every_python_that_is_supported_is_tested():
    (tests,) = [
        job["strategy"]["matrix"]["python"]
        for workflow in WORKFLOWS
        for job in yaml.safe_load(workflow.read_text(encoding="utf-8"))["jobs"].values()
        if "strategy" in job
    ]
    assert tests == PYTHONS


@pytest.fixture
def call(tmp_path):
    """Run a script in a folder with one rulebook and ``rulec`` on the path."""
    folder, programs = tmp_path / "repository", tmp_path / "programs"
    folder.mkdir()
    programs.mkdir()
    (programs / "rulec").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m rulec "$@"\n')
    (programs / "rulec").chmod(0o755)

    def run(script, rulebook, **variables):
        (folder / "lane.rules").write_text(rulebook)
        environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", **variables}
        return subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", script],
            cwd=folder,
            env=environment | {"GITHUB_OUTPUT": str(tmp_path / "output")},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def action_step(name, **inputs):
    """The script of a step of the action, and its environment for these inputs."""
    (step,) = [step for step in ACTION["runs"]["steps"] if step.get("name") == name]
    assert "${{" not in step["run"], "inputs come by the environment, where they are no script"
    values = {key: field["default"] for key, field in ACTION["inputs"].items()} | inputs
    environment = {
        variable: re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: values[match[1]], text)
        for variable, text in step["env"].items()
    }
    return step["run"], environment


@pytest.mark.parametrize(
    ("step", "rulebook", "status", "words"),
    [
        ("Canonical form", GOOD, 0, ""),
        ("Canonical form", UNTIDY, 1, "would change lane.rules"),
        ("Findings", GOOD, 0, ""),
        ("Findings", MISSPELT, 1, "::error file=lane.rules,line=5,"),
        ("Examples", GOOD, 0, "2 examples passed"),
        ("Examples", FAILING, 1, "1 passed, 1 failed"),
    ],
)
def test_the_action_checks_rulebooks(call, step, rulebook, status, words):
    script, environment = action_step(step, tests="./lane.rules")
    done = call(script, rulebook, **environment)
    assert done.returncode == status, done.stderr
    assert words in done.stdout


def test_the_action_hands_its_findings_on(call, tmp_path):
    script, environment = action_step("Findings")
    call(script, MISSPELT, **environment)
    name = (tmp_path / "output").read_text().strip().removeprefix("sarif=")
    assert '"R0202"' in (tmp_path / "repository" / name).read_text()


def test_the_action_installs_the_checkout_that_it_is_in():
    (step,) = [step for step in ACTION["runs"]["steps"] if step.get("name") == "Install rulec"]
    folder = step["run"].split('"')[1].replace("$HERE", str(ROOT / ".github/actions/rulec"))
    assert (Path(folder).resolve() / "pyproject.toml").is_file()


@pytest.mark.parametrize(
    ("hook", "rulebook", "status"),
    [
        ("rulec-fmt", GOOD, 0),
        ("rulec-fmt", UNTIDY, 0),
        ("rulec-fmt", MISSPELT.replace("{", "", 1), 2),
        ("rulec-check", GOOD, 0),
        ("rulec-check", MISSPELT, 1),
    ],
)
def test_a_hook_for_others_does_its_work(call, tmp_path, hook, rulebook, status):
    (found,) = [entry for entry in HOOKS if entry["id"] == hook]
    assert re.search(found["files"], "rules/lane.rules")
    done = call(f"{found['entry']} lane.rules", rulebook)
    assert done.returncode == status, done.stderr
    if hook == "rulec-fmt" and not status:
        assert (tmp_path / "repository" / "lane.rules").read_text() == GOOD


@pytest.mark.parametrize("hook", OWN_HOOKS["repos"][0]["hooks"], ids=lambda hook: hook["id"])
def test_a_hook_of_this_repository_names_a_program(hook):
    program, *arguments = hook["entry"].split()
    if program == ".venv/bin/python":
        assert arguments[:2] == ["-m", "ruff"]
    else:
        assert os.access(ROOT / program, os.X_OK)


def test_the_image_is_made_of_what_there_is_and_runs_as_nobody_in_particular():
    text = (ROOT / ".ci" / "Dockerfile").read_text(encoding="utf-8")
    copied = re.findall(r"^COPY (?!--from)(.+) \S+$", text, re.MULTILINE)
    assert copied
    for name in " ".join(copied).split():
        assert (ROOT / name).exists(), name
    assert text.count("\nFROM ") == 2
    assert text.index("\nUSER rulec") < text.index('\nENTRYPOINT ["rulec"]')


def locked(python, purpose):
    """Name -> release, of those that this Python takes; each has its files' hashes."""
    releases = {}
    text = (LOCKS / f"python{python}{purpose}.txt").read_text(encoding="utf-8")
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith("#"):
            continue
        said, *hashes = line.split("--hash=")
        assert hashes
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}\s*", one) for one in hashes)
        requirement = Requirement(said.strip())
        here = {
            "python_version": python,
            "python_full_version": f"{python}.0",
            "platform_system": "Linux",
            "sys_platform": "linux",
            "platform_machine": "x86_64",
        }
        if requirement.marker is None or requirement.marker.evaluate(here):
            (pin,) = requirement.specifier
            assert pin.operator == "=="
            assert requirement.name not in releases
            releases[canonicalize_name(requirement.name)] = pin.version
    return releases


@pytest.mark.parametrize("purpose", ["", "-test"])
@pytest.mark.parametrize("python", PYTHONS)
def test_the_locks_have_a_release_of_all_that_is_asked_for(python, purpose):
    releases = locked(python, purpose)
    extras = PROJECT["optional-dependencies"]
    # Spark is large, and has an environment of its own in the long profile.
    optional = [listed for extra, listed in extras.items() if extra != "spark"] if purpose else []
    asked = [*PROJECT["dependencies"], *BUILD_TOOLS, *chain(*optional), "pip", "editables"]
    for requirement in map(Requirement, asked):
        marker = requirement.marker
        if requirement.name == "rulec" or (
            marker and not marker.evaluate({"python_version": python})
        ):
            continue
        assert requirement.specifier.contains(releases[canonicalize_name(requirement.name)])


def test_a_lock_is_for_a_python_that_is_supported():
    assert {file.name for file in LOCKS.iterdir()} == {
        f"python{python}{purpose}.txt" for python in PYTHONS for purpose in ("", "-test")
    }


CONTRIBUTING = (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")


MADE_BY_TASKS = {"docs/_build", "htmlcov/"}
NAMED = set(re.findall(r"`([\w.-]+/[\w./-]*)`", CONTRIBUTING)) - MADE_BY_TASKS


@pytest.mark.parametrize("name", sorted(NAMED))
def test_the_contributing_guide_names_what_is_there(name):
    assert (ROOT / name).exists() or (ROOT / "src/rulec" / name).exists()


def test_the_contributing_guide_has_every_task():
    tasks = re.findall(r"^#   \.ci/task (\w+)", (ROOT / ".ci/task").read_text(), re.MULTILINE)
    assert set(re.findall(r"^\| `(\w+)` \|", CONTRIBUTING, re.MULTILINE)) == set(tasks)
