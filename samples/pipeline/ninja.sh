#!/bin/sh
# Writes a build.ninja that cooks every model of a folder, each again only where something behind it
# changed:
#   ninja.sh MODELS OUT [GTX] >build.ninja && ninja
set -e
models=${1%/} out=${2%/} gtx=$(command -v "${3:-gtx}")
path() { printf '%s' "$1" | sed 's/[$ :]/$&/g'; } # as Ninja wants one

cat <<EOF
ninja_required_version = 1.5

# The depfile tells Ninja what a model refers to. Where the content of all that is as it was, gtx
# leaves the asset alone, and restat spares what is made from it. Models are cooked side by side, so
# one takes one thread.
rule cook
  command = '$(printf '%s' "$gtx" | sed 's/\$/$$/g')' cook -q --threads 1 \$
      --if-changed --depfile \$out.d \$in -o \$out
  depfile = \$out.d
  deps = gcc
  restat = 1
  description = COOK \$out

EOF
# Buffers, images and material libraries are no models: they come with the one that names them.
find "$models" -type f | sed -n -E '/\.(glb|gltf|drc|ply|obj|off|stl)(\.gz)?$/p' | sort |
while IFS= read -r model; do
    asset=$out/${model#"$models"/}.gtx
    echo "build $(path "$asset"): cook $(path "$model") | $(path "$gtx")"
done
