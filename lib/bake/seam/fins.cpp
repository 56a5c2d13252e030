/* Takes back fins: what height fields show beyond their outlines, away from the source.
 *
 * A height field shows some of a texel past its outline, in the map. On a steep side that is more
 * than a texel in space, and where a trim was relaxed to show a wall it goes on above or below the
 * wall's end. So trims rise there until nothing shows that is away from the source; what lies on
 * the source stays, and so does an end that no other height field meets though one is near, unless
 * another shows the source beside it, or the source is far. What is only beside the source stays
 * where another is near but does not show it: it may close a gap. */
#include "bake/budget.hpp"
#include "bake/seam/near_source.hpp"
#include "bake/seam/seam.hpp"

namespace gtx::baking {

/* Figures of AWAY, LONG, MISSED and PARTS are of heights that rise by 0.6 texels (fit.cpp's
 * RISE_IN_ALL), which is 0.5 now. */

/* Texels of the model from the source: what is farther is taken back, what is as near as ON stays.
 * With LONG at 0.4, where no end has to be met: the chair has 34 wall pixels, and 82 at 0.5, 0.25
 * and 0.5. */
constexpr double AWAY = 0.4, ON = 0.1;
/* How far the source is looked for that another height field may show instead. Where it is not, an
 * engine (with Draco) has 186 wall pixels for 100, the chair 90 for 71. */
constexpr double BESIDE = 1;
/* Texels of the model that a cell has to show past its outline, as steep as it is. At 0.4 venus has
 * 3 hole pixels, and a cook takes 1.4 % longer (bunny). */
constexpr double LONG = 0.6;
/* Texels that another height field may be off, and texels outside its outline to which it counts,
 * where it meets an end. Where none has to, Spot's control mesh has a hole. */
constexpr double MISSED = 0.3, REACHED = 0.1;
/* Texels off and outside its outline up to which another is near. Gargoyle and Spot's control mesh:
 * no pixel at half and at double. */
constexpr double NEARBY = 1;
/* Samples along a cell, less one. At half the gargoyle has 110 wall pixels for 92. */
constexpr uint8_t PARTS = 4;
/* A limit on time: looks at the source, and at other height fields, for a sample. */
constexpr size_t LOOKS = 256;
constexpr size_t CELL_TURNS = 16; /* of a short loop, that take as long as a cell */

namespace {

constexpr double SHOWN = GTX_TRIM_OUTLINE + GTX_TRIM_TEXEL * GTX_TRIM_SHOWN; /* a code */

/* Far from it: so far that no source is looked for. */
enum Lies : uint8_t { ON_SOURCE, BESIDE_IT, AWAY_FROM_IT, FAR_FROM_IT };

/* What other height fields have at a point. */
enum Other : uint8_t { NONE, NEAR_IT, THERE };

/* A point that a cell shows beyond the outline. */
struct Sample {
    uint32_t cell;
    uint8_t x, y;                /* of PARTS */
    Lies lies;

    CellPoint place() const { return {cell, double(x) / PARTS, double(y) / PARTS}; }
};

class Fins {
public:
    Fins(const HeightField &own, const PatchMaps &maps, double texel)
        : own_(own), maps_(maps), trim_(maps.trim), texel_(texel)
    {
    }
    /* Samples of what may be a fin. */
    void collect();
    /* Finds where they lie; whether any is away from the source, at an end that is met. */
    bool judge(const NearSource &source, const HeightFields &fields);
    /* The trims as they are to be. */
    Vector<uint8_t> take_back(const HeightFields &fields);

    template <class Visit> void each_sample(Visit visit) const
    {
        for (const Sample &sample : samples_)
            visit(own_.point(sample.place()));
    }

private:
    std::array<size_t, 4> corners(size_t cell) const
    {
        const size_t w = size_t(own_.w);
        return {cell, cell + 1, cell + w, cell + w + 1};
    }
    bool has_codes(size_t cell) const
    {
        const std::array<size_t, 4> at = corners(cell);
        return std::all_of(at.begin(), at.end(), [&](size_t t) { return maps_.height[t]; });
    }
    double trim_at(const Vector<uint8_t> &trim, const CellPoint &place) const
    {
        double sum = 0;
        for (size_t k = 0; k < 4; ++k)
            sum += place.weight(k) * trim[own_.corner(place, k)];
        return sum;
    }
    bool is_long(size_t cell) const;
    Other other_at(const Vec3d &point, double reached, const HeightFields &fields,
                   Budget &budget) const;
    bool is_met(size_t first, size_t end, const HeightFields &fields, Budget &budget) const;
    bool is_in_front(const Sample &sample, const NearSource &source, const HeightFields &fields,
                     Budget &budget, size_t &looks) const;
    void mark_sheet(size_t cell);
    bool at_sheet(const CellPoint &place) const;
    bool stays(const Sample &sample, const HeightFields &fields, Budget &budget) const;
    void hide(const CellPoint &place);
    void show(const CellPoint &place);
    size_t show_cell(size_t cell, size_t sample, const HeightFields &fields, Budget &budget);

