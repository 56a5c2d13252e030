# Modules: shared libraries that hold one of others, opened when something asks for them. Without
# GDAL there is no grid module, and its tests skip.
gdal    := $(shell pkg-config --exists gdal libtiff-4 && echo grid)
modules := $(patsubst %,$(out)/geotex-%.so,image $(gdal))

# They are looked for beside the program that asks: links for those that lie elsewhere.
module_image := OpenImageIO
module_grid  := gdal libtiff-4
$(modules): $(out)/geotex-%.so: lib/%/module.cpp lib/%/module.h Makefile | $(out)/sees/.made
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(CXX) $(cxxflags) $(call room_flags,$<) $(CXXFLAGS) $(LDFLAGS) -shared -o $@ $< \
	  $(call pkg,--libs,$(module_$*))
	$(Q)for d in $(out)/samples $(sort $(dir $(test_bins))); do \
	  mkdir -p $$d && ln -sf $(abspath $@) $$d; done
