#!/bin/sh
# Other compilers and processors: the core's tests, and where the packages of that processor are
# there the cooker's, whose bytes must be those of tests/cook/test_content; of the big-endian s390x
# the core's alone. A row each.
#   check.sh FOLDER [gcc-11|clang-14|mingw|i386|arm64|s390x]...
# Sources are compiled by Debian's (cross-)compilers against packages unpacked in FOLDER, and run by
# this machine's processor, by wine64 or by qemu-user-static. What is not installed is named.
set -eu
folder=$(mkdir -p "$1" && realpath "$1")
shift
mirror='deb http://deb.debian.org/debian bookworm main'
cmocka=http://deb.debian.org/debian/pool/main/c/cmocka/cmocka_1.1.7.orig.tar.xz
packages=libc6-dev,libstdc++-12-dev,libopenmesh-dev,libdraco-dev,libtinygltf-dev,libeigen3-dev
packages=$packages,nlohmann-json3-dev,libmeshoptimizer-dev,libzstd-dev,zlib1g-dev,libcmocka-dev
packages=$packages,libopenimageio-dev,libpng-dev,libjpeg-dev,libegl-dev,libglfw3-dev
core='base/test_exact base/test_error base/test_json base/test_limits asset/test_bad
    asset/test_codings asset/test_create asset/test_frames asset/test_patch asset/test_prefix
    derive/test_hierarchy derive/test_levels derive/test_proxies edit/test_edit
    edit/test_operations edit/test_combine stream/test_answers stream/test_stream'
cooker='trace/test_cells trace/test_caster cook/test_content'
options='vulkan= gdal= netcdf='
failed=0

# Packages of a processor, in a folder that compilers take for the root.
unpack()
{
    root=$folder/$1/root
    mkdir -p "$folder/$1"
    [ "$(cat "$folder/$1/packages" 2>/dev/null)" = "$packages" ] || {
        rm -rf "$root"
        mmdebstrap --quiet --architectures="$1" --variant=extract --include="$packages" \
            bookworm "$root" "$mirror"
        echo "$packages" >"$folder/$1/packages"
    }
    # Linkers follow links such as libm.so, and would leave the folder by those that begin with /.
    find "$root" -type l -lname '/*' | while read -r link; do
        target=$(readlink "$link")
        case $target in "$root"/*) ;; *) ln -sfn "$root$target" "$link" ;; esac
    done
    export PKG_CONFIG_SYSROOT_DIR="$root"
    export PKG_CONFIG_LIBDIR="$root/usr/lib/$2/pkgconfig:$root/usr/share/pkgconfig"
    libraries=/usr/lib/$2:/usr/lib/$2/blas:/usr/lib/$2/lapack:/lib/$2:/usr/lib
}

# cmocka for Windows, which Debian has no package of.
build_cmocka()
{
    root=$folder/mingw/cmocka
    [ -f "$root/libcmocka.a" ] || {
        mkdir -p "$root"
        curl -sfL "$cmocka" | tar -xJ -C "$root" --strip-components=1
        for name in INTTYPES_H STDINT_H UINTPTR_T MALLOC_H IO_H TIME_H; do
            echo "#define HAVE_$name 1"
        done >"$root/config.h"
        x86_64-w64-mingw32-gcc -O2 -DHAVE_CONFIG_H=1 -I"$root" -I"$root/include" \
            -c "$root/src/cmocka.c" -o "$root/cmocka.o"
        x86_64-w64-mingw32-ar qcs "$root/libcmocka.a" "$root/cmocka.o"
    }
    export PKG_CONFIG_LIBDIR="$root"
    printf 'Name: cmocka\nDescription: tests\nVersion: 1.1.7\nCflags: -I%s\nLibs: %s\n' \
        "$root/include" "$root/libcmocka.a" >"$root/cmocka.pc"
    export WINEPREFIX="$folder/mingw/wine" WINEDEBUG=-all
}

for platform in ${*:-gcc-11 clang-14 mingw i386 arm64 s390x}; do
    programs="$core $cooker" modules='geotex-image.so geotex-png-jpeg.so'
    more='' flags='' suffix='' run=''
    unset PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_LIBDIR
    case $platform in
    gcc-11) needs=g++-11 CC=gcc-11 CXX=g++-11 ;;
    clang-14) needs=clang-14 CC=clang-14 CXX=clang++-14 ;;
    mingw) needs='x86_64-w64-mingw32-g++ wine64' programs=$core modules='' more=zstd=0 suffix=.exe
        CC=x86_64-w64-mingw32-gcc CXX='x86_64-w64-mingw32-g++ -static' run=wine64 ;;
    i386) needs='mmdebstrap i686-linux-gnu-g++' CC=i686-linux-gnu-gcc CXX=i686-linux-gnu-g++
        flags='-msse2 -mfpmath=sse' ;;
    arm64) needs='mmdebstrap aarch64-linux-gnu-g++ qemu-aarch64-static'
        CC=aarch64-linux-gnu-gcc CXX=aarch64-linux-gnu-g++ ;;
    s390x) needs='mmdebstrap s390x-linux-gnu-g++ qemu-s390x-static' programs=$core modules=''
        CC=s390x-linux-gnu-gcc CXX=s390x-linux-gnu-g++ ;;
    *) echo "$0: unknown platform $platform" >&2; exit 2 ;;
    esac
    PATH=$PATH:/usr/lib/wine
    missing=
    for program in $needs; do
        command -v "$program" >/dev/null || missing="$missing $program"
    done
    if [ "$missing" ]; then
        echo "$platform: not there:$missing"
        continue
    fi
    case $platform in
    mingw) build_cmocka ;;
    i386) unpack i386 i386-linux-gnu
        flags="$flags -Wl,--dynamic-linker=$root/lib/ld-linux.so.2"
        run="env LD_LIBRARY_PATH=$(echo "$libraries" | sed "s|/*:/|:$root/|g; s|^|$root|")" ;;
    arm64) unpack arm64 aarch64-linux-gnu
        run="qemu-aarch64-static -L $root -E LD_LIBRARY_PATH=$libraries" ;;
    s390x) unpack s390x s390x-linux-gnu
        run="qemu-s390x-static -L $root -E LD_LIBRARY_PATH=$libraries" ;;
    esac
    [ "${PKG_CONFIG_SYSROOT_DIR:-}" ] && CC="$CC --sysroot=$root" CXX="$CXX --sysroot=$root"
    out=$folder/$platform/release
    # shellcheck disable=SC2086
    make --no-print-directory -j"$(nproc)" build="$folder/$platform" $options $more \
        flags_release=-O2 CC="$CC $flags" CXX="$CXX $flags" \
        $(for p in $programs; do echo "$out/tests/$p"; done) \
        $(for m in $modules; do echo "$out/$m"; done) >&2
    for program in $programs; do
        log=$folder/$platform/$(basename "$program").tap
        status=0
        # shellcheck disable=SC2086
        CMOCKA_MESSAGE_OUTPUT=TAP GTX_OUT=$out $run "$out/tests/$program$suffix" >"$log" 2>&1 ||
            status=$?
        printf '%-8s %-22s %3d passed %2d failed %2d skipped\n' "$platform" "$program" \
            "$(grep '^ok' "$log" | grep -vci SKIP)" "$(grep '^not ok' "$log" | grep -vci SKIP)" \
            "$(grep -ci SKIP "$log")"
        [ $status = 0 ] || failed=1
    done
done
exit $failed
