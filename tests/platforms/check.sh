#!/bin/sh
# Other processors: the core and the cooker built by Debian's cross-compilers against packages of
# that processor, which are unpacked in a folder of their own, and their tests run there. Cooked
# bytes must be those of tests/cook/test_content. A row each, `name passed failed skipped`.
#   check.sh FOLDER [arm64|i386]...
# Needs mmdebstrap, and of each the cross-compilers; for arm64 qemu-user-static.
set -eu
folder=$(realpath -m "$1")
shift
packages=libc6-dev,libstdc++-12-dev,libopenmesh-dev,libdraco-dev,libtinygltf-dev,libeigen3-dev
packages=$packages,nlohmann-json3-dev,libmeshoptimizer-dev,libzstd-dev,zlib1g-dev,libcmocka-dev
packages=$packages,libopenimageio-dev
programs='tests/base/test_exact tests/base/test_limits tests/asset/test_codings
    tests/asset/test_golden tests/trace/test_cells tests/trace/test_caster tests/cook/test_content'
failed=0

for platform in ${*:-arm64 i386}; do
    root=$folder/$platform/root
    case $platform in
    arm64) triplet=aarch64-linux-gnu flags= run="qemu-aarch64-static -L $root" ;;
    i386) triplet=i686-linux-gnu flags='-msse2 -mfpmath=sse'
        libraries=$root/lib/i386-linux-gnu:$root/usr/lib/i386-linux-gnu
        run="$root/lib/ld-linux.so.2 --library-path $libraries" ;;
    *) echo "$0: unknown platform $platform" >&2; exit 2 ;;
    esac
    where=$triplet
    [ $platform = i386 ] && where=i386-linux-gnu
    [ -d "$root/usr" ] || mmdebstrap --quiet --architectures="$platform" --variant=extract \
        --include="$packages" bookworm "$root" 'deb http://deb.debian.org/debian bookworm main'
    out=$folder/$platform/release
    export PKG_CONFIG_SYSROOT_DIR="$root"
    export PKG_CONFIG_LIBDIR="$root/usr/lib/$where/pkgconfig:$root/usr/share/pkgconfig"
    # shellcheck disable=SC2086
    make --no-print-directory -j"$(nproc)" build="$folder/$platform" vulkan= gdal= \
        flags_release=-O2 CC="$triplet-gcc --sysroot=$root $flags" \
        CXX="$triplet-g++ --sysroot=$root $flags" \
        $(for program in $programs; do echo "$out/$program"; done) "$out/geotex-image.so" >&2
    for program in $programs; do
        log=$folder/$platform/$(basename $program).tap
        status=0
        CMOCKA_MESSAGE_OUTPUT=TAP GTX_OUT=$out $run "$out/$program" >"$log" 2>&1 || status=$?
        printf '%-6s %-24s %3d passed %2d failed %2d skipped\n' $platform $program \
            "$(grep '^ok' "$log" | grep -vc SKIP)" "$(grep '^not ok' "$log" | grep -vc SKIP)" \
            "$(grep -c SKIP "$log")"
        [ $status = 0 ] || failed=1
    done
done
exit $failed
