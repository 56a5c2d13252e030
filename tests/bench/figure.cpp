/* Figures: the table on stdout, the rows as JSON, the curves as SVG. */
#include "bench/figure.hpp"

#include <cmath>
#include <cstdio>

void print_row(const FigureRow &row, bool first)
{
    if (first)
        std::printf("| scene   | window    | pixels  | method      | frames | median ms | "
                    "least ms | frames/s |\n|---|---|---|---|---|---|---|---|\n");
    std::printf("| %-7s | %-9s | %7llu | %-11s | %6d | %9.2f | %8.2f | %8.2f |\n",
                row.scene.c_str(), row.window.c_str(), static_cast<unsigned long long>(row.pixels),
                row.method.c_str(), row.frames, row.median, row.least, 1000 / row.median);
    std::fflush(stdout);
}

static bool write_json(const std::string &path, const std::string &platform,
                       const std::vector<FigureRow> &rows)
{
    FILE *file = std::fopen(path.c_str(), "w");
    if (!file)
        return false;
    std::fprintf(file, "{\"platform\": \"%s\", \"rows\": [", platform.c_str());
    for (size_t i = 0; i < rows.size(); ++i)
        std::fprintf(file,
                     "%s\n{\"scene\": \"%s\", \"zoom\": \"%s\", \"method\": \"%s\", "
                     "\"pixels\": %llu, \"frames\": %d, \"ms_median\": %.3f, \"ms_min\": %.3f}",
                     i ? "," : "", rows[i].scene.c_str(), rows[i].window.c_str(),
                     rows[i].method.c_str(), static_cast<unsigned long long>(rows[i].pixels),
                     rows[i].frames, rows[i].median, rows[i].least);
    std::fprintf(file, "\n]}\n");
    return std::fclose(file) == 0;
}

/* ---- curves ---- */

static std::vector<std::string> names(const std::vector<FigureRow> &rows,
                                      std::string FigureRow::*field)
{
    std::vector<std::string> out;
    for (const FigureRow &row : rows)
        if (std::find(out.begin(), out.end(), row.*field) == out.end())
            out.push_back(row.*field);
    return out;
}

/* Whole decades around values. */
struct Decades {
    double low = INFINITY, high = -INFINITY;

    void add(double value)
    {
        low = std::min(low, std::floor(std::log10(value)));
        high = std::max(high, std::ceil(std::log10(value)));
    }
    double share(double value) const { return (std::log10(value) - low) / (high - low); }
};

constexpr int PANEL = 300, MARGIN = 56, TOP = 48;
constexpr int LABEL = 100; /* of the legend, in columns of this width */
static const char *const INKS[] = {"#7a7a7a", "#1f77b4", "#2ca02c", "#d62728", "#9467bd",
                                   "#8c564b", "#e377c2", "#17becf"};

static void draw_legend(FILE *file, const std::vector<std::string> &methods, size_t columns)
{
    for (size_t m = 0; m < methods.size(); ++m) {
        const int x = MARGIN + int(m % columns) * LABEL;
        const int y = TOP + PANEL + 52 + int(m / columns) * 16;
        std::fprintf(file, "<path d='M%d %dh18' stroke='%s' stroke-width='2'/>"
                           "<text x='%d' y='%d'>%s</text>\n",
                     x, y, INKS[m % (sizeof INKS / sizeof *INKS)], x + 22, y + 4,
                     methods[m].c_str());
    }
}

static void draw_axes(FILE *file, int x, const std::string &scene, const Decades &across,
                      const Decades &up)
{
    std::fprintf(file, "<rect x='%d' y='%d' width='%d' height='%d' fill='none' stroke='#444'/>\n"
                       "<text x='%d' y='%d' text-anchor='middle'>%s</text>\n",
                 x, TOP, PANEL, PANEL, x + PANEL / 2, TOP - 8, scene.c_str());
    for (double d = across.low; d <= across.high; ++d) {
        const double at = x + PANEL * (d - across.low) / (across.high - across.low);
        std::fprintf(file, "<path d='M%.1f %dv%d' stroke='#ddd'/>"
                           "<text x='%.1f' y='%d' text-anchor='middle'>%.10g</text>\n",
                     at, TOP, PANEL, at, TOP + PANEL + 16, std::pow(10, d));
    }
    for (double d = up.low; d <= up.high; ++d) {
        const double at = TOP + PANEL - PANEL * (d - up.low) / (up.high - up.low);
        std::fprintf(file, "<path d='M%d %.1fh%d' stroke='#ddd'/>"
                           "<text x='%d' y='%.1f' text-anchor='end'>%g</text>\n",
                     x, at, PANEL, x - 6, at + 4, std::pow(10, d));
    }
}

static bool write_svg(const std::string &path, const std::string &title,
                      const std::vector<FigureRow> &rows)
{
    FILE *file = std::fopen(path.c_str(), "w");
    if (!file)
        return false;
    const std::vector<std::string> scenes = names(rows, &FigureRow::scene);
    const std::vector<std::string> methods = names(rows, &FigureRow::method);
    Decades across, up;
    for (const FigureRow &row : rows) {
        across.add(double(std::max<uint64_t>(row.pixels, 1)));
        up.add(1000 / row.median);
    }
    const int width = MARGIN + int(scenes.size()) * (PANEL + MARGIN);
    const size_t columns = size_t((width - MARGIN) / LABEL);
    const int height = TOP + PANEL + 60 + 16 * int((methods.size() + columns - 1) / columns);
    std::fprintf(file, "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' "
                       "font-family='sans-serif' font-size='11'>\n"
                       "<rect width='100%%' height='100%%' fill='white'/>\n"
                       "<text x='%d' y='20' font-size='13'>%s</text>\n",
                 width, height, MARGIN, title.c_str());
    for (size_t s = 0; s < scenes.size(); ++s) {
        const int x = MARGIN + int(s) * (PANEL + MARGIN);
        draw_axes(file, x, scenes[s], across, up);
        for (size_t m = 0; m < methods.size(); ++m) {
            std::string points;
            for (const FigureRow &row : rows) {
                if (row.scene != scenes[s] || row.method != methods[m])
                    continue;
                char point[64];
                std::snprintf(point, sizeof point, "%.1f,%.1f ",
                              x + PANEL * across.share(double(std::max<uint64_t>(row.pixels, 1))),
                              TOP + PANEL * (1 - up.share(1000 / row.median)));
                points += point;
            }
            const char *ink = INKS[m % (sizeof INKS / sizeof *INKS)];
            std::fprintf(file, "<polyline points='%s' fill='none' stroke='%s' stroke-width='2'/>\n",
                         points.c_str(), ink);
        }
    }
    draw_legend(file, methods, columns);
    std::fprintf(file, "<text x='%d' y='%d'>frames a second over covered pixels</text>\n</svg>\n",
                 MARGIN, TOP + PANEL + 36);
    return std::fclose(file) == 0;
}

bool write_figure(const std::string &folder, const std::string &name, const std::string &title,
                  const std::string &platform, const std::vector<FigureRow> &rows)
{
    return write_json(folder + "/" + name + ".json", platform, rows) &&
           write_svg(folder + "/" + name + ".svg", title, rows);
}
