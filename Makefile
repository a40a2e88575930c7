# mcsample.h is one header: nothing here has to be built to use it. This file builds what proves it and what shows it.
#
# Variables: CC, CFLAGS (-O2), BUILD (build), PREFIX (/usr/local), PYTHON (python3), DESTDIR, SOURCE_DATE_EPOCH; for benchmarks MAPS
# (.hdr files, none), PBRT and CYCLES (checkouts of pbrt-v4 and Cycles, none); for tests also FILTER=text, SEED=number,
# WITHOUT=files, NATIVE=no and MCS_TEST_SCALE=0.05 (scales the sample counts of the statistical tests; 1 is the count that the
# tolerances are meant for).

CFLAGS ?= -O2
BUILD ?= build
PREFIX ?= /usr/local
PYTHON ?= python3
# -Wno-psabi: gcc's note that 8 and 16 wide vectors cross functions differently with AVX; in the header every such function is inlined.
# -Wno-enum-float-conversion: clang 22's note that constants of tests, which are enumerators as C has no others, meet floats.
# MCS_WARNINGS: clang looks for warnings in the header, too.
WARNINGS = -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-psabi -Wno-enum-float-conversion -DMCS_WARNINGS
FLAGS = $(CFLAGS) -std=c99 $(WARNINGS) -I. -Itests
# The tests demand the same bits from every width; the header promises them where a*b+c is not contracted.
EXACT = -ffp-contract=off
LIBS = -lm

TESTS = $(filter-out $(WITHOUT),$(sort $(wildcard tests/test_*.c)))
EXAMPLES = $(sort $(wildcard examples/[0-9][0-9]_*.c))
TEST_BINS = $(TESTS:%.c=$(BUILD)/%)
# Stress programs: at full size by `make stress`, part by part; a small cut of each with every full `make test`. The truth of
# extremes and climb is __float128, which takes gcc and its libquadmath.
STRESS_ALL = extremes floats deep hostile fuzz images climb fireflies
STRESS_QUAD = extremes climb
STRESS = $(if $(QUADMATH),$(STRESS_ALL),$(filter-out $(STRESS_QUAD),$(STRESS_ALL)))
STRESS_BINS = $(STRESS:%=$(BUILD)/tests/stress/%)
# The rows of the registry, those of lines among them, and those whose name does not end like another one, whose filter fits both.
STRESS_LINES := $(shell sed -n 's/^ *M.X, LINE, \([a-z0-9_]*\),.*/\1/p' tests/registry.h)
STRESS_NAMES := $(shell sed -n 's/^ *M.X, [A-Z]*, \([a-z0-9_]*\),.*/\1/p' tests/registry.h)
STRESS_ROWS := $(filter-out $(foreach n,$(STRESS_NAMES),$(filter-out $(n),$(filter %$(n),$(STRESS_NAMES)))),$(STRESS_NAMES))
# Parts of make stress, of up to three minutes each: program-filter, + for a space and . for a slash in the filter, ^ for all
# but what follows. stress-whole looks whether they leave a case out, or one of them has none.
STRESS_PARTS = hostile images fuzz-product fuzz-^product $(filter climb,$(STRESS)) fireflies-climbing fireflies-^climbing \
	$(addprefix floats-vector+maths.,sin 1 ln+x ln+of e^min e^x x normal+tail normal+quantile) \
	$(addprefix floats-,any+x+below any+x+from y+to+1 y+beyond+1 y+below y+from u+to+radius any+float.u) \
	$(addprefix floats-u+to+x.,$(STRESS_LINES)) $(addprefix floats-any+float.x+of+,$(STRESS_LINES)) \
	$(STRESS_ROWS:%=deep-%.) $(if $(filter extremes,$(STRESS)),$(STRESS_ROWS:%=extremes-%.) extremes-mass extremes-oracle)
STRESS_FILTER = $(if $(findstring -,$(1)),--filter '$(subst .,/,$(subst +, ,$(word 2,$(subst -, ,$(1)))))')
# One of them each day of the year.
DAY ?= $(shell date +%j)
STRESS_TODAY = $(word $(shell echo '$(DAY) $(words $(STRESS_PARTS))' | awk '{ print $$1 % $$2 + 1 }'),$(STRESS_PARTS))
STRESS_SUM = awk '/: [0-9]+ passed, [0-9]+ failed, [0-9.]+ s$$/ { p += $$(NF - 5); f += $$(NF - 3) } \
	END { print p + 0 " passed, " f + 0 " failed"; exit f != 0 || p == 0 }'
