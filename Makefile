# Everything starts here: `make demo` and `make test` set up all they need in .venv.
PYTHON ?= python3
BIN := .venv/bin
# Small matrices: threads of the linear algebra wait for one another on busy machines.
export OMP_NUM_THREADS ?= 1
# Tests and the programs that they start are compiled once, also where the shell forbids it.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test lint types contracts bench soak campaigns peers seeds pictures clean help

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

test: lint types contracts  ## everything that CI runs; two tests at a time, those of one file in their order, long ones first
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder tests/system tests/unit

peers: .venv/installed  ## public clients of the protocols, unmodified, against the emulators
	@command -v mbpoll >/dev/null || { test "$$(id -u)" = 0 && apt-get install -y mbpoll; } \
	  || { echo "mbpoll is missing; call: apt-get install mbpoll"; exit 2; }
	test -d .venv-peers || $(PYTHON) -m venv .venv-peers
	.venv-peers/bin/pip install --quiet --disable-pip-version-check melfapy==0.1.0 numpy matplotlib
	.venv-peers/bin/pip install --quiet --disable-pip-version-check --no-deps feather-xrol==0.1.1
	$(BIN)/python -m pytest -c pyproject.toml tests/peers

bench: .venv/installed  ## the figures of the README, side by side with their peers
	$(BIN)/python -m pytest -c pyproject.toml tests/benchmarks -s -q --timeout 900

soak: .venv/installed  ## ten minutes of a stream with 1000 samples a second
	CATSEYE_STREAM_S=600 $(BIN)/python -m pytest -c pyproject.toml tests/benchmarks/test_stream.py -s -q --timeout 900

campaigns: .venv/installed  ## long runs: the paper's whole plan, ways of following, killed runs
	$(BIN)/python -m pytest -c pyproject.toml tests/campaigns -s -q

seeds: .venv/installed  ## the demo with seeds 1 to 7: what the error map leaves of the conventional model's error
	@for seed in 1 2 3 4 5 6 7; do \
	  $(BIN)/catseye demo --seed $$seed --out catseye-demo/seed-$$seed --json 2>/dev/null | $(BIN)/python -c \
	  "import json, sys; d = json.load(sys.stdin); print('seed', $$seed, 'ratio', round(d['validation']['ratio'], 3), \
	  'normalised errors', round(d['rms_normalised_error'], 2), 'points', d['fit']['n_points'])"; done

pictures: .venv/installed demo  ## the pictures of the README and of the terminal user interface
	$(BIN)/python docs/pictures.py catseye-demo
	$(BIN)/python docs/screens.py

clean:  ## remove the environment and caches
	rm -rf .venv .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build *.egg-info
