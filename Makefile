# masspropd: `make` builds build/masspropd, `make run` serves it, `make test` tests it, `make help`
# lists the rest.  `run`, `test`, `bench`, `check`, `fuzz` and `coverage` install what they lack (tests/deps).
#
# CC=clang          another compiler           SANITIZE=address,undefined  in a folder of its own
# CFLAGS='-O0 -g'   other optimisation         V=1                         show whole commands
# LISTEN=HOST:PORT  where `make run` serves    T='PATTERN...'              which tests to run

PREFIX ?= /usr/local
LISTEN ?= 127.0.0.1:8080
TIME   ?= 60
CFLAGS ?= -O2 -g
ifeq ($(origin CC),default)
CC     := gcc
endif
# The compiler of the same family, for the one file of C++: gcc-12 means g++-12.
ifeq ($(origin CXX),default)
CXX    := $(patsubst cc,c++,$(subst clang,clang++,$(subst gcc,g++,$(CC))))
endif

# One folder for every kind of build, so that their objects never meet.
empty    :=
space    := $(empty) $(empty)
comma    := ,
BUILD    := build
ifneq ($(SANITIZE),)
BUILD    := build/$(subst $(space),-,$(subst $(comma),-,$(SANITIZE)))
endif
ifneq ($(COVERAGE),)
BUILD    := build/coverage
endif

WARN     := -Wall -Wextra -Wpedantic -Wconversion -Wshadow
# A fused multiply-add would break the error bounds; -ffast-math is out of the question.
MATH     := -ffp-contract=off -fno-math-errno
DEFINES  := -I. -I$(BUILD)/gen -D_GNU_SOURCE
# libdraco is linked as it comes, shared like the rest: its fixes arrive with the system's, and it
# has had many that matter to somebody who decodes strangers' files.
LDLIBS   := -lmicrohttpd -lcjson -lseccomp -lzstd -lz -lgmp -lnettle -ldraco -lstdc++ -lm

machine  := $(shell $(CC) -dumpmachine 2>/dev/null)
HARDEN   := -fstack-protector-strong
HARDEN   += $(if $(filter x86_64-% i%86-%,$(machine)),-fstack-clash-protection -fcf-protection)
HARDEN   += $(if $(filter aarch64-%,$(machine)),-mbranch-protection=standard)
HARDEN   += $(if $(filter -O1 -O2 -O3 -Os,$(CFLAGS)),-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3)
LINK     := -pie -Wl,-z,relro,-z,now,-z,noexecstack -Wl,--as-needed
ifneq ($(SANITIZE),)
# MP_SANITIZED: the program leaves out memory limits and seccomp, which sanitizers cannot live with.
HARDEN   := -fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer
DEFINES  += -DMP_SANITIZED=1
# libFuzzer need not see every comparison: that takes most of the time, and tests/fuzz/words.dict has
# the words.
HARDEN   += $(if $(findstring fuzzer,$(SANITIZE)),-fno-sanitize-coverage=trace-cmp)
LINK     := -pie -fsanitize=$(SANITIZE)
endif
ifneq ($(COVERAGE),)
HARDEN   := --coverage -O0
LINK     := -pie --coverage
endif

# Optimisation of single files, in the place of -O2: opt_FOLDER/NAME.c.
opt_core/moments/moments_kernel.c := -O3
opt_core/exact/exact_digits.c := -O3
opt_core/obj/polygon.c := -O3
opt_core/topology/manifold.c := -O3
opt_core/topology/rings.c := -O3
opt_core/topology/rings_far.c := -O3
opt_core/geometry/collinear.c := -O3
opt_core/moments/uncertainty_kernel.c := -O3
opt_core/stl/stl_binary.c := -O3
opt_core/stl/stl_kernel.c := -O3
opt_core/fingerprint/aes.c := -O3
opt_core/fingerprint/fingerprint_kernel.c := -O3
opt_core/topology/flat.c := -O3
opt_core/topology/vertices.c := -O3
opt_core/topology/recent.c := -O3
opt_core/topology/index.c := -O3
opt_core/draco/draco.c := -O3

optimised = $(patsubst -O2,$(or $(opt_$<),-O2),$(CFLAGS))
flags     = $(DEFINES) $(CPPFLAGS) $(WARN) -fPIE $(optimised) $(HARDEN) $(MATH)
compile   = $(CC) -std=c11 $(flags)
# libdraco's types have no RTTI to check theirs with.
compile++ = $(CXX) -std=c++17 $(flags) $(if $(findstring undefined,$(SANITIZE)),-fno-sanitize=vptr)
link      = $(CC) $(LINK) $(LDFLAGS)
quoted    = $(subst ','\'',$(text))
objects   = $(patsubst %,$(BUILD)/%.o,$(basename $(1)))

