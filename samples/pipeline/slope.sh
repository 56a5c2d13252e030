#!/bin/sh
# What worlds of a sculpt cost, a row each: processor seconds, the largest memory, bytes.
#   slope.sh GTX SCULPT FOLDER JOBS TRIANGLES...
# Needs Ninja, and /usr/bin/time of GNU. Worlds stay in FOLDER/TRIANGLES.
set -e
gtx=$1 sculpt=$2 folder=$3 jobs=$4
shift 4
mkdir -p "$folder"
printf '%s' "| triangles | tiles | plan, s | split, cook, merge, s | largest MB, plan and others "
echo "| assets, MB | root, MB | B a triangle |"
echo "|---|---|---|---|---|---|---|---|"
for count; do
    world=$folder/$count
    rm -rf "$world"
    "$sculpt" --triangles "$count" - | /usr/bin/time -o "$world.plan" -f '%U %S %M' \
        "$gtx" world plan - -o "$world" --triangles 1e6 --glb
    GTX=$gtx /usr/bin/time -o "$world.cook" -f '%U %S %M' \
        ninja -C "$world" -j "$jobs" >"$world.log"
    cat "$world.plan" "$world.cook" | tr '\n' ' ' | awk -v count="$count" \
        -v tiles="$(find "$world/tiles" -name '*.gtx' | wc -l)" \
        -v bytes="$(cat "$world"/tiles/*.gtx | wc -c)" \
        -v root="$(wc -c <"$world/tiles/r.gtx")" '{
            printf "| %g | %d | %.1f | %.0f | %.0f, %.0f | %.1f | %.2f | %.2f |\n",
                   count, tiles, $1 + $2, $4 + $5, $3 / 1000, $6 / 1000, bytes / 1e6, root / 1e6,
                   bytes / count }'
done
