/* geotex-netcdf: a NetCDF-4 file on stdin -> one of the classic kind on stdout, whose reader is our
 * own. A program, so that HDF5's library may crash on what is damaged: only this process ends. It
 * sees bytes alone; no file, however HDF5 names one inside another, can be opened once it looks.
 *
 *   geotex-netcdf BYTES     most memory to take
 *
 * What it writes is 'C', the size as eight bytes, the highest first, and the file; or 'E' and a
 * sentence. */
#include <netcdf.h>
#include <netcdf_mem.h>

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { MAX_SIDES = 64, MAX_VARIABLES = 1 << 12, MAX_ATTRIBUTES = 1 << 10 };
/* Of the processor, for what would never end: 13 million deflated nodes take a tenth of one, so
 * half would do, and twice as many would only let it run longer. */
enum { SECONDS = 60 };

static _Noreturn void fail(const char *sentence)
{
    printf("E%.140s", sentence);
    fflush(stdout);
    _Exit(1);
}

static void require(int code)
{
    if (code != NC_NOERR)
        fail(nc_strerror(code));
}

static void *take(size_t bytes)
{
    void *memory = malloc(bytes ? bytes : 1);
    if (!memory)
        fail("out of memory");
    return memory;
}

static void limit(int what, rlim_t most)
{
    const struct rlimit both = {most, most};
    if (setrlimit(what, &both) != 0)
        fail("a limit of the process cannot be set");
}

static void *read_all(size_t *size)
{
    size_t room = 1 << 20;
    char *out = take(room);
    for (size_t got = 1; got > 0; *size += got) {
        if (*size == room) {
            room *= 2;
            char *larger = realloc(out, room);
            if (!larger)
                fail("out of memory");
            out = larger;
        }
        got = fread(out + *size, 1, room - *size, stdin);
    }
    return out;
}

/* Types that classic files have, too: numbers and characters. */
static int is_plain(nc_type type)
{
    return type >= NC_BYTE && type <= NC_UINT64;
}

/* Texts of HDF5 become characters; what is of no plain type is left out. */
static void copy_attributes(int from, int variable, int count, int to, int copy)
{
    for (int k = 0; k < count && k < MAX_ATTRIBUTES; ++k) {
        char name[NC_MAX_NAME + 1];
        nc_type type;
        size_t length;
        require(nc_inq_attname(from, variable, k, name));
        require(nc_inq_att(from, variable, name, &type, &length));
        if (is_plain(type)) {
            require(nc_copy_att(from, variable, name, to, copy));
        } else if (type == NC_STRING && length == 1) {
            char *text = NULL;
            require(nc_get_att_string(from, variable, name, &text));
            if (text)
                require(nc_put_att_text(to, copy, name, strlen(text), text));
            nc_free_string(1, &text);
        }
    }
}

typedef struct variable {
    int id, copy, sides, attributes;
    nc_type type;
    size_t bytes;
    char name[NC_MAX_NAME + 1];
    int dimensions[NC_MAX_VAR_DIMS];
} variable;

/* What a grid may be, or tell where it lies; larger fields are no grids, and left out. */
static int is_wanted(int from, variable *v)
{
    size_t size = 0, count = 1;
    int nodes = 0;
    require(nc_inq_varndims(from, v->id, &v->sides));
    if (v->sides > MAX_SIDES)
        return 0;
    require(nc_inq_var(from, v->id, v->name, &v->type, &v->sides, v->dimensions, &v->attributes));
    if (!is_plain(v->type))
        return 0;
    require(nc_inq_type(from, v->type, NULL, &size));
    for (int k = 0; k < v->sides; ++k) {
        size_t side;
        if (v->dimensions[k] < 0 || v->dimensions[k] >= NC_MAX_DIMS)
            return 0;
        require(nc_inq_dimlen(from, v->dimensions[k], &side));
        nodes += side > 1;
        if (side == 0 || count > SIZE_MAX / 16 / side)
            return 0;
        count *= side;
    }
    v->bytes = count * size;
    return nodes <= 2;
}

static void copy_dimensions(int from, int to, int copies[NC_MAX_DIMS])
{
    int count, ids[NC_MAX_DIMS];
    require(nc_inq_ndims(from, &count));
    if (count > NC_MAX_DIMS)
        fail("it has too many dimensions");
    require(nc_inq_dimids(from, &count, ids, 0));
    for (int k = 0; k < count; ++k) {
        char name[NC_MAX_NAME + 1];
        size_t size;
        require(nc_inq_dim(from, ids[k], name, &size));
        if (ids[k] < 0 || ids[k] >= NC_MAX_DIMS)
            fail("its dimensions are of a kind that is not known");
        if (size > 0) /* 0 would be a dimension without an end */
            require(nc_def_dim(to, name, size, &copies[ids[k]]));
    }
}

static void copy(int from, int to)
{
    static int copies[NC_MAX_DIMS];
    int count, kept = 0, filled;
    copy_dimensions(from, to, copies);
    require(nc_inq_nvars(from, &count));
    if (count > MAX_VARIABLES)
        fail("it has too many variables");
    variable *all = take((size_t)count * sizeof *all);
    for (int k = 0; k < count; ++k) {
        variable *v = &all[kept];
        v->id = k;
        if (!is_wanted(from, v))
            continue;
        int sides[MAX_SIDES];
        for (int d = 0; d < v->sides; ++d)
            sides[d] = copies[v->dimensions[d]];
        require(nc_def_var(to, v->name, v->type, v->sides, sides, &v->copy));
        copy_attributes(from, v->id, v->attributes, to, v->copy);
        ++kept;
    }
    require(nc_set_fill(to, NC_NOFILL, &filled));
    require(nc_enddef(to));
    for (int k = 0; k < kept; ++k) {
        void *values = take(all[k].bytes);
        require(nc_get_var(from, all[k].id, values));
        require(nc_put_var(to, all[k].copy, values));
        free(values);
    }
}

int main(int count, char **arguments)
{
    const unsigned long long most = count == 2 ? strtoull(arguments[1], NULL, 10) : 0;
    size_t size = 0;
    int from, to;
    NC_memio made;
    if (most == 0)
        fail("it takes the most bytes that it may use");
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, 0);
    limit(RLIMIT_CPU, SECONDS);
    limit(RLIMIT_AS, (rlim_t)most);
    limit(RLIMIT_NOFILE, 0); /* those that are open stay so */
    void *bytes = read_all(&size);
    require(nc_open_mem("grid", NC_NOWRITE, size, bytes, &from));
    require(nc_create_mem("grid", NC_64BIT_DATA, size, &to));
    copy(from, to);
    require(nc_close_memio(to, &made));
    putchar('C');
    for (int k = 56; k >= 0; k -= 8)
        putchar((int)((uint64_t)made.size >> k & 255));
    if (fwrite(made.memory, 1, made.size, stdout) != made.size || fflush(stdout) != 0)
        _Exit(1);
    _Exit(0);
}
