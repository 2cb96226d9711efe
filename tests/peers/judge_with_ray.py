"""Judges a recording's vehicles in Ray's workers; in an environment that has Ray and rulec."""

import sys

import ray

import rulec

if __name__ == "__main__":
    recording, net = sys.argv[1:]
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)

    @ray.remote
    def violated(ego, rules):
        wanted = rulec.RequestedDrives((ego,))
        return rulec.verify_recording(recording, rules, wanted, net).rows()

    rules = ray.put(rulec.compile_rulebook("de"))
    cars = [body.id for body in rulec.read_recording(recording, net).participants]
    rows = [row for rows in ray.get([violated.remote(car, rules) for car in cars]) for row in rows]
    for row in rows:
        print(row["ego"], row["satisfied"], row["violated"])
