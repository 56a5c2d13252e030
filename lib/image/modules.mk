# Modules: shared libraries that hold some of others, opened when something asks for them; and a
# program, run for one that may crash. Without GDAL or NetCDF they are not there, and tests skip.
netcdf  := $(shell pkg-config --exists netcdf && echo $(out)/geotex-netcdf)
gdal    := $(shell pkg-config --exists gdal libtiff-4 && echo grid)
modules := $(patsubst %,$(out)/geotex-%.so,image png-jpeg $(gdal)) $(netcdf)

# They are looked for beside the program that asks: links for those that lie elsewhere.
module_image := OpenImageIO
module_grid  := gdal libtiff-4
link_beside = $(Q)for d in $(out)/samples $(out)/tests/bench $(sort $(dir $(test_bins))); do \
	  mkdir -p $$d && ln -sf $(abspath $@) $$d; done
$(patsubst %,$(out)/geotex-%.so,image $(gdal)): $(out)/geotex-%.so: lib/%/module.cpp \
    lib/%/module.h Makefile | $(out)/sees/.made
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(CXX) $(cxxflags) $(call room_flags,$<) $(CXXFLAGS) $(LDFLAGS) -shared -o $@ $< \
	  $(call pkg,--libs,$(module_$*))
	$(link_beside)

png_jpeg := $(wildcard lib/image/png_jpeg/*.c)
$(out)/geotex-png-jpeg.so: $(png_jpeg) lib/image/png_jpeg/codec.h lib/image/module.h Makefile \
    | $(out)/sees/.made
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(CC) $(cflags) -D_POSIX_C_SOURCE=200809L -I$(call path_of,lib/image/image.c) \
	  $(call pkg,--cflags,libpng libjpeg) $(CFLAGS) $(LDFLAGS) -shared -o $@ $(png_jpeg) \
	  $(call pkg,--libs,libpng libjpeg)
	$(link_beside)

# Its memory is limited by addresses, which sanitizers take all of.
$(netcdf): lib/grid/geotex_netcdf.c Makefile
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(CC) -std=c11 -O2 -g $(warnings) -Wpedantic -D_XOPEN_SOURCE=700 $(call pkg,--cflags,netcdf) \
	  $(CFLAGS) $(LDFLAGS) -o $@ $< $(call pkg,--libs,netcdf)
	$(link_beside)
