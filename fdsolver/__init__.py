"""Koiter plate and membrane solver: Green's-theorem finite differences and dynamic relaxation."""

import os

from fdsolver.compile_cache import use

use()
# A step takes less than a millisecond; threads that sleep between two steps take several to wake.
os.environ.setdefault("OMP_WAIT_POLICY", "active")
