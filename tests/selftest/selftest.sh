#!/bin/sh
# Shows that `make test` notices failure: runs it on the faulty programs of this directory and asks for a non-zero exit status and
# the expected last line. Takes MAKE and BUILD from the environment.
set -u
passed=0 failed=0

# expect WHAT ZERO|NONZERO LAST_LINE SOURCES [make arguments]; the last line - means any.
expect() {
    what=$1 want=$2 line=$3 tests=
    for t in $4; do tests="$tests tests/selftest/$t.c"; done
    shift 4
    output=$(MAKEFLAGS='' "${MAKE:-make}" --no-print-directory test TESTS="$tests" BUILD="${BUILD:-build/selftest}" "$@" 2>/dev/null)
    status=$?
    last=$(printf '%s\n' "$output" | tail -n 1)
    if [ $status = 0 ]; then got=ZERO; else got=NONZERO; fi
    if [ $got = "$want" ] && { [ "$line" = - ] || [ "$last" = "$line" ]; }; then
        passed=$((passed + 1))
        echo "ok   $what: exit status $status, last line \"$last\""
    else
        failed=$((failed + 1))
        echo "FAIL $what: exit status $status, last line \"$last\"; wanted $want, \"$line\""
        printf '%s\n' "$output"
    fi
}

expect 'no failure' ZERO '2 passed, 0 failed' passes
expect 'a failing case' NONZERO '1 passed, 1 failed' fails
expect 'a failing case among passing programs' NONZERO '3 passed, 1 failed' 'fails passes'
expect 'a crash' NONZERO '2 passed, 1 failed' 'passes crashes'
expect 'a crash after the summary' NONZERO '1 passed, 1 failed' late
expect 'no case run' NONZERO '2 passed, 1 failed' 'empty passes'
expect 'a test that does not compile' NONZERO - 'broken passes'
expect 'no test program' NONZERO '0 passed, 1 failed' ''
expect 'a filter' ZERO '1 passed, 0 failed' 'empty passes' FILTER=/two
expect 'a filter that matches nothing' NONZERO '0 passed, 1 failed' 'empty passes' FILTER=nothing
echo "$passed passed, $failed failed"
[ $failed = 0 ]