STRESS_CUT = $(if $(filter-out $(TESTS) $(WITHOUT),$(wildcard tests/test_*.c)),,$(STRESS_BINS))
EXAMPLE_BINS = $(EXAMPLES:%.c=$(BUILD)/%)
# What most of their compile time went into is compiled once: tests/shared. Programs have the header's declarations, but for those that
# look inside it, which have all of it. ASSERTING=yes: rows and bodies that count what MCS_ASSERT tells, which some programs want, are
# for all programs; else the bodies that do have arrays of 4 lanes alone, as what is told does not depend on lanes.
SHARED = $(BUILD)/tests/shared
ROWS = $(SHARED)/$(if $(ASSERTING),asserting,rows).o $(SHARED)/rough.o
BODIES = $(SHARED)/$(if $(ASSERTING),telling,implementation).o
INSIDE = $(patsubst %,$(BUILD)/tests/test_%,math pwc2 region tables values values_maps values_tables)
TELLING = $(patsubst %,$(BUILD)/tests/test_%,env_modes env_window mistakes oracle)
DECLARED = $(filter-out $(INSIDE),$(filter $(BUILD)/tests/test_%,$(TEST_BINS)) $(STRESS_BINS))
WIDE = $(SHARED)/wide16.o $(SHARED)/wide8.o $(SHARED)/wide4.o
# Packets of 16 lanes have registers of 16 lanes where the processor does, in the programs PACKETS_16 as well: gcc takes 43 s to make
# them of smaller ones, which those of 8 lanes show as well. NATIVE=no: smaller ones all the same, as in .ci/run.
AVX512 = -mavx512f -mavx512dq -mavx512bw -mavx512vl
UNITS_16 = $(eval UNITS_16 := $(UNITS_16_PROBE))$(UNITS_16)
UNITS_16_PROBE = $(if $(filter no,$(NATIVE)),,$(shell mkdir -p $(BUILD) && printf 'int main(void) { return \
	!(__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")); }\n' | \
	$(CC) $(CFLAGS) $(AVX512) -x c - -o $(BUILD)/avx512.probe 2>/dev/null && $(BUILD)/avx512.probe && echo '$(AVX512)'))
PACKETS_16 = $(patsubst %,$(BUILD)/tests/%,test_frame test_fresnel test_lights stress/hostile)
# What test_bits holds to stored bits is compiled as users do, by CFLAGS. Programs that call it, and bodies that count what is told, have
# -O1 where those say -O2, as by default: two thirds of the time to compile; all but these, whose own loops run for long. So do packets of
# 8 lanes, but with NATIVE=no, as in .ci/run.
LOOPING = $(patsubst %,$(BUILD)/tests/%,$(addprefix test_,chi2_lobes chi2_rest glass lines points product_chi2 values_lights) \
	stress/extremes stress/images)
CALLING = $(filter-out $(LOOPING),$(TEST_BINS) $(STRESS_BINS)) $(SHARED)/telling.o $(SHARED)/asserting.o \
	$(if $(filter no,$(NATIVE)),,$(SHARED)/wide8.o)
CALLING_FLAGS = $(CFLAGS:-O2=-O1)
RENDER = $(BUILD)/examples/render
GALLERY = $(BUILD)/examples/gallery

# Two at a time unless make was given its own -j. MAKEFLAGS holds -j only while a recipe is expanded, hence no := here.
JOBS = $(or $(patsubst -j%,%,$(filter -j%,$(MAKEFLAGS))),2)
SUBMAKE = $(MAKE) --no-print-directory $(if $(filter -j%,$(MAKEFLAGS)),,-j2)

# A target that make help lists says what it does when it starts, in the words of that list, and at its end how long it took and where
# the result is. make expands a recipe before it runs it: NOW is when it started. Suites are told, as their sum is the last line.
SAY = @sed -n 's/^$@:[^\#]*\#\# /make $@: /p' $(firstword $(MAKEFILE_LIST))
NOW = $(shell date +%s)
TOOK = printf 'took %d s; %s\n' $$(($$(date +%s) - $(NOW)))

