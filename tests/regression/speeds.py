"""Six speeds of a checkout, as ratios against another one, in turns in one run.

``python tests/regression/speeds.py OLDER NEWER [ROUNDS]`` prints for each path the least processor
time (ms) of both, and how many times as long the newer one takes.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
sys.path[:0] = [str(CHECKOUT / "tests/benchmarks")]

from checkouts import environment, python  # noqa: E402

BEGINNING = """
import time
import numpy as np
import rulec
ROOT = "{root}"
de, paper = rulec.compile_rulebook("de"), rulec.compile_rulebook("esterle2019")
following = rulec.read_recording(ROOT + "/docs/samples/following.xml")
traces = list(rulec.read_traces("{traces}"))
def least(call, times):
    call()
    taken = []
    for _ in range(times):
        begin = time.process_time()
        call()
        taken.append(time.process_time() - begin)
    print(1000 * min(taken))
"""
PATHS = {
    "a trace of twenty states": """
states = [{"surface": "R_cw", "position": {"v": "bbfl"[n % 4]}} for n in range(20)]
trace = rulec.Trace("t", 0.5, {"v": "vehicle"}, tuple(states))
least(lambda: rulec.verify(trace, paper), 200)
""",
    "recorded drives given as traces": """
least(lambda: [rulec.verify(one, de) for one in traces], 5)
""",
    "recorded drives as JSON Lines": """
least(lambda: list(rulec.verify_many(rulec.read_traces("{traces}"), de)), 10)
""",
    "recorded drives": """
least(lambda: list(rulec.verify_recording(following, de)), 10)
""",
    "a hundred candidates": """
world = rulec.TrafficWorld(following, "1", now_s=2.0)
x, y, heading, speed = world.past[-1]
time_s = 0.5 * np.arange(1, 7)
rows = [
    (x + speed * time_s + a * time_s**2 / 2, y + 0 * time_s, 0 * time_s, speed + a * time_s)
    for a in np.linspace(-2, 1, 100)
]
candidates = np.array([np.column_stack(row) for row in rows])
least(lambda: rulec.score(candidates, world, de, after=world.past), 3)
""",
    "live states": """
first = traces[0]
def live():
    monitor = rulec.Monitor(de, step_s=first.step_s, told=first.told, cut=True)
    for number, state in enumerate(first.states):
        there = {
            name: kind
            for name, kind in first.objects.items()
            if first.present.get(name, (0, number))[0] <= number
            and number <= first.present.get(name, (0, number))[1]
        }
        monitor.step(state, there)
least(live, 5)
""",
}


def taken(checkout: Path, path: str, traces: Path) -> float:
    """The least processor time (ms) of a path in a process of its own; NaN if it fails."""
    beginning = BEGINNING.replace("{traces}", str(traces)).replace("{root}", str(CHECKOUT))
    call = [python(checkout), "-c", beginning + PATHS[path].replace("{traces}", str(traces))]
    done = subprocess.run(call, env=environment(checkout), capture_output=True, text=True)
    if done.returncode:
        print(done.stderr, file=sys.stderr)
        return float("nan")
    return float(done.stdout)


def main(older: str, newer: str, rounds: str = "3") -> None:
    """Measure, and print a table."""
    with TemporaryDirectory() as folder:
        traces = Path(folder) / "drives.jsonl"
        recording = CHECKOUT / "docs/samples/following.xml"
        call = [CHECKOUT / "rulec", "traces", recording, "--recorded", "-r", "de", "-o", traces]
        subprocess.run(call, check=True, capture_output=True)
        table(Path(older).resolve(), Path(newer).resolve(), traces, int(rounds))


def table(older: Path, newer: Path, traces: Path, rounds: int) -> None:
    """Print the times of both checkouts."""
    print(f"{'least processor time, ms':34}{'older':>10}{'newer':>10}{'ratio':>8}")
    for path in PATHS:
        times: dict[Path, list[float]] = {older: [], newer: []}
        for _ in range(rounds):
            for checkout, found in times.items():
                found.append(taken(checkout, path, traces))
        old, new = min(times[older]), min(times[newer])
        print(f"{path:34}{old:10.2f}{new:10.2f}{new / old:8.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
