#!/bin/sh
# The renderer of the examples, $1: every strategy has the same mean within its error, maps are read, what is wrong is said in one
# line before any time is spent, results are not lost. $2: a folder for what it writes. Run by `make examples`.
render=$1 dir=$2
passed=0 failed=0
check() { # status, what
    if [ "$1" = 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)) && echo "FAIL $2"; fi
}
mkdir -p "$dir" && rm -rf "${dir:?}"/*

# Deviations are in standard errors of the difference to the most efficient strategy: one of five beyond 4 in 3000 runs. With 64
# samples the few that hit the mirrored sun leave the error of `uniform` anywhere from 0.008 to 0.036; with 256 it is known.
same_means() { # file, strategies: what was printed there is of so many, and no mean is off
    awk -v wanted="$2" '/^mean squared/ { exit }
        /^(uniform|cosine|brdf|env|mis|product|region|learned|angle|area) / && NF == 3 { n++; if ($3 > 4 || $3 < -4) print }
        END { if (n != wanted) print n + 0, "strategies" }' "$1" >"$dir/off.txt"
    [ ! -s "$dir/off.txt" ]
    check $? "render: means differ in $1: $(cat "$dir/off.txt")"
}
"$render" --strategy all --size 240x80 --spp 256 --out "$dir/all" >"$dir/all.txt"
check $? "render: every strategy"
same_means "$dir/all.txt" 8
"$render" --scene lamps --strategy all --size 240x80 --spp 256 --out "$dir/lamps" >"$dir/lamps.txt"
check $? "render: every strategy that fits lamps"
same_means "$dir/lamps.txt" 6
"$render" --scene haze --strategy all --size 240x80 --spp 256 --out "$dir/haze" >"$dir/haze.txt"
check $? "render: every strategy that fits haze"
same_means "$dir/haze.txt" 5
[ "$(grep -c '^strategy' "$dir/all.txt")" = 3 ]
check $? "render: three tables"
"$render" --scene room --strategy mis,region,learned --size 240x80 --spp 64 --out "$dir/room" >"$dir/room.txt"
check $? "render: a room"
same_means "$dir/room.txt" 3
"$render" --scene room --strategy mis,region,learned --size 240x80 --spp 8 --lights 8 --out "$dir/room" >"$dir/lights.txt"
check $? "render: many lights in a room"
same_means "$dir/lights.txt" 3

# Those that learn while they render: nothing may depend on which thread was first.
for scene in spheres room; do
    for threads in 1 4; do
        "$render" --scene $scene --strategy region,learned --size 120x40 --spp 24 --threads $threads \
            --out "$dir/by$threads" >"$dir/out.txt"
        check $? "render: $threads threads"
    done
    for strategy in region learned; do
        cmp -s "$dir/by1-$strategy.hdr" "$dir/by4-$strategy.hdr"
        check $? "render: the picture of $strategy depends on the number of threads in $scene"
    done
done

for threads in 1 4; do
    "$render" --scene haze --size 120x40 --spp 8 --threads $threads --out "$dir/by$threads" >"$dir/out.txt"
    check $? "render: $threads threads in haze"
done
cmp -s "$dir/by1-mis.hdr" "$dir/by4-mis.hdr"
check $? "render: the picture depends on the number of threads in haze"

# --- parts by several processes: joined they are a single run, to the bit; 21 rows are not as many in each of 4 parts

for scene in spheres room lamps haze; do
    many=uniform,cosine,brdf,env,mis,product
    rows=6
    [ $scene != lamps ] || many=uniform,cosine,brdf,mis,angle,area
    [ $scene != haze ] || { many=uniform,cosine,brdf,mis,angle && rows=5; }
    set -- --scene $scene --strategy $many --size 60x21 --spp 5 --lights 2
    "$render" "$@" --stops 1 --out "$dir/whole" --stack "$dir/whole.png" >"$dir/whole.txt"
    check $? "render: a whole picture of $scene"
    seq 4 | xargs -P 2 -I '{}' "$render" "$@" --threads 1 --out "$dir/$scene" --part '{}/4' >"$dir/out.txt" 2>"$dir/err.txt"
    check $? "render: parts of $scene: $(cat "$dir/err.txt")"
    # shellcheck disable=SC2012,SC2046
    "$render" --merge $(ls -r "$dir/$scene"-*-of-4.sums) --stops 1 --out "$dir/joined" --stack "$dir/joined.png" >"$dir/joined.txt"
    check $? "render: $scene joined"
    for file in $(echo $many | sed 's/[a-z]*/-&.png -&.hdr/g; s/,/ /g') .png; do
        cmp "$dir/whole$file" "$dir/joined$file" >"$dir/out.txt" 2>&1
        check $? "render: parts of $scene are not a single run: $(cat "$dir/out.txt")"
    done
    for run in whole joined; do # all columns but times and what comes of them
        awk '/^(uniform|cosine|brdf|env|mis|product|angle|area) / && NF == 8 { print $1, $2, $3, $6, $7 }' "$dir/$run.txt" >"$dir/$run.rows"
    done
    [ "$(wc -l <"$dir/whole.rows")" = $rows ] && cmp -s "$dir/whole.rows" "$dir/joined.rows" && [ "$(grep -c '^strategy' "$dir/joined.txt")" = 3 ]
    check $? "render: parts of $scene print other figures: $(cat "$dir/joined.txt")"
