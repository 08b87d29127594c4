# Every verb sets up what it needs: .venv with the tools of the group `dev`, and the compiled core.
# Needs only Python 3.11 or newer (with venv), cargo and make.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help atlas study test test-debug test-python test-rust test-browser test-explorer check bench bench-agreement bench-accuracy bench-engine bench-envs bench-map bench-models bench-peers bench-scaling compare-engines coverage coverage-python coverage-rust docs explorer film format build fuzz map mutants notebooks notices paper paper-chart soak supply test-wheel tools wheel

VENV := .venv
BIN := $(VENV)/bin
CARGO_TARGET_DIR ?= target
export CARGO_TARGET_DIR

# The first interpreter that is new enough; PYTHON=... overrides.
PYTHON ?= $(shell for p in python3 python3.14 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)

# What the compiled core is made of; cargo decides what of it is stale.
SOURCES := Cargo.toml $(wildcard Cargo.lock) pyproject.toml \
	$(shell find rust_core python/Cargo.toml python/src -name target -prune -o \
	\( -name '*.rs' -o -name Cargo.toml \) -print 2>/dev/null)

# pyo3 reads the interpreter from here, so that clippy and maturin build for the same one.
CARGO := PYO3_PYTHON=$(CURDIR)/$(BIN)/python cargo

help: ## list the verbs
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/\1\t\2/p' $(MAKEFILE_LIST) | sort | expand -t 14

study: $(VENV)/.built ## the main job in half a minute; all of it with ARGS=--full; files in out/
	$(BIN)/python -m research seizure $(ARGS)

# Side by side: where one compiles on one core, or waits for another build, the others take the rest.
test: ## all tests (Rust, Python, documentation) and all checks
	@$(MAKE) --no-print-directory --jobs=3 test-rust test-python check
# The binding has no Rust tests. It is named so that both ask for the same features, and the engine is compiled once.
CARGO_TEST := cargo test --release --package crawler2d-core --package crawler2d-python
# In sixteen pieces unit tests are compiled in half the time, and are as fast; all else would take longer to run.
UNIT_TESTS := --tests --config profile.release.package.crawler2d-core.codegen-units=16
test-rust: | tools
	$(CARGO_TEST) --test '*'
	MAKEFLAGS= $(CARGO_TEST) --doc
	$(CARGO_TEST) $(UNIT_TESTS)
# In the order of `testpaths`: sorted by their number of tests, files of few long ones would come last, on one core.
# `check` tests the walls.
test-python: $(VENV)/.built
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder --ignore=tests/walls
test-debug: | tools
	$(CARGO) test --package crawler2d-core --test facts every_build

test-browser: $(VENV)/.built $(VENV)/.browser ## the pages of runs and audits in a real browser
	CRAWLER2D_BROWSER="$$(cat $(VENV)/.browser)" $(BIN)/python -m pytest -o addopts=-ra tests/browser

test-explorer: $(VENV)/.built $(VENV)/.browser ## the explorer in a real browser, and its core against the usual one
	CRAWLER2D_BROWSER="$$(cat $(VENV)/.browser)" $(BIN)/python -m pytest -o addopts=-ra tests/explorer

check: $(VENV)/.built ## format, lint, types, walls, stubs and documentation, nothing changed
	cargo fmt --all --check
	$(CARGO) clippy --release --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --release --workspace --no-deps
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m pytest -q --noconftest tests/walls
	$(BIN)/python -m mypy.stubtest crawler2d._core --mypy-config-file tests/walls/stubtest.ini

atlas: $(VENV)/.built ## audit every model file in a tree of repositories, FOLDER=..., on one page; a minute a robot
	$(BIN)/python -m crawler2d atlas $(FOLDER) $(ARGS)

bench: | tools ## what a simulated second of each track model costs, two minutes
	cargo bench

bench-engine: | tools ## the same beside rapier's dynamics, minutes
	cargo bench --bench engine

bench-accuracy: $(VENV)/.built ## how exact rates are and what that costs, hours; Ctrl-C loses nothing
	$(BIN)/python -m benches.accuracy $(ARGS)

bench-agreement: $(VENV)/.built $(VENV)/.peers ## both engines on 300 random robots and the study's cells, hours; Ctrl-C loses little
	$(BIN)/python -m benches.agreement run
	$(BIN)/python -m benches.agreement third
	$(BIN)/python -m benches.agreement study
	$(BIN)/python -m benches.agreement one-by-one
	$(BIN)/python -m benches.agreement ensembles
	$(BIN)/python -m benches.agreement pinched
	$(BIN)/python -m benches.agreement table

bench-map: $(VENV)/.built $(VENV)/.peers ## a map of rates beside a loop over pymunk, some minutes
	$(BIN)/python -m benches.peers.maps $(ARGS)

