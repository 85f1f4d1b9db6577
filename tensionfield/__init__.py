"""Tension-field (relaxed) membranes on the engine of fdsolver, and the exact annulus."""
