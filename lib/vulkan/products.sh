#!/bin/sh
# The shaders of pipelines as products: GLSL, SPIR-V, HLSL, MSL and WGSL, each text once, and which
# pipeline has which.
#   lib/vulkan/products.sh WRITE_TEXTS FOLDER [PIPELINE...]
# FOLDER gets glsl, spirv, hlsl, msl, wgsl and pipelines.json. What a tool that is not installed
# would make is left out and said; what one refuses is an error. See format/shaders.md.
set -e
write=$1 folder=$2
shift 2
has() { command -v "$1" >/dev/null; }
run() { "$@" >"$folder/log" 2>&1 || { echo "$*" >&2; cat "$folder/log" >&2; exit 1; }; }
has glslangValidator || { echo '  shaders: nothing is made: no glslangValidator' >&2; exit 0; }
has spirv-val || echo '  shaders: spirv is not checked: no spirv-val' >&2
has spirv-cross || echo '  shaders: hlsl, msl are left out: no spirv-cross' >&2
has naga || echo '  shaders: wgsl is left out: no naga (a crate: cargo install naga-cli)' >&2
rm -rf "$folder"
mkdir -p "$folder/texts" "$folder/glsl" "$folder/spirv"
"$write" "$folder/texts"

# Textures without samplers, and one sampler for those that are filtered.
separate()
{
    sed -e '1a #extension GL_EXT_samplerless_texture_functions : require' \
        -e '1a #define GTX_FETCH' \
        -e '1a layout(set = 0, binding = 16) uniform sampler gtx_linear;' \
        -e 's/GTX_SAMPLER(\([0-9]*\), highp/layout(set = 0, binding = \1) uniform highp/' \
        -e 's/^\(layout(.*uniform highp u*\)sampler\([0-9A-Za-z]*\))/\1texture\2/' \
        -e 's/(highp sampler2DArray map/(highp texture2DArray map/' \
        -e 's/textureLod(\(gtx_[a-z]*\|map\),/textureLod(sampler2DArray(\1, gtx_linear),/' \
        -e 's/#define GTX_GATHER/#define GTX_NO_GATHER/' "$1"
}

make_one() # TEXT NAME: a text in all languages
{
    cp "$1" "$folder/glsl/$2"
    run glslangValidator -V --target-env vulkan1.0 -g0 -o "$folder/spirv/$2.spv" "$1"
    if has spirv-val; then run spirv-val --target-env vulkan1.0 "$folder/spirv/$2.spv"; fi
    sed '1a #define GTX_FETCH' "$1" >"$folder/fetch.${2##*.}"
    run glslangValidator -V --target-env vulkan1.0 -g0 -o "$folder/fetch.spv" \
        "$folder/fetch.${2##*.}"
    if has spirv-cross; then
        mkdir -p "$folder/hlsl" "$folder/msl"
        run spirv-cross --hlsl --shader-model 50 "$folder/fetch.spv" \
            --output "$folder/hlsl/$2.hlsl"
        run glslangValidator -D -V -e main -S "${2##*.}" -o "$folder/fetch.hlsl.spv" \
            "$folder/hlsl/$2.hlsl"
        run spirv-cross --msl --msl-version 20100 --msl-decoration-binding \
            --msl-texture-buffer-native "$folder/fetch.spv" --output "$folder/msl/$2.metal"
    fi
    # In WGSL no array goes from stage to stage, as those of tiles do.
    if has naga && ! grep -q '^#define GTX_TILES' "$1"; then
        mkdir -p "$folder/wgsl"
        separate "$1" >"$folder/separate.${2##*.}"
        run glslangValidator -V --target-env vulkan1.0 -g0 -o "$folder/separate.spv" \
            "$folder/separate.${2##*.}"
        run naga "$folder/separate.spv" "$folder/wgsl/$2.wgsl"
        run naga "$folder/wgsl/$2.wgsl"
    fi
}

[ $# -gt 0 ] || set -- $(cd "$folder/texts" && ls *.vert | sed 's/\.vert//' | sort -n)
echo '{' >"$folder/pipelines.json"
for pipeline; do
    for stage in vert frag; do
        text=$folder/texts/$pipeline.$stage
        name=$(cksum <"$text" | cut -d ' ' -f 1).$stage
        [ -e "$folder/glsl/$name" ] || make_one "$text" "$name"
        eval "$stage=$name"
    done
    [ "$pipeline" = "$1" ] || echo ',' >>"$folder/pipelines.json"
    printf '"%s": {"vertex": "%s", "fragment": "%s"}' "$pipeline" "$vert" "$frag" \
        >>"$folder/pipelines.json"
done
printf '\n}\n' >>"$folder/pipelines.json"
cd "$folder" && rm -rf texts log fetch.* separate.*
