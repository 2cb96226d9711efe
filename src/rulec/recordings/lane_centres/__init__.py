"""Lanelets made from the centre lines of lanes; participants made from tracks of boxes."""