# -fopenmp where the compiler can build and link it, else nothing.
OPENMP = $(shell mkdir -p $(BUILD) && printf '\043include <omp.h>\nint main(void) { return omp_get_max_threads() < 1; }\n' | \
	$(CC) -fopenmp -x c - -o $(BUILD)/openmp.probe 2>/dev/null && echo -fopenmp)

# What is installed, packed and built as a library.
VERSION := $(shell sed -n 's/.*define MCS_VERSION_STRING "\(.*\)".*/\1/p' mcsample.h)
INSTALLED = $(DESTDIR)$(PREFIX)
DIST = $(BUILD)/mcsample-$(VERSION)
LIB = $(BUILD)/lib
# The time of all files in the archive, 1980 unless the environment knows a better one.
SOURCE_DATE_EPOCH ?= 315532800
define PKG_CONFIG_FILE
prefix=$(PREFIX)
includedir=$${prefix}/include

Name: mcsample
Description: Monte Carlo sampling for rendering, in one C header
Version: $(VERSION)
Cflags: -I$${includedir}
Libs: -lm
endef
define CMAKE_FILE
# find_package(mcsample) makes the target mcsample::mcsample.
if(NOT TARGET mcsample::mcsample)
  get_filename_component(mcsample_include "$${CMAKE_CURRENT_LIST_DIR}/../../../include" ABSOLUTE)
  add_library(mcsample::mcsample INTERFACE IMPORTED)
  set_target_properties(mcsample::mcsample PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "$${mcsample_include}"
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "$${mcsample_include}")
  if(UNIX)
    set_target_properties(mcsample::mcsample PROPERTIES INTERFACE_LINK_LIBRARIES m)
  endif()
  unset(mcsample_include)
