"""Many files of recorded traffic, judged one after the other or side by side."""
