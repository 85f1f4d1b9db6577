"""Small readings and measures that the verification runs share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd


def path_table(folder: Path, name: str) -> pd.DataFrame:
    """The table paths/NAME.csv of a result folder."""
    return pd.read_csv(folder / "paths" / f"{name}.csv")


def relative_l2(value: np.ndarray, exact: np.ndarray) -> float:
    """Square root of sum (value - exact)^2 / sum exact^2; arrays of one shape."""
    return float(np.sqrt(np.sum((value - exact) ** 2) / np.sum(exact**2)))


def observed_order(spacing: np.ndarray, error: np.ndarray) -> float:
    """Slope of log(error) against log(spacing) by least squares; positive arrays (m,)."""
    return float(np.polyfit(np.log(spacing), np.log(error), 1)[0])


def extrapolated(spacing: np.ndarray, value: np.ndarray, order: float = 2.0) -> float:
    """Limit for spacing -> 0 from the two finest meshes, errors being of this order; (m,), finest last."""
    ratio = (spacing[-2] / spacing[-1]) ** order
    return float(value[-1] + (value[-1] - value[-2]) / (ratio - 1.0))
