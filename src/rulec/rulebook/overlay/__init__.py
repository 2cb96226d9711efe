"""Rulebooks laid over those that they extend: rules, constants, macros, priorities."""
