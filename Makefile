# Two commands do everything on a fresh machine: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PYTEST := $(BIN)/python -m pytest -n auto --dist worksteal --durations 10
export SIXFLIP_CACHE ?= $(CURDIR)/.cache
# Hundreds of programs are started here: where compiled files may not be kept, each of them
# compiles scipy anew, which is a tenth of a whole test run.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup micropython demo test test-long test-qemu test-pico size check bench bench-accuracy bench-fleet fidelity real blind \
	blind-studies zoo reproduce pictures box package.json clean

help:
	@echo "make demo            a virtual board calibrates itself and the host checks it (no hardware)"
	@echo "make test            the tests: CPython, real MicroPython, an emulated Cortex-M3"
	@echo "make test-long       those of them that take seven seconds each or more; CI runs both"
	@echo "make setup           the command 'sixflip' in $(BIN)"
	@echo "make micropython     the MicroPython interpreter that the virtual board runs on"
	@echo "make test-qemu       the tests on the emulated Cortex-M3 and micro:bit, a session of every chip"
	@echo "make test-pico       the whole product on an emulated Raspberry Pi Pico (an hour or two)"
	@echo "make size            flash and heap of every module of the firmware, and what its start takes"
	@echo "make check           ruff"
	@echo "make bench-accuracy  vector error against imucal, imu_calib and the theoretical bound"
	@echo "make bench-fleet     sixflip fleet: boards a second, memory, workers and schedulers that die"
	@echo "make bench           all but that: every other benchmark"
	@echo "make fidelity        the simulator against real recordings"
	@echo "make real            every claim on real recordings beside a plain computation"
	@echo "make blind           the diagnosis on sealed cases of an independent generator"
	@echo "make blind-studies   real noise, real recordings, effects taken out, captures recommended"
	@echo "make zoo             simulators' documented bugs on MuJoCo's motion, and whether they are named"
	@echo "make pictures        the pictures of the README and of docs/"
	@echo "make box             the STL of the box to print, with Debian's openscad"
	@echo "make reproduce       the paper's tables 3 and 4 (its map: sixflip reproduce --map)"

setup: $(VENV)/.installed

# --no-compile: Python compiles what is imported, a small part of what is installed
$(VENV)/.installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile \
		--editable '.[test,pico]'
	touch $@

micropython: setup
	@$(BIN)/python -m sixflip_host.virtual.micropython_fetch

demo: micropython
	@$(BIN)/sixflip demo --keep demo-output

test: micropython check
	$(PYTEST) -m "not long"

test-long: micropython
	$(PYTEST) -m long

test-qemu: setup
	SIXFLIP_QEMU_CHIPS=all $(BIN)/python -m pytest -s tests/on_qemu tests/on_microbit

test-pico: micropython
	SIXFLIP_PICO=whole $(BIN)/python -m pytest -v -n 3 --dist load --maxschedchunk 1 \
		--durations 0 tests/on_pico

size: setup
	@$(BIN)/python -m tests.studies.bench.size

check: setup
	$(BIN)/ruff check .

bench-accuracy: setup
	@$(BIN)/python -m tests.studies.bench.accuracy

# BOARDS="100 1000" boards; FLEETS=10 fleets of 200 for what the batch has and single boards have
bench-fleet: setup
	@$(BIN)/python -m tests.studies.bench.fleet --boards $(or $(BOARDS),100 1000)
	@$(BIN)/python -m tests.studies.bench.fleet_population --fleets $(or $(FLEETS),40)
	@$(BIN)/python -m tests.studies.bench.fleet_memory

bench: bench-accuracy
	@for each in $(filter-out __init__ accuracy fleet fleet_population fleet_memory,$(basename $(notdir $(wildcard tests/studies/bench/*.py)))); do \
		echo; echo "== $$each"; $(BIN)/python -m tests.studies.bench.$$each || exit 1; done

fidelity: setup
	@$(BIN)/python -m sixflip_host.simulation.fidelity

# COUNT=220 cases, SEED=1, JOBS=2 or SCHEDULER=tcp://host:8786; the result is in blind-output/
CLUSTER = $(if $(SCHEDULER),--scheduler $(SCHEDULER),--jobs $(or $(JOBS),2))
blind: setup
	@$(BIN)/python -m tests.studies.blind.blind_run --count $(or $(COUNT),220) --seed $(or $(SEED),1) \
		$(CLUSTER)

# every study to its end, whatever the others say; JOBS=2 or SCHEDULER=tcp://host:8786
blind-studies: setup
	@failed=0; for each in unattended null_study left_out resolved; do \
		echo; echo "== $$each"; $(BIN)/python -m tests.studies.robustness.$$each \
		$$([ $$each = unattended ] || echo $(CLUSTER)) || failed=1; done; exit $$failed

$(VENV)/.zoo: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[zoo]'
	touch $@

# SEEDS=3 of each defect, KINDS=box,rover, JOBS=2 or SCHEDULER=…; the printed table is the result
zoo: $(VENV)/.zoo
	@$(BIN)/python -m tests.studies.zoo.zoo_run --seeds $(or $(SEEDS),3) \
		$(if $(KINDS),--kinds $(KINDS)) $(CLUSTER)

# every claim on the recordings of ../shared/data beside a plain computation; ONLY=name
real: setup
	@$(BIN)/python -m tests.studies.real.real_run --only "$(ONLY)" $(CLUSTER)

reproduce: setup
	@$(BIN)/sixflip reproduce

# the drawings of the pages, and what terminal, browser and report look like
pictures: micropython
	@$(BIN)/python docs/draw.py
	@$(BIN)/python docs/screenshots.py

box:
	openscad -q -o docs/box/sixflip_box.stl docs/box/sixflip_box.scad

package.json: setup
	$(BIN)/python -m sixflip_host.board.mip_package > $@.new && mv $@.new $@

clean:
	rm -rf $(VENV) .cache build demo-output blind-output
