# make render   sets everything up and renders the Cornell box to out/
# make test     sets everything up and runs every test (about 6 minutes on 2 quiet cores)
# make help     lists the rest

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
# ninja and the renderer already use all cores, and Blender prints from several threads.
.NOTPARALLEL:

SCENE ?= blend_scenes/cornell_box.blend
NAME := $(basename $(notdir $(SCENE)))
RENDER_OPTIONS ?=

# Python 3.13 is for Blender 5.2 LTS; 3.11, for Blender 4.5 LTS, stands in where there is no 3.13.
VENV := .venv
VENV_OLD := .venv-3.11
PY := $(VENV)/bin/python
PY_OLD := $(VENV_OLD)/bin/python
NATIVE_SOURCES := $(shell find native -path native/.cache -prune -o -path native/tests -prune -o -type f -print 2>/dev/null)
# Tables (.inc, .def) keep the layout that their scripts gave them.
CXX_SOURCES = $(shell find native -path native/.cache -prune -o -type f \( -name '*.cpp' -o -name '*.h' -o -name '*.inl' \) -print)
# What is built in the virtual environment must find its tools there: cmake and ninja.
IN_VENV = PATH="$(CURDIR)/$(@D)/bin:$$PATH"

.PHONY: help setup setup-old setup-rivals render test lint format test-native test-python test-old extension extension-all extension-test wine-test cross-check release viewport-test manual-pictures update-test farm-test bench bench-viewport bench-persistent bench-gpu bench-nodes bench-large chart defaults stability convergence calibration references scenes reference oracle agreement wild nodes node-list sanitize wheel clean

help:
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' $(MAKEFILE_LIST) | expand -t 20

setup: $(VENV)/.native $(VENV)/.addon ## virtual environment with Blender as a module, the native module and the add-on
setup-old: $(VENV_OLD)/.native $(VENV_OLD)/.addon ## the same for Python 3.11 and Blender 4.5 LTS

setup-rivals: .venv-rivals/.packages ## Mitsuba and LuxCore, which make chart then draws too (not needed for anything else)

# --- set-up: each step leaves a stamp, so that nothing is done twice ------------------------------------------------

$(VENV)/.made:
	@python=$$(tools/find_python.sh 3.13 3.11) && echo "== $(VENV): $$python" && "$$python" -m venv --clear $(VENV)
	@touch $@

$(VENV_OLD)/.made:
	@python=$$(tools/find_python.sh 3.11) && echo "== $(VENV_OLD): $$python" && "$$python" -m venv --clear $(VENV_OLD)
	@touch $@

%/.packages: %/.made requirements-dev.txt
	@echo "== $(@D): installing packages (Blender is about 400 MB)"
	$(@D)/bin/python -m pip install --disable-pip-version-check -r requirements-dev.txt
	$(@D)/bin/python tools/fetch_libraries.py
	@touch $@

%/.native: %/.packages $(NATIVE_SOURCES) addon/blender_manifest.toml
	@echo "== $(@D): building the native module"
	$(IN_VENV) $(@D)/bin/python tools/kept_warnings.py build/warnings$(@D).json \
		$(@D)/bin/python -m pip install --disable-pip-version-check --no-build-isolation --no-deps --force-reinstall -v ./native
	@touch $@

%/.addon: %/.packages pyproject.toml setup.py addon/blender_manifest.toml $(wildcard addon/__init__.py)
	@echo "== $(@D): installing the add-on (editable)"
	$(@D)/bin/python -m pip install --disable-pip-version-check --no-build-isolation --no-deps -q -e .
	@touch $@

.venv-rivals/.packages: requirements-rivals.txt
	@python=$$(tools/find_python.sh 3.13 3.11) && echo "== .venv-rivals: $$python" && "$$python" -m venv --clear .venv-rivals
	.venv-rivals/bin/python -m pip install --disable-pip-version-check -r requirements-rivals.txt
	@touch $@

.PRECIOUS: %/.made %/.packages %/.cross %/.native %/.addon

# --- pictures -------------------------------------------------------------------------------------------------------

