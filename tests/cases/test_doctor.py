"""`wrinkle doctor`."""

from __future__ import annotations

from cases import doctor
from cases.__main__ import main


def test_doctor_reports_versions_cores_and_cache(capsys):
    assert main(["doctor"]) == 0
    output = capsys.readouterr().out
    for word in ("numpy", "numba", "cores", "threads", "cache", "nothing is missing"):
        assert word in output


def test_doctor_names_what_is_missing(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "NEEDED", ("numpy", "no_such_package"))
    assert main(["doctor"]) == 1
    assert "missing: no_such_package is not installed" in capsys.readouterr().out
