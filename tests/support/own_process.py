"""A command of rulec in a process of its own: what it says, and what it takes."""

import json
import subprocess
import sys
from dataclasses import dataclass

HANGS_AFTER_S = 60
"""Nothing takes as long that ends; no test says how fast a machine is."""

_MEASURED = """
import json, resource, subprocess, sys
done = subprocess.run(
    [sys.executable, "-m", "rulec", *sys.argv[2:]],
    capture_output=True, timeout=float(sys.argv[1]),
)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
said = (done.stdout + done.stderr).decode(errors="replace")
print(json.dumps([done.returncode, said, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024]))
"""


@dataclass(frozen=True)
class Cost:
    """A command's exit status, all that it said, its processor time, and its memory at most."""

    status: int
    said: str
    cpu_s: float
    peak_mib: float


def cost_of(arguments, folder, standard_input=""):
    """Run ``rulec`` with arguments in a folder.

    A small process starts it: the memory of whoever starts a process is counted as its own.
    """
    done = subprocess.run(
        [sys.executable, "-c", _MEASURED, str(HANGS_AFTER_S), *arguments],
        cwd=folder,
        input=standard_input.encode(),
        capture_output=True,
        check=True,
    )
    return Cost(*json.loads(done.stdout))
