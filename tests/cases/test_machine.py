"""What a result says of its machine: the memory of the run itself."""

from __future__ import annotations

import subprocess
import sys

import pytest

MEASURE = "from cases.machine import peak_memory_MB; print(peak_memory_MB())"
HOLD_400_MB = f"""
import subprocess, sys
import numpy as np
held = np.ones(50_000_000)
{MEASURE}
print(subprocess.run([sys.executable, "-c", {MEASURE!r}], capture_output=True, text=True, check=True).stdout)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems count in their own ways")
def test_peak_memory_is_that_of_the_process_and_not_of_the_one_that_started_it() -> None:
    ended = subprocess.run([sys.executable, "-c", HOLD_400_MB], capture_output=True, text=True, check=True)
    own, started = (float(word) for word in ended.stdout.split())
    assert started < 300.0 < 400.0 < own < 700.0
