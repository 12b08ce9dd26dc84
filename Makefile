# make build | test | torture | check | docs | reproduce | wheel | wheel-full | wheel-test | wheels | sdist | format |
# stubs | clean. Each does its own set-up and may be repeated.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := build
.PRECIOUS: build/%/build.ninja
MAKEFLAGS += --no-print-directory

PYTHON ?= python3
BIN := .venv/bin
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export CMAKE_BUILD_PARALLEL_LEVEL ?= $(shell nproc 2> /dev/null || echo 2)
unexport PYTHONPATH

CXX_FILES = $(shell find cpp -name '*.hpp' -o -name '*.cpp')

.PHONY: setup build module test torture wheel wheel-full wheel-test wheel-test-full wheels sdist docs reproduce check format stubs clean

## Set-up: compiler and libraries, then .venv; each is touched again only when its list changed.
build/stamps/system: scripts/system-packages.txt scripts/install_system_packages.sh
	@scripts/install_system_packages.sh "$(PYTHON)"
	@mkdir -p $(@D) && touch $@

## What builds the module (tools), what runs it (run), what tests it (dev)
.venv/stamps/run: .venv/stamps/tools
.venv/stamps/dev: .venv/stamps/run
.venv/stamps/%: pyproject.toml scripts/install_python_packages.sh build/stamps/system
	@scripts/install_python_packages.sh "$(PYTHON)" .venv $*
	@mkdir -p $(@D) && touch $@

setup: .venv/stamps/dev

## A browser for the tests of pages, which are skipped without it
build/stamps/browser: scripts/browser-packages.txt scripts/install_system_packages.sh
	@scripts/install_system_packages.sh "$(PYTHON)" $< || echo "Going on; tests of pages are skipped." >&2
	@mkdir -p $(@D) && touch $@

## Builds: build/<preset>, incremental. The release build puts flexarm._core beside the Python sources;
## what runs it is installed meanwhile.
build/%/build.ninja: CMakePresets.json .venv/stamps/tools
	@VIRTUAL_ENV="$(CURDIR)/.venv" PATH="$(CURDIR)/$(BIN):$$PATH" cmake --preset $*
	@touch $@

build:
	@$(MAKE) -j2 module .venv/stamps/run

module: build/release/build.ninja
	@$(BIN)/cmake --build --preset release --target _core

## C++ tests, and the Python tests of which each takes a few seconds at most; make check runs the long ones.
## A file's tests share what it makes, so they stay in one process.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(CMAKE_BUILD_PARALLEL_LEVEL) --dist loadfile --no-loadscope-reorder

test:
	@$(MAKE) -j2 module setup
	@$(MAKE) build/stamps/browser
	@$(BIN)/cmake --build --preset release
	@$(BIN)/ctest --preset release
	@$(PYTEST) -m "not slow"

## Malformed and damaged input, wrong calls, kills and random models by the thousand, for hours; the counts go into
## docs/reliability.md. JOBS workers, SCALE times the cases, another SEED; a run that was stopped goes on.
JOBS ?= $(CMAKE_BUILD_PARALLEL_LEVEL)
SCALE ?= 1
SEED ?= 1
torture: build
	@cd tests && OPENBLAS_NUM_THREADS=1 ../$(BIN)/python -m torture --jobs $(JOBS) --scale $(SCALE) --seed $(SEED) \
	  --table ../docs/reliability.md

## Self-contained wheels of this machine's kind: in dist/ a BSD one on Eigen alone, in dist/full one with SuiteSparse,
## GPL as a whole. A test installs them into a new environment and runs commands in an empty folder.
wheel: setup
	@scripts/build_wheel.sh $(BIN)/python bsd dist

wheel-full: setup
	@scripts/build_wheel.sh $(BIN)/python full dist/full

wheel-test: wheel
	@"$(PYTHON)" scripts/try_wheel.py dist/flexarm-*.whl

wheel-test-full: wheel-full
	@"$(PYTHON)" scripts/try_wheel.py dist/full/flexarm-*.whl

## BSD wheels by cibuildwheel (pip install cibuildwheel), which has its own containers and Pythons
wheels:
	@"$(PYTHON)" -m cibuildwheel --output-dir dist

## The source archive, from which pip builds a wheel
sdist: setup
	@rm -f dist/flexarm-*.tar.gz
	@$(BIN)/python -m build --sdist --no-isolation --outdir dist
	@ls -sh dist/flexarm-*.tar.gz

## The documentation site, into build/docs; a warning is an error
docs: module setup
	@$(BIN)/python -m sphinx -b html -W --keep-going -q docs build/docs
	@echo "make docs: build/docs/index.html"

## The figures of the paper, into results/
reproduce: build
	@$(BIN)/flexarm reproduce --out results --force

## Linters, types, layers, formats, stubs; C++ tests under sanitizers, with SuiteSparse and on Eigen alone; the long
## Python tests. That CMake does without SuiteSparse is seen from its configuration; make check-no-suitesparse
## builds all of it.
check: build check-python check-cpp check-stubs check-asan build/no-suitesparse/build.ninja check-slow
	@echo "make check: all passed"

.PHONY: check-python check-cpp check-stubs check-slow
check-python: setup
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	PYTHONPATH=python $(BIN)/lint-imports --no-logo
	$(BIN)/python scripts/count.py --check

check-cpp: setup
	@echo "$(BIN)/clang-format --dry-run --Werror (cpp/)"
	@$(BIN)/clang-format --dry-run --Werror $(CXX_FILES)

check-stubs: build setup
	$(BIN)/python scripts/stubs.py --check

check-slow: build setup build/stamps/browser
	@$(PYTEST) -m slow

check-%: build/%/build.ninja setup
	@$(BIN)/cmake --build --preset $*
	@$(BIN)/ctest --preset $*

## Lay out sources, write the stubs
format: setup
	@$(BIN)/ruff check --fix-only --quiet
	@$(BIN)/ruff format
	@$(BIN)/clang-format -i $(CXX_FILES)

stubs: build setup
	@$(BIN)/python scripts/stubs.py

clean:
	rm -rf build results .venv python/flexarm/_core*.so
