# Everything starts here: `make demo` and `make test` set up all they need in .venv.
PYTHON ?= python3
# `make pythons` and its like take other environments than .venv, `make lowest` other versions.
VENV := .venv
VERSIONS := constraints.txt
LOWEST := build/constraints-lowest.txt
PACKAGES := -e '.[dev]'
# Relative, and programs as modules: the path of the checkout may have spaces, which the first line of a script cannot.
BIN := $(VENV)/bin
# Small matrices: threads of the linear algebra wait for one another on busy machines.
export OMP_NUM_THREADS ?= 1
# Tests and the programs that they start are compiled once, also where the shell forbids it.
export PYTHONDONTWRITEBYTECODE :=

# A recipe that fails leaves no half-written file, which would count as made the next time.
.DELETE_ON_ERROR:

.PHONY: demo demo-resolution demo-six-axis test suite tests lint types contracts newest start pythons lowest tests-lowest bench day-by-keys soak campaigns mutations \
  campaign-stop campaign-safety campaign-kill campaign-disk campaign-links campaign-proxy campaign-following campaign-soak campaign-resolution \
  campaign-resolution-full campaign-short-series campaign-six-axis campaign-changes campaign-nights campaign-properties campaign-fuzz campaign-access audit peers seeds \
  shipped-recordings pictures looks clean help

help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/'

$(VENV)/installed: pyproject.toml $(VERSIONS)
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "catseye needs Python 3.11 or newer; call: make PYTHON=/path/to/python3.11"; exit 2; }
	@"$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null \
	  || { test "$$(id -u)" = 0 && apt-get install -y python3-venv; } \
	  || { echo "this Python has no venv module; call: apt-get install python3-venv"; exit 2; }
	"$(PYTHON)" -m venv --clear $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c $(VERSIONS) $(PACKAGES)
	@touch $@

demo: $(VENV)/installed  ## the whole measurement on emulated hardware
	$(BIN)/python -m catseye demo

demo-resolution: $(VENV)/installed  ## motion resolution of an emulated KUKA
	$(BIN)/python -m catseye demo resolution

demo-six-axis: $(VENV)/installed  ## calibration of an emulated ABB before a laser tracker
	$(BIN)/python -m catseye demo six-axis

lint: $(VENV)/installed  ## ruff
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .

types: $(VENV)/installed  ## mypy --strict
	$(BIN)/python -m mypy

contracts: $(VENV)/installed  ## who may import whom
	$(BIN)/python -c "from importlinter.cli import lint_imports_command as main; main()"

test: $(VENV)/installed  ## everything that CI runs; the terminal UI and a measurement on the newest Python found as well
	@# Tests hold programs to their time: the checks have what is left of the machine.
	@nice -n 19 $(MAKE) --no-print-directory lint types contracts & checks=$$!; \
	failed=0; $(MAKE) --no-print-directory newest && $(MAKE) --no-print-directory tests || failed=1; \
	wait $$checks || { echo "make lint types contracts: failed, see above"; failed=1; }; \
	exit $$failed

suite: lint types contracts tests  ## the checks and the whole suite in one environment

tests: $(VENV)/installed  ## the whole suite: two at a time, those of one file in their order, long ones first
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder tests/system tests/unit

newest:  ## what `start` does on the newest Python found, where it is newer than PYTHON
	"$(PYTHON)" -m tests.pythons newer start .venv-newest

# Fewer packages than the suite takes: they are installed in seconds.
start: PACKAGES := -e . pytest pytest-asyncio pytest-timeout pyte jsonschema
start: $(VENV)/installed  ## the terminal UI and a measurement by its keys
	$(BIN)/python -m pytest tests/system/test_start.py tests/system/test_tui_measures.py

pythons:  ## lint, types, contracts and the whole suite on every Python found
	"$(PYTHON)" -m tests.pythons each suite

lowest: $(LOWEST)  ## the whole suite with the oldest versions that pyproject.toml allows, on the oldest Python found
	"$(PYTHON)" -m tests.pythons oldest tests-lowest .venv-lowest

tests-lowest: VERSIONS := $(LOWEST)
tests-lowest: tests

$(LOWEST): pyproject.toml tests/lowest.py
	@mkdir -p $(@D)
	"$(PYTHON)" -m tests.lowest > $@

peers: $(VENV)/installed .venv-peers/installed  ## public clients of the protocols, unmodified, against the emulators
	@command -v mbpoll >/dev/null || { test "$$(id -u)" = 0 && apt-get install -y mbpoll; } \
	  || { echo "mbpoll is missing; call: apt-get install mbpoll"; exit 2; }
	$(BIN)/python -m pytest -c pyproject.toml tests/peers

LICENCES := MIT;BSD;Apache;ISC;PSF;Python Software Foundation;Mozilla Public License 2.0;MPL-2.0;Unlicense;0BSD;Zlib

