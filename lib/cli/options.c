/* Option tables: parsing and help. */
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool cli_quiet;
uint32_t cli_progress;
gtx_limits cli_limits;

/* Their names are those of gtx_error.limit. Every verb takes them all, so that a script may give
 * the same ones to each; its help lists those that bound something. */
static const option limit_options[GTX_LIMITED_COUNT + 1] = {
    [GTX_LIMITED_MEMORY] = {"max-memory", 0, OPTION_AMOUNT, &cli_limits.memory, "BYTES",
                            "limit of memory, such as 8G [268M + 2k per byte read]", 1, 1e18},
    [GTX_LIMITED_TRIANGLES] = {"max-triangles", 0, OPTION_AMOUNT, &cli_limits.triangles, "N",
                               "limit of triangles in all models [524k + 1.5 per byte read]", 1,
                               1e18},
    [GTX_LIMITED_TEXELS] =
        {"max-texels", 0, OPTION_AMOUNT, &cli_limits.texels, "N",
         "limit of texels of an asset, nodes of a grid [67M + 256 per byte read]", 1, 1e18},
    [GTX_LIMITED_PIXELS] = {"max-pixels", 0, OPTION_AMOUNT, &cli_limits.pixels, "N",
                            "limit of pixels of an image [67M + 16 per byte read]", 1, 1e18},
    [GTX_LIMITED_PATCHES] = {"max-patches", 0, OPTION_AMOUNT, &cli_limits.patches, "N",
                             "limit of patches [1M]", 1, 1e18},
    [GTX_LIMITED_CELLS] = {"max-cells", 0, OPTION_AMOUNT, &cli_limits.cells, "N",
                           "limit of cells that a ray may visit [524k]", 1, 1e18},
    [GTX_LIMITED_WORK] = {"max-work", 0, OPTION_AMOUNT, &cli_limits.work, "N",
                          "limit of steps of work [201M + 32 per byte read]", 1, 1e18},
};

static const option common_options[] = {
    {"quiet", 'q', OPTION_FLAG, &cli_quiet, NULL, "print errors only", 0, 0},
    {"help", 'h', OPTION_FLAG, NULL, NULL, "print this text", 0, 0},
    {0}};

/* An option that is wider than its column has its meaning on a line of its own. */
static void print_option(const option *o)
{
    enum { COLUMN = 34 };
    char left[64];
    char letter[8] = "    ";
    if (o->letter)
        snprintf(letter, sizeof letter, "-%c, ", o->letter);
    snprintf(left, sizeof left, "%s--%s%s%s", letter, o->name, o->argument ? " " : "",
             o->argument ? o->argument : "");
    if (strlen(left) >= COLUMN)
        printf("  %s\n  %*s %s\n", left, COLUMN, "", o->help);
    else
        printf("  %-*s %s\n", COLUMN, left, o->help);
}

static void print_help(const verb *v)
{
    printf("gtx %s %s\n%s\n\n", v->name, v->operands, v->summary);
    for (const option *o = v->options; o->name; ++o)
        print_option(o);
    for (uint32_t i = 0; i < GTX_LIMITED_COUNT; ++i)
        if (v->limits >> i & 1)
            print_option(&limit_options[i]);
    for (const option *o = common_options; o->name; ++o)
        print_option(o);
}

static int usage(const verb *v, const char *what, const char *which)
{
    print_message("gtx %s: error[usage]: %s '%s' (see gtx %s --help)", v->name, what, which,
                  v->name);
    return EXIT_CODE_USAGE;
}

static bool parse_number(const char *text, char **end, double *out)
{
    *out = strtod(text, end);
    return *end != text && isfinite(*out);
}

static bool parse_amount(const option *o, const char *text)
{
    static const char units[] = "kMGT";
    char *end;
    double number;
    if (!parse_number(text, &end, &number))
        return false;
    const char *unit = *end ? strchr(units, *end) : NULL;
    for (const char *u = units; unit && u <= unit; ++u)
        number *= 1000;
    if (unit)
        ++end;
    if (*end || number < o->min || number > o->max)
        return false;
    *(uint64_t *)o->value = (uint64_t)number;
    return true;
}

static bool parse_triple(const char *text, double out[3])
{
    char *end = (char *)text;
    for (int i = 0; i < 3; ++i) {
        if (!parse_number(end, &end, &out[i]) || *end != (i < 2 ? ',' : 0))
            return false;
        end += i < 2;
    }
    return true;
}

static bool parse_size(const option *o, const char *text)
{
    uint32_t *out = o->value;
    double w, h;
    char *end;
    if (!parse_number(text, &end, &w) || *end != 'x' || !parse_number(end + 1, &end, &h) || *end)
        return false;
    if (w != floor(w) || h != floor(h) || w < o->min || h < o->min || w > o->max || h > o->max)
        return false;
    out[0] = (uint32_t)w;
    out[1] = (uint32_t)h;
    return true;
}

