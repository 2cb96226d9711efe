"""What tests of several rooms share: oracles, generators, builders, engines and cases."""