render: out/$(NAME).png ## SCENE to out/*.exr and out/*.png (RENDER_OPTIONS: see photon-splat render --help)
	@echo "out/$(NAME).exr and out/$(NAME).png are ready."

.PHONY: out/$(NAME).exr
out/$(NAME).exr: setup
	@mkdir -p out
	$(VENV)/bin/photon-splat render $(SCENE) -o $@ --stats out/$(NAME).json $(RENDER_OPTIONS)

out/$(NAME).png: out/$(NAME).exr
	@$(PY) tools/exr_to_png.py $< $@

scenes: setup-old ## blend_scenes/*.blend from their scripts, by the oldest Blender that must open them
	$(PY_OLD) -m blend_scenes.scripts.make_all

# --- tests ----------------------------------------------------------------------------------------------------------

test: lint test-native extension test-python test-old ## every test
	@echo "All tests passed."

lint: setup ## formatter, linter and types
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	@$(VENV)/bin/clang-format --dry-run -Werror $(CXX_SOURCES)

format: setup ## lays out Python and C++ as make lint wants them
	$(VENV)/bin/ruff format .
	@$(VENV)/bin/clang-format -i $(CXX_SOURCES)

test-native: build/tests/.built ## C++ tests
	$(PY) tools/kept_warnings.py build/warnings$(VENV).json
	$(VENV)/bin/ctest --test-dir build/tests -j 2 --output-on-failure --timeout 1800 --no-tests=error

test-python: setup ## Python tests
	$(PY) tools/run_tests.py

test-old: setup ## the smoke tests with Python 3.11 and Blender 4.5 LTS, where there is a Python 3.11
	@if $(PY) -c 'import sys; sys.exit(sys.version_info[:2] == (3, 11))' && tools/find_python.sh 3.11 >/dev/null; then \
		$(MAKE) --no-print-directory setup-old && $(PY_OLD) tools/run_tests.py -m smoke; \
	else echo "No second Python 3.11: the smoke tests with Blender 4.5 LTS are left out."; fi

# The extension serves Blenders with either version of Python, if both are here.
EXTENSION_SOURCES = $(NATIVE_SOURCES) $(shell find addon shaders -type f -not -name '*.pyc' 2>/dev/null) \
	tools/build_extension.py tools/windows_python.py requirements-cross.txt
BUILD_EXTENSION = pythons=$(PY); \
	if $(PY) -c 'import sys; sys.exit(sys.version_info[:2] == (3, 11))' && tools/find_python.sh 3.11 >/dev/null; then \
		$(MAKE) --no-print-directory setup-old && pythons="$(PY) $(PY_OLD)"; \
	else echo "No second Python 3.11: the extension is built for this Python only."; fi && \
	PATH="$(CURDIR)/$(VENV)/bin:$$PATH" $(PY) tools/build_extension.py

dist/.extension: $(VENV)/.native $(EXTENSION_SOURCES)
	@$(BUILD_EXTENSION) dist $$pythons
	@touch $@

dist/.extension-all: $(VENV)/.native $(VENV)/.cross $(EXTENSION_SOURCES)
	@$(BUILD_EXTENSION) --windows dist $$pythons
	@touch dist/.extension $@

%/.cross: %/.packages requirements-cross.txt
	$(@D)/bin/python -m pip install --disable-pip-version-check -q -r requirements-cross.txt
	@touch $@

extension: dist/.extension ## dist/photon_splat-VERSION-PLATFORM.zip, which Blender installs
extension-all: dist/.extension-all ## the same for Windows besides, compiled here (needs Maven)

extension-test: extension ## the extension installed into clean Blenders
	$(PY) tools/run_tests.py tests/integration/extension
	@if [ -x $(PY_OLD) ]; then $(PY_OLD) tools/run_tests.py tests/integration/extension; fi

wine-test: extension-all ## the extension for Windows under Wine (needs Linux, root, debootstrap and Maven)
	@old=; if [ -x $(PY_OLD) ]; then old=$(PY_OLD); fi; \
		$(PY) tools/wine_test.py dist/photon_splat-*-windows_x64.zip $$old

