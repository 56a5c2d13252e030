#!/bin/sh
# An asset's exports in other programs: run.sh GTX ASSET FOLDER [MODULES]
#   MODULES  a node_modules folder with what there is of three, puppeteer-core and gltf-validator
# Writes FOLDER/PROGRAM.png, and of each program and kind of export a line: "ok NAME: what it made",
# "skip NAME" where it is not installed, or "not ok NAME" after what it said.
gtx=$(realpath "$1") asset=$(realpath "$2") modules=${4:+$(realpath "$4")}
here=$(dirname "$(realpath "$0")") failed=0
mkdir -p "$3" && cd "$3" || exit 1
for kind in none meshopt draco; do
    "$gtx" export "$asset" -q --compress $kind -o $kind.glb || exit 1
done
"$gtx" export "$asset" -q --textures ktx2 -o ktx2.glb || exit 1
"$gtx" export "$asset" -q --lods -o lods.glb || exit 1
"$gtx" export "$asset" -q --collision -o collision.glb || exit 1

# NAME COMMAND...: what it says counts only where it fails.
try() {
    name=$1 && shift
    if "$@" >said.txt 2>&1 && grep -q '^made: ' said.txt; then
        grep '^made: ' said.txt | sed "s|^made|ok $name|"
    else
        cat said.txt
        echo "not ok $name"
        failed=1
    fi
}

# A project of its own, with the export among its files; a home of its own keeps settings.
in_godot() {
    rm -rf godot && cp -r "$here/godot" godot && cp none.glb godot/model.glb || return 1
    for step in "-e -q" ""; do
        HOME=$PWD/godot XDG_DATA_HOME=$PWD/godot/home timeout 120 xvfb-run -a \
            -s "-screen 0 640x640x24" godot3 --path godot --audio-driver Dummy $step || return 1
    done
    mv godot/picture.png godot.png && rm -rf godot
}

has() {
    command -v "$1" >/dev/null
}

if has node && [ -d "$modules/gltf-validator" ]; then
    for kind in none meshopt draco ktx2 lods collision; do
        try "validator $kind" node "$here/validate.mjs" "$modules" $kind.glb
    done
else
    echo "skip validator"
fi
if has node && has "${CHROMIUM:-chromium}" && [ -d "$modules/three" ] &&
   [ -d "$modules/puppeteer-core" ]; then
    for kind in none meshopt draco ktx2; do
        try "three $kind" timeout 120 node "$here/three.mjs" "$modules" $kind.glb three_$kind.png
    done
else
    echo "skip three"
fi
if has blender; then
    try blender timeout 120 blender -b --factory-startup --python-exit-code 1 \
        --python "$here/blender.py" -- none.glb "$PWD/blender.png"
else
    echo "skip blender"
fi
if has godot3 && has xvfb-run; then
    try godot in_godot
else
    echo "skip godot"
fi
exit $failed
