"""The SARIF that rulec writes, validated by the format's own tool, SARIF Multitool, and its schema.

It comes from the npm registry; hence only in the long run of the tests, where npm is installed.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import jsonschema
import pytest

from rulec.cli.main import main
from support.builders.recorded_cars import three_cars

pytestmark = [
    pytest.mark.skipif(
        os.environ.get("RULEC_TEST_PROFILE") != "long", reason="installs a package: --long"
    ),
    pytest.mark.skipif(shutil.which("npm") is None, reason="needs npm"),
]
PROGRAMS = Path(__file__).parent.parent / "programs"


@pytest.fixture(scope="module")
def multitool(tmp_path_factory):
    """The folder of the tool, which has the schema beside it."""
    folder = tmp_path_factory.mktemp("sarif")
    subprocess.run(
        ["npm", "install", "--silent", "--ignore-scripts", "@microsoft/sarif-multitool@5.7.0"],
        cwd=folder,
        check=True,
    )
    program = next(folder.glob("node_modules/@microsoft/sarif-multitool-*/Sarif.Multitool"))
    program.chmod(0o755)
    return program.parent


@pytest.fixture(scope="module")
def validate(multitool):
    """What the schema and the tool find wrong in a file: one line each."""
    schema = json.loads((multitool / "sarif-2.1.0.json").read_text())
    validator = jsonschema.validators.validator_for(schema)(schema)
    program = multitool / "Sarif.Multitool"

    def found(file):
        wrong = [error.message for error in validator.iter_errors(json.loads(file.read_text()))]
        done = subprocess.run(
            [program, "validate", file, "--output", file.with_suffix(".found")],
            env={**os.environ, "DOTNET_SYSTEM_GLOBALIZATION_INVARIANT": "1"},
            capture_output=True,
            text=True,
            check=True,
        )
        assert "Analysis completed successfully." in done.stdout
        return wrong + [line for line in done.stdout.splitlines() if ": error " in line]

    return found


def test_what_check_writes_is_valid(validate, tmp_path, capsys):
    files = [*PROGRAMS.glob("bad/*.rules"), *PROGRAMS.glob("good/*.rules"), tmp_path / "no.rules"]
    main(["check", "--output-format", "sarif", *map(str, files)])
    written = capsys.readouterr().out
    document = json.loads(written)
    assert len(document["runs"][0]["results"]) > len(list(PROGRAMS.glob("bad/*.rules")))
    (tmp_path / "all.sarif").write_text(written)
    assert validate(tmp_path / "all.sarif") == []
    (tmp_path / "wrong.sarif").write_text(written.replace('"level"', '"levle"'))
    assert validate(tmp_path / "wrong.sarif") != []


BOOK = """\
rulebook tiny
use road
hard rule slow { cite "Art. 1" require always speed <= 45 km/h }
soft rule patient { require eventually speed > 300 km/h }
hard rule never_kept { require always (wet and not wet) }
"""
A_TRACE = '{"id": "ü %", "step_s": 0.5, "states": [{"speed": 50, "wet": false}]}\n'


def test_what_verify_writes_is_valid(validate, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tiny.rules").write_text(BOOK)
    Path(three_cars(tmp_path)).rename("a b#%ü:1.xml")
    Path("broken.xml").write_text("<commonRoad")
    Path("t.jsonl").write_text(A_TRACE + '{"id": "t2", "states": 3}\n')
    files = ["a b#%ü:1.xml", "broken.xml", "t.jsonl"]
    assert main(["verify", *files, "-r", "./tiny.rules", "-o", "found.sarif.json"]) == 2
    (run,) = json.loads(Path("found.sarif.json").read_text())["runs"]
    assert {result["kind"] for result in run["results"]} == {"fail", "open"}
    assert {result["level"] for result in run["results"]} == {"error", "warning", "none"}
    assert len(run["invocations"][0]["toolExecutionNotifications"]) >= 2
    assert validate(Path("found.sarif.json")) == []


def test_what_analyze_writes_is_valid(validate, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tiny.rules").write_text(BOOK)
    assert main(["analyze", "./tiny.rules", "-o", "odd.sarif"]) == 1
    (run,) = json.loads(Path("odd.sarif").read_text())["runs"]
    assert run["results"]
    assert validate(Path("odd.sarif")) == []
