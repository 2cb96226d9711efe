"""Order among maneuvers: cost, penalties, homotopy classes."""
