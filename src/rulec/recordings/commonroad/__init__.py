"""CommonRoad scenarios, read as recordings without CommonRoad's library."""
