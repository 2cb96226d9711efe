"""Drives judged on existing engines: from a table of tracks or traces to a table of findings."""

from rulec.fleet.finding_columns import arrow_schema as arrow_schema
from rulec.fleet.fleet_judge import FleetJudge as FleetJudge
from rulec.fleet.runs.fleet_run import FleetRun as FleetRun
from rulec.fleet.runs.fleet_run import FleetSettings as FleetSettings
from rulec.fleet.runs.fleet_run import run_fleet as run_fleet

__all__ = ["FleetJudge", "FleetRun", "FleetSettings", "arrow_schema", "run_fleet"]
