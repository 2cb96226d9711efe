"""Applies rulebooks to those that they extend: rules, constants, macros, priorities."""
