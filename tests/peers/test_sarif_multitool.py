"""The SARIF that ``rulec check`` writes, validated by the format's own tool, SARIF Multitool.

It comes from the npm registry; hence only in the long run of the tests, where npm is installed.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from rulec.cli.main import main

pytestmark = [
    pytest.mark.skipif(
        os.environ.get("RULEC_TEST_PROFILE") != "long", reason="installs a package: --long"
    ),
    pytest.mark.skipif(shutil.which("npm") is None, reason="needs npm"),
]
PROGRAMS = Path(__file__).parent.parent / "programs"


@pytest.fixture(scope="module")
def validate(tmp_path_factory):
    """What the tool finds wrong in a file: one line each."""
    folder = tmp_path_factory.mktemp("sarif")
    subprocess.run(
        ["npm", "install", "--silent", "--ignore-scripts", "@microsoft/sarif-multitool@5.7.0"],
        cwd=folder,
        check=True,
    )
    program = next(folder.glob("node_modules/@microsoft/sarif-multitool-*/Sarif.Multitool"))
    program.chmod(0o755)

    def found(file):
        done = subprocess.run(
            [program, "validate", file, "--output", file.with_suffix(".found")],
            env={**os.environ, "DOTNET_SYSTEM_GLOBALIZATION_INVARIANT": "1"},
            capture_output=True,
            text=True,
            check=True,
        )
        assert "Analysis completed successfully." in done.stdout
        return [line for line in done.stdout.splitlines() if ": error " in line]

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