    const HeightField &own_;
    const PatchMaps &maps_;
    Vector<uint8_t> trim_;
    const double texel_;         /* of the model */
    Vector<Sample> samples_;     /* by cells, rows and columns */
    Vector<uint8_t> sheet_;      /* corners of cells of which something is taken back, if any */
};

/* Whether a cell shows much past an outline that crosses it or runs beside it. */
bool Fins::is_long(size_t cell) const
{
    uint8_t least = 255, most = 0;
    for (size_t t : corners(cell)) {
        least = std::min(least, trim_[t]);
        most = std::max(most, trim_[t]);
    }
    if (least > SHOWN || most <= GTX_TRIM_OUTLINE || !has_codes(cell))
        return false;
    const double facing = dot(own_.normal({cell, 0.5, 0.5}), own_.axis[2]);
    return GTX_TRIM_SHOWN * own_.texel() >= LONG * texel_ * facing;
}

void Fins::collect()
{
    cancel_point(CELL_TURNS * trim_.size());
    for (int j = 0; j + 1 < own_.h; ++j)
        for (int i = 0; i + 1 < own_.w; ++i) {
            const size_t cell = own_.at(i, j);
            if (!is_long(cell))
                continue;
            for (uint8_t y = 0; y <= PARTS; ++y)
                for (uint8_t x = 0; x <= PARTS; ++x) {
                    const Sample sample = {uint32_t(cell), x, y, ON_SOURCE};
                    const double trim = trim_at(trim_, sample.place());
                    if (trim > GTX_TRIM_OUTLINE && trim <= SHOWN)
                        samples_.push_back(sample);
                }
        }
}

/* Whether any comes to a point, in so many texels outside its outline, or near it. */
Other Fins::other_at(const Vec3d &point, double reached, const HeightFields &fields,
                     Budget &budget) const
{
    Other found = NONE;
    fields.any_near(point, texel_, [&](const HeightField &other) {
        double above, trim;
        budget.spend(1);
        cancel_point();
        if (&other != &own_ && other.field_above(point, above, trim) && trim <= NEARBY) {
            const double off = std::fabs(
                above * dot(other.normal(other.place_of(point)), other.axis[2]));
            if (trim <= reached && off <= MISSED * texel_)
                found = THERE;
            else if (off <= NEARBY * texel_)
                found = NEAR_IT;
        }
        return found == THERE || budget.spent();
    });
    return found;
}

/* Whether another height field is where the samples of a cell begin. At the model's own border none
 * has to be, unless one is near: parts that touch are often not joined. */
bool Fins::is_met(size_t first, size_t end, const HeightFields &fields, Budget &budget) const
{
    size_t least = first;
    for (size_t i = first; i < end; ++i)
        if (trim_at(trim_, samples_[i].place()) < trim_at(trim_, samples_[least].place()))
            least = i;
    const std::array<size_t, 4> at = corners(samples_[first].cell);
    const Other other = other_at(own_.point(samples_[least].place()), REACHED, fields, budget);
    return other == THERE ||
           (other == NONE &&
            std::all_of(at.begin(), at.end(), [&](size_t t) { return own_.at_border(t); }));
}

/* Whether another height field shows the source beside a sample. */
bool Fins::is_in_front(const Sample &sample, const NearSource &source, const HeightFields &fields,
                       Budget &budget, size_t &looks) const
{
    Vec3d nearest;
    return source.find_nearest(own_.point(sample.place()), nearest, looks) &&
           other_at(nearest, REACHED, fields, budget) == THERE;
}

void Fins::mark_sheet(size_t cell)
{
    sheet_.resize(trim_.size());
    for (size_t t : corners(cell))
        sheet_[t] = 1;
}

bool Fins::at_sheet(const CellPoint &place) const
{
    for (size_t k = 0; k < 4 && !sheet_.empty(); ++k)
        if (place.weight(k) > 0 && sheet_[own_.corner(place, k)])
            return true;
    return false;
}

/* Whether what a cell showed there is to show whatever is taken back beside it. A sheet in the air
 * hangs between two places on the source: it goes only if they do, where another has them. */
bool Fins::stays(const Sample &sample, const HeightFields &fields, Budget &budget) const
{
    const CellPoint place = sample.place();
    if (sample.lies == ON_SOURCE)
        return !at_sheet(place) || other_at(own_.point(place), 0, fields, budget) != THERE;
    return sample.lies == BESIDE_IT && trim_at(trim_, place) > SHOWN &&
           other_at(own_.point(place), GTX_TRIM_SHOWN, fields, budget) == NEAR_IT;
}

bool Fins::judge(const NearSource &source, const HeightFields &fields)
{
    Budget budget(double(LOOKS * samples_.size()));
    size_t looks = LOOKS * samples_.size();
    uint32_t near = NO_TRIANGLE;
    bool any = false;
    for (size_t first = 0, end = 0; first < samples_.size(); first = end) {
        bool away = false;
        for (; end < samples_.size() && samples_[end].cell == samples_[first].cell; ++end) {
            Sample &sample = samples_[end];
            const double distance =
                source.distance(own_.point(sample.place()), ON * texel_, near, looks);
            sample.lies = distance <= ON * texel_ || !looks ? ON_SOURCE
                          : distance <= AWAY * texel_       ? BESIDE_IT
                          : distance <= BESIDE * texel_     ? AWAY_FROM_IT
                                                            : FAR_FROM_IT;
            away = away || sample.lies >= AWAY_FROM_IT;
        }
        if (away && is_met(first, end, fields, budget)) {
            mark_sheet(samples_[first].cell);
            any = true;
            continue;
        }
        for (size_t i = first; i < end; ++i) {
            Sample &sample = samples_[i];
            if (sample.lies == FAR_FROM_IT ||
                (sample.lies == AWAY_FROM_IT &&
                 is_in_front(sample, source, fields, budget, looks))) {
                mark_sheet(sample.cell);
                any = true;
            } else {
                sample.lies = std::min(sample.lies, BESIDE_IT);
            }
        }
    }
    return any;
}

/* The least change of the corners' trims that hides a place. */
void Fins::hide(const CellPoint &place)
{
    const double missing = SHOWN - trim_at(trim_, place);
    if (missing < 0)
        return;
    double square = 0;
    for (size_t k = 0; k < 4; ++k)
        square += place.weight(k) * place.weight(k);
    for (size_t k = 0; k < 4; ++k) {
        uint8_t &trim = trim_[own_.corner(place, k)];
        const int more = int(std::ceil(missing * place.weight(k) / square));
        trim = uint8_t(std::min(trim + more, 255));
    }
}

/* Lowers trims around a place until it shows, no farther than they were. */
void Fins::show(const CellPoint &place)
{
    const double over = trim_at(trim_, place) - SHOWN;
    for (size_t k = 0; k < 4 && over > 0; ++k) {
        const size_t t = own_.corner(place, k);
        if (place.weight(k) > 0)
            trim_[t] = uint8_t(std::max(int(maps_.trim[t]), trim_[t] - int(std::ceil(over))));
    }
}

/* Shows what a cell showed of the source: where it has samples, the first of which is given, they
 * tell. Returns the sample after them. */
size_t Fins::show_cell(size_t cell, size_t sample, const HeightFields &fields, Budget &budget)
{
    const bool is_sampled = sample < samples_.size() && samples_[sample].cell == cell;
    for (uint8_t y = 0; y <= PARTS; ++y)
        for (uint8_t x = 0; x <= PARTS; ++x) {
            const CellPoint place = Sample{uint32_t(cell), x, y, ON_SOURCE}.place();
            const double trim = trim_at(maps_.trim, place);
            if (trim <= SHOWN && (!is_sampled || trim <= GTX_TRIM_OUTLINE ||
                                  stays(samples_[sample++], fields, budget)))
                show(place);
        }
    return sample;
}

Vector<uint8_t> Fins::take_back(const HeightFields &fields)
{
    Budget budget(double(LOOKS * samples_.size()));
    for (const Sample &sample : samples_)
        if (sample.lies >= AWAY_FROM_IT)
            hide(sample.place());
    size_t next = 0;
    cancel_point(CELL_TURNS * trim_.size());
    for (int j = 0; j + 1 < own_.h; ++j)
        for (int i = 0; i + 1 < own_.w; ++i) {
            const size_t cell = own_.at(i, j);
            const std::array<size_t, 4> at = corners(cell);
            while (next < samples_.size() && samples_[next].cell < cell)
                ++next;
            if (has_codes(cell) && std::any_of(at.begin(), at.end(), [&](size_t t) {
                    return trim_[t] != maps_.trim[t];
                }))
                next = show_cell(cell, next, fields, budget);
        }
    return std::move(trim_);
}

} // namespace

void take_back_fins(const Job &job, Vector<PatchMaps> &patches, Task &task)
{
    const HeightFields fields(patches, job.options.height_bits);
    Vector<Fins> fins;
    fins.reserve(fields.size());
    for (size_t i = 0; i < fields.size(); ++i)
        fins.emplace_back(fields[i], patches[fields.patch(i)], job.pitch);
    task.parallel(fields.size(), [&](size_t i) { fins[i].collect(); });
    NearSource source(job, BESIDE * job.pitch);
    for (const Fins &some : fins)
        some.each_sample([&](const Vec3d &point) { source.add(point); });
    source.gather(task);
    Vector<Vector<uint8_t>> trims(patches.size());
    task.parallel(fields.size(), [&](size_t i) {
        if (fins[i].judge(source, fields))
            trims[fields.patch(i)] = fins[i].take_back(fields);
    });
    for (size_t i = 0; i < patches.size(); ++i)
        if (!trims[i].empty()) {
            std::copy(trims[i].begin(), trims[i].end(), patches[i].trim.begin());
            fill_trim(patches[i]);
        }
}

} // namespace gtx::baking
