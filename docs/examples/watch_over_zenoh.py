"""Watch a drive over zenoh: states in JSON under one key, their verdicts under another.

It needs `pip install eclipse-zenoh` but no router: it receives its own publications.
"""

import json
import queue

import rulec

try:
    import zenoh
except ImportError:
    zenoh = None

STATES, VERDICTS = "vehicle/ego/state", "vehicle/ego/verdict"
PASSING_ON_THE_RIGHT = [
    {"state": {"position": {"v1": place}}, "objects": {"v1": "vehicle"}} for place in "brf"
]


def answer_to(data: bytes, monitor: rulec.Monitor) -> dict:
    """The verdict after a state; an invalid one is answered by its error and then ignored."""
    try:
        said = json.loads(data)
        now = monitor.step(said["state"], said.get("objects", {}))
    except (rulec.RulecError, ValueError, LookupError, TypeError, RecursionError) as error:
        return {"error": str(error)[:1000]}
    return {"number": now.state, "verdict": str(now.verdict)}


def main() -> None:
    """Publish three states, and print the verdicts published for them."""
    rules = rulec.compile_rulebook("esterle2019")
    monitor = rulec.Monitor(rules)
    said = queue.Queue()
    # Do not look for other peers: no router, no multicast.
    settings = zenoh.Config.from_json5(
        '{mode: "peer", scouting: {multicast: {enabled: false}}, listen: {endpoints: []}}'
    )
    with zenoh.open(settings) as session:
        verdicts = session.declare_publisher(VERDICTS)

        def watch(sample) -> None:
            verdicts.put(json.dumps(answer_to(sample.payload.to_bytes(), monitor)))

        def hear(sample) -> None:
            said.put(json.loads(sample.payload.to_bytes()))

        session.declare_subscriber(VERDICTS, hear)
        session.declare_subscriber(STATES, watch)
        states = session.declare_publisher(STATES)
        answers = []
        for state in PASSING_ON_THE_RIGHT:
            states.put(json.dumps(state))
            answers.append(said.get(timeout=30))
            print(answers[-1])
    assert answers[-1] == {"number": 2, "verdict": "violated"}


if __name__ == "__main__":
    if zenoh is None:
        print("eclipse-zenoh is missing: pip install eclipse-zenoh")
    else:
        main()
