# geotex as WebAssembly: `make web` builds the npm package in build/web/geotex.
# Needs Debian's emscripten; the decoder of zstd is compiled from Debian's source package.
web := $(build)/web
web_package := $(web)/geotex
# Debian's emscripten does not find its own acorn.
emcc := NODE_PATH=/usr/share/nodejs emcc
# -Os, and -Oz where it is linked: 148.3 KB gzipped of the 150 that a page is to wait for at most.
# -Oz for all but frame and derive makes it no smaller.
web_flags := -std=c11 -Os -flto -Wall -Wextra $(if $(filter 1,$(werror)),-Werror) \
             -ffp-contract=off -fvisibility=hidden -Iinclude -Ilib -Ishaders -DGTX_BUILDING \
             -DGTX_ZSTD
# But for what absent.c stands for.
web_absent  := $(addprefix lib/frame/,compress_rows.c tiles.c project.c occlusion.c) \
               lib/render/stream.c lib/render/ahead.c
web_sources := $(filter-out $(web_absent), \
                 $(foreach r,$(ROOMS_CORE),$(wildcard lib/$(r)/*.c lib/$(r)/*/*.c)))
web_objects := $(web_sources:%.c=$(web)/%.o) $(web)/shader_sources.o
zstd_dir := $(web)/zstd/lib
# What each texel of a file goes through: 3 KB more.
$(web)/lib/asset/surface.o $(web)/lib/asset/heights.o $(web)/lib/asset/lod_filter.o \
$(web)/lib/asset/normal.o $(web)/lib/base/hash.o: web_flags += -O3 \
  -msimd128 -fno-trapping-math

# Lists of Debian's sources of our own: those of the machine stay as they are.
apt_source := apt-get -qq -o Dir::Etc::SourceList=$$PWD/sources.list \
              -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists=$$PWD/lists \
              -o APT::Sandbox::User=root
$(web)/zstd/.fetched:
	$(say) FETCH $(@D)
	$(Q)rm -rf $(@D) && mkdir -p $(@D)/lists/partial && cd $(@D) && \
	  echo 'deb-src http://deb.debian.org/debian bookworm main' > sources.list && \
	  $(apt_source) update && $(apt_source) source --download-only libzstd && \
	  tar xf libzstd_*.orig.tar.xz --strip-components=1 && touch .fetched

$(web)/zstd.o: $(web)/zstd/.fetched lib/web/web.mk
	$(say) EMCC $@
	$(Q)$(emcc) -O2 -DZSTD_DISABLE_ASM=1 -DDEBUGLEVEL=0 -DZSTD_STRIP_ERROR_STRINGS \
	  -DHUF_FORCE_DECOMPRESS_X1 -DZSTD_FORCE_DECOMPRESS_SEQUENCES_SHORT \
	  -I$(zstd_dir) -I$(zstd_dir)/common -r -o $@ $(zstd_dir)/common/entropy_common.c \
	  $(addprefix $(zstd_dir)/common/,error_private.c fse_decompress.c xxhash.c zstd_common.c) \
	  $(addprefix $(zstd_dir)/decompress/,huf_decompress.c zstd_ddict.c zstd_decompress.c \
	    zstd_decompress_block.c)

$(web)/shader_sources.c: $(shaders) lib/web/shaders.mjs
	@mkdir -p $(@D)
	$(Q)node lib/web/shaders.mjs $(shaders) > $@
$(web)/shader_sources.o: $(web)/shader_sources.c
	$(Q)$(emcc) $(web_flags) -c $< -o $@
$(web)/%.o: %.c $(web)/zstd/.fetched
	@mkdir -p $(@D)
	$(say) EMCC $<
	$(Q)$(emcc) $(web_flags) -I$(zstd_dir) -MMD -MP -c $< -o $@

# An archive: what nothing calls, such as encoding, stays out.
$(web)/core.a: $(web_objects)
	$(Q)rm -f $@ && emar qcs $@ $^
