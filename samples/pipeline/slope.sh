#!/bin/sh
# What worlds of a sculpt cost, a row each: processor seconds, the largest memory, bytes; and then
# what a frame takes around them, a row each, where WALK is samples/world.
#   [WALK=WORLD] [PLAN=OPTIONS] slope.sh GTX SCULPT FOLDER JOBS TRIANGLES...
# SCULPT may be more than a name: "sculpt --terrain GRID".
# Needs Ninja, and /usr/bin/time of GNU. Worlds stay in FOLDER/TRIANGLES, 120 bytes a triangle; a
# step that was killed begins again, what was cooked stays.
set -e
gtx=$(realpath "$1") sculpt=$2 folder=$3 jobs=$4 # Ninja works in the world's folder
shift 4
mkdir -p "$folder"

cook() {
    world=$folder/$1
    [ -f "$world/build.ninja" ] ||
        $sculpt --triangles "$1" - | /usr/bin/time -o "$world.plan" -f '%U %S %M' \
            "$gtx" world plan - -o "$world" --triangles 1e6 --glb $PLAN >&2
    [ -f "$world/tiles.gtw" ] ||
        GTX=$gtx /usr/bin/time -o "$world.cook" -f '%U %S %M' \
            ninja -C "$world" -j "$jobs" >"$world.log"
    cat "$world.plan" "$world.cook" | tr '\n' ' ' | awk -v count="$1" \
        -v tiles="$(find "$world/tiles" -name '*.gtx' | wc -l)" \
        -v bytes="$(cat "$world"/tiles/*.gtx | wc -c)" \
        -v root="$(wc -c <"$world/tiles/r.gtx")" '{
            printf "| %g | %d | %.1f | %.0f | %.0f, %.0f | %.1f | %.2f | %.2f |\n",
                   count, tiles, $1 + $2, $4 + $5, $3 / 1000, $6 / 1000, bytes / 1e6, root / 1e6,
                   bytes / count }'
}

# 600 frames of 1280 x 720 around a world, kept at half of that: what the sample tells of them.
walk() {
    "$WALK" "$folder/$1" --headless "$folder/$1.png" --size 640x360 | tr '\n' ' ' |
        sed 's/[^0-9. ]//g' | awk -v count="$1" '{
            printf "| %g | %s | %s | %s | %s, %s | %s | %s |\n",
                   count, $4, $5, $6, $7, $8, $9, $10 }'
}

printf '%s' "| triangles | tiles | plan, s | split, cook, merge, s | largest MB, plan and others "
echo "| assets, MB | root, MB | B a triangle |"
echo "|---|---|---|---|---|---|---|---|"
for count; do
    cook "$count"
done
[ "$WALK" ] || exit 0
printf '\n%s' "| triangles | ms a frame, median | nine of ten | tiles a frame "
echo "| MB at most, CPU and GPU | MB until the first picture | MB read |"
echo "|---|---|---|---|---|---|---|"
for count; do
    walk "$count"
done