audit:  ## what the program is made of: bill of materials, licences, known weaknesses; files in build/audit
	@mkdir -p build/audit
	$(MAKE) --no-print-directory .venv-shipped/installed VENV=.venv-shipped PACKAGES=".[parquet,cluster]"
	test -d .venv-audit || "$(PYTHON)" -m venv .venv-audit
	.venv-audit/bin/python -m pip install --quiet --disable-pip-version-check cyclonedx-bom==7.5.0 pip-audit==2.10.1 pip-licenses==5.5.5
	.venv-audit/bin/python -m cyclonedx_py environment .venv-shipped/bin/python --pyproject pyproject.toml -o build/audit/sbom.json
	.venv-audit/bin/python -m piplicenses --python .venv-shipped/bin/python --partial-match --allow-only "$(LICENCES)" \
	  --format markdown --with-urls --output-file build/audit/licences.md
	@# Asks an index for known weaknesses; without one, `--strict` fails instead of passing what nobody looked at.
	.venv-audit/bin/python -m pip_audit --strict --skip-editable --path "$$(echo .venv-shipped/lib/python3*/site-packages)" \
	  || { echo "make audit: pip-audit found something, or could not ask its index: see above"; exit 1; }

PEERS := tests/peers/packages
# pymodbus changed its names with version 3: a client of version 2 has it in a folder of its own.
.venv-peers/installed: $(PEERS)/requirements.txt $(PEERS)/without-dependencies.txt $(PEERS)/package.json
	"$(PYTHON)" -m venv --clear .venv-peers
	.venv-peers/bin/python -m pip install --quiet --disable-pip-version-check -r $(PEERS)/requirements.txt
	.venv-peers/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -r $(PEERS)/without-dependencies.txt
	.venv-peers/bin/python -m pip install --quiet --disable-pip-version-check --target .venv-peers/pymodbus2 pymodbus==2.5.3
	@command -v npm >/dev/null || echo "npm is missing: the clients for Node.js are left out"
	! command -v npm >/dev/null || { cp $(PEERS)/package.json .venv-peers/ \
	  && npm install --prefix .venv-peers --silent --no-audit --no-fund; }
	@touch $@

bench: $(VENV)/installed  ## the figures of the README, side by side with their peers
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c $(VERSIONS) textual-plot==0.10.1 statsmodels==0.15.0
	@# Its metadata ask for an older numpy, with which it is compared all the same.
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps pybotics==3.1.2 attrs
	$(BIN)/python -m pytest -c pyproject.toml tests/benchmarks -s -q --timeout 900

day-by-keys: $(VENV)/installed  ## the days of the three emulated benches by keys alone, from nothing to the certificate
	$(CAMPAIGN) tests/campaigns/test_days_by_keys.py

soak: $(VENV)/installed  ## ten minutes of a stream with 1000 samples a second
	CATSEYE_STREAM_S=600 $(BIN)/python -m pytest -c pyproject.toml tests/benchmarks/test_stream.py -s -q --timeout 900

CAMPAIGN := $(BIN)/python -m pytest -c pyproject.toml -s -q --timeout 7200

campaign-stop: $(VENV)/installed  ## STOP at random moments, each with a fault on a link
	$(CAMPAIGN) tests/campaigns/test_stop_moments.py tests/campaigns/test_serial_stop_moments.py

campaign-safety: $(VENV)/installed  ## killed and blocked programs, opened doors, two programs on one arm, bodies in the way
	$(CAMPAIGN) tests/campaigns/test_guard.py tests/campaigns/test_door.py tests/campaigns/test_two_programs.py \
	  tests/campaigns/test_collision_oracle.py tests/campaigns/test_kuka_guard.py

campaign-kill: $(VENV)/installed  ## SIGKILL at random moments and at every named place: every procedure, commands that write files; bit for bit with an injected clock
	$(CAMPAIGN) tests/campaigns/test_kill_procedures.py tests/campaigns/test_kill_commands.py tests/campaigns/test_kill_bit_for_bit.py \
	  tests/campaigns/test_kill_matrix.py tests/campaigns/test_serial_kill_matrix.py

campaign-disk: $(VENV)/installed  ## full, broken, read-only, over quota, moved away, torn, flipped, copied: runs of every procedure, files, the store
	$(CAMPAIGN) tests/campaigns/test_disk_faults.py tests/campaigns/test_disk_files.py tests/campaigns/test_disk_store.py

campaign-links: $(VENV)/installed  ## the paper's plan with one fault in 20 answers on every link
	$(CAMPAIGN) tests/campaigns/test_faulty_links.py

campaign-proxy: $(VENV)/installed  ## a small plan with a fault on each way of each link, 396 runs on three benches
	$(CAMPAIGN) --timeout 40000 tests/campaigns/test_proxy.py

campaign-following: $(VENV)/installed  ## what the beam misses while the arm is led by set points, with and without learned lags
	$(CAMPAIGN) tests/campaigns/test_led_beam.py

campaign-soak: $(VENV)/installed  ## hundreds of runs in one engine: memory
	$(CAMPAIGN) tests/campaigns/test_many_runs.py

