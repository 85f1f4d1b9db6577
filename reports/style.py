"""The look of all figures: colours per method and per zone state, fonts, number formats."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axis import Axis

METHOD_COLOURS: Mapping[str, str] = {  # Okabe and Ito's set, told apart by colour-blind readers
    "koiter": "#0072B2",
    "koiter-published": "#CC79A7",
    "tension-field": "#D55E00",
    "membrane": "#009E73",
    "exact": "#000000",
    "buckling": "#E69F00",
    "postbuckling": "#56B4E9",
}
METHOD_LINES: Mapping[str, Any] = {
    "koiter": "-",
    "koiter-published": (0, (3, 1, 1, 1)),
    "tension-field": (0, (5, 2)),
    "membrane": (0, (1.2, 1.2)),
    "exact": "-",
}
METHOD_NAMES: Mapping[str, str] = {
    "koiter": "plate (koiter)",
    "koiter-published": "plate, published scheme",
    "tension-field": "relaxed membrane (tension-field)",
    "membrane": "unrelaxed membrane",
    "exact": "closed form",
    "buckling": "finite elements, buckling",
    "postbuckling": "finite elements, post-buckled",
}
STATE_COLOURS = ("#E4E4E4", "#F0B94D", "#33678F")  # slack, wrinkled, tense
STATE_NAMES = ("slack", "wrinkled", "tense")
WRINKLED_TINT = "#FBF0D9"

STRETCH_MAJOR = r"largest principal stretch $\lambda_1$ (–)"
STRETCH_MINOR = r"second principal stretch $\lambda_2$ (–)"
STRESS_MINOR = r"minor stress $S_2$ (MPa)"

FIGURE_STYLE: dict[Any, Any] = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 8.5,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.formatter.useoffset": False,
    "lines.linewidth": 1.2,
    "lines.markersize": 4.0,
    "legend.frameon": False,
    "figure.dpi": 100,
    "savefig.dpi": 200,
    "svg.fonttype": "path",
    "svg.hashsalt": "wrinklebench",  # equal reports from equal results
    "pdf.fonttype": 42,
}


def colour(method: str) -> str:
    """Colour of a method's curves."""
    return METHOD_COLOURS.get(method, "#777777")


def line(method: str) -> Any:
    """Line style of a method's curves, so that colour is never the only difference."""
    return METHOD_LINES.get(method, "-")


def method_name(method: str) -> str:
    """What a reader of mechanics calls the method."""
    return METHOD_NAMES.get(method, method)


def number(value: float, digits: int = 3) -> str:
    """Short text of a number: `digits` significant digits, powers of ten as 1.2e-5, an en dash for NaN."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else str(value)
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if -3 <= size < 6:
        text = f"{value:.{max(digits - 1 - size, 0)}f}"
    else:
        text = f"{value:.{digits - 1}e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")
    return text.replace("-", "−", 1) if text.startswith("-") else text


def power_of_ten(value: float) -> str:
    """A number for mathematical text, two significant digits."""
    text = number(value, 2)
    if "e" in text:
        part, power = text.split("e")
        return rf"${part}\cdot10^{{{int(power.replace('−', '-'))}}}$"
    return text


def whole(value: float) -> str:
    """A count with thin spaces between thousands; an en dash for NaN."""
    return "–" if math.isnan(value) else f"{round(value):,}".replace(",", "\u2009")


def label_sparsely(axis: Axis) -> None:
    """Label a logarithmic axis of less than two decades at 1, 2 and 5 only, where every power of ten is too little.

    To be called when the data are drawn.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    axis.set_minor_formatter(NullFormatter())
    if low > 0.0 and high < 100.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(
            FuncFormatter(lambda value, _: whole(value) if value >= 1.0 else f"{value:g}")
        )
