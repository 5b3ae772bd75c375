"""Pictures of a scene as a policy draws it: one frame, coloured by level of detail."""
