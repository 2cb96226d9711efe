"""ScenarioNet's scenarios, read as recordings, without unpickling code that could run."""
