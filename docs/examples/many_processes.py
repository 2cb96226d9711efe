"""Judge traces in several processes; rulebooks, traces and verdicts can be pickled."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import rulec


def main() -> None:
    """Judge every maneuver of a scenario and print how many satisfy the rules."""
    rules = rulec.compile_rulebook("esterle2019")
    judge = partial(rulec.verify, rules=rules)
    traces = list(rulec.traces("s1", rules))
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        verdicts = list(pool.map(judge, traces, chunksize=50))
    kept = sum(verdict.satisfied for verdict in verdicts)
    print(f"{kept} of {len(verdicts)} maneuvers satisfy every hard rule")
    assert kept == rulec.find_maneuvers("s1", rules).satisfying


if __name__ == "__main__":
    main()
