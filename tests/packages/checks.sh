# SPDX-License-Identifier: Apache-2.0
# For the scripts of this folder: named checks that go on after a failure, and waiting for a condition.

failed=0

check() { # check "condition and outcome" COMMAND...
    local name=$1 output
    shift
    if output=$("$@" 2>&1); then
        printf 'ok      %s\n' "$name"
    else
        failed=$((failed + 1))
        printf 'FAILED  %s\n' "$name"
        sed 's/^/        /' <<<"$output" | tail -n 30
    fi
}

within() { # within SECONDS COMMAND...: tries until it succeeds
    local until=$((SECONDS + $1)) output
    shift
    until output=$("$@" 2>&1); do
        [ $SECONDS -lt $until ] || { printf 'not within the time: %s\n%s\n' "$*" "$output"; return 1; }
        sleep 0.2
    done
}

not() { ! "$@"; }

finish() { [ $failed -eq 0 ] || { printf '%d checks failed\n' $failed; exit 1; }; }
