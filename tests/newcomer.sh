#!/usr/bin/env bash
# The first steps of a newcomer who has only the program, in an empty folder: `tests/newcomer.sh PATH/OF/squall`. On
# failure, prints what failed and exits with 1.
set -euo pipefail
program=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin" "$folder/empty"
ln -s "$program" "$folder/bin/squall"
export PATH="$folder/bin:$PATH" XDG_RUNTIME_DIR="$folder"
cd "$folder/empty"

# Runs a command, and shows its output if it fails or its output lacks a text.
expect() {
    local text=$1 said
    shift
    if ! said=$("$@" 2>&1) || [[ $said != *"$text"* ]]; then
        printf 'FAILED: %s\nexpected %s in\n%s\n' "$*" "$text" "$said"
        exit 1
    fi
}

# The same for a command that must fail.
refuse() {
    local text=$1 said
    shift
    if said=$("$@" 2>&1) || [[ $said != *"$text"* ]]; then
        printf 'FAILED: %s\nexpected to fail with %s, and said\n%s\n' "$*" "$text" "$said"
        exit 1
    fi
}

expect "squall demo" squall
expect "Play:" squall help
expect "Examples:" squall run --help
expect "seas: " squall files
expect "blue" squall run strategy_4_vs_3 --no-record
expect "after 600 s" squall run surveyor_2v2 --sea fresh_breeze --blue learned --red strategy_3 --in-process --no-record
expect "after 600 s" squall run surveyor_2v2 --field jervis_bay_2023 --in-process --no-record
expect "significant" squall sea gale --plot gale.svg
expect "mode" squall strategy strategy_4
refuse "did you mean pav01_vs_pav01?" squall run pav1_vs_pav01
refuse "use it with squall run GAME --blue or --red" squall run strategy_4
refuse "is a sea, expected a game" squall run scenarios/seas/gale.toml

# The user's own file, which overrides the built-in one.
expect "scenarios/strategies/mine.toml" squall new strategy mine
expect "valid strategy" squall check scenarios/strategies/mine.toml
expect "after 600 s" squall run surveyor_2v2 --blue mine --in-process --no-record

# The game is played again each time the file is saved, with a mistake and without.
squall run surveyor_2v2 --blue mine --in-process --no-record --watch-files >watched.txt 2>&1 &
watching=$!
# Waits until this many lines of the output contain a text.
heard() {
    for _ in $(seq 300); do
        [[ $(grep -c "$2" watched.txt) -ge $1 ]] && return
        sleep 0.1
    done
    printf 'FAILED: run --watch-files never said %s %s times, but\n%s\n' "$2" "$1" "$(<watched.txt)"
    exit 1
}
heard 1 "waiting for changes"
cp scenarios/strategies/mine.toml whole.toml
printf 'about = gone\n' >scenarios/strategies/mine.toml
heard 1 'gone is not in quotes'
heard 2 "waiting for changes"
cp whole.toml scenarios/strategies/mine.toml
heard 2 "after 600 s"
kill -TERM $watching
wait $watching || [[ $? -eq 130 ]]
refuse "the file scenarios/strategies/mine.toml already exists" squall new strategy mine
for kind in boat sea game sweep training tournament; do
    expect "created scenarios/$kind" squall new "$kind" mine
done
for kind in boats seas games sweeps training tournaments; do
    expect "valid" squall check "scenarios/$kind/mine.toml"
done
expect "after 600 s" squall run mine --in-process --no-record
expect "scenarios/seas/gale.toml" squall copy gale
printf '\n[current]\nspeed_m_s = 99\n' >>scenarios/seas/gale.toml
refuse "scenarios/seas/gale.toml" squall run surveyor_2v2 --sea gale --in-process --no-record

expect "recorded" squall run pav01_vs_pav01 --in-process
expect "blue" squall log runs/*.mcap
expect "identical" squall replay runs/*.mcap --check
expect "_squall" squall completions bash
expect "man1" squall man man1
test -s man1/squall-run.1
printf 'a newcomer gets in: ok\n'