done
apart() { # part of the message, files: not joined, status 1 and one line before anything is written
    said=$1
    shift
    "$render" --out "$dir/apart" --merge "$@" >"$dir/out.txt" 2>"$dir/err.txt"
    [ $? = 1 ] && [ "$(wc -l <"$dir/err.txt")" = 1 ] && [ ! -s "$dir/out.txt" ] && grep -qF -e "$said" "$dir/err.txt" &&
        ! ls "$dir"/apart* >/dev/null 2>&1
    check $? "render: --merge where '$said': $(cat "$dir/err.txt")"
}
set -- "$dir/spheres-mis-1-of-4.sums" "$dir/spheres-mis-2-of-4.sums" "$dir/spheres-mis-3-of-4.sums"
apart 'part 4 of 4 of mis is missing' "$@"
apart 'part 2 of mis is given twice' "$@" "$2"
apart 'is no part of the same picture' "$@" "$dir/room-mis-4-of-4.sums"
apart 'part 1 of 4 of env is missing' "$@" "$dir/spheres-mis-4-of-4.sums" "$dir/spheres-env-3-of-4.sums"
apart 'No such file' "$@" "$dir/missing.sums"
head -c 2000 "$dir/spheres-mis-4-of-4.sums" >"$dir/cut.sums"
apart 'a damaged one' "$@" "$dir/cut.sums"
cat "$dir/spheres-mis-4-of-4.sums" "$dir/cut.sums" >"$dir/long.sums"
apart 'a damaged one' "$@" "$dir/long.sums"
sed '2s/mis/mit/' "$dir/spheres-mis-4-of-4.sums" >"$dir/other.sums"
apart 'a damaged one' "$@" "$dir/other.sums"
apart 'a damaged one' "$dir/whole.png"

# --- arguments

