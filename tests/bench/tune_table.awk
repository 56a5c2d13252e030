# The tables of tests/bench/tune: of lines "./FILE:NAME/FACTOR/MODEL<tab>FIGURES", a line a number
# on stdout, and one a number and model where something changed in `table`.
#   awk -F '\t' -v numbers=FILE -v table=OUT -f tests/bench/tune_table.awk

function told(figures,    f)
{
    if (figures !~ /^[0-9]/)
        return figures
    split(figures, f, " ")
    return f[1] " patches, " f[2] " texels, " f[3] " % empty, RMS " f[4] " %, " f[5] " holes, " \
        f[6] " B" (f[7] > 0 ? ", " \
        f[7] " LOD meshes of " f[8] " triangles, error " f[9] " %" : "")
}

function size(x) { return x < 0 ? -x : x }
function counted(k) { return k == 5 || k == 7 } # holes and LOD meshes: a difference, else a ratio
function short(model) { sub(/[.][^,]*/, "", model); return model }

# The greatest change of each figure over the models, with the model that has it.
function changes(number, factor,    i, k, m, a, b, d, worst, of, text, any)
{
    for (i = 1; i <= models; ++i) {
        m = model[i]
        if (cell[number, factor, m] == "")
            continue
        any = 1
        if (cell[number, factor, m] == "same")
            continue
        changed = 1
        if (cell[number, factor, m] ~ /^fails/) {
            text = text (text == "" ? "fails on " : ", ") short(m)
            large = 1
            continue
        }
        split(cell[number, factor, m], a, " ")
        split(cell[number, 1, m], b, " ")
        for (k = 1; k <= 9; ++k) {
            if (a[k] == "-" || b[k] == "-" || a[k] == b[k])
                continue
            d = counted(k) || k == 3 ? a[k] - b[k] : 100 * (a[k] / (b[k] ? b[k] : 1) - 1)
            if (size(d) > size(worst[k])) {
                worst[k] = d
                of[k] = short(m)
            }
        }
    }
    if (!any)
        return "not measured"
    for (k = 1; k <= 9; ++k) {
        i = substr("543126789", k, 1) + 0
        d = counted(i) ? sprintf("%+d", worst[i]) : sprintf("%+.1f %%", worst[i])
        if (d ~ /^[+-]0([.]0 %)?$/)
            continue
        large = large || i == 5 || (i != 3 && size(worst[i]) > 1)
        text = text (text == "" ? "" : ", ") what[i] " " d " (" of[i] ")"
    }
    return text != "" ? text : "same but for a few bytes"
}

BEGIN {
    split("patches,texels,empty,RMS,holes,bytes,LOD meshes,LOD triangles,LOD error", what,
        ",")
    while ((getline line < numbers) > 0) {
        split(line, part, "\t")
        name[++count] = part[1]
        kind[part[1]] = part[2]
        value[part[1]] = part[3]
    }
}

{
    match($1, /\/(0[.]5|1|2)\/[^\/]*$/)
    split(substr($1, RSTART + 1), part, "/")
    cell[substr($1, 3, RSTART - 3), part[1], part[2]] = $2
    if (!(part[2] in known)) {
        known[part[2]]
        model[++models] = part[2]
    }
}

END {
    printf "" > table
    for (n = 1; n <= count; ++n) {
        key = name[n]
        text = key " = " value[key]
        if (kind[key] ~ /^struct/) {
            print text " | half: - | double: - | " kind[key]
            continue
        }
        on = changed = large = 0
        for (i = 1; i <= models; ++i) {
            m = model[i]
            half = cell[key, 0.5, m]
            twice = cell[key, 2, m]
            on += half twice != ""
            if (half twice != "" && half twice != "samesame")
                print text " | " m " | half: " told(half) " | as is: " told(cell[key, 1, m]) \
                    " | double: " told(twice) > table
        }
        half = changes(key, 0.5)
        twice = changes(key, 2)
        if (!changed && on)
            half = twice = "same"
        verdict = !on ? "not measured" : kind[key] == "derived" ? "derived" : !changed ? \
            "nothing changes on " on " models" : "matters" (large ? "" : " (hardly: below 1 %)")
        print text " | half: " half " | double: " twice " | " verdict
    }
}
