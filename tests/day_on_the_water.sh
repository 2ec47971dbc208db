#!/usr/bin/env bash
# Runs the lines of "A day on the water" in docs/gateway.md, exactly as printed there, with emulated boats:
# `tests/day_on_the_water.sh PATH/OF/squall`. On failure, prints what failed and exits with 1.
set -euo pipefail
program=$(realpath "$1")
page=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../docs/gateway.md")
folder=$(mktemp -d)
started=()
cleanup() {
    ((${#started[@]} == 0)) || kill "${started[@]}" 2>/dev/null || true
    wait
    rm -rf "$folder"
}
trap cleanup EXIT
mkdir "$folder/bin"
ln -s "$program" "$folder/bin/squall"
PATH=$folder/bin:$PATH
cd "$folder"

fail() {
    exec >&2
    printf 'FAILED: %s\n' "$1"
    tail -n 20 ./*.txt || true
    exit 1
}

# Starts a command that keeps running, with its output in a file.
start() {
    local said=$1
    shift
    "$@" </dev/null >"$said.txt" 2>&1 &
    started+=($!)
}

# The address of a boat, once its emulator has printed it.
address() {
    for _ in $(seq 300); do
        grep -o 'tcp://[0-9.:]*' "$1.txt" 2>/dev/null && return
        sleep 0.1
    done
    fail "$1 has no address"
}

start water squall sim mixed_2v2 --afloat blue_one --afloat red_one --pace realtime --game water
start blue squall gateway emulate --game water --vehicle blue_one --listen tcp://127.0.0.1:0
start red squall gateway emulate --game water --vehicle red_one --listen tcp://127.0.0.1:0
blue_boat=$(address blue | head -n 1)
red_boat=$(address red | head -n 1)

# The lines of the section.
mapfile -t lines < <(awk '/^## /{here = /A day on the water/} here' "$page" | sed -n '/^```sh$/,/^```$/{/^```/d;p}')
((${#lines[@]} >= 15)) || fail "docs/gateway.md has ${#lines[@]} lines to type"
terminals=0
for line in "${lines[@]}"; do
    case $line in
    BLUE=*)
        eval "$line"
        # These boats exist.
        BLUE=$blue_boat RED=$red_boat
        ;;
    *"# in its own terminal")
        terminals=$((terminals + 1))
        [[ $line != "squall view"* ]] || line="${line%%#*} --listen 127.0.0.1:0"
        start "terminal_$terminals" bash -c "BLUE=$BLUE RED=$RED; exec $line"
        ;;
    *)
        # Like an operator who reads why it was refused and tries again.
        for attempt in $(seq 60); do
            eval "$line" >said.txt 2>&1 && break
            ((attempt < 60)) || fail "$line"
            sleep 1
        done
        ;;
    esac
done
grep -q "the recording, byte for byte" said.txt || fail "the replay"
printf 'a day on the water: ok, %d lines\n' "${#lines[@]}"
