"""A copy of the launcher in a folder of its own, with stand-ins for every tool that it calls."""

import ast
import marshal
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from support.builders.terminal_signals import as_from_a_terminal

ROOT = Path(__file__).resolve().parents[2]
STAND_IN = Path(__file__).with_name("stand_in.py")
TOOLS = "awk bash cat cksum dirname env grep mkdir mv readlink rm rmdir sed sh sleep tail"
LOOKS = {
    "version": [3, 11, 7],
    "implementation": "CPython",
    "free_threaded": 0,
    "maxsize": 2**63 - 1,
    "system": "Linux",
    "machine": "x86_64",
    "libc": "glibc 2.36",
    "ensurepip": True,
    "spot": None,
}


def in_own_group():
    as_from_a_terminal()
    os.setpgid(0, 0)


@dataclass
class Checkout:
    """The copy, the folder that is its whole PATH, and the ways to drive it."""

    folder: Path
    tools: Path
    plan: dict = field(default_factory=dict)

    @property
    def environment(self) -> Path:
        return self.folder / ".venv"

    def add_script(self, name: str, body: str) -> Path:
        """Puts a script on PATH, in the place of the tool of that name."""
        file = self.tools / name
        file.unlink(missing_ok=True)  # not written through a link to the system's tool
        file.write_text(f"#!/bin/sh\n{body}\n")
        file.chmod(0o755)
        return file

    def add_tool(self, name: str, **looks) -> Path:
        """Puts a stand-in on PATH: a Python with these looks, or uv."""
        (self.tools / f"{name}.looks").write_bytes(marshal.dumps(LOOKS | looks))
        return self.add_script(name, f'exec "{sys.executable}" -S "{STAND_IN}" {name} "$@"')

    def tell(self, tool: str, **behaviour) -> None:
        """Lays down how a tool behaves from now on: says=…, status=…, waits=…."""
        self.plan[tool] = behaviour
        (self.tools / "behaviour").write_bytes(marshal.dumps(self.plan))

    def start(self, *command, cwd=None, **variables) -> subprocess.Popen:
        environment = {"PATH": str(self.tools), "STAND_INS": str(self.tools), "LC_ALL": "C.UTF-8"}
        return subprocess.Popen(
            [str(part) for part in command],
            cwd=cwd or self.folder,
            env=environment | variables,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=in_own_group,
            encoding="utf-8",
        )

    def call(self, *arguments, command=None, stdin="", **options) -> subprocess.CompletedProcess:
        """Calls the launcher, or another command, to its end."""
        command = command or [self.folder / "rulec"]
        process = self.start(*command, *arguments, **options)
        out, err = process.communicate(stdin, timeout=30)
        return subprocess.CompletedProcess(process.args, process.returncode, out, err)

    def calls(self, *tools: str) -> list[dict]:
        """The journal's entries of these tools (of all, if none is named), in order."""
        journal = self.tools / "journal"
        lines = journal.read_text().splitlines() if journal.exists() else []
        entries = [ast.literal_eval(line) for line in lines]
        return [entry for entry in entries if not tools or entry["tool"] in tools]

    @staticmethod
    def comes_true(condition: Callable[[], bool]) -> bool:
        """Looks again and again, but not for ever."""
        for _ in range(3000):
            if condition():
                return True
            time.sleep(0.01)
        return False

    def wait_until_waiting(self, tool: str) -> None:
        assert self.comes_true((self.tools / f"{tool} is waiting").exists), f"{tool} was not called"

    def let_go_on(self) -> None:
        (self.tools / "go on").touch()

    def installers(self) -> list[int]:
        """The process numbers of the waiting tool and its helper."""
        return [int(pid) for pid in (self.tools / "pids").read_text().split()]


@pytest.fixture
def checkout(tmp_path):
    """A checkout with one fitting Python, and not yet an environment."""
    folder, tools = tmp_path / "checkout", tmp_path / "tools"
    folder.mkdir()
    tools.mkdir()
    for part in (
        "rulec",
        "pyproject.toml",
        "tests/run",
        "tests/benchmarks/run",
        ".ci/run",
        ".ci/task",
    ):
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / part, folder / part)
    shutil.copytree(ROOT / "src/launcher", folder / "src/launcher")
    for tool in TOOLS.split():
        (tools / tool).symlink_to(shutil.which(tool))
    made = Checkout(folder, tools)
    made.add_script("df", "echo head; echo disk 9000000 1000000 8000000 12% /")
    made.add_tool("python3")
    made.tell("venv")
    yield made
    if (tools / "pids").exists():
        for pid in made.installers():
            subprocess.run(["kill", f"-{signal.SIGKILL}", str(pid)], stderr=subprocess.DEVNULL)


@pytest.fixture
def ready(checkout):
    """A checkout whose environment is made."""
    first = checkout.call()
    assert first.returncode == 0, first.stderr
    (checkout.tools / "journal").unlink()
    return checkout
