"""Policies that steer by the times of completed frames, or by the pose to come."""
