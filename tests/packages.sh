#!/bin/sh
# packages.sh DIR: what `make install`, `make dist` and `make lib` give, used as a stranger uses it, in the empty folder DIR. What goes
# into files of CMake and Meson are the snippets of README.md, with a repository of this machine for the address. Run by
# `make packages`. Environment: CC (cc), MAKE (make), PYTHON (python3).
set -u
rm -rf "${1:?}" && mkdir -p "$1" || exit 1
dir=$(cd "$1" && pwd)
began=${BEGAN:-$(date +%s)} cc=${CC:-cc} python=${PYTHON:-python3}
root=$(pwd)
installed=$dir/dest/opt/mcs
export MAKEFLAGS=
passed=0 failed=0
check() { # STATUS WHAT [FILE]: FILE tells why
    if [ "$1" = 0 ]; then
        passed=$((passed + 1))
        echo "ok   $2"
    else
        failed=$((failed + 1))
        echo "FAIL $2"
        [ -z "${3:-}" ] || tail -n 12 "$3"
    fi
}
has() {
    command -v "$1" >/dev/null && return 0
    echo "SKIPPED: no $1 here: $2"
    return 1
}
make_() { "${MAKE:-make}" --no-print-directory "$@" >"$dir/make.log" 2>&1; }

# snippet LANGUAGE NUMBER: that block of the section of README.md.
snippet() {
    awk -v begin="\`\`\`$1" -v wanted="$2" '
        /^## / { here = /^## Add it to a project/ }
        here && $0 == begin { n++; inside = n == wanted; next }
        /^```/ { inside = 0 }
        inside' README.md | sed "s,https://[^ ]*\.git,file://$dir/origin,"
}

version=$(sed -n 's/.*define MCS_VERSION_STRING "\(.*\)".*/\1/p' mcsample.h)
sed "s/^int main.*/&\n    if (strcmp(MCS_VERSION_STRING, \"$version\")) return 1;/; 1i #include <string.h>" examples/02_disk.c >"$dir/user.c"
grep -q strcmp "$dir/user.c" && [ -n "$version" ]
check $? "a program that asks for version $version"

# --- installed
make_ install DESTDIR="$dir/dest" PREFIX=/opt/mcs && (cd "$installed" && find . -type f | LC_ALL=C sort) >"$dir/files"
[ "$(tr '\n' ' ' <"$dir/files")" = "./include/mcsample.h ./lib/cmake/mcsample/mcsample-config-version.cmake \
./lib/cmake/mcsample/mcsample-config.cmake ./lib/pkgconfig/mcsample.pc " ]
check $? "make install: header and files for pkg-config and CMake" "$dir/make.log"
if has pkg-config "its file is read by hand"; then
    flags=$(PKG_CONFIG_SYSROOT_DIR="$dir/dest" PKG_CONFIG_PATH="$installed/lib/pkgconfig" pkg-config --cflags --libs "mcsample = $version")
else
    flags="-I$installed/include -lm"
    grep -q "^Version: $version\$" "$installed/lib/pkgconfig/mcsample.pc" || flags=
fi
# shellcheck disable=SC2086
(cd "$dir" && $cc -std=c99 user.c -o user $flags && ./user) >"$dir/log" 2>&1
check $? "pkg-config: $flags" "$dir/log"

# --- a repository as the snippets fetch it
fetched=
if has git "the snippets that fetch are not tested"; then
    mkdir "$dir/origin" && cp mcsample.h LICENSE README.md "$dir/origin" &&
        (cd "$dir/origin" && git init -q -b main && git add . &&
            git -c user.name=tests -c user.email=tests@localhost commit -q -m "a copy") >"$dir/log" 2>&1 && fetched=yes
    check $? "a repository to fetch from" "$dir/log"
fi

# project NAME: the folder $dir/NAME, with a CMakeLists.txt that standard input ends.
project() {
    mkdir "$dir/$1" && {
        printf 'cmake_minimum_required(VERSION 3.14)\nproject(user C)\nset(CMAKE_EXPORT_COMPILE_COMMANDS ON)\n'
        printf 'add_executable(app ../user.c)\nif(UNIX)\n  target_link_libraries(app PRIVATE m)\nendif()\n'
        cat
    } >"$dir/$1/CMakeLists.txt"
}
with_cmake() { # NAME
    (cd "$dir/$1" && cmake -DCMAKE_C_COMPILER="$cc" -DCMAKE_PREFIX_PATH="$installed" . && cmake --build . && ./app &&
        grep -q -- -isystem compile_commands.json) >"$dir/log" 2>&1
    check $? "CMake, $1: builds, runs, takes the header for a system's" "$dir/log"
}
if has cmake "its snippets and files are not tested"; then
    {
        for v in 99 "$version.1" 0.0.1; do echo "find_package(mcsample $v QUIET)" && echo "list(APPEND found \"\${mcsample_FOUND}\")"; done
        # shellcheck disable=SC2016
        printf 'if(NOT found STREQUAL "0;0;1")\n  message(FATAL_ERROR "versions: ${found}")\nendif()\n'
        snippet cmake 1
        printf 'find_package(mcsample %s EXACT REQUIRED)\n' "$version" # again, which adds nothing
    } | project find_package
    with_cmake find_package
    if [ -n "$fetched" ]; then
        snippet cmake 2 | project FetchContent
        with_cmake FetchContent
    fi
fi

if [ -n "$fetched" ] && has meson "its snippets are not tested" && has ninja "the snippets for Meson are not tested"; then
    mkdir -p "$dir/meson/subprojects/packagefiles/mcsample"
    cp "$dir/user.c" "$dir/meson"
    snippet ini 1 >"$dir/meson/subprojects/mcsample.wrap"
    snippet meson 1 >"$dir/meson/subprojects/packagefiles/mcsample/meson.build"
    cat >"$dir/meson/meson.build" <<'END'
project('user', 'c')
m = meson.get_compiler('c').find_library('m', required: false)
executable('app', 'user.c', dependencies: [m, dependency('mcsample')])
END
    (cd "$dir/meson" && CC="$cc" meson setup build && ninja -C build && build/app && grep -q -- -isystem build/build.ninja) >"$dir/log" 2>&1
    check $? "Meson, a wrap: builds, runs, takes the header for a system's" "$dir/log"
fi

touch "$installed/lib/pkgconfig/other.pc"
make_ uninstall DESTDIR="$dir/dest" PREFIX=/opt/mcs && [ "$(cd "$installed" && find . -name '*mcsample*' -o -type f)" = ./lib/pkgconfig/other.pc ]
check $? "make uninstall: takes away what was installed and nothing else" "$dir/make.log"

# --- packed, here and from a copy of other times, modes and places
if tar --version 2>/dev/null | grep -q 'GNU tar'; then
    mkdir "$dir/copy" && cp mcsample.h LICENSE README.md Makefile "$dir/copy" && chmod 600 "$dir/copy"/*
    make_ dist BUILD="$dir/first" && (umask 077 && cd "$dir/copy" && make_ dist BUILD=second) &&
        cmp "$dir/first/mcsample-$version.tar.gz" "$dir/copy/second/mcsample-$version.tar.gz"
    check $? "make dist: the same bytes again" "$dir/make.log"
    mkdir "$dir/unpacked" && tar -C "$dir/unpacked" -xzf "$dir/first/mcsample-$version.tar.gz" &&
        [ "$(cd "$dir/unpacked" && find . -type f | LC_ALL=C sort | tr '\n' ' ')" = \
            "./mcsample-$version/LICENSE ./mcsample-$version/README.md ./mcsample-$version/mcsample.h " ] &&
        cmp mcsample.h "$dir/unpacked/mcsample-$version/mcsample.h"
    check $? "make dist: header, licence and README"
else
    echo "SKIPPED: no GNU tar here: make dist is not tested"
fi

# --- the library: points of a disk, in three languages
make_ lib CFLAGS='-O0 -DMCS_NO_WIDE' CC="$cc" BUILD="$dir" # hygiene.sh has one with all lanes
check $? "make lib" "$dir/make.log"
cat >"$dir/call.c" <<'EOC'
#define MCS_DECLARE
#include "mcsample.h"
#include <stdio.h>
int main(void) {
    const float u[3] = {0.1f, 0.5f, 0.9f};
    float x[3], y[3], pdf[3];
    mcs_disk_sample_n(2.0f, 3, u, u, x, y, pdf);
    for (int k = 0; k < 3; k++) printf("%.6f %.6f %.6f\n", (double)x[k], (double)y[k], (double)pdf[k]);
    return 0;
}
EOC
$cc -std=c99 -w -I"$root" "$dir/call.c" "$dir/lib/libmcsample.a" -o "$dir/call" -lm 2>"$dir/log" &&
    "$dir/call" >"$dir/call.txt" && [ "$(wc -l <"$dir/call.txt")" = 3 ] && grep -q ' 0.079577$' "$dir/call.txt" # 1 / (4 pi)
check $? "C calls the static library" "$dir/log"
same() { # LANGUAGE STATUS: what it printed into $dir/said
    [ "$2" = 0 ] && cmp -s "$dir/said" "$dir/call.txt"
    check $? "$1 calls the library: the points that C gets" "$dir/log"
}
if has "$python" "nothing calls the shared library"; then
    "$python" examples/call.py "$dir/lib/libmcsample.so" >"$dir/said" 2>"$dir/log"
    same Python $?
fi
if has rustc "examples/call.rs is not tested"; then
    rustc -L "$dir/lib" examples/call.rs -o "$dir/call_rust" 2>"$dir/log" && "$dir/call_rust" >"$dir/said" 2>>"$dir/log"
    same Rust $?
fi

echo "took $(($(date +%s) - began)) s; all files in $1"
echo "$passed passed, $failed failed"
[ $failed = 0 ]
