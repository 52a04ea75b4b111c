#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what a build needs, by Debian package name. Does nothing when all is there.
set -euo pipefail

packages=(
    # tools
    g++ cmake ninja-build ccache pkg-config git
    # Vulkan: headers and loader, shader compiler, the CPU driver, validation for tests
    libvulkan-dev glslc mesa-vulkan-drivers vulkan-validationlayers
    # libraries
    libglm-dev libfmt-dev libexpected-dev nlohmann-json3-dev libcli11-dev
    libtinygltf-dev libdraco-dev libmeshoptimizer-dev libassimp-dev
    libopenexr-dev libstb-dev zlib1g-dev libzstd-dev libxxhash-dev
    # tests, sanitizers and format check
    libgtest-dev clang-14 libclang-rt-14-dev llvm-14 clang-format
    # the model that scripts/demo.sh renders
    assimp-testmodels
)

die() {
    echo "setup: error: $*" >&2
    exit 1
}

if [[ ! -r /etc/debian_version ]] || ! command -v apt-get >/dev/null; then
    die "this is not Debian. Install the equivalents of: ${packages[*]}"
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
    echo "setup: all ${#packages[@]} packages are installed"
    exit 0
fi

root=()
if ((EUID != 0)); then
    command -v sudo >/dev/null || die "run this as root, or install sudo. Missing: ${missing[*]}"
    root=(sudo)
fi

echo "setup: installing ${missing[*]}"
# One run must do, also where the package lists are old or were never fetched.
"${root[@]}" apt-get -q update || die "apt-get update failed: check the network and the sources"
"${root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y install --no-install-recommends "${missing[@]}" ||
    die "apt-get install failed. These are the package names of Debian 12"
echo "setup: done"
