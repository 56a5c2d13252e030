/* Ends height fields sooner where they meet at a convex edge of the source.
 *
 * A height field shows some of a texel past its outline, so that what it meets may be off by as
 * much and still leave no way between them. Beyond the edge of a box that is a fin in the air, and
 * where both height fields lie on the edge none is needed: they cross there. */
#include "bake/budget.hpp"
#include "bake/height_field.hpp"
#include "bake/seam/seam.hpp"

#include <cmath>

namespace gtx::baking {

/* Codes that trims are raised by: what is left of GTX_TRIM_SHOWN is a tenth of a texel. At 4 a
 * corner of a box shows no less, for there the edge itself would be cut away. */
constexpr int RAISED = 3;
/* Texels that both height fields may miss the edge by, along it as they meet. */
constexpr double MISSED = 0.06;
/* Texels outside its outline to which the other one counts. */
constexpr double REACHED = 0.1;
constexpr double MIN_FACING = 0.15;
/* Of the edge, for a texel. */
constexpr int SAMPLES = 4;
/* A limit on time: looks for a texel of the map. */
constexpr double LOOKS = 64;

namespace {

class Endings {
public:
    Endings(const HeightFields &fields, const HeightField &own, const PatchMaps &maps)
        : fields_(fields), own_(own), maps_(maps), trim_(maps.trim), blocked_(trim_.size()),
          budget_(LOOKS * double(trim_.size()))
    {
    }
    /* The trims as they are to be. */
    Vector<uint8_t> run()
    {
        block_others();
        each_sample([&](const Crease &crease, const Vec3d &point, const CellPoint &at) {
            if (!meet(crease, point))
                block(int(at.cell % size_t(own_.w)) - 1, int(at.cell / size_t(own_.w)) - 1, 4);
        });
        if (budget_.spent())
            return maps_.trim;
        for (size_t t = 0; t < trim_.size(); ++t)
            if (maps_.ending[t] == AT_CREASE && !blocked_[t] && trim_[t] > DEEP)
                trim_[t] = uint8_t(std::min(trim_[t] + RAISED, 255));
        each_sample([&](const Crease &, const Vec3d &, const CellPoint &at) { show(at); });
        return std::move(trim_);
    }

private:
    static constexpr int DEEP = GTX_TRIM_OUTLINE + int(DEEPEST_TRIM * GTX_TRIM_TEXEL);

    /* Those of the square from (i, j) on stay. */
    void block(int i, int j, int side)
    {
        for (int y = std::max(j, 0); y < std::min(j + side, own_.h); ++y)
            for (int x = std::max(i, 0); x < std::min(i + side, own_.w); ++x)
                blocked_[own_.at(x, y)] = 1;
    }

    /* Around outlines of other kinds. */
    void block_others()
    {
        for (int j = 0; j < own_.h; ++j)
            for (int i = 0; i < own_.w; ++i) {
                const size_t t = own_.at(i, j);
                if (maps_.height[t] && trim_[t] > DEEP && maps_.ending[t] != AT_CREASE)
                    block(i - 1, j - 1, 3);
            }
    }

    /* Calls `visit` with points of the edges that the height field shows. */
    template <class Visit> void each_sample(Visit visit)
    {
        for (const Crease &crease : maps_.creases) {
            const Vec3d along = crease.to - crease.from;
            const double u = dot(own_.row(0), along), v = dot(own_.row(1), along);
            const double steps = std::ceil(SAMPLES * std::sqrt(u * u + v * v)) + 1;
            if (!budget_.grants(steps))
                return;
            for (double s = 0; s <= steps; ++s) {
                const Vec3d point = crease.from + along * (s / steps);
                double above, trim;
                cancel_point();
                if (own_.field_above(point, above, trim) && trim <= GTX_TRIM_SHOWN)
                    visit(crease, point, own_.place_of(point));
            }
        }
    }

    /* Whether the other face's height field and this one are so near to a point of the edge that
     * they cross. */
    bool meet(const Crease &crease, const Vec3d &point)
    {
        double above, trim;
        own_.field_above(point, above, trim);
        const double allowed = MISSED * own_.texel() *
                                   length(cross(crease.normal, crease.other)) -
                               std::fabs(above * dot(crease.normal, own_.axis[2]));
        return allowed >= 0 && fields_.any_near(point, own_.texel(), [&](const HeightField &f) {
            const double facing = dot(crease.other, f.axis[2]);
            budget_.spend(1);
            return budget_.spent() ||
                   (&f != &own_ && facing >= MIN_FACING && f.field_above(point, above, trim) &&
                    trim <= REACHED && std::fabs(above * facing) <= allowed);
        });
    }

    /* Lowers trims around a point of the edge until it shows, no farther than they were. */
    void show(const CellPoint &at)
    {
        constexpr double AIM = GTX_TRIM_OUTLINE + GTX_TRIM_TEXEL * GTX_TRIM_SHOWN - 1;
        double trim = 0;
        for (size_t k = 0; k < 4; ++k)
            trim += at.weight(k) * trim_[own_.corner(at, k)];
        for (size_t k = 0; k < 4 && trim > AIM; ++k) {
            const size_t t = own_.corner(at, k);
            trim_[t] = uint8_t(std::max(int(maps_.trim[t]), trim_[t] - int(std::ceil(trim - AIM))));
        }
    }

    const HeightFields &fields_;
    const HeightField &own_;
    const PatchMaps &maps_;
    Vector<uint8_t> trim_, blocked_;
    Budget budget_;
};

} // namespace

void end_at_creases(unsigned height_bits, Vector<PatchMaps> &patches, Task &task)
{
    const HeightFields fields(patches, height_bits);
    Vector<Vector<uint8_t>> trims(patches.size());
    task.parallel(fields.size(), [&](size_t i) {
        const PatchMaps &maps = patches[fields.patch(i)];
        if (!maps.creases.empty())
            trims[fields.patch(i)] = Endings(fields, fields[i], maps).run();
    });
    for (size_t i = 0; i < patches.size(); ++i)
        if (!trims[i].empty()) {
            std::copy(trims[i].begin(), trims[i].end(), patches[i].trim.begin());
            fill_trim(patches[i]);
        }
}

} // namespace gtx::baking
