# geotex: everything is built from here. `make help` lists the targets.
#
#   config=release|debug            optimised (default) · -O0 -g
#   config=sanitize|thread          address and undefined sanitizers · thread sanitizer
#   config=fuzz|coverage            for tests/fuzz, with clang
#   zstd=1|0                        compressed sections in libgeotex, or a library of libc alone
#   build=DIR                       where everything goes (build)
#   V=1                             print the commands
#   werror=1                        warnings are errors, for those who change the code
-include Makefile.config

config ?= release
zstd   ?= 1
build  ?= build
werror ?= 0
PREFIX ?= /usr/local
.DEFAULT_GOAL := all
again := @$(MAKE) --no-print-directory

VERSION := 0.1.0
SOVERSION := 0

# ---- rooms: what each needs. Imports run one way, from right to left -----------------------------
ROOMS_CORE := base asset derive trace edit stream frame render
ROOMS_COOK := image mesh grid chart bake measure cook export world

needs_base    := base
needs_asset   := base asset
needs_derive  := $(needs_asset) derive
needs_trace   := $(needs_derive) trace
needs_edit    := $(needs_trace) edit
needs_image   := base image
needs_host    := base image host
needs_stream  := base asset stream
needs_frame   := $(needs_derive) frame
needs_render  := $(needs_frame) render
needs_mesh    := base image mesh
needs_grid    := $(needs_mesh) grid
needs_chart   := $(needs_mesh) chart
needs_bake    := $(needs_asset) image mesh grid chart bake
needs_measure := $(needs_trace) image mesh measure
needs_cook    := $(needs_trace) frame image mesh grid chart bake measure cook
needs_export  := $(needs_cook) export
needs_world   := $(needs_cook) stream world
needs_cli      = $(needs_world) export edit frame render host cli $(vulkan)

