"""What a verification run leaves for the report: its result folders and every quantity with its limit.

`benchmarks.json`, in the folder of the results, is a list under "runs", one entry per test:

    name, title            file and function of the test, and the first line of its docstring
    status                 "passed", "failed" (a quantity is beyond its limit, or the run broke), "skipped"
    message                why, where it did not pass
    seconds, cpu_seconds   of the whole test, compilation included
    finished               UTC time, ISO 8601
    folders                result folders, relative to the file
    quantities             list of: quantity, value, unit, requirement ("at most 1e-06", "" for a mere note),
                           reason (of the limit), holds (null for a note)
"""

from __future__ import annotations

import json
import math
import os
import shutil
import time
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path

FILE = "benchmarks.json"


@dataclass(frozen=True)
class Quantity:
    quantity: str
    value: float | str
    unit: str
    requirement: str
    reason: str
    holds: bool | None


def plain(value: object) -> float | str:
    """A number or a text that JSON can hold; nan and inf become texts."""
    if isinstance(value, str):
        return value
    number = float(value)  # type: ignore[arg-type]
    return number if math.isfinite(number) else str(number)


@dataclass
class Verification:
    """Collects the quantities of one verification run.

    Limits are judged together when the test ends, so that one value beyond its limit hides no other.
    """

    name: str
    title: str
    root: Path
    quantities: list[Quantity] = field(default_factory=list)
    folders: list[str] = field(default_factory=list)
    started: tuple[float, float] = field(default_factory=lambda: (time.perf_counter(), time.process_time()))

    def folder(self, name: str) -> Path:
        """A result folder of this name, empty: an earlier run's result there is removed, nothing else is."""
        target = self.root / name
        if target.exists():
            if not (target / "result.json").exists():
                raise FileExistsError(f"{target} is not a result folder; move it away")
            shutil.rmtree(target)
        if name not in self.folders:
            self.folders.append(name)
        return target

    def below(self, quantity: str, value: float, limit: float, reason: str, unit: str = "") -> None:
        """Require value <= limit; nan fails."""
        self._judge(quantity, value, unit, f"at most {limit:.6g}", reason, value <= limit)

    def above(self, quantity: str, value: float, limit: float, reason: str, unit: str = "") -> None:
        """Require value >= limit; nan fails."""
        self._judge(quantity, value, unit, f"at least {limit:.6g}", reason, value >= limit)

    def within(
        self, quantity: str, value: float, low: float, high: float, reason: str, unit: str = ""
    ) -> None:
        """Require low <= value <= high; nan fails."""
        self._judge(quantity, value, unit, f"{low:.6g} to {high:.6g}", reason, low <= value <= high)

    def equal(self, quantity: str, value: float | str, expected: float | str, reason: str) -> None:
        """Require value == expected: for counts, words and bits, not for measured numbers."""
        self._judge(quantity, value, "", f"equal to {expected}", reason, value == expected)

    def note(self, quantity: str, value: float | str, unit: str = "") -> None:
        """Record a value that has no limit, such as a time, which depends on the machine."""
        self.quantities.append(Quantity(quantity, plain(value), unit, "", "", None))

    def _judge(
        self, quantity: str, value: float | str, unit: str, requirement: str, reason: str, holds: object
    ) -> None:
        if not reason.strip():
            raise ValueError(f"the limit of {quantity!r} needs a reason")
        self.quantities.append(Quantity(quantity, plain(value), unit, requirement, reason, bool(holds)))

    def conclude(self) -> None:
        """Fail if a requirement does not hold, or if there was none."""
        judged = [q for q in self.quantities if q.holds is not None]
        assert judged, "a verification run has to require something"
        broken = [
            f"{q.quantity}: {q.value} {q.unit}, required: {q.requirement}" for q in judged if not q.holds
        ]
        assert not broken, "; ".join(broken)

    def entry(self, status: str, message: str) -> dict[str, object]:
        """This run as it stands in the file."""
        wall, cpu = self.started
        return {
            "name": self.name,
            "title": self.title,
            "status": status,
            "message": message,
            "seconds": time.perf_counter() - wall,
            "cpu_seconds": time.process_time() - cpu,
            "finished": datetime.now(UTC).isoformat(timespec="seconds"),
            "folders": list(self.folders),
            "quantities": [asdict(quantity) for quantity in self.quantities],
        }


def save(root: Path, entry: dict[str, object]) -> None:
    """Put an entry into root/benchmarks.json in place of the earlier one of its name; others stay."""
    target = root / FILE
    earlier = json.loads(target.read_text(encoding="utf-8"))["runs"] if target.exists() else []
    runs = [run for run in earlier if run["name"] != entry["name"]] + [entry]
    runs.sort(key=lambda run: run["name"])
    unfinished = target.with_suffix(".json.part")
    with unfinished.open("w", encoding="utf-8") as file:
        json.dump({"runs": runs}, file, indent=1, allow_nan=False)
        file.flush()
        os.fsync(file.fileno())
    unfinished.replace(target)
