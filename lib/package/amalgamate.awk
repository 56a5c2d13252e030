# Many sources as one: prints them with the headers of lib where each is first included. Public
# headers are left out, for they come before.
#   awk -f lib/package/amalgamate.awk SOURCE...
#
# Names that two sources give to things of their own are kept apart by the preprocessor: behind its
# includes a source gets a #define for each, and at its end all that it defined is undefined. So
# such a name may be no member of a struct that a header declares.

# The path of what a source includes.
function where(path,    i, file, line)
{
    if (path in found)
        return found[path]
    for (i = 1; i <= roots; ++i) {
        file = root[i] "/" path
        if ((getline line < file) >= 0) {
            close(file)
            return found[path] = file
        }
    }
    print "amalgamate: " path " is nowhere" >"/dev/stderr"
    exit 1
}

# The names that a line at the margin gives to things that other files do not see.
function names_of(line,    tag)
{
    if (line ~ /^static .*[(]/) { # a function, or what is set by a call
        sub(/ *[(=].*/, "", line)
        sub(/\[.*/, "", line)
        sub(/.*[ *]/, "", line)
        return line
    }
    if (line ~ /^static /) { # one variable or several
        sub(/;.*/, "", line)
        gsub(/ *(\[[^]]*\])* *=[^,]*/, "", line)
        gsub(/ *, */, ",", line)
        sub(/\[.*/, "", line)
        sub(/^.*[ *]/, "", line)
        gsub(/,/, " ", line)
        return line
    }
    if (line ~ /^(typedef )?(struct|union|enum) [A-Za-z_0-9]+ \{/) {
        sub(/^typedef /, "", line)
        split(line, tag, " ")
        return tag[2]
    }
    if (line ~ /^typedef /) {
        sub(/ __attribute__.*/, "", line)
        sub(/ *[[;].*/, "", line)
        sub(/.*[ *]/, "", line)
        return line
    }
    if (line ~ /^\} [A-Za-z_0-9]+/) {
        gsub(/^\} | *[[;=].*/, "", line)
        return line
    }
    if (line ~ /^enum \{/) {
        gsub(/^enum \{|\}.*/, "", line)
        gsub(/ *=[^,]*/, "", line)
        gsub(/[ ,]+/, " ", line)
        return line
    }
    return ""
}

function look_at(source,    line, list, n, k)
{
    while ((getline line < source) > 0) {
        n = split(names_of(line), list, " ")
        for (k = 1; k <= n; ++k)
            if (list[k] ~ /^[A-Za-z_]/ && !((list[k], source) in own)) {
                own[list[k], source]
                of[source] = of[source] " " list[k]
                ++givers[list[k]]
            }
        if (line ~ /^#define /) {
            split(line, list, /[ (]/)
            macros[source] = macros[source] " " list[2]
        }
    }
    close(source)
}

function is_public(line)
{
    return line ~ /^#include <geotex\// || line ~ /^#define _POSIX_C_SOURCE/
}

# Prints a line, or what it includes: lists each time, headers once.
function show(line,    part, file)
{
    if (is_public(line))
        return
    if (line !~ /^#include "/) {
        print line
        return
    }
    split(line, part, "\"")
    file = where(part[2])
    if (file ~ /\.h$/ && file in shown)
        return
    shown[file]
    while ((getline line < file) > 0)
        show(line)
    close(file)
}

# Includes first, then the names, then the rest.
function show_source(source,    line, text, last, n, k)
{
    while ((getline line < source) > 0) {
        text[++n] = line
        if (line ~ /^#include.*\.h[">]/)
            last = n
    }
    close(source)
    print "\n/* ---- " source " ---- */"
    for (k = 1; k <= n; ++k) {
        show(text[k])
        if (k == last)
            define(source)
    }
    undefine(source)
}

function define(source,    list, n, k, stem)
{
    stem = source
    gsub(/^.*lib\/|\.c$/, "", stem)
    gsub(/[^A-Za-z0-9]/, "_", stem)
    n = split(of[source], list, " ")
    for (k = 1; k <= n; ++k)
        if (givers[list[k]] > 1)
            print "#define " list[k] " " stem "_" list[k]
}

function undefine(source,    list, n, k)
{
    n = split(of[source], list, " ")
    for (k = 1; k <= n; ++k)
        if (givers[list[k]] > 1)
            print "#undef " list[k]
    n = split(macros[source], list, " ")
    for (k = 1; k <= n; ++k)
        print "#undef " list[k]
}

BEGIN {
    roots = split("lib shaders", root, " ")
    for (a = 1; a < ARGC; ++a)
        look_at(ARGV[a])
    for (a = 1; a < ARGC; ++a)
        show_source(ARGV[a])
}
