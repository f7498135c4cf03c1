"""Surfaces as triangle meshes."""
