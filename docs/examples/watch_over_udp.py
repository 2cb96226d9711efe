"""Watch a drive over UDP: each datagram is a state in JSON; the answer is the verdict after it."""

import json
import socket
import threading

import rulec

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


def serve(server: socket.socket, rules: rulec.CompiledRulebook, n_states: int) -> None:
    """Answer ``n_states`` datagrams."""
    monitor = rulec.Monitor(rules)
    for _ in range(n_states):
        data, sender = server.recvfrom(65_507)
        server.sendto(json.dumps(answer_to(data, monitor)).encode(), sender)


def main() -> None:
    """Send three states and an invalid datagram to the server, and print its answers."""
    rules = rulec.compile_rulebook("esterle2019")
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle,
    ):
        server.bind(("127.0.0.1", 0))
        given = [json.dumps(state).encode() for state in PASSING_ON_THE_RIGHT]
        given.append(b"no state")
        watch = threading.Thread(target=serve, args=(server, rules, len(given)), daemon=True)
        watch.start()
        vehicle.settimeout(30)
        answers = []
        for data in given:
            vehicle.sendto(data, server.getsockname())
            answers.append(json.loads(vehicle.recv(65_507)))
            print(answers[-1])
        watch.join()
    assert [one.get("verdict") for one in answers] == [
        "holds so far",
        "holds so far",
        "violated",
        None,
    ]


if __name__ == "__main__":
    main()
