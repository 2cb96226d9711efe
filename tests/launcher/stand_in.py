"""Plays python3, uv and an environment's python for the launcher's tests.

Called as ``stand_in.py NAME ARGUMENT…``. The folder in STAND_INS holds what each name pretends to
be (``NAME.json``), how the tools are to behave (``behaviour.json``), and the journal of all calls.
It is called a thousand times in a run of the tests, so what few calls need is imported there.
"""

import json
import os
import sys
from pathlib import Path

FOLDER = Path(os.environ["STAND_INS"])


def pretend(name: str) -> None:
    """Makes this interpreter look like the one that ``NAME.json`` describes."""
    import platform
    import sysconfig
    import types

    looks = json.loads((FOLDER / f"{name}.json").read_text())
    sys.version_info = tuple(looks["version"])
    sys.executable = str(FOLDER / name)
    sys.maxsize = looks["maxsize"]
    platform.python_implementation = lambda: looks["implementation"]
    platform.system = lambda: looks["system"]
    platform.machine = lambda: looks["machine"]
    sysconfig.get_config_var = {"Py_GIL_DISABLED": looks["free_threaded"]}.get
    sysconfig.get_path = lambda _: str(Path(".venv/site").absolute())
    if looks["libc"] is None:
        del os.confstr
    else:
        os.confstr = {"CS_GNU_LIBC_VERSION": looks["libc"]}.get
    if not looks["ensurepip"]:
        sys.modules["ensurepip"] = None
    if looks["spot"]:
        spot = types.ModuleType("spot")
        spot.version = lambda: looks["spot"]
        sys.modules["spot"] = spot


def behave(tool: str) -> None:
    """Notes the call, then waits, speaks and ends as the test has laid down for this tool."""
    kept = {k: v for k, v in os.environ.items() if k.startswith(("PIP_", "UV_", "PYTHON", "RULEC"))}
    with (FOLDER / "journal").open("a") as journal:
        call = {
            "tool": tool,
            "arguments": sys.argv[2:],
            "environment": kept,
            "folder": str(Path.cwd()),
        }
        if "-r" in sys.argv:
            call["requirements"] = Path(sys.argv[sys.argv.index("-r") + 1]).read_text()
        journal.write(json.dumps(call) + "\n")
    plan = json.loads((FOLDER / "behaviour.json").read_text()).get(tool, {})
    if plan.get("waits"):
        import subprocess
        import time

        helper = subprocess.Popen(["sleep", "60"])  # an installer's own helper process
        (FOLDER / "pids").write_text(f"{os.getpid()} {helper.pid}")
        (FOLDER / f"{tool} is waiting").touch()
        while not (FOLDER / "go on").exists():
            time.sleep(0.01)
        helper.kill()
    if says := plan.get("says", f"{tool} chatters"):
        sys.stdout.write(f"{says}\n")
        sys.stdout.flush()
    if plan.get("status", 0):
        sys.exit(plan["status"])


def make_environment() -> None:
    binaries = Path(".venv/bin")
    binaries.mkdir(parents=True, exist_ok=True)
    (binaries / "python").write_text(
        f'#!/bin/sh\nexec "{sys.orig_argv[0]}" -S "{__file__}" environment "$@"\n'
    )
    (binaries / "python").chmod(0o755)


def main() -> None:
    name, *arguments = sys.argv[1:]
    match arguments:
        case ["-E", "-c", code, *rest] | ["-c", code, *rest]:
            sys.argv = ["-c", *rest]
            pretend("python3" if name == "environment" else name)
            exec(code, {})
        case ["-m", "venv", *_]:
            behave("venv")
            make_environment()
        case ["venv", *_]:
            behave("uv venv")
            make_environment()
        case ["-m", "pip", *_] | ["pip", *_]:
            behave("pip" if name == "environment" else "uv pip")
            Path(".venv/bin/rulec").touch()
        case ["-m", tool, *_]:
            behave(tool)
        case [script, *rest] if script.endswith("/rulec"):
            seen = {"arguments": rest, "folder": str(Path.cwd()), "script": script}
            seen["strangers"] = [n for n in ("PYTHONPATH", "PYTHONHOME") if n in os.environ]
            seen["descriptors"] = [n for n in range(3, 20) if Path(f"/proc/self/fd/{n}").exists()]
            sys.stdout.write(f"{json.dumps(seen)}\n{sys.stdin.read()}")
            sys.exit(7 if "seven" in rest else 0)
        case [script, *_]:
            behave(Path(script).name)


main()
