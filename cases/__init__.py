"""Scenes, runs and result folders."""
