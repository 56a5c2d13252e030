# The cooker as WebAssembly: `make web-cook` adds it to the package, as a module of its own. It
# takes some six minutes of processor, so that nothing else asks for it. What it needs of OpenMesh,
# Draco, meshoptimizer, zlib and zstd is compiled from Debian's source packages.
cook_web := $(web)/cook
cook_src := $(cook_web)/src
emxx := NODE_PATH=/usr/share/nodejs em++
cook_debian := openmesh draco meshoptimizer zlib libzstd
# Draco's build would write a list of all that it can; this can read.
cook_features := POINT_CLOUD_COMPRESSION MESH_COMPRESSION NORMAL_ENCODING STANDARD_EDGEBREAKER \
                 PREDICTIVE_EDGEBREAKER BACKWARDS_COMPATIBILITY ATTRIBUTE_INDICES_DEDUPLICATION \
                 ATTRIBUTE_VALUES_DEDUPLICATION
$(cook_src)/.fetched:
	$(say) FETCH $(@D)
	$(Q)rm -rf $(@D) && mkdir -p $(@D)/lists/partial $(@D)/of_machine && cd $(@D) && \
	  echo 'deb-src http://deb.debian.org/debian bookworm main' > sources.list && \
	  $(apt_source) update && $(apt_source) source --download-only $(cook_debian) && \
	  for p in $(cook_debian); do mkdir $$p && \
	    tar xf $$(ls $${p}_*.orig.tar.*[z2]) -C $$p --strip-components=1 || exit 1; done && \
	  for f in $(cook_features); do echo "#define DRACO_$${f}_SUPPORTED"; done \
	    > draco/src/draco/draco_features.h && \
	  ln -s /usr/include/nlohmann /usr/include/GL /usr/include/tiny_gltf.h of_machine && touch .fetched

# Exceptions are WebAssembly's own: through JavaScript each call that might throw would cost.
cook_flags := -O2 -ffp-contract=off -fvisibility=hidden -fwasm-exceptions -DEIGEN_DONT_VECTORIZE \
              $(patsubst %,-isystem $(cook_src)/%,openmesh/src draco/src meshoptimizer/src zlib \
                libzstd/lib of_machine) -isystem /usr/include/eigen3
cook_own := -Wall -Wextra $(if $(filter 1,$(werror)),-Werror) -DGTX_BUILDING -DGTX_ZSTD \
            -Iinclude -Ilib -Ishaders -MMD -MP
cook_others := -w -DZSTD_DISABLE_ASM=1 -DDEBUGLEVEL=0 -DXXH_NAMESPACE=ZSTD_

# What is not here, or is there but cannot do anything in a browser, stands in absent.cpp.
cook_absent := %/module.cpp lib/image/png_jpeg/% %/geotex_netcdf.c %/netcdf4.cpp lib/image/open.c \
               lib/cook/driver.cpp
