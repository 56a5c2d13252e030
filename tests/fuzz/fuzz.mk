# Fuzzing: one program of libFuzzer, which fuzzes the target that a link to it is named after.
#   CLANG=clang     its compiler       TIME=600    seconds for all targets together
#   FUZZ="ply obj"  some targets       WORK=DIR    where what is found is kept (build/fuzz/work)
#   TMPDIR=DIR      for scratch files: on a disk they take most of the time (/dev/shm)
CLANG ?= clang
TIME  ?= 600
FUZZ  ?= $(notdir $(wildcard tests/fuzz/corpus/*))
WORK  ?= $(build)/fuzz/work
TMPDIR ?= /dev/shm
clang := CC="$(CLANG)" CXX="$(CLANG)++"

# The test of the corpora links what the fuzzer does, but for libFuzzer.
fuzz_objects := $(patsubst %,$(out)/%.o,$(basename $(filter-out tests/fuzz/test_% \
                  tests/fuzz/libfuzzer.cpp,$(wildcard tests/fuzz/*.c tests/fuzz/*.cpp))))
$(out)/tests/fuzz/test_fuzz: $(fuzz_objects) | $(modules)

$(out)/tests/fuzz/fuzz: $(fuzz_objects) $(out)/tests/fuzz/libfuzzer.o \
    $(call objects_of,$(links_fuzz)) | $(modules)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) -fsanitize=fuzzer -o $@ $^ $(call libs_of,$(links_fuzz))

# Comparisons are traced where text is read; elsewhere that would double the time.
ifeq ($(config),fuzz)
untraced := -fno-sanitize-coverage=trace-cmp
$(foreach d,$(filter-out lib/mesh lib/grid,$(rooms:%=lib/%)) tests/fuzz,\
  $(eval $(out)/$(d)/%: cflags += $(untraced))$(eval $(out)/$(d)/%: cxxflags += $(untraced)))
endif

# A target's own folder first: libFuzzer puts there what reaches something new. Image libraries
# leak a little.
fuzz_flags = -timeout=10 -rss_limit_mb=1500 -max_len=8192 -entropic=0 -print_final_stats=1
leaking   := image gltf obj
fuzz: ## fuzz every target, or FUZZ="ply obj", for TIME=600 seconds in all (needs clang)
	$(again) config=fuzz $(clang) $(build)/fuzz/tests/fuzz/fuzz
	@set -e; each=$$(($(TIME) / $(words $(FUZZ)))); \
	for t in $(FUZZ); do \
	  mkdir -p $(WORK)/$$t tests/fuzz/found/$$t; \
	  ln -sf fuzz $(build)/fuzz/tests/fuzz/$$t; \
	  dict=$$(ls tests/fuzz/$$t.dict 2>/dev/null | sed 's/^/-dict=/'); \
	  case " $(leaking) " in *" $$t "*) leaks=0 ;; *) leaks=1 ;; esac; \
	  TMPDIR=$(TMPDIR) ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=$$leaks \
	  $(build)/fuzz/tests/fuzz/$$t $(fuzz_flags) $$dict -max_total_time=$$each \
	    -artifact_prefix=tests/fuzz/found/$$t/ $(WORK)/$$t tests/fuzz/corpus/$$t; \
	done

# What the corpora reach, file by file.
covered := lib/asset lib/mesh/import lib/mesh/stream lib/grid lib/world lib/stream
fuzz-coverage: ## lines of the readers that the corpora of tests/fuzz reach (needs clang)
	$(again) config=coverage $(clang) $(build)/coverage/tests/fuzz/test_fuzz
	@LLVM_PROFILE_FILE=$(build)/coverage/fuzz.profraw $(build)/coverage/tests/fuzz/test_fuzz \
	  >/dev/null 2>&1 || true
	@llvm-profdata merge -o $(build)/coverage/fuzz.profdata $(build)/coverage/fuzz.profraw
	@llvm-cov report $(build)/coverage/tests/fuzz/test_fuzz \
	  -instr-profile=$(build)/coverage/fuzz.profdata $(covered)