release: extension-all ## dist/release: the zips, checksums, and index.json of an extension repository
	$(PY) tools/release.py dist/release dist/photon_splat-*.zip

farm-test: setup ## jobs of photon-splat farm on a Slurm of one node, whose daemons are Debian's packages, not installed
	$(PY) tools/farm_test.py .cache/slurm

viewport-test: extension ## the extension in a Blender with a window (VIEWPORT_OPTIONS: see tools/viewport_test.py --help)
	$(PY) tools/viewport_test.py dist/photon_splat-*-linux_x64.zip $(VIEWPORT_OPTIONS)

manual-pictures: extension ## the manual's pictures of panels, from a Blender with a window (needs what viewport-test needs)
	$(PY) tools/manual_pictures.py dist/photon_splat-*-linux_x64.zip

update-test: extension ## an update from an older version, and a dropped link, in a Blender with a window (needs what viewport-test needs)
	$(PY) tools/update_test.py dist/photon_splat-*-linux_x64.zip

CMAKE_NATIVE = $(VENV)/bin/cmake -S native -G Ninja -DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(VENV)/bin/ninja \
	-DPython_EXECUTABLE=$(CURDIR)/$(PY)
CMAKE_TESTS = $(CMAKE_NATIVE) -DPHOTON_SPLAT_MODULE=OFF -DPHOTON_SPLAT_TESTS=ON

# The tests are linked to the module's own code, where its build folder is there.
build/tests/.built: $(VENV)/.native $(shell find native/tests -type f)
	$(CMAKE_TESTS) -B build/tests -DPHOTON_SPLAT_WERROR=ON -DPHOTON_SPLAT_CORE_LIBRARY=$$( \
		ls $(CURDIR)/build/native-$$($(PY) -c 'import sys; print(sys.implementation.cache_tag)')/libphoton_splat_core.a 2>/dev/null)
	$(VENV)/bin/cmake --build build/tests
	@touch $@

# Debug and without optimising: only whether all of the code compiles and links is asked.
CROSS_TARGETS = linux-aarch64 macos-arm64
cross-check: $(VENV)/.cross ## the native code compiled for 64-bit ARM, Linux and macOS (nothing of it is run)
	@for target in $(CROSS_TARGETS); do echo "== $$target" && \
		PHOTON_SPLAT_PYTHON=$(CURDIR)/$(PY) $(CMAKE_NATIVE) -B build/cross-$$target \
			-DCMAKE_TOOLCHAIN_FILE=$(CURDIR)/native/cmake/toolchains/$$target.cmake -DPHOTON_SPLAT_TESTS=ON \
			-DPHOTON_SPLAT_WERROR=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 && \
		$(VENV)/bin/cmake --build build/cross-$$target || exit 1; \
	done

sanitize: $(VENV)/.packages ## C++ tests under the address, undefined behaviour and thread sanitizers
	$(CMAKE_TESTS) -B build/asan -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPHOTON_SPLAT_SANITIZE=address,undefined
	$(VENV)/bin/cmake --build build/asan
	$(VENV)/bin/ctest --test-dir build/asan --output-on-failure --timeout 3600 --no-tests=error
	$(CMAKE_TESTS) -B build/tsan -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPHOTON_SPLAT_SANITIZE=thread
	$(VENV)/bin/cmake --build build/tsan
	$(VENV)/bin/ctest --test-dir build/tsan --output-on-failure --timeout 3600 --no-tests=error

reference: setup ## the comparisons with references that take too long for make test (see also oracle, agreement, nodes)
	$(PY) tools/run_tests.py -m slow

oracle: setup ## every case against the committed Cycles pictures: out/oracle/index.html
	$(PY) -m tests.reference.cycles.report

agreement: setup ## splat against the reference integrator on 200 random scenes: out/agreement (AGREEMENT_OPTIONS: see python -m tests.reference.agreement.run --help)
	$(PY) -m tests.reference.agreement.run $(AGREEMENT_OPTIONS)

# Files by strangers, with Cycles' pictures of them; they are no part of the project.
WILD ?= ../shared/wild
WILD_SECONDS ?= 8
wild: setup ## real files against Cycles: out/wild (WILD: the folder that holds them)
	@if [ -f $(WILD)/wild.py ]; then $(PY) $(WILD)/wild.py check $(WILD)/files out/wild --seconds $(WILD_SECONDS); \
	else echo "No real files to judge by: $(WILD)/wild.py is not there (WILD=FOLDER names another place)."; fi

nodes: setup ## node trees against Cycles (NODE_OPTIONS: see python -m tests.reference.nodes.run --help)
	$(PY) -m tests.reference.nodes.run $(NODE_OPTIONS)

node-list: setup ## docs/nodes.md, from the exporter's own table
	@$(PY) -m photon_splat.export.nodes.table docs/nodes.md

references: setup ## what tests/reference/cycles and tests/reference/caustics compare with, anew (long)
	$(PY) -m tests.reference.cycles.references
	$(PY) -m tests.reference.cycles.sweep
	$(PY) -m tests.benchmarks.stability.run --reference
	$(PY) -m tests.benchmarks.convergence.run --reference
	$(PY) -m tests.reference.caustics.reference
	$(PY) -m tests.reference.caustics.pictures

# --- measurements ---------------------------------------------------------------------------------------------------

bench: setup ## benchmarks
	$(PY) -m tests.benchmarks.bench.run

bench-viewport: setup ## seconds to the first picture after an edit, pictures a second while orbiting
	$(PY) -m tests.benchmarks.bench.viewport

bench-persistent: setup ## seconds of a frame with Persistent Data and without
	$(PY) -m tests.benchmarks.bench.persistent

bench-nodes: setup ## a hit on a shader of 200 nodes, beside Cycles'
	$(PY) -m tests.benchmarks.bench.nodes200

bench-large: setup ## a million strands, five million displaced triangles and eight million diced ones, beside Cycles
	$(PY) -m tests.benchmarks.bench.large

bench-gpu: setup ## the GPU splatter on a graphics card (GPU_OPTIONS: see python -m tests.benchmarks.bench.gpu --help)
	$(PY) -m tests.benchmarks.bench.gpu $(GPU_OPTIONS)

chart: setup ## error against time, ours, Cycles' and rivals': tests/benchmarks/chart (CHART_OPTIONS: see python -m tests.benchmarks.chart --help)
	$(PY) -m tests.benchmarks.chart $(CHART_OPTIONS)
	@if [ -z "$(CHART_OPTIONS)" ]; then $(PY) -m tests.benchmarks.chart.seed_comparison; fi

defaults: setup ## what a click on Render gives, beside Cycles with its defaults: tests/benchmarks/chart/defaults.csv (CHART_OPTIONS: see python -m tests.benchmarks.chart.defaults --help)
	$(PY) -m tests.benchmarks.chart.defaults $(CHART_OPTIONS)

equal-time: setup ## any .blend files beside Cycles at equal time (FILES=..., EQUAL_TIME_OPTIONS: see python -m tests.benchmarks.chart.equal_time --help)
	$(PY) -m tests.benchmarks.chart.equal_time $(EQUAL_TIME_OPTIONS) $(FILES)

stability: setup ## the product and plain photon maps on the known failures: tests/benchmarks/stability/methods.md and .png
	$(PY) -m tests.benchmarks.stability.run

convergence: setup ## error against photons, and against fixed radii: tests/benchmarks/convergence/convergence.md and .png
	$(PY) -m tests.benchmarks.convergence.run

calibration: setup ## error estimate and error_threshold against true error: tests/benchmarks/calibration/calibration.md and .png
	$(PY) -m tests.benchmarks.calibration.run

wheel: setup ## dist/*.whl of the native module and of the add-on
	PATH="$(CURDIR)/$(VENV)/bin:$$PATH" $(PY) -m pip wheel --disable-pip-version-check --no-build-isolation --no-deps -w dist ./native .

clean: ## removes everything that was built, installed or rendered
	rm -rf $(VENV) $(VENV_OLD) .venv-rivals build dist out .cache native/.cache *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
