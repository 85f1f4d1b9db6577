"""A solver that is another function, as in the tests of runs."""

from __future__ import annotations

from tests.cases.conftest import _faked

__all__ = ["_faked"]