# Bullet is built from source, which takes minutes. ODE is used where an interpreter has it (Debian: python3-pyode).
bench-models: $(VENV)/.built $(VENV)/.engines ## files of models in Bullet, ODE and DART beside the predictions, hours; Ctrl-C loses little
	for engine in dart dart-dantzig bullet bullet-pyramid bullet-prisms ode-fine ode; do $(BIN)/python -m benches.models run $$engine || exit; done
	$(BIN)/python -m benches.models table

bench-peers: $(VENV)/.built $(VENV)/.peers ## the same job in other engines, about three quarters of an hour
	$(BIN)/python -m benches.peers $(ARGS)

bench-envs: $(VENV)/.built $(VENV)/.peers ## steps of environments a second, two minutes
	$(BIN)/python -m benches.envs $(ARGS)

bench-scaling: $(VENV)/.built ## cost against wheels, ground, threads and accuracy, some minutes
	$(BIN)/python -m benches.scaling $(ARGS)

# ODE is not in the package index in a form that builds: it is used where an interpreter has it (Debian: python3-pyode).
compare-engines: $(VENV)/.built $(VENV)/.peers $(VENV)/.engines ## the same runs in other engines, hours; Ctrl-C loses little; ARGS=--quick is a look in ten minutes
	$(BIN)/python -m benches.engines run $(ARGS)
	$(BIN)/python -m benches.engines table $(ARGS)

coverage: coverage-python coverage-rust ## what the ordinary tests execute of package and core, in out/; an hour

# A test with a limit of time may fail, as what is traced takes longer: what it executed counts.
coverage-python: $(VENV)/.built $(VENV)/.coverage
	@rm -rf out/coverage && mkdir -p out/coverage
	-$(BIN)/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder --cov --cov-context=test --cov-report= \
		--junitxml=out/coverage/tests.xml
	$(BIN)/coverage json -q -o out/coverage/python.json
	$(BIN)/python -m tests.coverage.package out/coverage/python.json > out/coverage/python.txt
	@sed '/^$$/,$$d' out/coverage/python.txt

# The core is built anew with counters, and its facts are several times as slow.
coverage-rust: $(VENV)/.dependencies $(BIN)/cov
	$(BIN)/python -m tests.coverage.core $(ARGS)

docs: $(VENV)/.built $(VENV)/.docs ## the documentation site, out/site/index.html, in two minutes; no network; with the explorer if that was made
	$(BIN)/codespell README.md CONTRIBUTING.md CHANGELOG.md docs studies python/crawler2d
	$(BIN)/python docs/site/build.py $(ARGS)

# Rust's standard library for browsers comes from rustup (rustup target add wasm32-unknown-unknown) or from Debian.
explorer: $(VENV)/.built ## write out/explorer.html, one page that simulates by itself; ten minutes at first
	$(BIN)/python -m explorer

format: $(VENV)/.dependencies ## format all code
	cargo fmt --all
	$(BIN)/ruff check --fix-only --quiet .
	$(BIN)/ruff format .

build: $(VENV)/.built ## the compiled core, in place

# Needs a C++ compiler, too: libFuzzer is built from source. Only our own crates are compiled for it.
MINUTES ?= 20
fuzz: $(VENV)/.built $(VENV)/.fuzz ## changed inputs that look for paths in core and readers, MINUTES=20 in all; TARGETS="solver xacro" are those alone
	RUSTC_WORKSPACE_WRAPPER=$(CURDIR)/rust_core/fuzz/rustc.sh \
		cargo build --release --package crawler2d-fuzz --features libfuzzer --bins
	$(BIN)/python -m tests.fuzz.guided $(MINUTES) $(TARGETS)

map: $(VENV)/.built ## draw docs/rooms.svg: what rooms import of each other
	$(BIN)/python -m tests.walls.map

notebooks: $(VENV)/.built ## run the notebooks of studies/ and keep their outputs, some minutes
	$(BIN)/python -m tests.research.notebooks $(ARGS)

paper: $(VENV)/.built ## reproduce the paper: tables, claims, figures; an hour or two, Ctrl-C loses nothing
	$(BIN)/python -m research paper --full $(ARGS)

paper-chart: $(VENV)/.built ## draw which motors and rotors give the paper's Table 2, a quarter of an hour; Ctrl-C loses nothing
	$(BIN)/python -m research chart $(ARGS)

film: $(VENV)/.built ## make docs/readme-light.gif and docs/readme-dark.gif: the example of the README
	$(BIN)/python docs/readme_film.py

soak: $(VENV)/.built test-debug ## the long tests, and those of a debug build, minutes to hours
	CRAWLER2D_SOAK=1 $(CARGO_TEST) -- --include-ignored
	CRAWLER2D_SOAK=1 $(CARGO_TEST) --test '*' -- --include-ignored
	CRAWLER2D_SOAK=1 $(BIN)/python -m pytest -m 'soak or not soak'