comma := ,
space := $() $()
web_methods := GL HEAPU8 HEAPU32 HEAPF32 HEAPF64 UTF8ToString stringToUTF8 lengthBytesUTF8
# Of the stack web-test needs less than 64 KB (-sSTACK_OVERFLOW_CHECK=2).
web_faces := $(patsubst %.c,$(web)/%.o,$(wildcard lib/web/*.c))
$(web_package)/core.js: $(web_faces) $(web)/core.a $(web)/zstd.o
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(emcc) -Oz --closure 0 -o $@ $^ --no-entry \
	  -sMODULARIZE=1 -sEXPORT_ES6=1 -sENVIRONMENT=web,worker -sFILESYSTEM=0 -sMALLOC=emmalloc \
	  -sMIN_WEBGL_VERSION=2 -sMAX_WEBGL_VERSION=2 -sALLOW_MEMORY_GROWTH=1 \
	  -sINITIAL_MEMORY=512KB -sMEMORY_GROWTH_GEOMETRIC_STEP=0.05 -sTOTAL_STACK=128KB \
	  -sGL_SUPPORT_AUTOMATIC_ENABLE_EXTENSIONS=0 -sGL_TRACK_ERRORS=0 -sGL_POOL_TEMP_BUFFERS=0 \
	  -sTEXTDECODER=2 -sSUPPORT_ERRNO=0 -sINCOMING_MODULE_JS_API=[locateFile] \
	  -sEXPORTED_RUNTIME_METHODS=$(subst $(space),$(comma),$(web_methods)) \
	  -sEXPORTED_FUNCTIONS=_malloc,_free

$(web_package)/%: lib/web/%
	@mkdir -p $(@D)
	$(Q)cp $< $@
# Without comments and indentation, 3 KB of what a page waits for: types tell what is there.
$(web_package)/%.js: lib/web/%.js lib/web/web.mk
	@mkdir -p $(@D)
	$(Q)sed -e '/^ *\/\*.*\*\/ *$$/d' -e '/^ *\/\*/,/\*\/ *$$/d' -e 's/^ *//' $< > $@
$(web_package)/LICENSE: LICENSE
	@mkdir -p $(@D)
	$(Q)cp $< $@

web_glue := geotex.js inside.js load.js state.js upload.js worker.js workshop.js
web_three := bridge.js three.js world.js tiles.js
web_files := core.js $(web_glue) $(web_three) package.json README.md LICENSE \
             $(addsuffix .d.ts,geotex load three world tiles)
web: $(web_files:%=$(web_package)/%) ## the npm package geotex, as WebAssembly (needs emscripten)
	@cd $(web_package) && echo "$$PWD: $$(cat core.wasm core.js $(web_glue) | gzip -9 | wc -c)" \
	  "bytes of core and glue, gzipped"

# A project as a page's author has it: installs the package, checks its types, is built by Vite.
web_app := $(web)/app/.built
$(web_app): $(web_files:%=$(web_package)/%) $(wildcard tests/web/app/*)
	$(say) NPM $(@D)
	$(Q)rm -rf $(@D) && cp -r tests/web/app $(@D) && cd $(@D) && \
	  npm pack --silent ../geotex >/dev/null && \
	  if npm install --silent --no-fund --no-audit --fetch-retries=1 ./geotex-$(VERSION).tgz; then \
	    npm run --silent build && touch $(@F); \
	  else echo "  npm's registry does not answer: the tests of web are skipped"; fi

# Among all tests, where there is what it takes.
build-tests: $(if $(and $(shell command -v emcc),$(shell command -v npm)),web-app)
web-app: | $(filter web,$(MAKECMDGOALS)) # one make at a time links the core
	$(Q)if $(MAKE) --no-print-directory $(web)/zstd/.fetched; then \
	  $(MAKE) --no-print-directory $(web_app); \
	else echo "  sources of zstd cannot be had: the tests of web are skipped"; fi

web-deps: ## install the Debian packages of the web's tests that are missing
	$(again) deps packages="xz-utils $(if $(shell command -v emcc),,emscripten) \
	  $(if $(shell command -v chromium),,chromium) $(if $(shell command -v npm),,npm)"

web-test: | $(filter web-cook,$(MAKECMDGOALS))
web-test: web ## the package in a real Chromium (needs chromium, node and npm's registry)
	$(Q)rm -f $(web_app)
	$(again) $(web_app)
	$(again) test-web

# Of what there is: the dragon and the bunny of GEOTEX_MODELS. Nexus is compared where NEXUS is a
# checkout of github.com/cnr-isti-vclab/nexus, built by CMake in NEXUS/build.
web_models := dragon_810k_loop_q14 bunny
nxs := QT_QPA_PLATFORM=offscreen $(NEXUS)/build/src
bench-web: web-test ## .gtx beside Draco and meshopt at 10 Mbit/s (needs GEOTEX_MODELS too)
	$(Q)mkdir -p $(web)/bench && for m in $(web_models); do b=$(web)/bench/$$m; \
	  cp -f $(GEOTEX_MODELS)/draco/$$m.drc $$b.drc && $(build)/gtx cook -q $$b.drc -o $$b.gtx && \
	  node tests/web/meshopt.mjs $(web)/app $$b.drc $$b.obj && \
	  npx --yes gltfpack@1.3.0 -i $$b.obj -o $$b.glb -cc -vp 14 || exit 1; \
	  $(if $(NEXUS),$(nxs)/nxsbuild/nxsbuild $$b.obj -o $$b.nxs >/dev/null && \
	    $(nxs)/nxsedit/nxscompress $$b.nxs -o $$b.nxz >/dev/null || exit 1;) done
	$(if $(NEXUS),$(Q)mkdir -p $(web)/bench/nexus && \
	  cp $(NEXUS)/nexus3d/src/*.js $(web)/bench/nexus && \
	  cp $(NEXUS)/nexus3d/dist/corto.em.js $(web)/bench/nexus/corto.worker.js)
	$(Q)node tests/web/bench.mjs $(web)/app $(web)/bench $(web_models)
.PHONY: web web-app web-deps web-test bench-web
-include $(wildcard $(web)/lib/*/*.d $(web)/lib/*/*/*.d)
