/* What the density of texels is worth to textures: models cooked as relief needs, as the cooker
 * finds (the default), and as fine as half of the textures' pixels, and as these.
 *
 *   texels OUT_FOLDER MODEL...
 *
 * PSNR: at points spread evenly over the source's area, its colour at full resolution against that
 * of the asset, in sRGB; the angle between the normals there, both with normal textures. */
#include "measure/sample.hpp"
#include "mesh/mesh.hpp"

#include <geotex/cook.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

using namespace gtx;

namespace {

constexpr size_t POINTS = 200000;
constexpr double LIFT = 0.005; /* of the diagonal: rays begin as far above the surface */
constexpr double NEAR = 0.1;   /* of that: what they may miss the point by */

const struct {
    const char *name;
    float density;
} WAYS[] = {{"relief", GTX_TEXEL_DENSITY_RELIEF}, {"default", 0}, {"0.5", 0.5f}, {"1", 1}};

void require(gtx_result result, const gtx_error &error)
{
    if (!result)
        return;
    std::fprintf(stderr, "texels: %s\n", error.message);
    std::exit(3);
}

struct Off {
    double psnr = 0, degrees = 0;
};

double srgb(double light)
{
    light = std::min(std::max(light, 0.), 1.);
    return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

Off compare(const gtx_asset *asset, const Mesh &mesh)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    gtx_caster *caster = nullptr;
    gtx_error error;
    require(gtx_caster_create(asset, nullptr, &caster, &error), error);
    Vector<double> areas;
    Vec3d low = mesh.positions[0], high = low;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        areas.push_back(length(mesh.area_vector(t)));
    for (const Vec3d &p : mesh.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    const double lift = LIFT * length(high - low);
    const Vec3d anchor(info.anchor[0], info.anchor[1], info.anchor[2]);
    Random random;
    double square = 0, degrees = 0, count = 0;
    stratify(areas, POINTS, random, [&](size_t t) {
        const double root = std::sqrt(random.next()), b = random.next();
        const float w[3] = {float(1 - root), float(root * (1 - b)), float(root * b)};
        const Vec3d n = normalize(mesh.area_vector(t));
        const Vec3d p = mesh.position(t, 0) * double(w[0]) + mesh.position(t, 1) * double(w[1]) +
                        mesh.position(t, 2) * double(w[2]) + n * lift - anchor;
        const SurfaceSample seen = sample_surface(mesh, t, w, 0);
        if (seen.cut < 0)
            return;
        gtx_ray ray = {};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = float(p[k]);
            ray.direction[k] = float(-n[k]);
        }
        ray.t_max = float(2 * lift);
        gtx_hit hit;
        float color[1][4];
        require(gtx_raycast(caster, &ray, &hit, 1, 0), error);
        if (hit.patch == UINT32_MAX || std::fabs(double(hit.t) - lift) > NEAR * lift)
            return; /* another part of the model lies over it */
        require(gtx_hit_colors(asset, &hit, color, 1), error);
        for (int k = 0; k < 3; ++k)
            square += std::pow(srgb(double(seen.color[k])) - srgb(double(color[0][k])), 2) / 3;
        const Vec3d found(double(hit.normal[0]), double(hit.normal[1]), double(hit.normal[2]));
        const double cosine = std::max(-1., std::min(1., dot(Vec3d(seen.normal), found)));
        degrees += std::acos(cosine) * 180 / M_PI;
        ++count;
    });
    gtx_caster_destroy(caster);
    return {-10 * std::log10(square / count), degrees / count};
}

void add_model(const std::string &folder, const char *model)
{
    Task task(0, nullptr, nullptr);
    CleanReport clean;
    const Mesh mesh = clean_mesh(import_mesh(model, task), task, clean);
    std::printf("%s, %zu triangles\n%-8s %9s %9s %8s %9s %8s\n", model, mesh.triangle_count(),
                "density", "texels", "bytes", "seconds", "PSNR, dB", "normals");
    for (const auto &way : WAYS) {
        const std::string path = folder + "/texels.gtx";
        gtx_cook_desc desc = {};
        desc.partition = GTX_PARTITION_CUTS;
        desc.texel_density = way.density;
        gtx_error error;
        const std::clock_t start = std::clock();
        require(gtx_cook_file(model, path.c_str(), &desc, nullptr, &error), error);
        const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
        gtx_asset *asset = nullptr;
        require(gtx_open_file(path.c_str(), nullptr, &asset, &error), error);
        gtx_info info;
        gtx_get_info(asset, &info);
        uint64_t texels = 0;
        for (uint32_t i = 0; i < info.patch_count; ++i)
            texels += uint64_t(gtx_patches(asset)[i].rect[2]) * gtx_patches(asset)[i].rect[3];
        const Off off = compare(asset, mesh);
        std::printf("%-8s %9llu %9llu %8.2f %9.2f %8.2f\n", way.name,
                    static_cast<unsigned long long>(texels),
                    static_cast<unsigned long long>(info.file_size), seconds, off.psnr,
                    off.degrees);
        std::fflush(stdout);
        gtx_close(asset);
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: texels OUT_FOLDER MODEL...\n");
        return 1;
    }
    try {
        for (int i = 2; i < argc; ++i)
            add_model(argv[1], argv[i]);
        return 0;
    } catch (const Error &e) {
        std::fprintf(stderr, "texels: %s\n", e.message.c_str());
        return 3;
    }
}
