"""Drives judged on engines that exist: a table of tracks or traces in, one of findings out."""

from rulec.fleet.finding_columns import arrow_schema as arrow_schema
from rulec.fleet.fleet_judge import FleetJudge as FleetJudge

__all__ = ["FleetJudge", "arrow_schema"]
