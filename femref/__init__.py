"""Finite-element witness: buckling and post-buckled states, on scikit-fem and independent of the other solvers."""