short() { # options: a small picture is rendered
    "$render" --size 30x10 --out "$dir/some" "$@" >"$dir/out.txt" 2>"$dir/err.txt"
    check $? "render: $*: $(cat "$dir/err.txt")"
}
wrong() { # part of the message, options: refused with status 2 in one line that has it, and no number with an exponent
    said=$1
    shift
    "$render" --size 30x10 --out "$dir/wrong" "$@" >"$dir/out.txt" 2>"$dir/err.txt"
    [ $? = 2 ] && [ "$(wc -l <"$dir/err.txt")" = 1 ] && [ ! -s "$dir/out.txt" ] && grep -qF -e "$said" "$dir/err.txt" &&
        ! grep -q '[0-9]e[-+]*[0-9]' "$dir/err.txt"
    check $? "render: $*: $(cat "$dir/err.txt")"
}
wrong 'from 1 to 1000000' --spp 0
wrong 'from 1 to 1000000' --spp=2.5
wrong 'from 1 to 4096' --lights none
wrong 'from 0.001 to 1000000' --seconds 0
wrong 'from 0.0000001 to 1' --error 2
wrong 'from -20 to 20' --stops 21
wrong 'from 1 to 1024' --threads=
wrong 'from 0 to 9000000000000000' --seed -1
wrong 'at most 33554432' --size 16384x16384
wrong 'WIDTHxHEIGHT' --size=60
wrong 'none of spheres, room, lamps, haze' --scene hall
wrong 'takes no map' --scene lamps a.hdr
wrong '--scene haze takes no map' --scene haze a.hdr
wrong "'env' is not for --scene lamps" --strategy env --scene lamps
wrong "'area' is not for --scene haze" --strategy area --scene haze
wrong "'area' is not for --scene room" --scene room --strategy mis,area
wrong 'is none of' --strategy mis,
wrong 'name is empty' --out ''
wrong 'name is empty' --out=
wrong 'name is empty' --stack ''
wrong 'name is empty' --beside=
wrong 'name is empty' ''
wrong 'value is missing' --spp
wrong 'unknown option' --bounces
wrong 'unknown option' --help=all
wrong 'only one map' a.hdr b.hdr
for part in 0/4 5/4 1 1/ 1/0 a/b 1/2/3 -1/4; do wrong 'is not K/N' --part $part; done
wrong '10 rows are no 11 parts' --part 1/11
wrong 'learn from the whole picture' --part 1/2 --strategy mis,region
wrong 'neither --seconds' --part 1/2 --seconds 1
wrong 'neither --seconds' --part 1/2 --error 0.1
wrong 'are for --merge' --part 1/2 --stack a.png
wrong 'are for --merge' --part 1/2 --stops 1
wrong 'is not for --merge' --merge a.sums

short --size=60x20 --strategy=brdf --spp=3
grep -q 'picture 60 x 20,' "$dir/out.txt" && [ "$(grep -c '^strategy' "$dir/out.txt")" = 1 ]
check $? "render: --size=60x20, one table for one strategy: $(cat "$dir/out.txt")"
short --spp 1 --strategy mis,env --stack "$dir/stack.png"
grep -q '^mis  *1 .*unknown  *unknown$' "$dir/out.txt" && [ "$(grep -c '^strategy' "$dir/out.txt")" = 1 ]
check $? "render: one sample tells no error: $(cat "$dir/out.txt")"
short --spp 1 --strategy mis,env --beside "$dir/beside.png"
[ "$(od -An -tu1 -j16 -N8 "$dir/beside.png" | tr -s ' ')" = ' 0 0 0 60 0 0 0 10' ]
check $? "render: --beside is twice as wide"
short --seconds 0.01 --error 0.9 # one sample has no error that could be small enough
awk '/^mis / { exit !($2 > 1 && $7 > 0) }' "$dir/out.txt"
check $? "render: --seconds and --error: $(cat "$dir/out.txt")"

# --- maps

header='#?RADIANCE\nFORMAT=32-bit_rle_%s\n\n'
four='\200\100\040\201\100\200\040\202\040\100\200\203\200\200\200\200' # pixels
# shellcheck disable=SC2059
printf "$header-Y 2 +X 2\n$four" rgbe >"$dir/plain.hdr"
printf '#?RGBE\r\n# made by hand\r\n\r\n-Y 2 +X 2\r\n%b' "$(echo "$four" | sed 's/\\/\\0/g')" >"$dir/crlf.hdr"
short --seed 2 "$dir/plain.hdr"
mv "$dir/some-mis.hdr" "$dir/plain-mis.hdr"
short --seed 2 "$dir/crlf.hdr"
cmp -s "$dir/some-mis.hdr" "$dir/plain-mis.hdr"
check $? "render: line ends change the picture"
short "$dir/all-mis.hdr" # what was written is read

