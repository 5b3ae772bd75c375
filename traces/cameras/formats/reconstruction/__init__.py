"""Poses of reconstructions: structure from motion, radiance fields, splats."""
