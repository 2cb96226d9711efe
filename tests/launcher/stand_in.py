"""Plays python3, uv and an environment's python for the launcher's tests.

Called as ``stand_in.py NAME ARGUMENT…``. The folder in STAND_INS holds what each name pretends to
be (``NAME.looks``), how the tools are to behave (``behaviour``), and the journal of all calls.
It is called a thousand times in a run of the tests, so it imports next to nothing: ``json`` and
``pathlib`` would take longer than all that it does.
"""

import marshal
import os
import sys

FOLDER = os.environ["STAND_INS"]


def laid_down(name: str) -> dict:
    with open(f"{FOLDER}/{name}", "rb") as file:
        return marshal.load(file)


def write(path: str, text: str) -> None:
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def stand_in_module(name: str, **parts) -> None:
    """Puts a module with these parts in the place of one that takes long to import."""
    module = type(sys)(name)
    vars(module).update(parts)
    sys.modules[name] = module


def pretend(name: str) -> None:
    """Makes this interpreter look like the one that ``NAME.looks`` describes."""
    looks = laid_down(f"{name}.looks")
    sys.version_info = tuple(looks["version"])
    sys.executable = f"{FOLDER}/{name}"
    sys.maxsize = looks["maxsize"]
    stand_in_module(
        "platform",
        python_implementation=lambda: looks["implementation"],
        system=lambda: looks["system"],
        machine=lambda: looks["machine"],
    )
    stand_in_module(
        "sysconfig",
        get_config_var={"Py_GIL_DISABLED": looks["free_threaded"]}.get,
        get_path=lambda _: os.path.abspath(".venv/site"),
    )
    stand_in_module("venv")
    stand_in_module("ensurepip")
    if looks["libc"] is None:
        del os.confstr
    else:
        os.confstr = {"CS_GNU_LIBC_VERSION": looks["libc"]}.get
    if not looks["ensurepip"]:
        sys.modules["ensurepip"] = None
    if looks["spot"]:
        stand_in_module("spot", version=lambda: looks["spot"])


def behave(tool: str) -> None:
    """Notes the call, then waits, speaks and ends as the test has laid down for this tool."""
    kept = {k: v for k, v in os.environ.items() if k.startswith(("PIP_", "UV_", "PYTHON", "RULEC"))}
    call = {"tool": tool, "arguments": sys.argv[2:], "environment": kept, "folder": os.getcwd()}
    if "-r" in sys.argv:
        with open(sys.argv[sys.argv.index("-r") + 1], encoding="utf-8") as requirements:
            call["requirements"] = requirements.read()
    with open(f"{FOLDER}/journal", "a", encoding="utf-8") as journal:
        journal.write(f"{call!r}\n")
    plan = laid_down("behaviour").get(tool, {})
    if plan.get("waits"):
        import subprocess
        import time

        helper = subprocess.Popen(["sleep", "60"])  # an installer's own helper process
        write(f"{FOLDER}/pids", f"{os.getpid()} {helper.pid}")
        write(f"{FOLDER}/{tool} is waiting", "")
        while not os.path.exists(f"{FOLDER}/go on"):
            time.sleep(0.01)
        helper.kill()
    if says := plan.get("says", f"{tool} chatters"):
        sys.stdout.write(f"{says}\n")
        sys.stdout.flush()
    if plan.get("status", 0):
        sys.exit(plan["status"])


def make_environment() -> None:
    os.makedirs(".venv/bin", exist_ok=True)
    python = ".venv/bin/python"
    write(python, f'#!/bin/sh\nexec "{sys.orig_argv[0]}" -S "{__file__}" environment "$@"\n')
    os.chmod(python, 0o755)


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
            write(".venv/bin/rulec", "")
            os.makedirs(".venv/lib/python3.11/site-packages", exist_ok=True)
            write(".venv/lib/python3.11/site-packages/_rulec.pth", os.path.abspath("src"))
        case ["-m", tool, *_]:
            behave(tool)
        case [script, *rest] if script.endswith("/rulec"):
            seen = {"arguments": rest, "folder": os.getcwd(), "script": script}
            seen["strangers"] = [n for n in ("PYTHONPATH", "PYTHONHOME") if n in os.environ]
            seen["descriptors"] = [n for n in range(3, 20) if os.path.exists(f"/proc/self/fd/{n}")]
            sys.stdout.write(f"{seen!r}\n{sys.stdin.read()}")
            sys.exit(7 if "seven" in rest else 0)
        case [script, *_]:
            behave(os.path.basename(script))


main()
