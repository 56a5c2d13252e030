/* The fuzz targets. */
#include "fuzz/fuzz.hpp"

namespace fuzz {

const Target targets[] = {
    {"gtx", run_gtx, mutate_gtx},    {"ply", run_ply, nullptr},
    {"obj", run_obj, nullptr},       {"off", run_off, nullptr},
    {"stl", run_stl, nullptr},       {"gltf", run_gltf, mutate_glb},
    {"draco", run_draco, nullptr},   {"gzip", run_gzip, mutate_gzip},
    {"irap", run_irap, nullptr},     {"zmap", run_zmap, nullptr},
    {"cps3", run_cps3, nullptr},     {"netcdf", run_netcdf, nullptr},
    {"image", run_image, nullptr},   {"world", run_world, nullptr},
    {"stream", run_stream, nullptr}, {"prefix", run_prefix, mutate_gtx},
    {"pieces", run_pieces, mutate_glb},
};
const size_t target_count = sizeof targets / sizeof *targets;

} // namespace fuzz
