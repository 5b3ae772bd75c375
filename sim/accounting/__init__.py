"""What a frame draws, costs and shows, counted for every policy alike."""