campaign-resolution: $(VENV)/installed  ## least steps, lost motion, masking, least steps from recordings, and from the joints' recordings to measured steps of the tool
	$(CAMPAIGN) tests/campaigns/test_motion_resolution.py
	$(BIN)/python -m tests.masking
	$(BIN)/python -m tests.recorded_least_steps
	$(BIN)/python -m tests.short_series
	$(BIN)/python -m tests.resolution_loop

campaign-short-series: $(VENV)/installed  ## least steps from short series and standstills: how many of 400 intervals hold
	$(BIN)/python -m tests.short_series

campaign-changes: $(VENV)/installed  ## the change alarm: unchanged nights, and nights before which a node has moved
	$(CAMPAIGN) tests/campaigns/test_changes.py

campaign-resolution-full: $(VENV)/installed  ## the 60 series of six joints over real sockets, 40 minutes; called again it goes on
	$(BIN)/python -m tests.resolution_campaign $(CAMPAIGN_RESOLUTION)

campaign-six-axis: $(VENV)/installed  ## calibration of a six-axis arm: accuracy, lack of fit, disturbed sets, choice of the model
	$(CAMPAIGN) tests/campaigns/test_six_axis.py

campaign-nights: $(VENV)/installed  ## 200 nights of a job, each with one fault: killed, terminated, no disk, no reader, no device, two at a time; hours
	$(CAMPAIGN) tests/campaigns/test_nights.py --timeout 100000

campaign-properties: $(VENV)/installed  ## what must hold of any input and any sequence, with examples that nobody tried before; ROUNDS=5
	for round in $$(seq $(or $(ROUNDS),5)); do \
	  CATSEYE_EXAMPLES=fresh $(BIN)/python -m pytest -q -n 2 -m hypothesis tests/unit || exit 1; done

campaign-fuzz: $(VENV)/installed  ## ten million random and mutated bytes into every codec, mutated files of every kind, hostile clients of an engine
	CATSEYE_FUZZ_BYTES=$${CATSEYE_FUZZ_BYTES:-10000000} CATSEYE_FUZZ_FILES=$${CATSEYE_FUZZ_FILES:-1000} $(CAMPAIGN) \
	  tests/unit/test_random_bytes.py tests/unit/test_mutated_files.py tests/unit/app/service/test_mutated_requests.py \
	  tests/campaigns/test_hostile_clients.py

campaign-access: $(VENV)/installed  ## who may reach what: sockets, other users, other controllers, hostile names, texts and links
	CATSEYE_FUZZ_FILES=$${CATSEYE_FUZZ_FILES:-1000} $(CAMPAIGN) tests/campaigns/test_other_user.py \
	  tests/unit/app/service/test_address.py tests/unit/app/service/test_control.py tests/unit/app/service/test_crowd.py \
	  tests/unit/app/service/test_protocol.py tests/unit/app/service/test_mutated_requests.py tests/unit/app/guard/test_lock.py \
	  tests/unit/app/results/test_hostile_texts.py tests/unit/app/render tests/unit/app/tui/test_frame_titles.py \
	  tests/unit/app/tui/test_control_of_others.py tests/unit/app/test_tables_in_a_spreadsheet.py tests/unit/app/files/test_csv_text.py \
	  tests/unit/drivers/test_device_text.py tests/unit/app/store/test_hostile_names.py tests/unit/app/store/test_linked_files.py \
	  tests/unit/app/store/test_seal.py tests/unit/simulators/test_emulated_bench.py tests/system/test_hostile_device.py

mutations: $(VENV)/installed  ## faults put into critical code one at a time: each has to be caught by a test
	$(BIN)/python -m tests.mutations

campaigns: $(VENV)/installed  ## long runs: the paper's whole plan, ways of following, killed runs
	$(BIN)/python -m pytest -c pyproject.toml tests/campaigns -s -q

seeds: $(VENV)/installed  ## the demo with seeds 1 to 7: what the error map leaves of the conventional model's error
	@for seed in 1 2 3 4 5 6 7; do \
	  $(BIN)/python -m catseye demo --seed $$seed --out catseye-demo/seed-$$seed --json 2>/dev/null | $(BIN)/python -c \
	  "import json, sys; d = json.load(sys.stdin); print('seed', $$seed, 'ratio', round(d['validation']['ratio'], 3), \
	  'normalised errors', round(d['rms_normalised_error'], 2), 'points', d['fit']['n_points'])"; done

shipped-recordings: $(VENV)/installed  ## the tests of every joint of the emulated KR210 that come with the program
	$(BIN)/python -m tests.shipped_recordings

pictures: $(VENV)/installed demo  ## the pictures of the README and of the terminal user interface
	$(BIN)/python docs/pictures.py catseye-demo
	$(BIN)/python docs/screens.py

looks: $(VENV)/installed  ## every screen of all systems in three sizes and two themes, to be looked at: catseye-looks
	$(BIN)/python docs/every_screen.py catseye-looks

clean:  ## remove the environment and caches
	rm -rf .venv .venv-* .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build *.egg-info
