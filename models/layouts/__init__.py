"""Objects placed on the ground by a layout, and scenes of them."""
