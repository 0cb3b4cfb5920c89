# Two commands: `make demo` and `make test`. Each sets up what is missing first (tools/setup.sh).
VENV ?= .venv
DOCS_VENV ?= .venv-docs
RESULTS ?= results
JOBS ?= 2
SEED ?= 1
WITHIN ?= 0
N ?= 1000
# compiled modules are kept as kernels are: without them each process of the tests compiles its own for 15 s
unexport PYTHONDONTWRITEBYTECODE
# one BLAS thread a process: the work is shared out over processes instead
RUN = OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(VENV)/bin/python -m

# two programs, with dolfinx and without: memory that compiled code takes is given back between them;
# what builds the wheel comes first, so that no process waits for it at the end
WITH_SOLID = $(addprefix tests/,installed unitcell3d meshing weavecell refusals)
QUICK = $(RUN) pytest -n $(JOBS) --dist worksteal -m "not slow"

.PHONY: demo test test-slow test-nightly test-processor test-generic nightly mutants package ledger scored convergence printed validate fuzz pages stale lint figures studies docs docs-again kernels setup clean

demo: setup  ## S-720: 3D crossover, calibration and four impacts, with a report in results/demo
	$(RUN:-m=) examples/demo.py $(RESULTS)/demo

test test-slow test-nightly test-processor test-generic printed mutants package ledger scored convergence fuzz studies stale pages lint: export EXTRAS = app,dev
test: export KERNELS = all
test: setup  ## everything but the long validation runs, then the style
	$(QUICK) $(WITH_SOLID)
	$(QUICK) tests $(WITH_SOLID:%=--ignore=%)
	$(MAKE) lint

# each process takes the next test as it gets free
LONG = $(RUN) pytest -n $(JOBS) --dist load --maxschedchunk 1

test-slow: setup  ## the long tests, the published outcomes among them
	$(LONG) -m "slow and not printed and not nightly"

test-nightly: setup  ## the longest tests, of which test-slow has a cheaper kind
	$(LONG) -m nightly

# tests that hold computed numbers, and of `fabrics.base.sums`: they run once more as on other processors
NUMBERS = $(addprefix tests/,test_golden.py test_processor_places.py fabrics/test_sums.py fabrics/test_laws.py \
	$(addprefix validation/models/test_,bare_impact.py cable_net.py smith.py) shellfabric/cell shellfabric/block shellfabric/projectile weavecell/limits weavecell/runs weavecell/studies)
# the verdicts of the ledger, in 170 CPU s more: nightly, by `test-generic`
VERDICTS = tests/validation/claims
# BLAS of a processor without AVX2, and numpy's loops without it: nothing is compiled
OTHER = OPENBLAS_CORETYPE=Sandybridge NPY_DISABLE_CPU_FEATURES="AVX2 FMA3"
# kernels for any x86-64 processor, in a cache of their own
GENERIC = NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES="" NUMBA_CACHE_DIR=$(CURDIR)/$(RESULTS)/generic-kernels

test-processor: setup  ## what holds numbers, once more with BLAS and numpy's loops of another processor
	$(OTHER) $(QUICK) $(NUMBERS)

test-generic: setup  ## the same with kernels compiled for any processor: minutes of compiling
	$(GENERIC) $(OTHER) $(QUICK) $(NUMBERS) $(VERDICTS)

printed: setup  ## every command that the guide prints, run as a reader would: twenty minutes of one core
	$(LONG) -m printed

nightly:  ## all that takes too long for a test, one after the other; goes on after one that fails, and names those
	$(MAKE) --keep-going --jobs 1 test-nightly test-generic fuzz ledger stale printed docs-again package convergence mutants

mutants: setup  ## planted defects, each with the tests nearest to it: more than an hour; fails where fewer than 95 % are found
	nice $(RUN:-m=) tools/mutants.py --out $(RESULTS)/mutants.csv --least 0.95

package: setup  ## the wheel by Python 3.11 to 3.13, with the newest and the lowest packages and without extras, and the container image step by step: built, and tried as users would
	tools/package.sh wheel
	tools/package.sh lowest
	tools/package.sh newest
	tools/package.sh base
	tools/package.sh image

validate: test-slow ledger  ## the long tests, and the ledger of the thesis's claims

ledger: setup  ## all claims of the thesis, slow ones and variants too: fails where a verdict is not the recorded one
	$(RUN) validation claims --slow --out $(RESULTS)/validate

scored: setup  ## each test of a ply or pack against drawn shots, as far as they are fired: rank, CRPS, Brier, in results/scored
	$(RUN) validation scored --jobs $(JOBS) --out $(RESULTS)/scored

convergence: setup  ## critical velocities by mesh and by the force of the clamps, held by what they are expected to be
	$(RUN) validation study published-critical-velocities edges-limits --out $(RESULTS)/studies

fuzz: setup  ## N random scenes of the sequence SEED: a quarter of an hour of two cores
	HYPOTHESIS_PROFILE=fuzz $(RUN) pytest tests/fuzz/test_properties.py --hypothesis-seed $(SEED)
	$(RUN) tests.fuzz.mutations --seed $(SEED) --count 2000
	WEAVECELL_BYTES=500 $(RUN) pytest -q tests/refusals/test_bytes.py
	$(RUN) tests.fuzz.kills --seed $(SEED) --count 200
	$(RUN) tests.fuzz --seed $(SEED) --count $(N) --jobs $(JOBS) --out $(RESULTS)/fuzz

figures: demo  ## the figures of README and docs
	$(RUN:-m=) tools/figures.py $(RESULTS)/demo

studies: setup  ## all studies again, their CSVs into docs/reports/data: many hours; what is done is not done again
	$(RUN) validation study all --jobs $(JOBS)

pages: setup  ## pages and numbers of the documentation that are made from code and from the data of studies
	$(RUN:-m=) tools/pages.py

docs:  ## the documentation site in results/site; runs the scripts of examples/ that have changed; warnings are errors
	@VENV=$(DOCS_VENV) EXTRAS=app,docs KERNELS=none tools/setup.sh
	$(DOCS_VENV)/bin/python -m sphinx -W --keep-going -b html docs $(RESULTS)/site
	@echo "docs: $(RESULTS)/site/index.html; 'make docs-again' runs all scripts of the gallery again"

docs-again:  ## the same from the beginning: a change of the code can change what the scripts print
	rm -rf docs/generated/*/ $(RESULTS)/site
	$(MAKE) docs

stale: setup  ## golden rows of studies against docs/reports/data: fails where one has moved that validation/moved.csv does not list; all in some ten minutes, or the cheapest WITHIN so many CPU seconds
	$(RUN) validation stale --within $(WITHIN)

lint: setup
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	$(VENV)/bin/lint-imports --no-cache

kernels: setup  ## those of all kinds of runs: a first shot of any kind then waits for none
	$(RUN:-m=) tools/compile_kernels.py all

setup:  ## what `make demo` needs
	@VENV=$(VENV) tools/setup.sh

clean:
	rm -rf $(RESULTS) .pytest_cache .ruff_cache .mypy_cache
