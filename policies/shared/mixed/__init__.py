"""The parts of Zach's policy for scenes of smooth and discrete objects."""