rooms := $(ROOMS_CORE) $(ROOMS_COOK) vulkan host cli
tests := $(filter-out bench common golden platforms run,$(notdir $(wildcard tests/*)))

# ---- flags ---------------------------------------------------------------------------------------
CC  ?= cc
CXX ?= c++
flags_release  := -O3 -g
flags_debug    := -O0 -g
flags_sanitize := -O1 -g -fno-omit-frame-pointer \
                  -fsanitize=address,undefined,float-cast-overflow \
                  -fno-sanitize-recover=undefined,float-cast-overflow
flags_thread   := -O1 -g -fsanitize=thread
flags_fuzz     := -O1 -g -fno-omit-frame-pointer -fno-sanitize-recover=all \
                  -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow
flags_coverage := -O0 -g -fprofile-instr-generate -fcoverage-mapping
flags := $(flags_$(config))
ifeq ($(flags),)
$(error config=$(config): use release, debug, sanitize, thread, fuzz or coverage)
endif
warnings := -Wall -Wextra $(if $(filter 1,$(werror)),-Werror)

# Contraction to fused multiply-adds would make the bytes depend on the processor.
common   := $(flags) $(warnings) -fPIC -fvisibility=hidden -ffp-contract=off -MMD -MP \
            -Iinclude -DGTX_BUILDING $(if $(filter 1,$(zstd)),-DGTX_ZSTD)
cflags   := -std=c11 -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes $(common)
cxxflags := -std=c++17 $(common)
# gcc's plain -Wshadow also warns of a parameter that has a member's name; clang's does not.
cxxflags += $(if $(findstring clang,$(shell $(CXX) --version)),-Wshadow,-Wshadow=local)

# Packages, asked for only where they are used: nothing here is needed to build libgeotex.
pkg = $(shell pkg-config $(1) $(2))
cflags_mesh  = $(call pkg,--cflags,openmesh draco tinygltf)
# Vectors of Eigen would add in another order on another processor.
cflags_chart = $(call pkg,--cflags,openmesh eigen3) -DEIGEN_DONT_VECTORIZE
cflags_image = $(call pkg,--cflags,OpenImageIO)
cflags_grid  = $(if $(gdal),$(call pkg,--cflags,gdal))
cflags_host  = $(call pkg,--cflags,egl glfw3)
# Loops become vectors where a comparison of floats may be made in vain, and a root sets no errno.
quick = $(if $(filter asset derive mesh chart bake,$(room)),-fno-trapping-math -fno-math-errno)
# The layouts of records are of shaders and of C.
cflags_frame  = -Ishaders
cflags_render = -Ishaders
cflags_cli   = -D_POSIX_C_SOURCE=200809L -I$(out)/gen $(if $(vulkan),-DGTX_VULKAN)
libs_asset   = $(if $(filter 1,$(zstd)),$(call pkg,--libs,libzstd))
libs_mesh    = $(call pkg,--libs,openmesh draco zlib) -lmeshoptimizer -ldl -pthread -lstdc++
libs_image   = -ldl $(libs_asset)
libs_host    = $(call pkg,--libs,egl glfw3) -pthread
libs_of      = $(strip $(foreach r,$(1),$(libs_$(r)))) -lm

# ---- objects -------------------------------------------------------------------------------------
out := $(build)/$(config)
Q   := $(if $(V),,@)
say  = @printf '  %-5s %s\n'

sources    = $(filter-out %/module.cpp lib/image/png_jpeg/% %/geotex_netcdf.c %/write_texts.c \
               $(if $(vulkan),,lib/host/vulkan%), \
               $(wildcard lib/$(1)/*.c* lib/$(1)/*/*.c*))
objects    = $(patsubst %,$(out)/%.o,$(basename $(call sources,$(1)))) \
             $(if $(filter frame,$(1)),$(out)/gen/shader_sources.o) \
             $(if $(filter vulkan,$(1)),$(out)/gen/spirv.o)
objects_of = $(foreach r,$(1),$(call objects,$(r)))
room       = $(word 2,$(subst /, ,$(1)))

# What a file may include: headers of the rooms that its own needs, and the public ones. An include
# path is a folder of links to those rooms; benchmarks, samples and what is generated see all.
path_of    = $(out)/sees/$(or $(filter $(rooms:%=lib/%) $(tests:%=tests/%),$(call folder,$(1))),all)
folder     = $(word 1,$(subst /, ,$(1)))/$(room)
room_flags = -I$(path_of) $(cflags_$(room)) $(quick) $(test_flags)
link_rooms = mkdir -p $(out)/sees/$(1) && \
             ln -sfn $(foreach r,$(2),$(CURDIR)/lib/$(r)) $(out)/sees/$(1) &&
$(out)/sees/.made: Makefile
	$(Q)rm -rf $(@D)
	$(Q)$(call link_rooms,all,$(rooms)) \
	  $(foreach r,$(rooms),$(call link_rooms,lib/$(r),$(needs_$(r)))) \
	  $(foreach t,$(tests),$(call link_rooms,tests/$(t),$(call test_needs,$(t)))) touch $@

$(out)/%.o: %.c | $(out)/sees/.made
	@mkdir -p $(@D)
	$(say) CC $<
	$(Q)$(CC) $(cflags) $(call room_flags,$<) $(CFLAGS) -c $< -o $@

$(out)/%.o: %.cpp | $(out)/sees/.made
	@mkdir -p $(@D)
	$(say) CXX $<
	$(Q)$(CXX) $(cxxflags) $(call room_flags,$<) $(CXXFLAGS) -c $< -o $@

# Shaders travel inside the library: one byte array a file and a table of names.
# Which commit the command is of: asked of git, where these sources are a checkout of their own.
$(out)/gen/commit.h: .FORCE
	@mkdir -p $(@D)
	@commit=; if [ "$$(git rev-parse --show-toplevel 2>/dev/null)" = "$(CURDIR)" ]; then \
	  commit=$$(git rev-parse --short=12 HEAD); \
	  git diff --quiet HEAD || commit="$$commit, changed"; commit=" (commit $$commit)"; fi; \
	echo "#define GTX_COMMIT \"$$commit\"" | cmp -s - $@ || \
	echo "#define GTX_COMMIT \"$$commit\"" > $@
$(out)/lib/cli/version.o: $(out)/gen/commit.h
.PHONY: .FORCE

shaders := $(sort $(wildcard shaders/*.glsl shaders/*.vert shaders/*.frag))
$(out)/gen/shader_sources.c: $(shaders) Makefile
	@mkdir -p $(@D)
	$(say) GEN $@
	$(Q){ echo '/* Generated from shaders/. */'; echo '#include "frame/shaders.h"'; n=0; \
	for f in $(shaders); do echo "static const char text_$$n[] = {"; \
	  od -An -v -tx1 $$f | sed 's/ \([0-9a-f][0-9a-f]\)/0x\1,/g'; echo '0};'; n=$$((n+1)); done; \
	echo 'const gtx_shader_file gtx_shader_files[] = {'; n=0; \
	for f in $(shaders); do echo "{\"$${f#shaders/}\", text_$$n},"; n=$$((n+1)); done; \
	echo '{0, 0}};'; } > $@
$(out)/gen/shader_sources.o: $(out)/gen/shader_sources.c | $(out)/sees/.made
	$(Q)$(CC) $(cflags) -I$(out)/sees/lib/frame -c $< -o $@

# ---- products ------------------------------------------------------------------------------------
lib_core := $(out)/libgeotex.a
lib_cook := $(out)/libgeotex-cook.a
so_core  := $(out)/libgeotex.so.$(VERSION)
so_cook  := $(out)/libgeotex-cook.so.$(VERSION)
command  := $(out)/gtx
sample_names := $(filter-out $(if $(vulkan),,vulkan%),\
                  $(basename $(notdir $(wildcard samples/*.c samples/*.cpp))))
sample_bins  := $(addprefix $(out)/samples/,$(sample_names))

include lib/vulkan/vulkan.mk lib/image/modules.mk
all: $(build)/gtx $(libraries) $(sample_bins) ## libraries, command (build/gtx) and samples

$(lib_core): $(call objects_of,$(ROOMS_CORE))
	$(say) AR $@
	$(Q)rm -f $@ && $(AR) qcs $@ $^

$(lib_cook): $(call objects_of,$(ROOMS_COOK))
	$(say) AR $@
	$(Q)rm -f $@ && $(AR) qcs $@ $^

# What a shared library exports: the functions that its headers declare, and nothing else.
headers_core := geotex edit solid frame rays render stream
$(out)/gen/libgeotex.map: $(headers_core:%=include/geotex/%.h)
$(out)/gen/libgeotex-cook.map: $(addprefix include/geotex/,cook.h export.h grid.h)
$(out)/gen/%.map: Makefile
	@mkdir -p $(@D)
	$(Q){ echo '{ global:'; sed -n 's/^GTX_API.*[ *]\(gtx_[a-z_]*\)(.*/  \1;/p' $(filter %.h,$^); \
	echo 'local: *; };'; } > $@

$(so_core): $(call objects_of,$(ROOMS_CORE)) | $(out)/gen/libgeotex.map
	$(say) LINK $@
	$(Q)$(CC) $(flags) $(LDFLAGS) -shared -Wl,-soname,libgeotex.so.$(SOVERSION) \
	  -Wl,--no-undefined -Wl,--version-script=$(out)/gen/libgeotex.map -o $@ $^ $(call libs_of,asset)
	$(Q)ln -sf $(@F) $(out)/libgeotex.so.$(SOVERSION) && ln -sf $(@F) $(out)/libgeotex.so

$(so_cook): $(call objects_of,$(ROOMS_COOK)) $(so_core) | $(out)/gen/libgeotex-cook.map
	$(say) LINK $@
	$(Q)$(CXX) $(flags) $(LDFLAGS) -shared -Wl,-soname,libgeotex-cook.so.$(SOVERSION) \
	  -Wl,--no-undefined -Wl,--version-script=$(out)/gen/libgeotex-cook.map -o $@ \
	  $(call objects_of,$(ROOMS_COOK) base asset derive trace stream frame) $(call libs_of,asset mesh)
	$(Q)ln -sf $(@F) $(out)/libgeotex-cook.so.$(SOVERSION) && ln -sf $(@F) $(out)/libgeotex-cook.so

$(command): $(call objects_of,cli host image $(vulkan)) $(lib_cook) $(lib_core) | $(modules)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) $(LDFLAGS) -o $@ $^ $(call libs_of,asset mesh host image)

$(build)/gtx: $(command) $(modules)
	$(Q)ln -sf $(config)/gtx $@

# A sample is one file; it links what an engine would link, and lib/host for its window.
$(out)/samples/%: $(out)/samples/%.o $(call objects_of,host image) $(lib_cook) $(lib_vulkan) \
    $(lib_core) | $(modules)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) $(LDFLAGS) -o $@ $^ $(call libs_of,asset mesh host image)

# ---- tests: every tests/ROOM/test_*.c(pp) is a program that links its room and what it needs -----
test_sources := $(filter-out $(if $(vulkan),,tests/vulkan/%),\
                  $(wildcard tests/*/test_*.c tests/*/test_*.cpp))
test_bins    := $(patsubst %,$(out)/%,$(basename $(test_sources)))
test_needs    = $(or $(links_$(1)),$(needs_$(1)) $(extra_needs_$(1)))
# These run the command and the products; they link nothing of ours but the smallest room.
$(foreach r,consumer corpus python source web,$(eval links_$(r) := base))
links_cli      := base image
links_fuzz     := $(needs_world) export edit frame render
links_samples  := $(needs_image)
links_threads  := $(needs_cook) frame render host
links_verbs    := $(needs_cli)
extra_needs_render  := trace edit host image
extra_needs_trace   := frame image mesh grid chart bake measure cook
extra_needs_bake    := derive trace measure host
extra_needs_cook    := host
extra_needs_measure := frame grid chart bake cook
extra_needs_world   := frame render host
# Embree ships no pkg-config file; its test asks for the header in the same way.
libs_test_embree = $(shell printf '\043include <embree3/rtcore.h>' | \
                     $(CXX) -E -x c++ - >/dev/null 2>&1 && echo -lembree3)
# An archive: a test takes from it only what it asks for, and so needs no room but its own.
common_tests := $(out)/tests/common.a
$(common_tests): $(patsubst %,$(out)/%.o,$(basename $(wildcard tests/common/*.c)))
	$(Q)rm -f $@ && $(AR) qcs $@ $^

# Debugging data stays in the objects: in 200 programs it would be 7 GB. Tests are compiled by -O1;
# what they have inline as the library has it is the library's, which comes first.
define test_rule
$(out)/$(basename $(1)): \
    $(filter-out %/cli/gtx.o,$(call objects_of,$(call test_needs,$(call room,$(1))))) \
    $(out)/$(basename $(1)).o $(common_tests)
	$$(say) LINK $$@
	$$(Q)$$(CXX) $$(flags) $$(if $$(filter release,$$(config)),-Xlinker -S) $$(LDFLAGS) -o $$@ $$^ \
	  $$(call libs_of,$$(call test_needs,$(call room,$(1)))) \
	  $$(call pkg,--libs,cmocka) $$(libs_$(notdir $(basename $(1))))
endef
$(foreach t,$(test_sources),$(eval $(call test_rule,$(t))))
$(out)/tests/%: cflags += -Itests -D_XOPEN_SOURCE=700 $(call pkg,--cflags,cmocka)
$(out)/tests/%: cxxflags += -Itests $(call pkg,--cflags,cmocka)
$(test_bins:=.o): test_flags := $(if $(filter release,$(config)),-O1)

# The decoder of the specification stands alone: C99, no header of geotex.
$(out)/gtx_decode: format/gtx_decode.c
	@mkdir -p $(@D)
	$(say) CC $@
	$(Q)$(CC) -std=c99 $(flags) $(warnings) $(if $(filter 1,$(zstd)),,-DNO_ZSTD) -o $@ $< \
	  $(libs_asset) -lm
$(filter $(out)/tests/asset/%,$(test_bins)): | $(out)/gtx_decode
$(filter $(out)/tests/vulkan/%,$(test_bins)): | $(out)/gen/write_texts
$(filter $(out)/tests/mesh/% $(out)/tests/grid/% $(out)/tests/verbs/%,$(test_bins)): | $(modules)

build-tests: $(test_bins) $(out)/gtx_decode all

# What test programs may ask for: the command, the build folder, the compilers.
test_env = GTX=$(abspath $(command)) GTX_BUILD=$(abspath $(build)) GTX_OUT=$(abspath $(out)) \
           GTX_CONFIG=$(config) CC="$(CC)" CXX="$(CXX)" GTX_FLAGS="$(flags)" \
           GTX_DEFINES="$(if $(filter 1,$(zstd)),-DGTX_ZSTD)" GTX_LIBS="$(libs_asset) -lm"

run-tests: build-tests
	@$(test_env) tests/run $(test_bins)

# `make test-asset` builds and runs the programs of one room alone.
test-%:
	$(again) $(filter $(out)/tests/$*/%,$(test_bins)) \
	  $(if $(filter cli samples consumer corpus image web,$*),all)
	@$(test_env) tests/run $(filter $(out)/tests/$*/%,$(test_bins))

test: ## install what is missing, build, pass the tests
	$(again) deps
	$(again) -j$$(nproc) build-tests
	$(again) run-tests

check: ## every test under the sanitizers, threads under theirs, every file of the corpus
	$(again) deps
	$(again) -j$$(nproc) config=sanitize werror=1 build-tests
	@GTX_CORPUS=all $(MAKE) --no-print-directory config=sanitize run-tests
	$(again) -j$$(nproc) config=thread werror=1 test-threads

check-platforms: ## core and cooker by other compilers, for Windows, i386, arm64; core for s390x
	@tests/platforms/check.sh $(build)/platforms

# ---- the demo ------------------------------------------------------------------------------------
MODEL ?= $(build)/demo/sculpt.glb
demo: ## install what is missing, build, cook MODEL (default: the sculpt) and render the mixed scene
	$(again) deps
	$(again) -j$$(nproc) all
	$(again) run-demo

$(build)/demo/sculpt.glb: $(out)/samples/sculpt
	@mkdir -p $(@D)
	@$< $@

run-demo: $(MODEL)
	@mkdir -p $(build)/demo
	@$(build)/gtx cook $(MODEL) -o $(build)/demo/model.gtx
	@$(out)/samples/mixed_scene $(build)/demo/model.gtx --headless $(build)/demo/mixed_scene.png
	@echo $(build)/demo/mixed_scene.png

include lib/package/install.mk lib/web/web.mk lib/web/cook.mk lib/python/python.mk \
  tests/bench/bench.mk tests/fuzz/fuzz.mk

# ---- dependencies --------------------------------------------------------------------------------
packages := g++ pkg-config libopenmesh-dev libeigen3-dev libdraco-dev libtinygltf-dev \
            nlohmann-json3-dev libmeshoptimizer-dev libglfw3-dev libegl-dev libgl-dev libegl1 \
            libegl-mesa0 libgl1-mesa-dri libpng-dev libjpeg-dev libopenimageio-dev libgdal-dev \
            libnetcdf-dev libzstd-dev zlib1g-dev libcmocka-dev glslang-tools $(packages_vulkan) \
            ninja-build cmake xvfb libembree-dev python3-cffi python3-numpy python3-venv

deps: ## install the Debian packages that are missing (apt-get, with sudo when not root)
	@missing=; for p in $(packages); do \
	  dpkg-query -W -f '$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || \
	    missing="$$missing $$p"; done; \
	if [ -n "$$missing" ]; then \
	  if [ "$$(id -u)" = 0 ]; then sudo=; else sudo=sudo; fi; \
	  echo "installing:$$missing"; \
	  $$sudo apt-get update -qq && \
	  $$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
	    --no-install-recommends $$missing >/dev/null; \
	fi

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(filter %Makefile %.mk,$(MAKEFILE_LIST)) | \
	  awk -F'\t' '{printf "  make %-14s %s\n", $$1, $$2}'

clean: ## remove what was built
	rm -rf $(build)

.PHONY: all install install-strip uninstall \
        dist build-tests run-tests test check check-platforms deb demo run-demo bench run-bench \
        bench-paths run-bench-paths bench-truth run-bench-truth bench-rays run-bench-rays tune \
        bench-atlas bench-models bench-solids run-bench-solids bench-texels run-bench-texels \
        paper-tables run-paper-tables paper-figures run-paper-figures deps help clean
.SECONDARY:
.DELETE_ON_ERROR:
-include $(shell [ -d $(out) ] && find $(out) -name '*.d')
