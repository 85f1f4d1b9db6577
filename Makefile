# Every target sets up its own environment in .venv; running one twice does the work once.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/installed

.PHONY: help report test lint benchmark wheel clean

help:
	@echo "make report     solve the scenes and write report/index.html and report/report.pdf"
	@echo "make test       the quick tests"
	@echo "make lint       ruff and mypy"
	@echo "make benchmark  the verification runs, into runs/benchmark"
	@echo "make wheel      the installable wheel, into dist"
	@echo "make clean      remove .venv and caches; results in runs/ and report/ stay"

$(INSTALLED): pyproject.toml constraints.txt
	@command -v $(PYTHON) >/dev/null || { echo "wrinklebench needs Python 3.11 or newer; no $(PYTHON) was found. Name another with: make PYTHON=..."; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "wrinklebench needs Python 3.11 or newer; $(PYTHON) is $$($(PYTHON) -V 2>&1). Name another with: make PYTHON=..."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[test,dev]'
	@touch $@

report: $(INSTALLED)
	$(BIN)/wrinkle report --quick

test: $(INSTALLED)
	$(BIN)/python -m pytest -n auto

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

benchmark: $(INSTALLED)
	$(BIN)/python -m pytest -m benchmark

wheel: $(INSTALLED)
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist .

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .benchmarks
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
