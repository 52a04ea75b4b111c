#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# demo.sh [SCENE]: setup, build, and the main job: an orbit about SCENE in 60 % of the time that full
# quality takes, judged against full quality.
set -euo pipefail

engine=/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb
scene=${1:-$engine}
# A file is named relative to where the user stands.
if [[ $scene != builtin:* ]]; then scene=$(realpath -m -- "$scene"); fi
cd "$(dirname "$0")/.."

scripts/setup.sh
if [[ $scene != builtin:* && ! -r $scene ]]; then
    echo "demo: error: cannot read $scene" >&2
    exit 1
fi

cmake --preset release
cmake --build --preset release -j "$(nproc)" --target lodestar_program

out=out/demo
rm -rf "$out"
mkdir -p "$out"
build/release/lodestar render "$scene" --budget 60% --frames 120 --path orbit --size 1280x720 \
    --reference --out "$out/frame.png" --json "$out/frame.json"

echo
echo "demo: written to $PWD/$out:"
ls -1 "$out" | sed 's/^/  /'