core      := $(wildcard core/*.c core/*/*.c) core/draco/draco_wrap.cc
api       := $(wildcard api/*.c)
server    := $(filter-out server/main.c,$(wildcard server/*.c))
generated := $(patsubst core/number/gen/gen_%.c,$(BUILD)/gen/%_table.h,$(wildcard core/number/gen/gen_*.c))
libs      := $(BUILD)/libserver.a $(BUILD)/libapi.a $(BUILD)/libmasspropd.a
unit      := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/unit/test_*.c))
unit_help := $(call objects,$(filter-out tests/unit/test_%,$(wildcard tests/unit/*.c)))
fuzz      := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))
wrap      := $(if $(unit_help),-Wl$(comma)--wrap=malloc$(comma)--wrap=calloc$(comma)--wrap=realloc$(comma)--wrap=free)
bench     := $(addprefix $(BUILD)/tests/bench/,generate discard stages bare_draco)
tests     := $(unit) $(fuzz) $(bench) $(BUILD)/sample/flange.stl $(BUILD)/tests/check/option_names

# All cores, unless somebody said otherwise with -j.
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(shell nproc 2>/dev/null || echo 1)
endif
MAKEFLAGS += --no-print-directory
Q := $(if $(V),,@)
say = $(if $(V)$(findstring s,$(firstword -$(MAKEFLAGS))),,@printf '  %-4s %s\n' '$(1)' '$(2)')

all: $(BUILD)/masspropd

$(BUILD)/masspropd: $(BUILD)/server/main.o $(libs)
	$(call say,LD,$@)
	$(Q)$(link) -o $@ $^ $(LDLIBS)
$(BUILD)/libmasspropd.a: $(call objects,$(core)) $(BUILD)/stamp/core
$(BUILD)/libapi.a: $(call objects,$(api)) $(BUILD)/stamp/api
$(BUILD)/libserver.a: $(call objects,$(server)) $(BUILD)/stamp/server
$(BUILD)/%.a:
	$(call say,AR,$@)
	$(Q)rm -f $@ && ar rcs $@ $(filter %.o,$^)
$(BUILD)/%.o: %.c $(BUILD)/stamp/flags | $(BUILD)/stamp/deps $(generated)
	$(call say,CC,$<)
	$(Q)mkdir -p $(@D) && $(compile) -MMD -MP -c -o $@ $<
$(BUILD)/%.o: %.cc $(BUILD)/stamp/flags | $(BUILD)/stamp/deps
	$(call say,C++,$<)
	$(Q)mkdir -p $(@D) && $(compile++) -MMD -MP -c -o $@ $<
-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

# Tables that are computed rather than typed in: core/number/gen/gen_NAME.c prints NAME_table.h.
$(BUILD)/gen/%_table.h: core/number/gen/gen_%.c $(BUILD)/stamp/flags | $(BUILD)/stamp/deps
	$(call say,GEN,$@)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) -I. -D_GNU_SOURCE -std=c11 -O1 $(WARN) $(MATH) -o $(@D)/gen_$* $< -lgmp -lm
	$(Q)$(@D)/gen_$* >$@.tmp && mv $@.tmp $@

# The contract as bytes for the compiler: api/openapi.json is served as it stands.
generated += $(BUILD)/gen/openapi_json.h
$(BUILD)/gen/openapi_json.h: api/openapi.json
	$(call say,GEN,$@)
	$(Q)mkdir -p $(@D)
	$(Q)od -An -v -tx1 $< | sed 's/ \(..\)/0x\1,/g' >$@.tmp && mv $@.tmp $@
$(BUILD)/api/openapi.o: $(BUILD)/gen/openapi_json.h

# Files that change only when what they say does, for everything to depend on: the commands, the
# members of the libraries.
$(BUILD)/stamp/flags: text = $(compile) $(compile++) $(link) $(LDLIBS) $(shell $(CC) --version 2>/dev/null)
$(BUILD)/stamp/core: text = $(core)
$(BUILD)/stamp/api: text = $(api)
$(BUILD)/stamp/server: text = $(server)
$(BUILD)/stamp/flags $(BUILD)/stamp/core $(BUILD)/stamp/api $(BUILD)/stamp/server: FORCE
	@mkdir -p $(@D)
	@echo '$(quoted)' | cmp -s - $@ || echo '$(quoted)' >$@
# Say what is missing rather than let the compiler stumble over it.
$(BUILD)/stamp/deps: tests/deps $(BUILD)/stamp/flags
	@CC='$(CC)' tests/deps check build
	@touch $@

# The sample part, the unit tests (malloc and friends can be made to fail: alloc_fail.h), and the
# fuzz targets: with a main of our own, or libFuzzer's where SANITIZE says so.
$(BUILD)/sample/%.stl: $(BUILD)/tests/sample/make_part
	$(call say,GEN,$@)
	$(Q)mkdir -p $(@D) && $< $@
$(BUILD)/tests/sample/make_part: $(BUILD)/tests/sample/make_part.o
	$(call say,LD,$@)
	$(Q)$(link) -o $@ $^ -lm
$(BUILD)/tests/unit/test_%: $(BUILD)/tests/unit/test_%.o $(unit_help) $(libs)
	$(call say,LD,$@)
	$(Q)$(link) $(wrap) -o $@ $^ -lcmocka $(LDLIBS)
# What a target does besides is not what libFuzzer is to learn from, and takes long enough without.
$(patsubst %,%.o,$(fuzz)): private HARDEN += $(if $(findstring fuzzer,$(SANITIZE)),-fno-sanitize=fuzzer-no-link)
fuzz_main := $(if $(findstring fuzzer,$(SANITIZE)),-fsanitize=fuzzer,$(BUILD)/tests/fuzz/driver.o)
$(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.o $(filter %.o,$(fuzz_main)) $(libs)
	$(call say,LD,$@)
	$(Q)$(link) -o $@ $(filter-out %.o,$(fuzz_main)) $^ $(LDLIBS)

# What `make bench` measures with: the solid in all formats, the server that only receives, the decoder
# of others, single stages.
$(BUILD)/tests/bench/generate: $(call objects,tests/bench/generate.c tests/bench/mesh.c)
$(BUILD)/tests/bench/stages: $(call objects,tests/bench/stages.c tests/bench/mesh.c) $(libs)
$(BUILD)/tests/bench/discard: $(BUILD)/tests/bench/discard.o
$(BUILD)/tests/bench/bare_draco: $(BUILD)/tests/bench/bare_draco.o
$(bench):
	$(call say,LD,$@)
	$(Q)$(link) -o $@ $^ $(LDLIBS)

# The goals that install first call make again afterwards: what make found out about the compiler
# was wrong before.
run:
	@CC='$(CC)' tests/deps install run
	@$(MAKE) sample
	@exec tests/sample/run $(BUILD)/masspropd $(LISTEN) $(BUILD)/sample/flange.stl
test:
	@CC='$(CC)' tests/deps install test
	@$(MAKE) all tests
	@BUILD=$(BUILD) tests/run $(T)
bench:
	@CC='$(CC)' tests/deps install bench
	@$(MAKE) all $(bench)
	@BUILD=$(BUILD) tests/bench/run $(T)
sample: all $(BUILD)/sample/flange.stl
	@:
tests: $(tests)
	@:

check:
	@CC='$(CC)' tests/deps install check
	@$(MAKE) all $(BUILD)/tests/check/option_names
	@BUILD=$(BUILD) tests/check/check
format lint layers docs:
	@BUILD=$(BUILD) tests/check/check $(@:format=reformat)
docs: all $(BUILD)/tests/check/option_names
layers: all
$(BUILD)/tests/check/option_names: $(BUILD)/tests/check/option_names.o $(libs)
	$(call say,LD,$@)
	$(Q)$(link) -o $@ $^ $(LDLIBS)

fuzz:
	@tests/deps install fuzz
	@$(MAKE) CC=clang SANITIZE=fuzzer-no-link,address,undefined fuzzers
	@SEED=$(SEED) tests/fuzz/run build/fuzzer-no-link-address-undefined/tests/fuzz $(TIME) $(T)
fuzzers: $(fuzz)
soak:
	@CC='$(CC)' tests/deps install test
	@$(MAKE) all
	@MASSPROPD=$(BUILD)/masspropd python3 tests/http/soak.py $(TIME)
coverage:
	@CC='$(CC)' tests/deps install coverage
	@find build/coverage -name '*.gcda' -delete 2>/dev/null || :
	@tests/check/coverage $(T)

install: all
	install -D -m 755 $(BUILD)/masspropd $(DESTDIR)$(PREFIX)/bin/masspropd
uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/masspropd
clean:
	rm -rf build
help:
	@sed -n '1,/^$$/s/^# \{0,1\}//p' Makefile
	@echo 'make            build'
	@echo 'make run        install what is missing, build, serve, post a sample part'
	@echo 'make test       install what is missing, build, run all tests'
	@echo 'make check      layers, style, lint and spelling; parts: layers, lint, docs'
	@echo 'make format     let clang-format rewrite the sources'
	@echo 'make bench      measure speed, compare it (BENCH=quick: in about a minute)'
	@echo 'make fuzz       run every fuzz target for TIME=60 seconds'
	@echo 'make soak       mixed load for TIME=60 seconds: is memory flat, every answer right?'
	@echo 'make coverage   lines the tests reach, at least 95 % of core and api; build/coverage/html'
	@echo 'make install    to $$DESTDIR$$PREFIX/bin (PREFIX=/usr/local)'
	@echo 'make uninstall, make clean'

FORCE:
.PHONY: all run sample test tests bench check format lint layers docs fuzz fuzzers soak coverage install uninstall \
	clean help FORCE
.SECONDARY:
.DELETE_ON_ERROR:
