# libgeotex-vulkan, where there are Vulkan's headers and glslang; its tests skip without a driver.
packages_vulkan := libvulkan-dev mesa-vulkan-drivers vulkan-validationlayers spirv-cross \
                   spirv-tools
vulkan := $(shell printf '\043include <vulkan/vulkan_core.h>' | $(CC) -E - >/dev/null 2>&1 && \
            command -v glslangValidator >/dev/null && echo vulkan)
needs_vulkan := base vulkan
cflags_vulkan = -Ishaders
extra_needs_vulkan = $(needs_render) host $(needs_world)
ifdef vulkan
lib_vulkan := $(out)/libgeotex-vulkan.a
so_vulkan  := $(out)/libgeotex-vulkan.so.$(VERSION)
endif
libraries := $(so_core) $(so_cook) $(lib_vulkan) $(so_vulkan) $(if $(vulkan),,no-vulkan)
no-vulkan:
	@echo '  libgeotex-vulkan is left out: it needs libvulkan-dev and glslang-tools'

# Its shaders travel inside it.
$(out)/gen/write_texts: $(out)/lib/vulkan/write_texts.o $(lib_core)
	$(Q)$(CC) $(flags) -o $@ $^ $(call libs_of,asset)
$(out)/gen/spirv.c: $(out)/gen/write_texts lib/vulkan/spirv.sh
	$(say) GEN $@
	$(Q)sh lib/vulkan/spirv.sh $< $(@D)/spirv > $@.tmp && mv $@.tmp $@
$(out)/gen/spirv.o: $(out)/gen/spirv.c | $(out)/sees/.made
	$(Q)$(CC) $(cflags) -I$(out)/sees/lib/vulkan -c $< -o $@

$(out)/libgeotex-vulkan.a: $(call objects_of,vulkan)
	$(say) AR $@
	$(Q)rm -f $@ && $(AR) qcs $@ $^

$(out)/gen/libgeotex-vulkan.map: include/geotex/vulkan.h
$(out)/libgeotex-vulkan.so.$(VERSION): $(call objects_of,$(needs_vulkan)) $(so_core) \
    | $(out)/gen/libgeotex-vulkan.map
	$(say) LINK $@
	$(Q)$(CC) $(flags) $(LDFLAGS) -shared -Wl,-soname,libgeotex-vulkan.so.$(SOVERSION) \
	  -Wl,--no-undefined -Wl,--version-script=$(out)/gen/libgeotex-vulkan.map -o $@ $^ -lm
	$(Q)ln -sf $(@F) $(out)/libgeotex-vulkan.so.$(SOVERSION) && \
	  ln -sf $(@F) $(out)/libgeotex-vulkan.so

# For engines with other interfaces: format/shaders.md.
shaders: $(out)/gen/write_texts ## shaders of all pipelines as GLSL, SPIR-V, HLSL, MSL and WGSL
	@sh lib/vulkan/products.sh $< $(build)/shaders
	@echo $(build)/shaders
install-shaders: shaders ## the same, below PREFIX
	@install -d $(to)/share/geotex/shaders
	@cp -r $(build)/shaders/* $(to)/share/geotex/shaders
