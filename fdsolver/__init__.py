"""Koiter plate and membrane solver: Green's-theorem finite differences and dynamic relaxation."""

from fdsolver.compile_cache import use

use()
