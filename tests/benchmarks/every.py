"""All benchmarks, or those that are named, each in a process of its own. See ``run``."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import click
import msgspec
from figure import Result, as_text
from machine import load, machine
from page import as_lines

HERE = Path(__file__).parent
KEPT = HERE.parents[1] / "docs" / "benchmarks.jsonl"
NAMES = (
    "batch",
    "reading",
    "ready",
    "peers",
    "long",
    "online",
    "onboard",
    "unknown",
    "graph",
    "world",
    "recordings",
    "drives",
    "hour",
    "scored",
    "compiling",
    "starting",
    "verbs",
    "typing_rules",
)


@click.command()
@click.argument("names", nargs=-1, type=click.Choice(NAMES), metavar="[NAME]...")
@click.option("--rounds", type=click.IntRange(min=1), help="How often everything is measured.")
@click.option("--write", is_flag=True, help="Write docs/benchmarks.jsonl; without any NAME.")
def every(names: tuple[str, ...], rounds: int | None, write: bool) -> None:
    """Run benchmarks and print their tables."""
    if write and names:
        raise click.UsageError("the file has all benchmarks: call --write without names")
    found: dict[str, list[Result]] = {}
    before = load()
    for name in names or NAMES:
        results = measured(name, rounds)
        if results is None:
            raise SystemExit(1)
        found[name] = results
    about = machine(before)
    print("\n".join(about))
    if write:
        KEPT.write_bytes(as_lines(found, about))


def environment() -> dict[str, str]:
    """This process's own, and where `support` is found."""
    return os.environ | {"PYTHONPATH": str(HERE.parent)}


def measured(name: str, rounds: int | None) -> list[Result] | None:
    """What a benchmark finds, printed as it comes; None if it broke."""
    command = [sys.executable, str(HERE / f"{name}.py"), "--json"]
    command += [] if rounds is None else [str(rounds)]
    results = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment()) as process:
        assert process.stdout is not None
        for line in process.stdout:
            results.append(msgspec.json.decode(line, type=Result))
            print(as_text(results[-1]), end="\n\n", flush=True)
    if process.returncode:
        print(f"the benchmark {name} broke", file=sys.stderr)
        return None
    return results


if __name__ == "__main__":
    every()
