# Installation: exactly the files of lib/package/files, below PREFIX; and the source archive.
fill = sed -e 's|@PREFIX@|$(PREFIX)|g' -e 's|@VERSION@|$(VERSION)|g' \
  -e 's|@SOVERSION@|$(SOVERSION)|g' -e 's|@CORE_LIBS@|$(call libs_of,asset)|g' \
  -e 's|@COOK_LIBS@|$(call libs_of,mesh)|g'
verbs := cook horizons world info validate unpack pack export filter combine render view compare \
  bench
to    := $(DESTDIR)$(PREFIX)

$(out)/gen/gtx.1: lib/package/gtx.1.in lib/package/verbs.awk $(command)
	@mkdir -p $(@D)
	$(Q){ sed '/@VERBS@/,$$d' $<; for verb in $(verbs); do $(command) $$verb --help; done | \
	  awk -f lib/package/verbs.awk; sed '1,/@VERBS@/d' $<; } | $(fill) > $@

install: all $(out)/gen/gtx.1 ## libraries, headers, command, shaders, manual: below PREFIX
	@install -d $(to)/bin $(to)/include/geotex $(to)/lib/geotex $(to)/lib/pkgconfig \
	  $(to)/lib/cmake/geotex $(to)/share/geotex/shaders $(to)/share/doc/geotex \
	  $(to)/share/man/man1 $(to)/share/bash-completion/completions
	@install -m 755 $(command) $(to)/bin
	@install -m 644 include/geotex/*.h $(to)/include/geotex
	@install -m 644 $(lib_core) $(lib_cook) $(lib_vulkan) $(to)/lib
	@install -m 755 $(so_core) $(so_cook) $(so_vulkan) $(to)/lib
	@for so in libgeotex.so libgeotex-cook.so $(if $(vulkan),libgeotex-vulkan.so); do \
	  ln -sf $$so.$(VERSION) $(to)/lib/$$so.$(SOVERSION); ln -sf $$so.$(SOVERSION) $(to)/lib/$$so; done
	@install -m 755 $(modules) $(to)/lib/geotex
	@for pc in geotex geotex-cook $(if $(vulkan),geotex-vulkan); do \
	  $(fill) lib/package/$$pc.pc.in > $(to)/lib/pkgconfig/$$pc.pc; done
	@for cmake in geotexConfig geotexConfigVersion; do \
	  $(fill) lib/package/$$cmake.cmake.in > $(to)/lib/cmake/geotex/$$cmake.cmake; done
	@install -m 644 $(shaders) $(to)/share/geotex/shaders
	@install -m 644 README.md LICENSE $(filter-out %.gtx,$(wildcard format/*)) $(to)/share/doc/geotex
	@install -m 644 $(out)/gen/gtx.1 $(to)/share/man/man1
	@install -m 644 lib/package/gtx.bash $(to)/share/bash-completion/completions/gtx

# Debugging data is nine tenths of the shared libraries and more of the command.
install-strip: install ## the same, without debugging data
	@strip --strip-unneeded $(to)/bin/gtx $(to)/lib/libgeotex.so.$(VERSION) \
	  $(patsubst $(out)/%,$(to)/lib/%,$(so_cook) $(so_vulkan) $(modules:$(out)/%=$(out)/geotex/%))
	@strip --strip-debug $(patsubst $(out)/%,$(to)/lib/%,$(lib_core) $(lib_cook) $(lib_vulkan))

uninstall: ## remove what install put there
	@cd $(to) && rm -f $$(cat $(abspath lib/package/files)) share/geotex/shaders/pipelines.json && \
	  rm -rf $(addprefix share/geotex/shaders/,glsl spirv hlsl msl wgsl) && \
	  rmdir --ignore-fail-on-non-empty -p include/geotex lib/geotex lib/cmake/geotex lib/pkgconfig \
	    share/geotex/shaders share/doc/geotex share/man/man1 share/bash-completion/completions \
	    bin 2>/dev/null || true

# What an engine links, as one C11 source and two headers: nothing else to build or to install.
drop := $(build)/amalgamation
drop_sources := $(foreach r,$(ROOMS_CORE),$(wildcard lib/$(r)/*.c lib/$(r)/*/*.c)) \
                $(out)/gen/shader_sources.c
