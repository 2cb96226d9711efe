"""CommonRoad scenarios, read with the library ``commonroad-io`` as recordings."""
