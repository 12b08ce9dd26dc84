# make build | test | check | reproduce | format | stubs | clean. Each does its own set-up and may be repeated.
SHELL      := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := build
MAKEFLAGS  += --no-print-directory

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
STAMPS := $(VENV)/stamps
CMAKE  := $(BIN)/cmake
CTEST  := $(BIN)/ctest
export PATH := $(CURDIR)/$(BIN):$(PATH)
export CMAKE_BUILD_PARALLEL_LEVEL ?= $(shell nproc 2>/dev/null || echo 2)
export PIP_DISABLE_PIP_VERSION_CHECK := 1
unexport PYTHONPATH

.PHONY: build setup test test-cpp test-python test-notebooks check reproduce format stubs clean

## Set-up: compiler and libraries, virtual environment, Python packages, each again only when its list changed.
$(STAMPS)/system: scripts/system-packages.txt scripts/install_system_packages.sh
	@scripts/install_system_packages.sh "$(PYTHON)"
	@mkdir -p $(@D) && touch $@

$(STAMPS)/python: pyproject.toml scripts/install_python_packages.sh $(STAMPS)/system
	@scripts/install_python_packages.sh "$(PYTHON)" $(VENV)
	@mkdir -p $(@D) && touch $@

setup: $(STAMPS)/python

## The incremental Release build; the Python sources are used where they lie.
build/%/build.ninja: CMakePresets.json $(STAMPS)/python
	@$(CMAKE) --preset $* -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python -DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(BIN)/ninja
	@touch $@

build: build/release/build.ninja
	@$(CMAKE) --build --preset release
