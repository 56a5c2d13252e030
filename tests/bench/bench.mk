# Benchmarks: frame times, rays, and the paper's tables and figures.
bench: ## frame times of MODEL (default: the sculpt) by every method; BENCH="--instances 1,10"
	$(again) deps
	$(again) -j$$(nproc) all
	$(again) run-bench

run-bench: $(MODEL)
	@mkdir -p $(build)/demo
	@$(build)/gtx cook $(MODEL) --lod-levels 5 -o $(build)/demo/bench.gtx
	@$(build)/gtx bench $(build)/demo/bench.gtx $(MODEL) --min-iou 0.99 $(BENCH)

# Paths are files of tests/bench/paths, SCENE or SCENE_NAME; a scene is what model_SCENE was cooked
# to. Of reek the four horizons are one asset, as given and as resampled for the paper's Figure 9.
reek_files   = 1_topreek_rota.gri 1_midreek_rota.gri 1_lowreek_rota.gri 1_basereek_rota.gri
reek_grids   = $(reek_files:%=$(GEOTEX_MODELS)/heightfields/reek/%)
model_andes  = $(GEOTEX_MODELS)/draco/andes_S33W071_2880k_q16.drc
model_dragon = $(GEOTEX_MODELS)/draco/dragon_810k_loop_q14.drc
model_reek  := $(build)/paths/reek.ply
fine_folder  = $(GEOTEX_MODELS)/heightfields/reek_1588x1188
fine_grids   = $(foreach h,0_top 1_mid 2_low 3_base,$(fine_folder)/$(h)reek_rota_z16.png)
fine_options = --depths --range 1547.1962890625,1976.0126953125 --spacing 6.969124,7.58214
model_horizons := $(build)/paths/horizons.ply
model_hall  := $(build)/paths/hall.glb
model_cave  := $(build)/paths/cave.glb
scene_of     = $(firstword $(subst _, ,$(1)))
own_paths   := cave hall
PATHS       ?= $(if $(GEOTEX_MODELS),$(sort $(notdir $(wildcard tests/bench/paths/*))),$(own_paths))
bench-paths: ## frame times from inside and on surfaces, along PATHS of tests/bench/paths
	$(again) deps
	$(again) -j$$(nproc) all $(out)/tests/bench/grid_mesh $(out)/samples/sculpt
	$(again) run-bench-paths

run-bench-paths: $(foreach p,$(PATHS),$(model_$(call scene_of,$(p))) \
                   $(build)/paths/$(call scene_of,$(p)).gtx)
	@$(foreach p,$(PATHS),echo "$(p)" && $(build)/gtx bench \
	  $(build)/paths/$(call scene_of,$(p)).gtx $(model_$(call scene_of,$(p))) \
	  --path tests/bench/paths/$(p) -q $(BENCH) &&) true

$(build)/paths/hall.glb $(build)/paths/cave.glb: $(build)/paths/%.glb: $(out)/samples/sculpt
	@mkdir -p $(@D)
	@$< --shape $* $@

$(build)/paths/reek.ply: $(out)/tests/bench/grid_mesh
	@mkdir -p $(@D)
	@$< $@ --depths $(reek_grids)

$(build)/paths/horizons.ply: $(out)/tests/bench/grid_mesh
	@mkdir -p $(@D)
	@$< $@ $(fine_options) $(fine_grids)

$(build)/paths/horizons.gtx: $(command)
	@mkdir -p $(@D)
	@$(build)/gtx horizons $(fine_grids) $(fine_options) --missing 0 -o $@

$(build)/paths/reek.gtx: $(command)
	@mkdir -p $(@D)
	@$(build)/gtx horizons $(reek_grids) --depths --lod-levels 5 -o $@

$(build)/paths/hall.gtx $(build)/paths/cave.gtx: $(build)/paths/%.gtx: $(build)/paths/%.glb
$(build)/paths/%.gtx: $(command)
	@mkdir -p $(@D)
	@$(build)/gtx cook $(model_$*) --lod-levels 5 --if-changed -q -o $@

model_bunny     = $(GEOTEX_MODELS)/scans/bunny.ply
model_armadillo = $(GEOTEX_MODELS)/scans/armadillo_86k.obj.gz
model_cooked   := $(MODEL)
TRUTH       ?= $(if $(GEOTEX_MODELS),bunny armadillo dragon andes,cooked)
truth_sizes := 100x100,200x200,400x400,640x480,1280x1024
bench-truth: ## how near pictures are to the mesh at 8x8 samples a pixel; TRUTH=dragon, or of MODEL
	$(again) deps
	$(again) -j$$(nproc) all
	$(again) run-bench-truth

run-bench-truth: $(foreach m,$(TRUTH),$(model_$(m)) $(build)/paths/$(m).gtx)
	@$(foreach m,$(TRUTH),$(build)/gtx bench $(build)/paths/$(m).gtx $(model_$(m)) --truth -q \
	  --frames 1 --sizes $(truth_sizes) --methods mesh,simplified,cast,lod,auto $(BENCH) &&) true

ATLAS        ?= $(addprefix $(GEOTEX_MODELS)/scans/,bunny.ply armadillo_86k.obj.gz horse.ply.gz \
                  gargo_3dhop.ply.gz nefertiti.obj.gz)
ATLAS_PYTHON ?= python3
bench-atlas: ## exports of ATLAS beside the same triangles unwrapped and baked by xatlas
	$(again) deps
	$(again) -j$$(nproc) all
	@$(ATLAS_PYTHON) tests/bench/atlas.py $(build)/gtx $(ATLAS)

MODELS ?= $(addprefix $(GEOTEX_MODELS)/,gltf textured)
bench-models: ## walls, holes, bytes and seconds of MODELS (files or folders), cooked with COOK
	$(again) deps
	$(again) -j$$(nproc) all
	@python3 tests/bench/models.py $(build)/gtx $(COOK) $(MODELS)

bench-rays: ## rays a second into MODEL (default: the sculpt), and what shadows by ray cost a frame
	$(again) deps
	$(again) -j$$(nproc) all $(out)/tests/bench/rays
	$(again) run-bench-rays

run-bench-rays: $(MODEL)
	@mkdir -p $(build)/demo
	@$(build)/gtx cook $(MODEL) -o $(build)/demo/rays.gtx
	@$(out)/tests/bench/rays $(build)/demo/rays.gtx

bench-plan: ## what planning a frame of MODEL (default: the sculpt) costs, without drawing it
	$(again) deps
	$(again) -j$$(nproc) all $(out)/tests/bench/plan
	$(again) run-bench-plan

run-bench-plan: $(MODEL)
	@mkdir -p $(build)/demo
	@$(build)/gtx cook $(MODEL) -o $(build)/demo/plan.gtx
	@$(out)/tests/bench/plan $(build)/demo/plan.gtx

bunny := $(wildcard $(GEOTEX_MODELS)/scans/bunny.ply)
# The bunny, closed, and a ball. With CGAL (libcgal-dev) beside the same operations on the meshes.
cgal = $(shell printf '\043include <CGAL/version.h>' | \
         $(CXX) $(CXXFLAGS) -E -x c++ - >/dev/null 2>&1 && echo -lmpfr -lgmp)
bench-solids: ## the bunny, or MODEL, combined with a ball: volumes beside CGAL's, if it is there
	$(again) deps
	$(again) -j$$(nproc) all $(out)/tests/bench/solids
	$(again) run-bench-solids

run-bench-solids: $(if $(bunny),,$(MODEL))
	@mkdir -p $(build)/paper
	@$(out)/tests/bench/solids $(build)/paper $(or $(bunny),$(MODEL))

# Models with textures.
TEXTURED ?= $(if $(GEOTEX_MODELS),$(wildcard $(GEOTEX_MODELS)/textured/*.glb) \
              $(addprefix $(GEOTEX_MODELS)/,$(duck) $(truck)),$(MODEL))
bench-texels: ## what texels as fine as textures cost and show, of TEXTURED
	$(again) deps
	$(again) -j$$(nproc) all $(out)/tests/bench/texels
	$(again) run-bench-texels

run-bench-texels: $(filter $(build)/demo/%,$(TEXTURED))
	@mkdir -p $(build)/paper
	@$(out)/tests/bench/texels $(build)/paper $(TEXTURED)

# Models and their charts: the paper's bunny, and MODEL (without the bunny: the sculpt).
CHARTS ?= 0
more_models  = $(if $(bunny),$(filter-out $(build)/demo/sculpt.glb,$(MODEL)),$(MODEL))
table_models = $(if $(bunny),$(bunny) 222) \
               $(foreach model,$(leaf) $(more_models),$(model) $(CHARTS))
leaf := $(build)/demo/leaf.ply
paper-tables: ## the paper's Tables 2 and 3 of the bunny, a leaf and MODEL, by all partitions
	$(again) deps
	$(again) -j$$(nproc) all $(out)/tests/bench/paper_tables $(out)/tests/bench/leaves
	$(again) run-paper-tables

$(leaf): $(out)/tests/bench/leaves
	@mkdir -p $(@D)
	@$< $@ 1

run-paper-tables: $(filter $(build)/demo/%,$(table_models))
	@mkdir -p $(build)/demo $(build)/paper
	@$(out)/tests/bench/paper_tables $(build)/paper $(table_models)
	@tests/bench/frames $(build)/gtx $(build)/paper $(filter-out 222 $(CHARTS),$(table_models))

# A figure is a program tests/bench/NAME.cpp that measures, prints, and writes NAME.json and
# NAME.svg; what it takes besides the folder is arguments_NAME.
figures := figure2 figure7 figure9
reek    := $(wildcard $(GEOTEX_MODELS)/heightfields/reek_1588x1188)
arguments_figure7 = $(MODEL)
arguments_figure9 := $(or $(reek),own)
bench_objects := $(addprefix $(out)/lib/cli/,bench/bench.o bench/camera.o bench/floor.o \
                   bench/mesh.o bench/parts.o bench/picture.o bench/scene.o bench/shading.o \
                   bench/truth.o view/polygons.o message.o options.o)
paper-figures: ## the paper's figures of frame rates: tables, JSON and curves in build/paper
	$(again) deps
	$(again) -j$$(nproc) all $(figures:%=$(out)/tests/bench/%)
	$(again) run-paper-figures

run-paper-figures: $(MODEL)
	@mkdir -p $(build)/demo $(build)/paper
	@$(foreach f,$(figures),$(out)/tests/bench/$(f) $(build)/paper $(arguments_$(f)) &&) true

$(figures:%=$(out)/tests/bench/%): $(out)/tests/bench/%: $(out)/tests/bench/%.o \
    $(out)/tests/bench/figure.o \
    $(bench_objects) $(call objects_of,host image) $(lib_cook) $(lib_core) | $(modules)
	$(say) LINK $@
	$(Q)ln -sf $(abspath $(modules)) $(@D)
	$(Q)$(CXX) $(flags) -o $@ $^ $(call libs_of,asset mesh host image) -lmeshoptimizer

$(out)/tests/bench/paper_tables: $(out)/tests/bench/paper_tables.o \
    $(out)/tests/bench/equal_texels.o $(lib_cook) $(lib_core)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) -o $@ $^ $(call libs_of,asset mesh)

$(out)/tests/bench/texels: $(out)/tests/bench/texels.o $(call objects_of,image) $(lib_cook) \
    $(lib_core) | $(modules)
	$(say) LINK $@
	$(Q)ln -sf $(abspath $(modules)) $(@D)
	$(Q)$(CXX) $(flags) -o $@ $^ $(call libs_of,asset mesh image)

$(out)/tests/bench/solids: $(out)/tests/bench/solids.o $(lib_cook) $(lib_core)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) -o $@ $^ $(call libs_of,asset mesh) $(cgal)

$(out)/tests/bench/grid_mesh: $(out)/tests/bench/grid_mesh.o $(lib_cook) $(lib_core)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) -o $@ $^ $(call libs_of,asset mesh)

$(out)/tests/bench/leaves: $(out)/tests/bench/leaves.o
	$(say) LINK $@
	$(Q)$(CXX) $(flags) -o $@ $^

$(out)/tests/bench/rays $(out)/tests/bench/plan: %: %.o $(call objects_of,host image) $(lib_core)
	$(say) LINK $@
	$(Q)$(CXX) $(flags) -o $@ $^ $(call libs_of,asset host image)

# Numbers that a cook goes by, on models of few triangles and scans; the rare are for what is left.
duck        := gltf/KhronosSampleModels/Duck/glTF_Binary/Duck.glb
truck       := gltf/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf
tune_common := textured/spot/spot/spot_control_mesh.obj $(truck) scans/bunny.ply \
               $(duck) \
               heightfields/reek/1_topreek_rota.gri \
               heightfields/reek_1588x1188/0_topreek_rota_z16.png
tune_rare   := $(truck),--partition,vsa scans/gargo_3dhop.ply.gz gltf/dragon_draco_119k.glb
below        = $(addprefix $(GEOTEX_MODELS)/,$(1))
TUNE_MODELS ?= $(if $(GEOTEX_MODELS),$(call below,$(tune_common)) --rare \
                 $(call below,$(tune_rare)),$(MODEL))
tune: ## what each constant of the cooker changes at half and at double; TUNE=REGEX takes some
	$(again) deps
	$(if $(GEOTEX_MODELS),,$(again) $(MODEL))
	@TUNE='$(TUNE)' tests/bench/tune $(build)/tune $(TUNE_MODELS)
