#!/bin/sh
# Compiles the texts that write_texts writes, each once, and prints them as C.
#   lib/vulkan/spirv.sh WRITE_TEXTS FOLDER
# What is compiled stays in the folder, for texts that come again.
set -e
folder=$2/$(cksum <"$0" | cut -d ' ' -f 1)
mkdir -p "$folder"
rm -f "$folder"/*.vert "$folder"/*.two "$folder"/*.frag "$folder/table"
"$1" "$folder" own
cd "$folder"
echo '/* Generated from shaders/. */'
echo '#include "vulkan/spirv.h"'
for text in *.vert *.two *.frag; do
    case $text in *.frag) stage=frag ;; *) stage=vert ;; esac
    sum=$(cksum <"$text" | tr ' ' _)
    grep -q " $sum " table 2>/dev/null && known=1 || known=
    echo "$text $sum " >>table
    [ -z "$known" ] || continue
    [ -e "$sum.spv" ] || \
        glslangValidator -V --target-env vulkan1.0 -g0 -S $stage -o new "$text" >log || {
        cat log >&2
        exit 1
    }
    [ -e "$sum.spv" ] || mv new "$sum.spv"
    echo "static const uint32_t code_$sum[] = {"
    od -An -v -tx4 "$sum.spv" | sed 's/ \([0-9a-f][0-9a-f]*\)/0x\1,/g'
    echo '};'
done
echo 'const gtx_spirv gtx_spirvs[] = {'
sed 's/\([0-9]*\)\.vert \(.*\) /{\1, 0, code_\2, sizeof code_\2},/
     s/\([0-9]*\)\.frag \(.*\) /{\1, 1, code_\2, sizeof code_\2},/
     s/\([0-9]*\)\.two \(.*\) /{\1, 2, code_\2, sizeof code_\2},/' table
echo '{0, 0, 0, 0}};'
