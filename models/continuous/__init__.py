"""Continuous models of detail: ordered meshes, foliage, splat trees and terrain."""