refused() { # file, what is wrong with it, part of the message: status 1, one line, no picture, old ones untouched
    echo old >"$dir/none-mis.png"
    "$render" --size 30x10 --out "$dir/none" "$dir/$1" >"$dir/out.txt" 2>"$dir/err.txt"
    [ $? = 1 ] && [ "$(wc -l <"$dir/err.txt")" = 1 ] && grep -qF -e "$3" "$dir/err.txt" && [ ! -e "$dir/none-mis.hdr" ] &&
        [ "$(cat "$dir/none-mis.png")" = old ]
    check $? "render: $2: $(cat "$dir/err.txt")"
}
: >"$dir/empty.hdr"
printf 'nothing of the kind\n' >"$dir/other.hdr"
# shellcheck disable=SC2059
printf "$header-Y 2 +X 2\n$four" hsv >"$dir/hsv.hdr"
# shellcheck disable=SC2059
printf "$header-Y 4 +X 8\n\001\002" rgbe >"$dir/short.hdr"
# shellcheck disable=SC2059
printf "$header-Y 999999999 +X 999999999\n" rgbe >"$dir/huge.hdr"
# shellcheck disable=SC2059
printf "$header-Y -4 +X 0\n" rgbe >"$dir/sizes.hdr"
# shellcheck disable=SC2059
printf "$header-Y 1 +X 70000\n\200\200\200\201\001\001\001\157\001\001\001\021\001\001\001\001" rgbe >"$dir/wide.hdr"
# shellcheck disable=SC2059
printf "$header-Y 1 +X 2\n\0\0\0\0\0\0\0\0" rgbe >"$dir/black.hdr"
refused empty.hdr "an empty file" 'the file is empty'
refused other.hdr "another kind of file" 'no Radiance picture'
refused hsv.hdr "other colours" "'32-bit_rle_hsv'"
refused short.hdr "a truncated file" 'the file ends in scan line 1 of 4'
refused huge.hdr "a size beyond memory" 'more than the'
refused sizes.hdr "sizes below 1" 'two positive numbers'
refused wide.hdr "too wide for a table" 'more than a sampling table takes'
refused black.hdr "a black map" 'the map is black'
refused missing.hdr "no file" 'No such file'
refused . "a folder" 'directory'

# --- output

lost() { # what, options: status 1 and one line before anything is rendered
    what=$1
    shift
    "$render" --size 30x10 "$@" >"$dir/out.txt" 2>"$dir/err.txt"
    [ $? = 1 ] && [ "$(wc -l <"$dir/err.txt")" = 1 ] && [ ! -s "$dir/out.txt" ]
    check $? "render: $what: $(cat "$dir/err.txt")"
}
mkdir "$dir/taken-env.hdr"
lost "--out in no folder" --out "$dir/no/such"
lost "--out where a folder is" --strategy mis,env --out "$dir/taken"
lost "--part in no folder" --part 1/2 --out "$dir/no/such"
lost "--stack in no folder" --stack "$dir/no/such.png"
lost "--beside in no folder" --beside "$dir/no/such.png"
[ ! -e "$dir/taken-mis.png" ]
check $? "render: a file is left behind that was only tried"

if [ -c /dev/full ]; then
    full() { # what, standard output, options
        what=$1 output=$2
        shift 2
        "$render" --size 30x10 --spp 2 --out "$dir/full" "$@" >"$output" 2>"$dir/err.txt"
        [ $? = 1 ] && [ "$(wc -l <"$dir/err.txt")" = 1 ] && grep -q 'cannot write' "$dir/err.txt"
        check $? "render: $what on a full device: $(cat "$dir/err.txt")"
    }
    full results /dev/full
    full help /dev/full --help
    full "the stack" "$dir/out.txt" --stack /dev/full
    ln -sf /dev/full "$dir/full-mis.hdr"
    full "a picture" "$dir/out.txt"
    ln -sf /dev/full "$dir/full-mis-1-of-1.sums"
    full "a part" "$dir/out.txt" --part 1/1
else
    echo "SKIPPED: no /dev/full"
fi

# Under a constant map BRDF sampling reaches the error a hundred times sooner than the map's, during which the run is ended.
printf '#?RADIANCE\n\n-Y 1 +X 1\n\200\200\200\201' >"$dir/white.hdr"
"$render" --strategy brdf,env --spp 1000000 --error 0.001 --size 30x10 --out "$dir/cut" "$dir/white.hdr" >"$dir/cut.txt" 2>&1 &
cut=$! tries=0
until grep -qs "^brdf " "$dir/cut.txt" || [ $tries = 600 ]; do
    sleep 0.05
    tries=$((tries + 1))
done
kill $cut 2>/dev/null
wait $cut 2>/dev/null
[ $? = 143 ] && [ "$(grep -c '^brdf ' "$dir/cut.txt")" = 1 ]
check $? "render: what is done is not printed before all is: $(cat "$dir/cut.txt")"

echo "$passed passed, $failed failed"
[ $failed = 0 ]
