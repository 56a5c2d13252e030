/* Wavefront MTL: colours and textures, with the common additions for physically based shading. */
#include "mesh/import/mtl.hpp"

#include <algorithm>
#include <filesystem>

namespace gtx {

namespace {

/* One line: words, numbers, and the rest of it. */
struct Line {
    const char *at, *end;

    void skip_blanks()
    {
        while (at < end && (*at == ' ' || *at == '\t'))
            ++at;
    }
    std::string_view word()
    {
        skip_blanks();
        const char *start = at;
        while (at < end && *at != ' ' && *at != '\t')
            ++at;
        return {start, size_t(at - start)};
    }
    bool number(double &value)
    {
        skip_blanks();
        return parse_number(at, end, value);
    }
    std::string_view rest()
    {
        skip_blanks();
        while (end > at && (end[-1] == ' ' || end[-1] == '\t'))
            --end;
        return {at, size_t(end - at)};
    }
};

/* The options that may stand before the name of a map, and how many words follow them at most;
 * numbers may be fewer. */
const struct {
    const char *name;
    int words;
    bool numbers;
} MAP_OPTIONS[] = {{"-blendu", 1, false}, {"-blendv", 1, false}, {"-boost", 1, true},
                   {"-bm", 1, true},      {"-cc", 1, false},     {"-clamp", 1, false},
                   {"-imfchan", 1, false}, {"-mm", 2, true},     {"-o", 3, true},
                   {"-s", 3, true},       {"-t", 3, true},       {"-texres", 1, true},
                   {"-type", 1, false}};

/* What a bump map holds, heights or normals, its image says: exporters write either. */
enum class Holds : uint8_t { PLAIN, BUMP, OPACITY };
const struct {
    const char *statement;
    Texture Material::*map;
    Holds holds;
} MAPS[] = {{"map_Kd", &Material::color_map, Holds::PLAIN},
            {"map_Ke", &Material::emission_map, Holds::PLAIN},
            {"norm", &Material::normal_map, Holds::PLAIN},
            {"map_Kn", &Material::normal_map, Holds::PLAIN},
            {"map_Bump", &Material::normal_map, Holds::BUMP},
            {"map_bump", &Material::normal_map, Holds::BUMP},
            {"bump", &Material::normal_map, Holds::BUMP},
            {"map_Pr", &Material::rough_map, Holds::PLAIN},
            {"map_Pm", &Material::metal_map, Holds::PLAIN},
            {"map_d", &Material::opacity_map, Holds::OPACITY}};

/* Options of a map that its image or its material need. */
struct MapOptions {
    double bump = 1;
    std::string_view channel;
};

/* Of older shading models, or of curves: nothing that the maps hold. */
const char *const SILENT[] = {"Ka", "Ks", "Ns", "Ni", "Tf", "illum", "sharpness", "map_Ka",
                              "map_Ks", "map_Ns", "aniso", "anisor", "Pc", "Pcr"};

class MtlReader {
public:
    MtlReader(const ModelFile &file, MtlLibrary &library, Task &task)
        : file_(file), library_(library), task_(task)
    {
    }
    void statement(Line line);

private:
    bool factor(std::string_view word, Line &line);
    bool map(std::string_view word, Line &line);
    bool map_options(Line &line, Texture &texture, MapOptions &options);
    uint32_t image(const std::string &name, const EncodedImage &use);
    Material &look() { return library_.materials[current_]; }

