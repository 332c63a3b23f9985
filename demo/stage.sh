# SPDX-License-Identifier: Apache-2.0
# What the demonstrations share: programs that are started and ended together, a broker on a free port. Sourced by them,
# after they have set `once`. Sets root, bin, work (a folder of its own), port and ASIP_BROKER.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${ASIP_BIN:-$root/build/dev/bin}
ctl=$bin/asipctl
work=$(mktemp -d "${TMPDIR:-/tmp}/asip-demo.XXXXXX")
declare -A pids=()
declare -a started=()

# Ends what was started, newest first, and waits for each; a process that does not end within three seconds is killed.
clean_up() {
    local i pid tries
    trap - EXIT
    trap '' HUP INT TERM # a second Ctrl-C must not leave the rest behind
    for ((i = ${#started[@]} - 1; i >= 0; i--)); do
        pid=${pids[${started[i]}]}
        kill -TERM -- "-$pid" 2>/dev/null || kill -TERM "$pid" 2>/dev/null || continue # a group begins a moment later
        for ((tries = 0; tries < 60; tries++)); do
            kill -0 -- "-$pid" 2>/dev/null || break
            sleep 0.05
        done
        kill -KILL -- "-$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
    rm -rf "$work"
}
trap clean_up EXIT
trap 'exit 129' HUP # the terminal was closed
trap 'exit 130' INT
trap 'exit 143' TERM

fail() {
    local name
    printf '\ndemo: %s\n' "$1" >&2
    for name in "${started[@]}"; do
        printf -- '--- last lines of %s\n' "$name" >&2
        tail -n 12 "$work/$name.log" >&2 || true
    done
    exit 1
}

# start NAME COMMAND...: in the background, its words in a log file. As a group of its own: a compiler's helpers end with it, and Ctrl-C ends
# nothing before clean_up does.
start() {
    local name=$1
    shift
    setsid "$@" >"$work/$name.log" 2>&1 </dev/null &
    pids[$name]=$!
    started+=("$name")
}

ended() { # ended NAME: waits for its end; with its status
    wait "${pids[$1]}" || return
    local i
    for i in "${!started[@]}"; do [ "${started[i]}" != "$1" ] || unset "started[i]"; done
    started=("${started[@]}")
}

within() { # within SECONDS WHAT COMMAND...: tries until it succeeds
    local until=$((SECONDS + $1)) what=$2
    shift 2
    until "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt $until ] || fail "$what did not happen in time"
        sleep 0.1
    done
}

step() { # ASIP_DEMO_PAUSE: seconds before each, for viewers of a recording
    sleep "${ASIP_DEMO_PAUSE:-0}"
    if [ -t 1 ]; then printf '\n\033[1m%s\033[0m\n' "$1"; else printf '\n%s\n' "$1"; fi
}
show() { # prints a command as a person would type it, then runs it
    printf '$ %s\n' "$*"
    "$@"
}
asipctl() { "$ctl" "$@"; }
sim() { "$bin/asip-sim" ctl --socket "$work/sim.sock" "$@"; }
part() { sim list | awk -v name="$1" '$1 == name { print $3 }'; } # what a part shows: an angle, on, off, ...

port_is_free() { ! (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }
for _ in {1..50}; do
    port=$((20000 + RANDOM % 12000))
    port_is_free $port && break
done
export ASIP_BROKER=127.0.0.1:$port


start_bus() { # the broker and a registry
    sed -e "s|^listener .*|listener $port 127.0.0.1|" -e "s|^persistence_location .*|persistence_location $work/|" \
        "$root/packaging/mosquitto/asip.conf" >"$work/mosquitto.conf"
    local mosquitto
    mosquitto=$(PATH=$PATH:/usr/sbin:/usr/local/sbin command -v mosquitto) || fail "mosquitto is not installed"
    start broker "$mosquitto" -c "$work/mosquitto.conf"
    within 20 "the broker's start" grep -q ' running$' "$work/broker.log" # its own word: another program may listen there
    start registry "$bin/asip-registry" --history "$work/history.db"
}
start_gateway() {
    start gateway "$bin/asip-gateway" --http 127.0.0.1:0
    within 20 "the gateway's start" page
}
start_boards() { # two simulated boards, desk and lamp, each with its agent
    local board
    for board in desk lamp; do
        sed -e "s|\.\./\.\./build/dev|$root/build/dev|" -e "s|\"link\": \"|&$work/|" "$root/demo/boards/$board.json" >"$work/$board.json"
    done
    start boards "$bin/asip-sim" --socket "$work/sim.sock" "$work/desk.json" "$work/lamp.json"
    for board in desk lamp; do
        within 5 "the start of board $board" test -e "$work/$board.port"
        start "agent-$board" "$bin/asip-agent" --serial "$work/$board.port" --name "$board" --state-dir "$work/state"
    done
    within 20 "both boards' announcement" boards_are 2
}
boards_are() { [ "$(asipctl list boards --state online -o name 2>/dev/null | wc -l)" -eq "$1" ]; }
# What a second terminal needs.
exports() {
    printf 'export ASIP_BROKER=%s ASIP_SOCKET=%s PATH=%s:$PATH' "$ASIP_BROKER" "$work/sim.sock" "$bin"
    [ -z "$(page 2>/dev/null)" ] || printf ' ASIP_GATEWAY=%s' "$(page)"
    echo
}
page_of() { echo "$(page)/#/board/$1"; } # page_of BOARD
page() { grep -om1 'listening  address=http[^ ]*' "$work/gateway.log" | cut -d= -f2; }
