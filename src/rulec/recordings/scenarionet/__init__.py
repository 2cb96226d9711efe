"""ScenarioNet's scenarios, read as recordings, without unpickling what might run."""