endif()
endef
# Versions with the same first number fit, if they are not older than what is asked for.
define CMAKE_VERSION_FILE
set(PACKAGE_VERSION "$(VERSION)")
if(PACKAGE_FIND_VERSION_MAJOR EQUAL $(firstword $(subst ., ,$(VERSION))) AND NOT PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
  if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
  endif()
endif()
endef
install: export PKG_CONFIG_FILE := $(PKG_CONFIG_FILE)
install: export CMAKE_FILE := $(CMAKE_FILE)
install: export CMAKE_VERSION_FILE := $(CMAKE_VERSION_FILE)

# A probe is run once, where its result is first asked for.
QUADMATH = $(eval QUADMATH := $(QUADMATH_PROBE))$(QUADMATH)
QUADMATH_PROBE = $(shell mkdir -p $(BUILD) && printf '\043include <quadmath.h>\nint main(void) { return sqrtq(4) != 2; }\n' | \
	$(CC) -x c - -o $(BUILD)/quadmath.probe -lquadmath 2>/dev/null && echo -lquadmath)

test: ## build and run every tests/test_*.c (the default); two minutes; build/tests; FILTER=text and SEED=number narrow it
	$(SAY)
	@echo '$(CC) ($(shell $(CC) --version 2>/dev/null | head -n 1)): $(FLAGS) $(EXACT); programs that only call: $(CALLING_FLAGS)'
	+@$(SUBMAKE) test-binaries
	@$(if $(STRESS_CUT),$(if $(QUADMATH),,echo 'SKIPPED: $(STRESS_QUAD:%=tests/stress/%.c): $(CC) has no libquadmath'))
	@BEGAN=$(NOW) BUILD='$(BUILD)' FILTER='$(FILTER)' SEED='$(SEED)' sh tests/run.sh $(JOBS) $(STRESS_CUT) $(TEST_BINS)

stress: ## every float, deep statistics, extremes, hostile input at full size; hours; build/stress; what passed is not run again
	$(SAY)
	@$(if $(QUADMATH),,echo 'SKIPPED: $(STRESS_QUAD:%=tests/stress/%.c): $(CC) has no libquadmath')
	+@$(SUBMAKE) stress-whole
	+@$(SUBMAKE) --keep-going $(STRESS_PARTS:%=$(BUILD)/stress/%.ok)
	@cat $(STRESS_PARTS:%=$(BUILD)/stress/%.txt)
	@$(TOOK) "what each part printed in $(BUILD)/stress"
	@cat $(STRESS_PARTS:%=$(BUILD)/stress/%.txt) | $(STRESS_SUM)

stress-today: ## a part of make stress at full size, another each day; some minutes; build/stress; DAY=number picks
	$(SAY)
	@echo 'stress: day $(DAY): $(STRESS_TODAY)'
	+@$(SUBMAKE) stress-whole
	+@$(SUBMAKE) --keep-going $(STRESS_TODAY:%=$(BUILD)/stress/%.ok)
	@$(TOOK) "what each part printed in $(BUILD)/stress"
	@cat $(STRESS_TODAY:%=$(BUILD)/stress/%.txt) | $(STRESS_SUM)

cross: ## the same bits on other machines, by cross compilers and qemu-user; many minutes; build/cross; ONLY=name picks one
	$(SAY)
	@BEGAN=$(NOW) BUILD='$(BUILD)' sh tests/cross.sh $(ONLY)

cuda: ## the same bits, chi-square and rates on a graphics processor, or only that it compiles; some minutes; build/cuda
	$(SAY)
	+@if command -v $(NVCC) >/dev/null; then $(SUBMAKE) cuda-binaries && $(CUDA)/bits && MCS_TEST_SCALE=0.1 $(CUDA)/samplers; \
	else echo 'SKIPPED: ALL OF IT: $(NVCC) is not installed'; fi
	@$(TOOK) "$$(if command -v $(NVCC) >/dev/null; then echo 'programs in $(CUDA)'; else echo 'nothing is built'; fi)"

analyze: ## valgrind, memory sanitizer, -fanalyzer, clang-tidy, cppcheck; many minutes; build/analyze; ONLY=name picks one
	$(SAY)
	@BEGAN=$(NOW) BUILD='$(BUILD)' sh tests/analyze.sh $(ONLY)

mutants: ## does a test fail for every slip in tests/mutants.txt? half an hour; build/mutants; ONLY='name...' picks some
	$(SAY)
	@BEGAN=$(NOW) CC='$(CC)' BUILD='$(BUILD)' sh tests/mutants.sh $(JOBS) $(ONLY)

examples: ## build, run and check every example, the gallery and the renderer; two minutes; build/examples
	$(SAY)
	@echo '$(CC): $(FLAGS)'
	+@$(SUBMAKE) example-binaries $(RENDER) $(GALLERY)
	@mkdir -p $(BUILD)/gallery
	@passed=0; failed=0; for e in $(EXAMPLE_BINS) '$(GALLERY) $(BUILD)/gallery' 'sh tests/render.sh $(RENDER) $(BUILD)/render'; do \
		echo "$$e"; \
		if $$e; then passed=$$((passed + 1)); else failed=$$((failed + 1)); echo "FAIL $$e: exit status not 0"; fi; \
	done; \
	$(TOOK) "programs in $(BUILD)/examples, pictures in $(BUILD)/render"; \
	echo "$$passed passed, $$failed failed"; \
	test $$failed = 0 && test $$passed != 0

demo: ## render the default scene with every strategy, print the strategy table; two minutes; build/demo; DEMO='--spp 8' is quicker
	$(SAY)
	+@$(SUBMAKE) $(RENDER)
	@mkdir -p $(BUILD)/demo
	$(RENDER) --strategy all $(DEMO) --out $(BUILD)/demo/spheres
	@$(TOOK) "pictures in $(BUILD)/demo"

gallery: ## draw each sampler's density, with samples on it; 15 s; build/gallery: gallery.png, one sheet, and an SVG a group
	$(SAY)
	+@$(SUBMAKE) $(GALLERY)
	@mkdir -p $(BUILD)/gallery
	@$(GALLERY) $(BUILD)/gallery
	@$(TOOK) "pictures in $(BUILD)/gallery"

hygiene: ## warnings in every language standard, index, macros, symbols, cost of including; some minutes; build/hygiene
	$(SAY)
	@BEGAN=$(NOW) MAKE='$(MAKE)' BUILD='$(BUILD)' JOBS='$(JOBS)' sh tests/hygiene.sh

selftest: ## show that make test notices tests that fail, crash, are empty or do not compile; some seconds; build/selftest
	$(SAY)
	@BEGAN=$(NOW) MAKE='$(MAKE)' BUILD='$(BUILD)/selftest' sh tests/selftest/selftest.sh

install: ## copy the header into DESTDIR/PREFIX, and files by which pkg-config and CMake find it; 1 s
	$(SAY)
	@install -d '$(INSTALLED)/include' '$(INSTALLED)/lib/pkgconfig' '$(INSTALLED)/lib/cmake/mcsample'
	@install -m 644 mcsample.h '$(INSTALLED)/include/mcsample.h'
	@printf '%s\n' "$$PKG_CONFIG_FILE" > '$(INSTALLED)/lib/pkgconfig/mcsample.pc'
	@printf '%s\n' "$$CMAKE_FILE" > '$(INSTALLED)/lib/cmake/mcsample/mcsample-config.cmake'
	@printf '%s\n' "$$CMAKE_VERSION_FILE" > '$(INSTALLED)/lib/cmake/mcsample/mcsample-config-version.cmake'
	@$(TOOK) "$(INSTALLED)/include/mcsample.h, lib/pkgconfig/mcsample.pc, lib/cmake/mcsample"

uninstall: ## remove what make install has put into DESTDIR/PREFIX; 1 s
	$(SAY)
	@rm -f '$(INSTALLED)/include/mcsample.h' '$(INSTALLED)/lib/pkgconfig/mcsample.pc'
	@rm -f '$(INSTALLED)/lib/cmake/mcsample/mcsample-config.cmake' '$(INSTALLED)/lib/cmake/mcsample/mcsample-config-version.cmake'
	@rmdir '$(INSTALLED)/lib/cmake/mcsample' 2>/dev/null || true
	@$(TOOK) "nothing of mcsample is left in $(INSTALLED)"

dist: ## pack header, licence and README by GNU tar; the same files give the same bytes; 1 s; build/mcsample-VERSION.tar.gz
	$(SAY)
	@rm -rf $(DIST)
	@install -d -m 755 $(DIST)
	@install -m 644 mcsample.h LICENSE README.md $(DIST)
	@tar --format=ustar --sort=name --owner=0 --group=0 --numeric-owner --mtime=@$(SOURCE_DATE_EPOCH) -C $(BUILD) -cf $(DIST).tar $(notdir $(DIST))
	@gzip -9nf $(DIST).tar
	@rm -r $(DIST)
	@$(TOOK) "$(DIST).tar.gz"

lib: ## compile array forms, tables, maps and products into libmcsample.a and libmcsample.so; 10 s; build/lib
	$(SAY)
	+@$(SUBMAKE) $(LIB)/libmcsample.a $(LIB)/libmcsample.so
	@$(TOOK) "libmcsample.a and libmcsample.so in $(LIB)"

packages: ## use what install, dist and lib make by pkg-config, CMake, Meson, C, Python and Rust; 20 s; build/packages
	$(SAY)
	@BEGAN=$(NOW) CC='$(CC)' MAKE='$(MAKE)' sh tests/packages.sh $(BUILD)/packages

help: ## this list: what each does, how long it takes, where the result is, what narrows it
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/    make \1\t\2/p' Makefile | expand -t 22

clean: ## remove everything that was built; 1 s
	$(SAY)
	@rm -rf $(BUILD)
	@$(TOOK) "$(BUILD) is gone"

test-binaries: $(TEST_BINS) $(STRESS_CUT)
# Every case of every program is in a part, and every part has a case.
stress-whole: $(STRESS_BINS)
	@for p in $(STRESS_BINS); do $$p --list | grep -v '^SKIPPED' | sed "s,^,$${p##*/} ,"; done | sort -u > $(BUILD)/stress.cases
	@{ $(foreach p,$(STRESS_PARTS),$(BUILD)/tests/stress/$(firstword $(subst -, ,$(p))) --list $(call STRESS_FILTER,$(p)) | \
		grep -v '^SKIPPED' | sed 's,^,$(firstword $(subst -, ,$(p))) ,' | grep . || echo 'FAIL stress: $(p) has no case';) } | \
		sort -u > $(BUILD)/stress.parts
	@comm -3 $(BUILD)/stress.cases $(BUILD)/stress.parts > $(BUILD)/stress.left
	@if [ -s $(BUILD)/stress.left ]; then echo 'FAIL stress: in no part, or a part without a case:'; cat $(BUILD)/stress.left; exit 1; fi
example-binaries: $(EXAMPLE_BINS)

# Rewritten only when the compiler or a flag changes, so that such a change rebuilds everything and nothing else does.
$(BUILD)/flags: FORCE
	@mkdir -p $(@D)
	@echo '$(CC) $(FLAGS) $(EXACT) $(NATIVE)' | cmp -s - $@ || echo '$(CC) $(FLAGS) $(EXACT) $(NATIVE)' > $@

$(BUILD)/%: %.c mcsample.h $(wildcard tests/*.h) examples/hdr.h $(BUILD)/flags
	@mkdir -p $(@D)
	$(CC) $(FLAGS) $(CONTRACT) $< $(filter %.o,$^) -o $@ $(LIBS)

$(SHARED)/wide%.o: tests/shared/wide.c mcsample.h $(wildcard tests/*.h) $(BUILD)/flags
	@mkdir -p $(@D)
	$(CC) $(FLAGS) $(EXACT) $(SHARED_FLAGS) $(if $(filter 16,$*),$(UNITS_16)) -DLANES=$* -c $< -o $@

$(SHARED)/%.o: tests/shared/%.c mcsample.h $(wildcard tests/*.h) $(BUILD)/flags
	@mkdir -p $(@D)
	$(CC) $(FLAGS) $(EXACT) $(SHARED_FLAGS) -c $< -o $@

# The declared way: one file that compiles what MCS_DECLARE declares.
$(LIB)/mcsample.o: mcsample.h $(BUILD)/flags
	@mkdir -p $(@D)
	printf '#include "mcsample.h"\n' | $(CC) $(FLAGS) $(EXACT) -DMCS_IMPLEMENTATION -fPIC -c -x c - -o $@

$(LIB)/libmcsample.a: $(LIB)/mcsample.o
	@rm -f $@
	$(AR) rcs $@ $<

$(LIB)/libmcsample.so: $(LIB)/mcsample.o
	$(CC) -shared $< -o $@ $(LIBS)

$(RENDER): examples/render.c $(wildcard examples/render_*.h) examples/hdr.h mcsample.h $(BUILD)/flags
	@mkdir -p $(@D)
	$(CC) $(FLAGS) $(OPENMP) $< -o $@ $(LIBS)

$(GALLERY): $(wildcard examples/gallery_*.h) examples/render_png.h tests/bench/svg.h

# private: what they are linked with has the flags of its own.
$(CALLING): private CFLAGS := $(CALLING_FLAGS)
$(TEST_BINS) $(STRESS_BINS): CONTRACT = $(EXACT) -DMCST_LINKED
$(DECLARED): CONTRACT = $(EXACT) -DMCST_LINKED -DMCS_DECLARE
# Headers define functions that one object or another does not call.
SHARED_FLAGS = -DMCST_LINKED -DMCST_SHARED -DMCS_DECLARE -Wno-unused-function -Wno-unused-variable
$(STRESS_BINS) $(filter $(BUILD)/tests/test_values%,$(TEST_BINS)): $(ROWS)
$(patsubst %,$(BUILD)/tests/test_%,bits chi2_lobes chi2_rest fenv lines mutants width): $(ROWS)
$(patsubst %,$(BUILD)/tests/test_%,mistakes oracle): $(SHARED)/asserting.o $(SHARED)/rough.o
$(SHARED)/rough.o: private SHARED_FLAGS += $(shell $(CC) -mlong-double-64 -E -x c /dev/null >/dev/null 2>&1 && echo '-mlong-double-64')
$(filter-out $(TELLING),$(DECLARED)) $(filter $(BUILD)/tests/test_values%,$(TEST_BINS)): $(BODIES)
$(TELLING): $(SHARED)/telling.o
$(SHARED)/telling.o: private SHARED_FLAGS += $(if $(ASSERTING),,-DMCS_MAX_LANES=4)
$(BUILD)/tests/test_env_files $(BUILD)/tests/stress/fuzz: $(SHARED)/forge.o
$(patsubst %,$(BUILD)/tests/%,test_bits test_fenv test_lines test_width stress/floats stress/hostile): $(WIDE)
$(patsubst %,$(BUILD)/tests/test_%,bits fenv): $(SHARED)/functions.o
$(STRESS_BINS): $(wildcard tests/stress/*.h)
# private: what they share, and $(BUILD)/flags, have the flags of all programs.
$(STRESS_BINS): private FLAGS += -Itests/stress
$(STRESS_QUAD:%=$(BUILD)/tests/stress/%): LIBS = $(QUADMATH) -lm
$(BUILD)/tests/stress/fuzz: private FLAGS += -DMCS_FUZZ_MAIN
$(PACKETS_16): private FLAGS += $(UNITS_16)

$(STRESS_PARTS:%=$(BUILD)/stress/%.ok): $(BUILD)/stress/%.ok: $(STRESS_BINS)
	@mkdir -p $(@D)
	@echo 'stress: $* ...'
	@$(BUILD)/tests/stress/$(firstword $(subst -, ,$*)) $(call STRESS_FILTER,$*) > $(@:.ok=.txt); status=$$?; cat $(@:.ok=.txt); test $$status = 0 && touch $@

# ---- a graphics processor. The bits are those of the host where nothing is fused; samplers are measured as users compile them. The
# host's packets are of no use there.
NVCC ?= nvcc
CUDA = $(BUILD)/cuda
# Where there is none, nothing is run: that it compiles is told by the front end, and code as it comes will do.
CUDA_LEVEL = $(if $(shell nvidia-smi -L 2>/dev/null),-O2,-O0 -G)
CUDA_FLAGS = -x cu -arch=native $(CUDA_LEVEL) -Wno-deprecated-gpu-targets -diag-suppress 20014 -I. -Itests

cuda-binaries: $(CUDA)/bits $(CUDA)/samplers

$(CUDA)/bits: tests/test_bits.c mcsample.h $(wildcard tests/*.h)
	@mkdir -p $(@D)
	$(NVCC) $(CUDA_FLAGS) -DMCST_ARRAYS --fmad=false -Xcompiler $(EXACT) $< -o $@

$(CUDA)/samplers: tests/cuda.cu mcsample.h $(wildcard tests/*.h)
	@mkdir -p $(@D)
	$(NVCC) $(CUDA_FLAGS) $< -o $@

# ---- benchmarks: what a user's build gives, -O2 without -march. Everything below $(BUILD)/bench.
BENCH = $(BUILD)/bench
BENCH_FLAGS = $(CFLAGS) -std=gnu17 $(WARNINGS) -Wno-unused-function -I. -Itests -Itests/bench -DBENCH_FLAGS='"$(CFLAGS) -std=gnu17"'
# $(1) where the compiler takes it, else nothing: then the processor has no such unit, and the forms that want it are skipped.
BENCH_TAKES = $(shell $(CC) $(1) -E -x c /dev/null >/dev/null 2>&1 && echo '$(1)')
# Rows of SLEEF, where its development files are installed.
BENCH_SLEEF = $(shell mkdir -p $(BENCH) && printf '\043include <sleef.h>\nint main(void) { return Sleef_expf8_u10avx2 == 0; }\n' | \
	$(CC) -mavx2 -x c - -o $(BENCH)/sleef.probe -lsleef 2>/dev/null && echo -DBENCH_SLEEF)
BENCH_HEADERS = mcsample.h $(wildcard tests/*.h tests/bench/*.h) examples/hdr.h $(BUILD)/flags
BENCH_BINS = $(BENCH)/throughput $(BENCH)/tables $(BENCH)/clock $(BENCH)/convergence $(BENCH)/shadow $(BENCH)/spectrum

bench: ## run time against error, in tables, CSV files and plots; three minutes; build/bench
	$(SAY)
	+@$(SUBMAKE) $(BENCH_BINS)
	@$(BENCH)/throughput --out $(BENCH)
	@$(BENCH)/tables --out $(BENCH)
	@CLOCK=$(BENCH)/clock sh tests/bench/include.sh $(BENCH)
	@$(BENCH)/convergence --out $(BENCH) $(MAPS)
	@$(BENCH)/shadow --out $(BENCH) $(MAPS)
	@$(BENCH)/spectrum --out $(BENCH)
	@$(TOOK) "CSV files and plots in $(BENCH)"

bench-quick: ## the same with less repetition and smaller tables; 45 s; build/bench
	$(SAY)
	+@$(SUBMAKE) $(BENCH_BINS)
	@$(BENCH)/throughput --quick --out $(BENCH)
	@$(BENCH)/tables --quick --out $(BENCH)
	@CLOCK=$(BENCH)/clock sh tests/bench/include.sh $(BENCH) quick
	@$(BENCH)/convergence --quick --out $(BENCH) $(MAPS)
	@$(BENCH)/shadow --quick --out $(BENCH) $(MAPS)
	@$(BENCH)/spectrum --quick --out $(BENCH)
	@$(TOOK) "CSV files and plots in $(BENCH)"

# Peers by their own sources, in the directories PBRT and CYCLES. They are built each time, as nothing here says what is checked out
# there. Headers of Cycles want a lock of TBB, which is not taken here.
PEERS = $(if $(PBRT),$(BENCH)/peers_pbrt) $(if $(CYCLES),$(BENCH)/peers_cycles)
PEERS_FLAGS = -O3 -march=native
PEERS_BUILD = $(CXX) $(PEERS_FLAGS) -DNDEBUG -ffunction-sections -fdata-sections -Wl,--gc-sections -w -Itests/bench
# $(1) its directory, $(2) its program: the comparison, if there is a directory.
PEERS_RUN = $(if $($(1)),echo '$($(1)): commit' "$$(git -C '$($(1))' log -1 --format='%h of %cs' || echo unknown)" && $(BENCH)/$(2), \
	echo 'SKIPPED: the comparison with $(3): $(1)=directory is not given')

bench-peers: ## samplers of pbrt, Mitsuba, Cycles beside ours; 1 min; tables; PBRT=directory CYCLES=directory; pip install mitsuba numpy
	$(SAY)
	+@$(SUBMAKE) $(LIB)/libmcsample.so $(PEERS)
	@if command -v $(PYTHON) >/dev/null; then $(PYTHON) tests/bench/peers.py $(LIB)/libmcsample.so; \
	else echo 'SKIPPED: the comparison with Mitsuba: $(PYTHON) is not installed'; fi
	@$(call PEERS_RUN,PBRT,peers_pbrt,pbrt)
	@$(call PEERS_RUN,CYCLES,peers_cycles,Cycles)
	@$(TOOK) "the tables above"

$(BENCH)/peers.o: tests/bench/peers.c $(BENCH_HEADERS)
	@mkdir -p $(@D)
	$(CC) $(BENCH_FLAGS) -DPEERS_FLAGS='"$(PEERS_FLAGS)"' -c $< -o $@

$(BENCH)/peers_pbrt: tests/bench/peers_pbrt.cpp $(BENCH)/peers.o FORCE
	$(PEERS_BUILD) -std=c++17 -I'$(PBRT)/src' -I'$(PBRT)/src/ext' -I'$(PBRT)/src/ext/gtest' $< '$(PBRT)/src/pbrt/util/sampling.cpp' \
		$(BENCH)/peers.o -o $@ $(LIBS)

$(BENCH)/peers_cycles: tests/bench/peers_cycles.cpp $(BENCH)/peers.o FORCE
	@mkdir -p $(BENCH)/tbb
	@echo 'namespace tbb { struct spin_mutex { void lock() {} void unlock() {} }; }' > $(BENCH)/tbb/spin_mutex.h
	$(PEERS_BUILD) -std=c++20 -I'$(CYCLES)/src' -I$(BENCH) $< $(BENCH)/peers.o -o $@ $(LIBS)

$(BENCH)/wide8.o: tests/bench/wide.c $(BENCH_HEADERS)
	@mkdir -p $(@D)
	$(CC) $(BENCH_FLAGS) -DBENCH_W=8 $(BENCH_SLEEF) $(call BENCH_TAKES,-mavx2 -mfma) -c $< -o $@

$(BENCH)/wide16.o: tests/bench/wide.c $(BENCH_HEADERS)
	@mkdir -p $(@D)
	$(CC) $(BENCH_FLAGS) -DBENCH_W=16 $(call BENCH_TAKES,-mavx512f -mavx512dq -mavx512bw -mavx512vl) -c $< -o $@

$(BENCH)/throughput: tests/bench/throughput.c $(BENCH)/wide8.o $(BENCH)/wide16.o $(BENCH_HEADERS)
	$(CC) $(BENCH_FLAGS) $< $(BENCH)/wide8.o $(BENCH)/wide16.o -o $@ $(if $(BENCH_SLEEF),-lsleef) $(LIBS)

$(BENCH)/%: tests/bench/%.c $(BENCH_HEADERS)
	@mkdir -p $(@D)
	$(CC) $(BENCH_FLAGS) $< -o $@ $(LIBS)

FORCE:
.PHONY: test cuda cuda-binaries stress stress-today stress-whole cross analyze mutants examples demo gallery hygiene selftest install uninstall dist lib packages help clean test-binaries example-binaries FORCE bench bench-quick bench-peers
