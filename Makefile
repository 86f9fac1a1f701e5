# Everything starts here: `make demo` and `make test` set up all they need in .venv.
PYTHON ?= python3
BIN := .venv/bin
# Small matrices: threads of the linear algebra wait for one another on busy machines.
export OMP_NUM_THREADS ?= 1

.PHONY: demo test lint types contracts unit bench clean help

help:  ## list the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/'

.venv/installed: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "catseye needs Python 3.11 or newer; call: make PYTHON=/path/to/python3.11"; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
	  || { test "$$(id -u)" = 0 && apt-get install -y python3-venv; } \
	  || { echo "this Python has no venv module; call: apt-get install python3-venv"; exit 2; }
	$(PYTHON) -m venv --clear .venv
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	@touch $@

demo: .venv/installed  ## the whole measurement on emulated hardware
	$(BIN)/catseye demo

lint: .venv/installed  ## ruff
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: .venv/installed  ## mypy --strict
	$(BIN)/mypy

contracts: .venv/installed  ## who may import whom
	$(BIN)/lint-imports

test: lint types contracts  ## everything that CI runs
	$(BIN)/python -m pytest

bench: .venv/installed  ## the figures of the README, side by side with their peers
	$(BIN)/python -m pytest -c pyproject.toml tests/benchmarks -s -q --timeout 900

clean:  ## remove the environment and caches
	rm -rf .venv .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build *.egg-info
