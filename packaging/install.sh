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
    g++ cmake ninja-build pkg-config
    # studio
    qt6-base-dev qt6-tools-dev qt6-tools-dev-tools qt6-l10n-tools libqt6opengl6-dev 'qt6-svg-dev|libqt6svg6-dev'
    libgl-dev libegl-dev libepoxy-dev libpng-dev libturbojpeg0-dev
    # core
    libeigen3-dev libassimp-dev libcgal-dev libopenblas-dev liblapacke-dev libhwy-dev libxxhash-dev libsqlite3-dev
    libexpected-dev nlohmann-json3-dev libtinygltf-dev
    # at run time: OpenGL without a graphics card or display, Qt's X11 and Wayland platforms, fonts for both languages
    libegl1 libgl1-mesa-dri libxcb-cursor0 libxkbcommon-x11-0 qt6-wayland qt6-translations-l10n fonts-inter fonts-noto-cjk
)
test_packages=(doctest-dev librapidcheck-dev libbenchmark-dev xvfb xauth xdotool imagemagick
    # finite elements to compare with
    libgmsh-dev libsuitesparse-dev)
fuzz_packages=(clang libclang-rt-14-dev)

# npm may come from elsewhere, as one package with node.
command -v npm >/dev/null || test_packages+=(nodejs npm)

packages=("${build_packages[@]}")
case "${1:-build}" in
    build) ;;
    test) packages+=("${test_packages[@]}") ;;
    fuzz) packages+=("${test_packages[@]}" "${fuzz_packages[@]}") ;;
    *) echo "install.sh: \"$1\" is none of build, test, fuzz."; exit 2 ;;
esac

# Programs that exported files are tested with; tests that need them are skipped without. Blender is another one, of your own.
clients() {
    [ "${1:-build}" != build ] && command -v npm >/dev/null || return 0
    local folder
    folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../tests/clients" && pwd -P)
    [ "$folder/node_modules/.package-lock.json" -nt "$folder/package-lock.json" ] && return 0
    (cd "$folder" && npm ci --no-audit --no-fund --ignore-scripts && touch node_modules/.package-lock.json) ||
        echo "gltf-validator and three.js could not be installed: their tests will be skipped."
}
trap 'status=$?; [ $status -eq 0 ] && clients "$@"; exit $status' EXIT

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This is neither Debian nor Ubuntu: install the counterparts of these packages yourself: ${packages[*]}"
    exit 0
fi

# One call for all: a name per installed package, nothing for the others.
installed=$(IFS=' |'; dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' ${packages[*]} 2>/dev/null | sed -n 's/^.i //p' || true)
missing=()
for package in "${packages[@]}"; do
    grep -qxE "${package//+/\\+}" <<<"$installed" || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

echo "Installing: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "These packages are missing and neither root nor sudo is at hand. Have them installed by: apt-get install ${missing[*]}"
        exit 1
    fi
    as_root=(sudo)
fi
apt() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" </dev/null
}
# The name that this release knows.
known() {
    local name
    for name in ${1//|/ }; do
        if apt-cache show "$name" >/dev/null 2>&1; then echo "$name"; return; fi
    done
    echo "${1%%|*}"
}
install_missing() {
    local names=() package
    for package in "${missing[@]}"; do names+=("$(known "$package")"); done
    apt install --no-install-recommends "${names[@]}"
}
# Package lists may be missing or old: a failed first try is answered by an update.
if ! install_missing 2>/dev/null; then
    apt update
    install_missing
fi