drop_headers := $(wildcard lib/*/*.h lib/*/*/*.h lib/*/*.def shaders/*.glsl)
# $(call drop_head,WHAT): its first lines.
drop_head = { echo '/* geotex $(VERSION), $(1)'; echo ' *'; sed 's/^/ * /; s/ *$$//' LICENSE; \
              echo ' */'; }
drop_sources_made = $(drop)/geotex.c $(if $(vulkan),$(drop)/geotex_vulkan.c)
build-tests: $(drop_sources_made)
amalgamation: $(drop_sources_made) ## geotex.c, .h, GL's and Vulkan's faces, to drop into an engine
	@echo $(drop)

$(drop)/geotex.h: $(foreach h,geotex edit solid stream view frame rays,include/geotex/$(h).h) \
    lib/package/install.mk LICENSE
	@mkdir -p $(@D)
	$(Q){ $(call drop_head,all of its headers but OpenGL); \
	  sed '/^#include <geotex/d' $(filter %.h,$^); } > $@
$(drop)/geotex_gl.h: include/geotex/render.h LICENSE
	@mkdir -p $(@D)
	$(Q){ $(call drop_head,drawing with OpenGL); \
	  sed 's/^#include <geotex.*/#include "geotex.h"/' $<; } > $@
$(drop)/geotex.c: lib/package/amalgamate.awk $(drop_sources) $(drop_headers) $(drop)/geotex.h \
    $(drop)/geotex_gl.h
	$(say) GEN $@
	$(Q){ $(call drop_head,all of its sources. Compile as C11; -DGTX_ZSTD reads compressed \
	    sections (zstd). Needs libm.); \
	  echo '#define _POSIX_C_SOURCE 200809L'; echo '#define GTX_BUILDING'; \
	  echo '#include "geotex_gl.h"'; echo '#ifdef __clang__'; \
	  echo '#pragma clang diagnostic ignored "-Wunused-function" /* inline ones of headers */'; \
	  echo '#endif'; awk -f $< $(drop_sources); } > $@.tmp && mv $@.tmp $@

# Drawing with Vulkan beside it, its SPIR-V inside; where there is glslang.
drop_vulkan := $(filter-out %/write_texts.c,$(wildcard lib/vulkan/*.c)) $(out)/gen/spirv.c
$(drop)/geotex_vulkan.h: include/geotex/vulkan.h LICENSE
	@mkdir -p $(@D)
	$(Q){ $(call drop_head,drawing with Vulkan); \
	  sed 's/^#include <geotex.*/#include "geotex.h"/' $<; } > $@
$(drop)/geotex_vulkan.c: lib/package/amalgamate.awk $(drop_vulkan) $(drop_headers) \
    $(drop)/geotex_vulkan.h
	$(say) GEN $@
	$(Q){ $(call drop_head,drawing with Vulkan. Compile as C11 beside geotex.c.); \
	  echo '#define GTX_BUILDING'; echo '#include "geotex_vulkan.h"'; \
	  awk -f $< $(drop_vulkan); } > $@.tmp && mv $@.tmp $@

# The same bytes from the same commit, wherever and whenever.
dist_name := geotex-$(VERSION)
dist: ## the committed sources as build/geotex-VERSION.tar.gz
	@mkdir -p $(build)
	@git -c tar.umask=0022 archive --format=tar --prefix=$(dist_name)/ HEAD > $(build)/$(dist_name).tar
	@gzip -9nf $(build)/$(dist_name).tar
	@echo $(build)/$(dist_name).tar.gz

deb: dist ## Debian packages of the committed sources in build/deb (needs debhelper)
	@sh lib/package/deb.sh $(build) $(VERSION) '$(packages)'
	@ls $(build)/deb/*.deb
