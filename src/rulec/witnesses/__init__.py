"""Synthesis of states, traces and counterexamples from what monitors read."""
