# Makes every named number of a source one that can be multiplied: the statements become
# `static const TYPE NAME = gtx_tune<TYPE>("FILE:NAME", VALUE);`, and their names, whether they are
# tuned, derived from others or structural, and their values are added to `numbers`.
#   awk -v file=bake/mask.cpp -v numbers=OUT -f tests/bench/tune_numbers.awk lib/bake/mask.cpp

# Numbers that are none to choose, as patterns of FILE:NAME without folders.
function structural(name)
{
    name = file ":" name
    if (name ~ /:NO_[A-Z_]+$|:(UNUSED|OFF|OPEN)$/) return "means none, or is a bit"
    if (name ~ /:[A-Z]+_CHANNELS$/) return "of the format"
    if (name ~ /MIN_CODE$/) return "a code of the format"
    if (name ~ /:(COOKER_REVISION|DEFAULT_ZSTD)$/) return "a version, a default"
    if (name ~ /pgp.hpp:UV_GRID$|height_field.hpp:DIAGONAL$/) return "mathematics"
    if (name ~ /vsa.cpp:(BUCKETS|WORDS|LOWEST)$|fan.hpp:MAX_FAN$/) return "array size"
    return ""
}

function declared(text,    name, value, why)
{
    name = text
    sub(/ *=.*/, "", name)
    gsub(/[ \t]/, "", name)
    value = text
    sub(/^[^=]*= */, "", value)
    gsub(/[ \t]+/, " ", value)
    why = structural(name)
    why = why != "" ? "structural: " why : value ~ /[A-Z][A-Z_]/ ? "derived" : "tuned"
    if (file !~ /^measure/)
        print file ":" name "\t" why "\t" value >> numbers
    if (why ~ /^structural/)
        return head type " " name " = " value "; "
    return indent "static const " type " " name " = gtx_tune<" type ">(\"" file ":" name "\", " \
        value "); "
}

/^[ \t]*((static|inline) )*(constexpr|static const) [a-z0-9_]+ [A-Z][A-Z0-9_]* = / {
    text = $0
    while (text !~ /;/) {
        getline
        text = text " " $0
    }
    rest = substr(text, index(text, ";") + 1)
    text = substr(text, 1, index(text, ";") - 1)
    match(text, /^[ \t]*/)
    indent = substr(text, 1, RLENGTH)
    match(text, /^[ \t]*((static|inline) )*(constexpr|static const) /)
    head = substr(text, 1, RLENGTH)
    text = substr(text, RLENGTH + 1)
    type = text
    sub(/ .*/, "", type)
    sub(/^[^ ]+ /, "", text)
    made = one = ""
    depth = 0
    for (at = 1; at <= length(text); ++at) { # a comma outside of brackets ends a declarator
        c = substr(text, at, 1)
        depth += (c ~ /[({]/) - (c ~ /[)}]/)
        if (c == "," && !depth) {
            made = made declared(one)
            one = ""
        } else
            one = one c
    }
    $0 = made declared(one) rest
}

{ print }
