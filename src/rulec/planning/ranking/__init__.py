"""Comparing maneuvers: cost, penalties, homotopy classes."""
