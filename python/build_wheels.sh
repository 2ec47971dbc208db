#!/usr/bin/env bash
# Builds the wheel for this kind of machine and the source distribution: python/build_wheels.sh [FOLDER], python/dist by
# default.
#
# One wheel serves every CPython from 3.10 on (abi3). On Linux, zig (from PyPI, like maturin) links it against an old C
# library, so that it runs on systems from 2014 on (manylinux_2_17). With PLATFORM=linux it is linked against the host's
# library: this is faster, and the wheel runs on similar hosts. RUST_TARGET builds wheels for other machines:
# RUST_TARGET=aarch64-unknown-linux-gnu.
set -euo pipefail
out=$(realpath -m "${1:-"$(dirname "${BASH_SOURCE[0]}")/dist"}")
cd "$(dirname "${BASH_SOURCE[0]}")"

tools=target/wheel_tools
python3 -m venv "$tools"
"$tools/bin/pip" install -q "maturin[zig]>=1.9,<2"
PATH=$PWD/$tools/bin:$PATH

options=(--release --locked --out "$out")
if [[ -n ${RUST_TARGET:-} ]]; then
    rustup target add "$RUST_TARGET"
    options+=(--target "$RUST_TARGET")
fi
if [[ $(uname) == Linux ]]; then
    if [[ ${PLATFORM:-} == linux ]]; then
        options+=(--compatibility linux)
    else
        options+=(--zig --compatibility "${PLATFORM:-manylinux_2_17}")
    fi
fi
maturin build "${options[@]}"
maturin sdist --out "$out"
ls -l "$out"