# Known vulnerabilities are asked of the databases of RustSec and PyPI.
supply: $(VENV)/.built $(VENV)/.supply $(BIN)/cargo-deny ## licences, sources, duplicates and known vulnerabilities of all that we depend on; needs the network
	$(BIN)/cargo-deny check
	$(BIN)/pip-audit --skip-editable

mutants: coverage-python $(BIN)/cargo-mutants $(VENV)/.mutants ## put small faults into core and package, see that tests notice; hours
	$(BIN)/python -m tests.mutants.core $(ARGS)
	$(BIN)/python -m tests.mutants.package

# One wheel for every Python from 3.11 on.
wheel: $(VENV)/.dependencies ## build the wheel into dist/
	@rm -f dist/*.whl
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin build --release --locked --out dist

notices: | tools ## write anew whose libraries the compiled core contains; after changes of Cargo.lock
	@test -x $(VENV)/about/bin/cargo-about || cargo install cargo-about@0.9.3 --locked --features cli --root $(VENV)/about
	$(VENV)/about/bin/cargo-about about generate --locked --manifest-path python/Cargo.toml \
		-c python/notices.toml python/notices.hbs -o THIRD-PARTY-NOTICES

# Nothing is on the PATH there: neither cargo nor a compiler.
test-wheel: wheel ## the wheel in a fresh environment without a compiler
	@rm -rf $(VENV)/fresh && $(PYTHON) -m venv $(VENV)/fresh
	PATH=$(CURDIR)/$(VENV)/fresh/bin python -m pip install --quiet --disable-pip-version-check --only-binary :all: "$$(ls dist/*.whl)[models,plot,analysis,sensitivity]" ipykernel nbclient
	cd $(VENV)/fresh && PATH=$(CURDIR)/$(VENV)/fresh/bin python $(CURDIR)/tests/fresh_wheel.py
	PATH=$(CURDIR)/$(VENV)/fresh/bin python -m pip install --quiet --disable-pip-version-check uv
	@# What uv installs starts by a script of the shell; and by itself uv takes no interpreter of a virtual environment.
	ln -sf "$$(command -v realpath)" "$$(command -v dirname)" $(VENV)/fresh/bin/
	cd $(VENV)/fresh && PATH=$(CURDIR)/$(VENV)/fresh/bin UV_CACHE_DIR=cache uvx --quiet --python "$$(bin/python -c 'import sys; print(sys._base_executable)')" --from "$$(ls $(CURDIR)/dist/*.whl)" crawler2d demo

tools:
	@if [ -z "$(PYTHON)" ]; then \
		echo "crawler2d needs Python 3.11 or newer: no such python3 was found (set PYTHON=...)" >&2; exit 1; fi
	@if ! $(PYTHON) -c 'import venv, ensurepip' 2>/dev/null; then \
		echo "crawler2d needs Python's venv and ensurepip (Debian: apt-get install python3-venv)" >&2; exit 1; fi
	@if ! command -v cargo >/dev/null; then \
		echo "crawler2d needs cargo, Rust's build tool: https://rustup.rs" >&2; exit 1; fi

$(VENV)/.dependencies: pyproject.toml | tools
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
	$(BIN)/python -m pip install --quiet --group dev
	@touch $@

# Built aside, so that nothing of them stays in the target folder.
INSTALL := env -u CARGO_TARGET_DIR cargo install --quiet --locked --root $(VENV)
$(BIN)/cargo-mutants: | tools
	$(INSTALL) cargo-mutants@27.1.0
$(BIN)/cargo-deny: | tools
	$(INSTALL) cargo-deny@0.20.2
$(BIN)/cov: | tools
	$(INSTALL) --features cli llvm_profparser@0.15.0

# Groups of pyproject.toml that single verbs need.
$(addprefix $(VENV)/.,coverage docs engines fuzz mutants peers supply): $(VENV)/.%: $(VENV)/.dependencies
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --group $*
	@touch $@

# Which browser the pages are tested in: one of this machine, playwright's own, or Debian's.
$(VENV)/.browser: $(VENV)/.dependencies
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --group browser
	@find() { for name in chromium chromium-browser google-chrome google-chrome-stable chrome; do \
		command -v $$name && return; done; return 1; }; \
	if find > $@; then exit; fi; \
	if $(BIN)/python -m playwright install chromium; then echo playwright > $@; exit; fi; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -qq --yes chromium; fi; \
	if ! find > $@; then \
		echo "test-browser needs chromium or chrome on the PATH (Debian: apt-get install chromium)" >&2; \
		exit 1; fi

# An old core of another kind (abi3 or not) would be preferred silently: it goes first. Maturin cannot install the extra
# `all`, which names the others.
$(VENV)/.built: $(VENV)/.dependencies $(SOURCES)
	@rm -f python/crawler2d/_core*.so python/crawler2d/_core*.pyd
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin develop --release --quiet --extras plot,animation,analysis,progress,files,dask,models,notebook,sensitivity,cli,gym
	@touch $@
