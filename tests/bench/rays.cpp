/* Rays a second into an asset on one thread.
 *
 *   rays ASSET.gtx [--rays N]
 *
 * Chords join two points of the asset's bounding sphere, inner rays start anywhere in it towards
 * anywhere: no two rays have anything in common. Each row is the best of three runs, in time of the
 * processor. */
#include <geotex/geotex.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>
#include <vector>

static void check(gtx_result result, const gtx_error &error)
{
    if (result == GTX_OK)
        return;
    std::fprintf(stderr, "rays: error: %s\n", error.message);
    std::exit(1);
}

/* Of the processor: what else it does in the meantime does not count. */
static double seconds()
{
    return double(std::clock()) / CLOCKS_PER_SEC;
}

using Random = std::mt19937_64;

/* Unit, spread evenly. */
static void direction(Random &random, float out[3])
{
    std::uniform_real_distribution<double> uniform;
    double z = 2 * uniform(random) - 1, turn = 6.283185307179586 * uniform(random);
    double r = std::sqrt(1 - z * z);
    out[0] = float(r * std::cos(turn));
    out[1] = float(r * std::sin(turn));
    out[2] = float(z);
}

static std::vector<gtx_ray> random_rays(const gtx_info &info, size_t count, bool inside)
{
    Random random(1);
    std::uniform_real_distribution<double> uniform;
    float centre[3], radius = 0;
    for (int k = 0; k < 3; ++k) {
        centre[k] = (info.bounds_min[k] + info.bounds_max[k]) / 2;
        radius = std::hypot(radius, info.bounds_max[k] - centre[k]);
    }
    std::vector<gtx_ray> rays(count);
    for (gtx_ray &ray : rays) {
        float from[3], to[3];
        direction(random, from);
        direction(random, to);
        float reach = inside ? float(std::cbrt(uniform(random))) : 1;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = centre[k] + radius * reach * from[k];
            ray.direction[k] = inside ? to[k] : radius * (to[k] - from[k]);
        }
        ray.t_min = ray.t_max = 0;
    }
    return rays;
}

static void measure(const gtx_caster *caster, const gtx_info &info, size_t count, bool inside,
                    uint32_t flags)
{
    std::vector<gtx_ray> rays = random_rays(info, count, inside);
    std::vector<gtx_hit> hits(count);
    double best = INFINITY;
    for (int run = 0; run < 3; ++run) {
        double start = seconds();
        gtx_raycast(caster, rays.data(), hits.data(), count, flags);
        best = std::fmin(best, seconds() - start);
    }
    size_t met = 0;
    for (const gtx_hit &hit : hits)
        met += hit.patch != UINT32_MAX;
    std::printf("%-10s %-9s %9zu %8.1f %% %10.3f\n", inside ? "inner rays" : "chords",
                flags & GTX_RAY_ANY ? "any hit" : "first hit", count,
                100 * double(met) / double(count), double(count) / best / 1e6);
}

int main(int argc, char **argv)
{
    size_t count = 500000;
    if (argc == 4 && std::strcmp(argv[2], "--rays") == 0)
        count = std::strtoull(argv[3], nullptr, 10);
    if ((argc != 2 && argc != 4) || !count) {
        std::fprintf(stderr, "usage: rays ASSET.gtx [--rays N]\n");
        return 1;
    }
    gtx_error error;
    gtx_asset *asset;
    gtx_caster *caster;
    gtx_info info;
    check(gtx_open_file(argv[1], nullptr, &asset, &error), error);
    gtx_get_info(asset, &info);
    double start = seconds();
    check(gtx_caster_create(asset, nullptr, &caster, &error), error);
    std::printf("%u patches, caster made in %.0f ms\n", info.patch_count,
                1e3 * (seconds() - start));
    std::printf("%-10s %-9s %9s %10s %10s\n", "rays", "query", "count", "hit", "M rays/s");
    for (int inside = 0; inside < 2; ++inside)
        for (uint32_t flags : {uint32_t(0), uint32_t(GTX_RAY_ANY)})
            measure(caster, info, count, inside, flags);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}
