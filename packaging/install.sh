#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the Debian or Ubuntu packages that Imomushi needs and that are missing; does nothing when none is.
#   packaging/install.sh [build|test|fuzz]
# build (default): to build and run the program; test: also what the tests need; fuzz: also what the fuzzers need.
# Everything printed goes to standard error. A name a|b is a package that is called a in some releases and b in others.
set -euo pipefail
exec >&2

build_packages=(
    # tools
    g++ cmake ninja-build pkg-config ccache mold
    # studio
    qt6-base-dev qt6-tools-dev qt6-tools-dev-tools qt6-l10n-tools libqt6opengl6-dev 'qt6-svg-dev|libqt6svg6-dev'
    libgl-dev libegl-dev libepoxy-dev libpng-dev libturbojpeg0-dev
    # core
    libeigen3-dev libassimp-dev libcgal-dev libopenblas-dev liblapacke-dev libsuitesparse-dev libtet1.5-dev libhwy-dev libxxhash-dev libsqlite3-dev
    libexpected-dev nlohmann-json3-dev libtinygltf-dev libdraco-dev libmeshoptimizer-dev
    # devices of live input
    libsdl2-dev librtmidi-dev
    # at run time: OpenGL without a graphics card or display, Qt's X11 and Wayland platforms, fonts for both languages
    libegl1 libgl1-mesa-dri libxcb-cursor0 libxkbcommon-x11-0 qt6-wayland qt6-translations-l10n fonts-inter fonts-noto-cjk
)
test_packages=(python3 doctest-dev librapidcheck-dev libbenchmark-dev xvfb xauth xdotool imagemagick
    # the studio as a screen reader has it
    at-spi2-core dbus gir1.2-atspi-2.0 python3-gi
    # finite elements to compare with
    libgmsh-dev)
fuzz_packages=(clang libclang-rt-14-dev)

# npm may come from elsewhere, as one package with node.
command -v npm >/dev/null || test_packages+=(nodejs npm)

kind="${1:-build}"
packages=("${build_packages[@]}")
case "$kind" in
    build) ;;
    test) packages+=("${test_packages[@]}") ;;
    fuzz) packages+=("${test_packages[@]}" "${fuzz_packages[@]}") ;;
    *) echo "install.sh: \"$kind\" is none of build, test, fuzz."; exit 2 ;;
esac

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}
apt() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -y -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" </dev/null
}
# The name that this release knows.
known() {
    local name
    for name in ${1//|/ }; do
        if apt-cache show "$name" >/dev/null 2>&1; then echo "$name"; return; fi
    done
    echo "${1%%|*}"
}
apt_install() {
    local names=() package
    for package in "$@"; do names+=("$(known "$package")"); done
    apt install --no-install-recommends "${names[@]}"
}

# install_packages NAME...: those that are missing. The status is 1 where they cannot be had.
install_packages() {
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        echo "This is neither Debian nor Ubuntu: install the counterparts of these packages yourself: $*"
        return 0
    fi
    local names="$*" installed package missing=()
    # One call for all: a name per installed package, nothing for the others.
    installed=$(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' ${names//|/ } 2>/dev/null | sed -n 's/^.i //p' || true)
    for package in "$@"; do
        grep -qxE "${package//+/\\+}" <<<"$installed" || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null; then
        echo "These packages are missing and neither root nor sudo is at hand. Have them installed by: apt-get install ${missing[*]}"
        return 1
    fi
    echo "Installing: ${missing[*]}"
    # Package lists may be missing or old: a failed first try is answered by an update.
    apt_install "${missing[@]}" 2>/dev/null || { apt update && apt_install "${missing[@]}"; }
}

# Programs that exported files are tested with; tests that need them are skipped without. Blender is another one, of your own.
install_clients() {
    local folder browser
    folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../tests/clients" && pwd -P)
    if [ ! "$folder/node_modules/.package-lock.json" -nt "$folder/package-lock.json" ]; then
        (cd "$folder" && npm ci --no-audit --no-fund --ignore-scripts && touch node_modules/.package-lock.json) ||
            echo "gltf-validator, three.js and tree-sitter could not be installed: tests of exported files will be skipped."
    fi
    for browser in chromium-headless-shell chromium chromium-browser google-chrome; do
        if command -v "$browser" >/dev/null; then return; fi
    done
    install_packages chromium-headless-shell || echo "Chromium could not be installed: exported files will not be tested in a browser."
}

install_packages "${packages[@]}"
[ "$kind" = build ] || install_clients