static bool parse_choice(const option *o, const char *text)
{
    uint32_t index = 0;
    size_t length = strlen(text);
    for (const char *name = o->argument; name; ++index) {
        const char *bar = strchr(name, '|');
        size_t size = bar ? (size_t)(bar - name) : strlen(name);
        if (size == length && !memcmp(name, text, size)) {
            *(uint32_t *)o->value = index;
            return true;
        }
        name = bar ? bar + 1 : NULL;
    }
    return false;
}

static bool parse_step(const option *o, const char *text)
{
    steps *all = o->value;
    char *end;
    step next = {.name = o->name, .text = text};
    const bool is_number = o->max > o->min;
    if (!*text || all->count == MAX_STEPS)
        return false;
    if (is_number && (!parse_number(text, &end, &next.number) || *end || next.number < o->min ||
                      next.number > o->max))
        return false;
    all->list[all->count++] = next;
    return true;
}

static bool parse_value(const option *o, const char *text)
{
    char *end;
    double number;
    switch (o->kind) {
    case OPTION_STRING:
        *(const char **)o->value = text;
        return *text != 0;
    case OPTION_SIZE: return parse_size(o, text);
    case OPTION_TRIPLE: return parse_triple(text, o->value);
    case OPTION_CHOICE: return parse_choice(o, text);
    case OPTION_ONE_OF:
        if (!parse_choice(o, text))
            return false;
        *(uint32_t *)o->value = (uint32_t)strtoul(text, NULL, 10);
        return true;
    case OPTION_STEP: return parse_step(o, text);
    case OPTION_AMOUNT: return parse_amount(o, text);
    default: break;
    }
    if (!parse_number(text, &end, &number) || *end || number < o->min || number > o->max)
        return false;
    if (o->kind != OPTION_NUMBER && number != floor(number))
        return false;
    if (o->kind == OPTION_UINT)
        *(uint32_t *)o->value = (uint32_t)number;
    else if (o->kind == OPTION_INT)
        *(int32_t *)o->value = (int32_t)number;
    else
        *(double *)o->value = number;
    return true;
}

static const option *find(const option *options, const char *name, size_t length)
{
    for (; options->name; ++options) {
        bool is_long = length > 1 && strlen(options->name) == length;
        if (is_long ? !memcmp(options->name, name, length)
                    : length == 1 && options->letter == *name)
            return options;
    }
    return NULL;
}

static const option *find_any(const verb *v, const char *name, size_t length)
{
    const option *const tables[] = {v->options, limit_options, common_options};
    const option *found = NULL;
    for (int i = 0; i < 3 && !found; ++i)
        found = find(tables[i], name, length);
    return found;
}

static int wrong_value(const verb *v, const option *o, const char *value)
{
    char range[64] = "";
    if (o->max > o->min)
        snprintf(range, sizeof range, " (%g to %g)", o->min, o->max);
    print_message("gtx %s: error[usage]: --%s wants %s, not '%s'%s", v->name, o->name, o->argument,
                  value, range);
    return EXIT_CODE_USAGE;
}

int parse_options(const verb *v, int argc, char **argv, const char **operands, int *count)
{
    bool only_operands = false;
    *count = 0;
    for (int i = 1; i < argc; ++i) {
        const char *text = argv[i];
        if (only_operands || text[0] != '-' || !text[1]) {
            if (*count == v->max_operands)
                return usage(v, "one operand too many:", text);
            operands[(*count)++] = text;
            continue;
        }
        if (!strcmp(text, "--")) {
            only_operands = true;
            continue;
        }
        const char *name = text + (text[1] == '-' ? 2 : 1);
        const char *equals = text[1] == '-' ? strchr(name, '=') : NULL;
        size_t length = equals ? (size_t)(equals - name) : strlen(name);
        const option *o = find_any(v, name, length);
        if (!o || (text[1] != '-' && length != 1))
            return usage(v, "unknown option", text);
        if (o->kind == OPTION_FLAG) {
            if (equals)
                return usage(v, "no value belongs to", text);
            if (!o->value) {
                print_help(v);
                return EXIT_CODE_OK;
            }
            *(bool *)o->value = true;
            continue;
        }
        const char *value = equals ? equals + 1 : i + 1 < argc ? argv[++i] : NULL;
        if (!value)
            return usage(v, "a value is missing after", text);
        if (!parse_value(o, value))
            return wrong_value(v, o, value);
    }
    if (*count < v->min_operands)
        return usage(v, "operands are missing: expected", v->operands);
    return -1;
}
