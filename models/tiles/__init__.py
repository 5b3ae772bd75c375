"""3D Tiles tilesets as hierarchical scenes."""