    const ModelFile &file_;
    MtlLibrary &library_;
    Task &task_;
    size_t current_ = 0;
    bool has_normals_ = false; /* the material, by a statement that leaves nothing open */
    bool repeated_ = true; /* nothing is defined yet, or it was before */
};

/* 0..limit; what is no number counts as 0. */
float within(double value, double limit)
{
    return float(value > 0 ? std::min(value, limit) : 0);
}

bool MtlReader::factor(std::string_view word, Line &line)
{
    double v[3] = {0, 0, 0};
    int count = 0;
    while (count < 3 && line.number(v[count]))
        ++count;
    if (count == 1)
        v[1] = v[2] = v[0];
    if (count == 0)
        return false;
    for (int k = 0; k < 3; ++k) {
        if (word == "Kd")
            look().color[k] = within(v[k], 1);
        else if (word == "Ke")
            look().emission[k] = within(v[k], 1e6);
    }
    if (word == "Pr")
        look().roughness = within(v[0], 1);
    else if (word == "Pm")
        look().metallic = within(v[0], 1);
    return true;
}

bool MtlReader::map_options(Line &line, Texture &texture, MapOptions &options)
{
    double scale[3] = {1, 1, 1}, offset[3] = {0, 0, 0};
    for (line.skip_blanks(); line.at < line.end && *line.at == '-'; line.skip_blanks()) {
        std::string_view name = line.word();
        auto option = std::find_if(std::begin(MAP_OPTIONS), std::end(MAP_OPTIONS),
                                   [&](const auto &o) { return name == o.name; });
        if (option == std::end(MAP_OPTIONS))
            return false;
        double ignored[3], *values = name == "-s"    ? scale
                                     : name == "-o"  ? offset
                                     : name == "-bm" ? &options.bump
                                                     : ignored;
        for (int i = 0; i < option->words; ++i) {
            if (option->numbers && !line.number(values[i]))
                break;
            const std::string_view word = option->numbers ? std::string_view() : line.word();
            if (word == "on" && name == "-clamp")
                texture.wrap[0] = texture.wrap[1] = Wrap::CLAMP;
            if (name == "-imfchan")
                options.channel = word;
        }
    }
    for (double v : {scale[0], scale[1], offset[0], offset[1]})
        if (!(v >= -1e6 && v <= 1e6))
            return false;
    /* The coordinates at hand have their origin at the top: v = 1 - v of the file. */
    texture.transform[0] = float(scale[0]);
    texture.transform[2] = float(offset[0]);
    texture.transform[4] = float(scale[1]);
    texture.transform[5] = float(1 - scale[1] - offset[1]);
    return true;
}

uint32_t MtlReader::image(const std::string &name, const EncodedImage &use)
{
    const std::string path = texture_path(file_, name);
    std::string key = path.empty() ? name : normal_path(path);
    if (use.bump > 0 || use.opacity) /* no name has such a separator */
        key += '\n' + std::to_string(use.opacity ? -1 : use.bump);
    const auto [number, fresh] = library_.image_names.add(key);
    if (fresh) {
        std::string shown = "image '" + printable(name) + "'";
        EncodedImage encoded;
        encoded.name = shown;
        encoded.problem = "it is not a file in the model's folder";
        library_.images.push_back(
            path.empty() ? encoded : read_image_file(file_, shown, path, task_));
        library_.images.back().bump = use.bump;
        library_.images.back().opacity = use.opacity;
    }
    return number;
}

/* Of -imfchan; luminance and depth are those of grey. */
static uint8_t channel_of(std::string_view letter)
{
    return letter == "g" ? 1 : letter == "b" ? 2 : letter == "m" ? 3 : 0;
}

bool MtlReader::map(std::string_view word, Line &line)
{
    for (const auto &m : MAPS) {
        if (word != m.statement)
            continue;
        Texture texture;
        MapOptions options;
        if (!map_options(line, texture, options) || line.rest().empty())
            return false;
        if (m.holds == Holds::BUMP && (has_normals_ || !(options.bump > 0)))
            return true;
        EncodedImage use;
        use.bump = m.holds == Holds::BUMP ? float(std::min(options.bump, 1e3)) : 0;
        use.opacity = m.holds == Holds::OPACITY && options.channel.empty();
        texture.channel = channel_of(options.channel);
        texture.image = image(std::string(line.rest()), use);
        Material &material = look();
        material.*m.map = texture;
        has_normals_ |= m.map == &Material::normal_map && m.holds == Holds::PLAIN;
        if (m.map == &Material::metal_map && material.metallic == 0)
            material.metallic = 1;
        if (m.map == &Material::opacity_map)
            material.alpha_cutoff = 0.5f; /* holes, as of foliage: nothing is half there */
        if (m.map == &Material::emission_map && material.emission[0] + material.emission[1] +
                                                        material.emission[2] == 0)
            std::fill_n(material.emission, 3, 1.f);
        return true;
    }
    return false;
}

void MtlReader::statement(Line line)
{
    std::string_view word = line.word();
    if (word.empty() || word[0] == '#')
        return;
    if (word == "newmtl") {
        const auto [number, fresh] = library_.names.add(std::string(line.rest()));
        repeated_ = !fresh;
        has_normals_ = false;
        current_ = number;
        if (fresh)
            library_.materials.emplace_back();
        return;
    }
    if (repeated_)
        return;
    for (const char *name : SILENT)
        if (word == name)
            return;
    double alpha;
    if (word == "d" || word == "Tr") { /* only what is not opaque deserves a word */
        if (line.number(alpha) && (word == "d" ? alpha >= 1 : alpha <= 0))
            return;
    } else if (word == "Kd" || word == "Ke" || word == "Pr" || word == "Pm") {
        if (factor(word, line))
            return;
    } else if (map(word, line)) {
        return;
    }
    std::string shown = printable(word);
    if (std::find(library_.ignored.begin(), library_.ignored.end(), shown) ==
            library_.ignored.end() && library_.ignored.size() < 8)
        library_.ignored.push_back(shown);
}

} // namespace

void read_mtl(const ModelFile &file, const std::string &name, MtlLibrary &library, Task &task)
{
    std::string path = path_beside(file, name);
    Bytes text;
    std::error_code error;
    if (path.empty() || !std::filesystem::is_regular_file(path, error)) {
        task.warn(GTX_WARNING_UNREAD_LIBRARY,
                  "material library '" + printable(name) + "' was not found");
        return;
    }
    try {
        text = read_file_beside(path, task);
    } catch (const Error &e) {
        if (e.result == GTX_ERROR_LIMIT)
            throw;
        task.warn(GTX_WARNING_UNREAD_LIBRARY,
                  "material library '" + printable(name) + "' was ignored: " + e.message);
        return;
    }
    if (file.sources)
        file.sources->push_back(path);
    MtlReader reader(file, library, task);
    for (size_t at = 0; at < text.size();) {
        size_t end = std::min(text.find_first_of("\r\n", at), text.size());
        reader.statement({text.data() + at, text.data() + end});
        at = end + 1;
        task.advance(0.9);
    }
}

} // namespace gtx
