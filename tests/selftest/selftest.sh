#!/bin/sh
# Shows that `make test` notices failure, and that it is calm otherwise: runs it on the programs of this directory, most of which
# are faulty, and asks for the exit status, the last line and what else is printed. Takes MAKE, BUILD and BEGAN from the environment.
set -u
passed=0 failed=0 began=${BEGAN:-$(date +%s)}

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

# says WHAT LINES PATTERN [make argument]: so many lines of `make test` on passing and failing programs match.
says() {
    count=$(MAKEFLAGS='' "${MAKE:-make}" --no-print-directory test TESTS='tests/selftest/passes.c tests/selftest/fails.c' \
        BUILD="${BUILD:-build/selftest}" "${4:-MCS_TEST_VERBOSE=}" 2>/dev/null | grep -c -e "$3")
    if [ "$count" = "$2" ]; then
        passed=$((passed + 1))
        echo "ok   $1: $count lines"
    else
        failed=$((failed + 1))
        echo "FAIL $1: $count lines that match \"$3\"; wanted $2"
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
says 'one line of a program in which all is well' 1 'passes: 2 passed, 0 failed, [0-9.]* s$'
says 'no detail, and of groups only those that failed' 1 '^ok \|a detail\|^FAIL selftest'
says 'what was skipped' 1 '^SKIPPED: something'
says 'the check that failed' 1 'fails.c:[0-9]*: selftest/nan: zero / zero <= 1: error = -\{0,1\}nan'
says 'detail and groups on request' 3 '^ok \|a detail\|^FAIL selftest' MCS_TEST_VERBOSE=1
says 'what it does' 1 '^make test: build and run '
says 'how long it took, and where the programs are' 1 '^took [0-9]* s; programs in '

# Every target that make help lists says so, too.
silent=$(awk -F: '/^[a-z-]+:[^#]*## / { name = $1; next }
    /^\t\$\(SAY\)$/ { said = name }
    /^\t.*(\$\(TOOK\)|BEGAN=\$\(NOW\))/ && said == name { told[name] }
    name != "" && /^$/ { if (name != "help" && !(name in told)) print name; name = "" }' Makefile)
if [ -z "$silent" ]; then
    passed=$((passed + 1))
    echo "ok   every target says what it does and how long it took"
else
    failed=$((failed + 1))
    printf 'FAIL these targets do not say what they do or how long it took:\n%s\n' "$silent"
fi
echo "took $(($(date +%s) - began)) s; programs in ${BUILD:-build/selftest}"
echo "$passed passed, $failed failed"
[ $failed = 0 ]