cook_sources := $(filter-out $(cook_absent),$(foreach r,image mesh grid chart bake measure cook, \
                  $(wildcard lib/$(r)/*.c* lib/$(r)/*/*.c*))) $(wildcard lib/web/cook/*.c*) \
                  lib/frame/compress_rows.c # which a page's core does without
cook_objects := $(patsubst %,$(cook_web)/%.o,$(basename $(cook_sources)))
$(cook_web)/lib/%.o: lib/%.cpp $(cook_src)/.fetched
	@mkdir -p $(@D)
	$(say) EMXX $<
	$(Q)$(emxx) -std=c++17 $(cook_flags) $(cook_own) -c $< -o $@
$(cook_web)/lib/%.o: lib/%.c $(cook_src)/.fetched
	@mkdir -p $(@D)
	$(say) EMCC $<
	$(Q)$(emcc) -std=c11 $(cook_flags) $(cook_own) -c $< -o $@

of = $(foreach f,$(2),$(cook_web)/src/$(strip $(1))/$(f).o)
draco := draco/src/draco
cook_parts := \
  $(call of, openmesh/src/OpenMesh/Core, Mesh/ArrayKernel Mesh/BaseKernel Mesh/PolyConnectivity \
    Mesh/TriConnectivity System/omstream Utils/BaseProperty) \
  $(call of, meshoptimizer/src, allocator indexcodec vertexcodec vertexfilter) \
  $(call of, zlib, adler32 crc32 inffast inflate inftrees zutil) \
  $(call of, libzstd/lib/common, debug entropy_common error_private fse_decompress pool threading \
    xxhash zstd_common) \
  $(call of, libzstd/lib/compress, fse_compress hist huf_compress zstd_compress \
    zstd_compress_literals zstd_compress_sequences zstd_compress_superblock zstd_double_fast \
    zstd_fast zstd_lazy zstd_ldm zstd_opt) \
  $(call of, libzstd/lib/decompress, huf_decompress zstd_ddict zstd_decompress \
    zstd_decompress_block) \
  $(call of, $(draco)/attributes, attribute_octahedron_transform attribute_quantization_transform \
    attribute_transform geometry_attribute point_attribute) \
  $(call of, $(draco)/compression, decode entropy/symbol_decoding) \
  $(call of, $(draco)/compression/attributes, attributes_decoder kd_tree_attributes_decoder \
    sequential_attribute_decoder sequential_attribute_decoders_controller \
    sequential_integer_attribute_decoder sequential_normal_attribute_decoder \
    sequential_quantization_attribute_decoder) \
  $(call of, $(draco)/compression/bit_coders, adaptive_rans_bit_decoder direct_bit_decoder \
    rans_bit_decoder symbol_bit_decoder) \
  $(call of, $(draco)/compression/mesh, mesh_decoder mesh_edgebreaker_decoder \
    mesh_edgebreaker_decoder_impl mesh_sequential_decoder) \
  $(call of, $(draco)/compression/point_cloud, point_cloud_decoder point_cloud_kd_tree_decoder \
    point_cloud_sequential_decoder) \
  $(call of, $(draco)/core, bit_utils bounding_box data_buffer decoder_buffer divide draco_types \
    options quantization_utils status) \
  $(call of, $(draco), mesh/corner_table mesh/mesh mesh/mesh_attribute_corner_table \
    metadata/geometry_metadata metadata/metadata metadata/metadata_decoder point_cloud/point_cloud)
# Their sources are there once they are fetched: by one rule, whatever their names end in.
$(cook_parts): $(cook_web)/src/%.o: $(cook_src)/.fetched
	$(say) EMXX $*
	$(Q)f=$$(ls $(cook_src)/$*.c*); case $$f in *.c) how='emcc';; *) how='em++ -std=c++17';; esac; \
	  NODE_PATH=/usr/share/nodejs $$how $(cook_flags) $(cook_others) -c $$f -o $@

cook_methods := HEAPU8 UTF8ToString stringToUTF8 lengthBytesUTF8
$(cook_web)/core.a: $(cook_objects) $(cook_parts)
	$(Q)rm -f $@ && emar qcs $@ $^
$(web_package)/cooker.js: $(cook_web)/lib/web/cook/cook.o $(cook_web)/core.a $(web)/core.a
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(emxx) -O3 -fwasm-exceptions -o $@ $^ --no-entry \
	  -sMODULARIZE=1 -sEXPORT_ES6=1 -sENVIRONMENT=worker -sALLOW_MEMORY_GROWTH=1 \
	  -sINITIAL_MEMORY=32MB -sMAXIMUM_MEMORY=2GB -sTOTAL_STACK=4MB \
	  -sINCOMING_MODULE_JS_API=[locateFile] \
	  -sEXPORTED_RUNTIME_METHODS=$(subst $(space),$(comma),$(cook_methods)) \
	  -sEXPORTED_FUNCTIONS=_malloc,_free

cook_files := cooker.js cook.js cook-worker.js cook.d.ts
web-cook: web $(cook_files:%=$(web_package)/%) ## the package with a cooker (needs minutes)
	@cd $(web_package) && echo "$$PWD: $$(cat cooker.wasm cooker.js cook.js cook-worker.js | \
	  gzip -9 | wc -c) bytes of the cooker, gzipped"
.PHONY: web-cook
-include $(wildcard $(cook_web)/lib/*/*.d $(cook_web)/lib/*/*/*.d)
