"""Independent finite-element reference on scikit-fem."""
